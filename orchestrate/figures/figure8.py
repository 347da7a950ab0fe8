"""Figure 8: typical phase curves in the first irregular region, 0.43 < eta < 1.37, e = 0.7, D = 0.005; the last 500 of 2500 periods."""

from ..curves import curve, panel_at
from ..paper.resolution import ELASTIC

ETAS = (0.45, 0.49, 0.59, 0.63, 0.70, 0.80, 0.88, 1.047, 1.08, 1.13, 1.24, 1.31)
PANELS = len(ETAS)
POINTS = 150  # a period, beside both sides of each impact
CAPTION = "Typical phase curves in the first irregular region 0.43 < eta < 1.37; T, nT: periodic."
METHOD = "Each started from the up-sweep's response; states sampled inside the FMU and both sides of each impact, after the periods dropped."


def panels(sweeps):
    """The responses it shows."""
    return [panel_at(sweeps[0], ELASTIC, eta) for eta in ETAS]


def compute(fmu, panel, skip, keep):
    """One phase curve, and its panel."""
    return curve(fmu, panel, skip, keep, POINTS), panel


def draw(data):
    """Draw the phase planes; returns the figure."""
    from .phase_grid import draw_grid

    return draw_grid(data)
