"""Figure 11: bifurcation diagram for e = 0.3, D = 0.005; its data is the up-sweep of section 3.1, which ``orchestrate.paper.sweeps`` computes."""

from .orbit_diagram import METHOD
from .orbit_diagram import picture as draw

__all__ = ("CAPTION", "METHOD", "draw")
CAPTION = "Bifurcation diagram for e = 0.3, D = 0.005: stroboscopic samples of the gap, and below them the impacts per excitation period."
