"""Figure 5: phase curves at eta = 0.4, e = 0.7, D = 0.005, the three states told apart by colour."""

import numpy as np

from ..curves import KINDS, curve, panel_at
from ..paper.resolution import ELASTIC

ETA = 0.4
PANELS = 1
POINTS = 4000  # a period
CAPTION = "Phase curves for eta = 0.4, e = 0.7, D = 0.005: (a) motion of both masses, (b) relative motion."
METHOD = "Started from the up-sweep's response at eta = 0.4; one period, states sampled inside the FMU and both sides of each impact."


def panels(sweeps):
    """The one response it shows."""
    return [panel_at(sweeps[0], ELASTIC, ETA)]


def compute(fmu, panel, skip, keep):
    """One period of it, and the panel."""
    return curve(fmu, panel, skip, keep, POINTS), panel


def draw(data):
    """Draw both phase planes; returns the figure."""
    from .canvas import BLUE, GREY, RED, XI_REL, XI_REL_RATE, relative
    from .canvas import panels as make

    figure, (left, right) = make(1, 2, (10, 4.6))
    state, kind, colours = data.state.values, data.kind.values, (BLUE, RED, GREY)
    _, gap, rate = relative(data, 0)
    curves = [(left, state[:, 0], state[:, 2], "-"), (left, state[:, 1], state[:, 3], "--"), (right, gap, rate, "-")]
    for axes, x, v, style in curves:
        for index, colour in enumerate(colours):
            shown = np.where(kind == index, 1.0, np.nan)
            width = 2.5 if index == 2 and axes is left else 1.0
            label = KINDS[index] if style == "-" else None
            axes.plot(x * shown, v * shown, style, color=colour, linewidth=width, label=label, marker="o" if index == 2 and axes is right else "")
    left.set(title=r"(a) both masses: solid $\xi_1$, dashed $\xi_2$", xlabel=r"$\xi_i$", ylabel=r"$\xi'_i$")
    right.set(title="(b) relative motion", xlabel=XI_REL, ylabel=XI_REL_RATE)
    right.legend(fontsize=8)
    return figure
