"""The pictures inside the FMU: the mechanical system (Figure 4) and an example run."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402 - after the backend was chosen
from matplotlib.patches import Rectangle  # noqa: E402


def spring(axes, x, y, length):
    """A zigzag from (x, y) to the right."""
    n = 9
    xs = [x, x + 0.15 * length] + [x + length * (0.15 + 0.7 * (i + 0.5) / n) for i in range(n)] + [x + 0.85 * length, x + length]
    ys = [y, y] + [y + (0.16 if i % 2 else -0.16) for i in range(n)] + [y, y]
    axes.plot(xs, ys, "k", lw=1.4)


def damper(axes, x, y, length):
    """A dashpot from (x, y) to the right."""
    middle = x + 0.5 * length
    axes.plot([x, middle - 0.18], [y, y], "k", lw=1.4)
    axes.plot([middle + 0.18, middle - 0.18, middle - 0.18, middle + 0.18], [y + 0.16, y + 0.16, y - 0.16, y - 0.16], "k", lw=1.4)
    axes.plot([middle + 0.05, middle + 0.05], [y - 0.11, y + 0.11], "k", lw=1.4)
    axes.plot([middle + 0.05, x + length], [y, y], "k", lw=1.4)


def draw_scheme(path, width=4.8):
    """Two masses in a shaken box (Figure 4)."""
    figure, axes = plt.subplots(figsize=(width, width * 0.5))
    axes.add_patch(Rectangle((0, 0), 10, 4, fill=False, lw=2.5))
    for x, name in ((3.4, "$m_1$"), (5.0, "$m_2$")):
        axes.add_patch(Rectangle((x, 1.1), 1.6, 1.8, facecolor="0.85", edgecolor="k", lw=1.6))
        axes.text(x + 0.8, 2.0, name, ha="center", va="center", fontsize=13)
    for x, stiffness, dashpot in ((0.0, "$k_1$", "$d_1$"), (6.6, "$k_2$", "$d_2$")):
        spring(axes, x, 2.5, 3.4)
        damper(axes, x, 1.5, 3.4)
        axes.text(x + 1.7, 2.95, stiffness, ha="center", fontsize=12)
        axes.text(x + 1.7, 0.75, dashpot, ha="center", fontsize=12)
    axes.annotate("", (4.9, 3.35), (3.5, 3.35), arrowprops={"arrowstyle": "->"})
    axes.annotate("", (6.5, 3.35), (5.1, 3.35), arrowprops={"arrowstyle": "->"})
    axes.text(4.2, 3.45, "$x_1$", ha="center", fontsize=11)
    axes.text(5.8, 3.45, "$x_2$", ha="center", fontsize=11)
    axes.annotate("", (6.2, -0.55), (3.8, -0.55), arrowprops={"arrowstyle": "<->", "lw": 1.6})
    axes.text(5.0, -1.15, r"$a\,\sin\,\Omega t$", ha="center", fontsize=12)
    axes.set(xlim=(-0.2, 10.2), ylim=(-1.3, 4.2))
    axes.set_aspect("equal")
    axes.axis("off")
    figure.savefig(path, dpi=100, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)


def draw_example(times, values, path):
    """Displacements, gap and permanent contact over time.

    Parameters
    ----------
    times : ndarray, shape (n,)
    values : dict of ndarray
        x1, x2, x_rel, in_contact.
    path : Path
        SVG file.
    """
    with plt.rc_context({"svg.hashsalt": "vibroimpact", "svg.fonttype": "none"}):
        figure, (top, bottom) = plt.subplots(2, 1, figsize=(9, 5), sharex=True, layout="constrained")
        top.plot(times, values["x1"], label=r"$\xi_1$")
        top.plot(times, values["x2"], label=r"$\xi_2$", ls="--")
        bottom.plot(times, values["x_rel"], "k", label=r"$\xi_{Rel}$")
        for axes in (top, bottom):
            low, high = axes.get_ylim()
            axes.fill_between(times, low, high, where=values["in_contact"] > 0, color="0.88", lw=0)
            axes.set_ylim(low, high)
            axes.legend(loc="upper right")
        bottom.set_xlabel(r"$\tau$")
        figure.savefig(Path(path), format="svg", metadata={"Date": None, "Creator": "matplotlib"})
        plt.close(figure)
