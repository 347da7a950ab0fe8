"""The pictures inside the MotorShaker FMU: the mechanical system, and its reference run."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402 - after the backend was chosen
from matplotlib.patches import Circle, Rectangle  # noqa: E402

from .fmu_pictures import damper, spring  # noqa: E402


def draw_shaker(path, width=4.2):
    """A box on a spring and a damper, with a motor that turns an unbalance."""
    figure, axes = plt.subplots(figsize=(width, width * 0.5))
    axes.plot([0, 0], [0, 4], "k", lw=2.5)
    spring(axes, 0.0, 2.9, 3.0)
    damper(axes, 0.0, 1.1, 3.0)
    axes.add_patch(Rectangle((3.0, 0.2), 4.6, 3.6, fill=False, lw=2.5))
    axes.add_patch(Circle((5.3, 2.0), 1.2, facecolor="0.92", edgecolor="k", lw=1.6))
    axes.plot([5.3, 6.1], [2.0, 2.75], "k", lw=1.6)
    axes.add_patch(Circle((6.1, 2.75), 0.22, color="k"))
    texts = ((1.5, 3.35, "$k_b$"), (1.5, 0.3, "$c_b$"), (3.5, 0.55, "$M_t$"), (5.35, 2.6, r"$\varphi$"), (6.65, 3.15, "$m_u$"), (8.6, 2.35, "$F$"))
    for x, y, text in texts:
        axes.text(x, y, text, ha="center", fontsize=12)
    axes.annotate("", (9.4, 2.0), (7.6, 2.0), arrowprops={"arrowstyle": "->", "lw": 1.6})
    axes.annotate("", (6.2, 4.4), (4.2, 4.4), arrowprops={"arrowstyle": "->"})
    axes.text(5.2, 4.55, "$y$", ha="center", fontsize=12)
    axes.set(xlim=(-0.3, 9.8), ylim=(-0.1, 5.2))
    axes.set_aspect("equal")
    axes.axis("off")
    figure.savefig(path, dpi=100, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)


def draw_run_up(times, speed, position, path):
    """Speed of the rotor and position of the box over time.

    Parameters
    ----------
    times, speed, position : ndarray
        s, rad/s, m.
    path : Path
        SVG file.
    """
    with plt.rc_context({"svg.hashsalt": "vibroimpact", "svg.fonttype": "none"}):
        figure, (top, bottom) = plt.subplots(2, 1, figsize=(9, 5), sharex=True, layout="constrained")
        top.plot(times, speed, "k", lw=1.0)
        top.set_ylabel(r"$\dot\varphi$ in rad/s")
        bottom.plot(times, 1e3 * position, "k", lw=0.6)
        bottom.set_ylabel("$y$ in mm")
        bottom.set_xlabel("$t$ in s")
        figure.savefig(Path(path), format="svg", metadata={"Date": None, "Creator": "matplotlib"})
        plt.close(figure)
