"""Figure 11: bifurcation diagram for e = 0.3, D = 0.005; its data is the up-sweep of section 3.1, which ``orchestrate.paper.sweeps`` computes."""

CAPTION = "Bifurcation diagram for e = 0.3, D = 0.005: stroboscopic samples of the gap, and below them the impacts per excitation period."
METHOD = (
    "One sequential sweep upwards, 0.1 <= eta <= 8.0 by 0.001, each frequency started from the end of the last, stroboscopic samples taken inside "
    "the FMU's steps after the periods dropped."
)


def draw(data):
    """Draw it; returns the figure."""
    from .orbit_diagram import picture

    return picture(data)
