"""The largest Lyapunov exponent along the sweeps of the three cases, with its uncertainty and the verdict."""

from ..lyapunov import CHAOTIC, PERIODIC, QUASI_PERIODIC

TITLE = "Largest Lyapunov exponent"
CAPTION = (
    "Largest Lyapunov exponent per unit of tau along the up-sweeps (e, D) = (0.7, 0.005), (0.7, 0.05), (0.3, 0.005), bars of three standard "
    "errors. Red: chaotic; blue: neutral, that is quasi-periodic or not decided; black: periodic."
)
METHOD = (
    "Exact flow matrices between the impacts that the FMU reports and saltation matrices at them; chattering's end projects the deviation on the "
    "common motion. Validated in the tests against differences of neighbouring runs of the FMU, and against -D without impacts. The standard error "
    "is that of seven batches."
)
COLOURS = {CHAOTIC: ("tab:red", "chaotic"), QUASI_PERIODIC: ("tab:blue", "neutral"), PERIODIC: ("black", "periodic")}


def draw(*cases):
    """One panel a case; returns the figure."""
    from .canvas import panels as make

    figure, axes = make(len(cases), 1, (12, 3.0 * len(cases)), sharex=True, sharey=True)
    for plane, data in zip(axes, cases, strict=True):
        for verdict, (colour, label) in COLOURS.items():
            part = data.isel(eta=data.verdict.values == verdict)
            plane.errorbar(part.eta, part.exponent, 3.0 * part.error, fmt=".", color=colour, markersize=3, linewidth=0.5, label=label)
        plane.axhline(0.0, color="0.5", linewidth=0.8)
        plane.set(ylabel=r"$\lambda$", title=data.attrs["title"].partition(", ")[2])
    axes[0].set_ylim(-0.1, max(0.05, 1.2 * max(float(data.exponent.max()) for data in cases)))
    axes[0].legend(fontsize=8)
    axes[-1].set_xlabel(r"$\eta$")
    return figure
