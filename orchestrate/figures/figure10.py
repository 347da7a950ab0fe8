"""Figure 10: bifurcation diagram for e = 0.7, D = 0.05; its data is the up-sweep of section 3.1, which ``orchestrate.paper.sweeps`` computes."""

from .orbit_diagram import METHOD
from .orbit_diagram import picture as draw

__all__ = ("CAPTION", "METHOD", "draw")
CAPTION = "Bifurcation diagram for e = 0.7, D = 0.05: stroboscopic samples of the gap, and below them the impacts per excitation period."
