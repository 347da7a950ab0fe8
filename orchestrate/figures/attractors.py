"""Coexisting attractors of the case of Figure 6: what random starts lead to, and how many of them."""

import numpy as np

TITLE = "Coexisting attractors"
CAPTION = (
    "Random starts, e = 0.7, D = 0.005. Above: largest xi_Rel of each attractor found, its size the share of starts that lead to it; black: "
    "periodic, red: not periodic. Below: number of attractors; where responses are irregular the number depends on the clustering's threshold."
)
ARTEFACT = "Where an impact falls on the sampling phase itself, samples show either side of it, and a periodic response may count as another kind."
METHOD = (
    "At each frequency random starts in a box three times the up-sweep's largest gap, followed for at least 300 eta periods and sampled; responses "
    "are clustered by multiplicity, impacts per period, largest gap, mean and deviation of the samples (2 % for periodic ones, 25 % for others). "
    + ARTEFACT
)


def draw(data):
    """Draw attractors and their number over eta; returns the figure."""
    from .canvas import BLACK, RED, XI_REL
    from .canvas import panels as make

    figure, (top, bottom) = make(2, 1, (12, 6.5), sharex=True, height_ratios=(3, 1))
    for k in range(data.sizes["attractor"]):
        part = data.isel(attractor=k)
        colours = np.where(part.multiplicity.values > 0, BLACK, RED)
        top.scatter(part.eta, part.xi_rel_max, 40.0 * part.share.values, c=colours, linewidths=0, alpha=0.7)
    top.set(yscale="log", ylabel=rf"max {XI_REL}")
    bottom.step(data.eta, data.number, "-k", where="mid", linewidth=0.8)
    bottom.set(ylabel="attractors", xlabel=r"$\eta$", xscale="log", ylim=(0, None))
    bottom.minorticks_off()
    bottom.set_xticks([0.5, 0.7, 1, 1.4, 2, 3, 5, 8], ["0.5", "0.7", "1", "1.4", "2", "3", "5", "8"])
    return figure
