"""Figure 9: typical phase curves in the second irregular region, 2.61 < eta < 3.77, e = 0.7, D = 0.005; the last 500 of 2500 periods."""

from ..curves import curve, panel_at
from ..paper.resolution import ELASTIC
from .figure8 import METHOD, draw

__all__ = ("CAPTION", "METHOD", "compute", "draw", "panels")
ETAS = (2.60, 2.65, 2.69, 2.737, 2.83, 2.92, 3.05, 3.17, 3.30, 3.49, 3.56, 3.70)
PANELS = len(ETAS)
POINTS = 60  # a period, beside both sides of each impact
CAPTION = "Typical phase curves in the second irregular region 2.61 < eta < 3.77; T, nT: periodic."


def panels(sweeps):
    """The responses it shows."""
    return [panel_at(sweeps[0], ELASTIC, eta) for eta in ETAS]


def compute(fmu, panel, skip, keep):
    """One phase curve, and its panel."""
    return curve(fmu, panel, skip, keep, POINTS), panel
