"""Figure 12: phase curves of both masses at the main resonance peak of the three cases, one scale."""

import numpy as np

from ..curves import curve, panel_at
from ..paper.resolution import CASES

PANELS = 3
POINTS = 2000  # a period
CAPTION = (
    "Phase curves of both masses at the main resonance peak: (a) close to elastic impact, low internal damping; (b) close to elastic impact, "
    "significant internal damping; (c) close to plastic impact, low internal damping. Solid: mass 1, dotted: mass 2; a jump is an impact."
)
METHOD = "The peak of each up-sweep's largest xi_Rel is found, and its response followed for one more period."


def panels(sweeps):
    """The response at each sweep's largest gap."""
    return [panel_at(sweep, case, float(sweep.xi_rel_max.idxmax())) for sweep, case in zip(sweeps, CASES.values(), strict=True)]


def compute(fmu, panel, skip, keep):
    """One period of it, and the panel."""
    return curve(fmu, panel, skip, keep, POINTS), panel


def draw(data):
    """Draw the three phase planes on one scale; returns the figure."""
    from .canvas import BLACK, RED
    from .canvas import panels as make

    figure, axes = make(1, 3, (12, 4.6))
    reach = 1.08 * float(np.abs(data.state).max())
    for index, plane in enumerate(axes):
        state = data.state.values[data.panel_of.values == index]
        plane.plot(state[:, 0], state[:, 2], "-", color=BLACK, linewidth=1.0, label=r"$m_1$")
        plane.plot(state[:, 1], state[:, 3], ":", color=RED, linewidth=1.4, label=r"$m_2$")
        values = [float(data[name][index]) for name in ("e", "D", "eta")]
        plane.set_title(rf"({'abc'[index]}) $e = {values[0]:g}$, $D = {values[1]:g}$, $\eta = {values[2]:.3f}$")
        plane.set_xlabel(r"$\xi_i$")
        plane.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    axes[0].set_ylabel(r"$\xi'_i$")
    axes[0].legend(fontsize=8)
    return figure
