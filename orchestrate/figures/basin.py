"""Basins of attraction in a plane of starts, at one frequency of 1.07-1.37."""

TITLE = "Basins of attraction"
CAPTION = (
    "Which attractor a start leads to: gap and gap velocity at phase 0, mass 1 at rest in its middle; e = 0.7, D = 0.005. The frequency is the one "
    "of 1.07-1.37 at which random starts share themselves most evenly between two periodic attractors."
)
METHOD = "Each point is a start of the FMU, followed until settled and told apart as in the random starts."
SHOWN = 5  # attractors with a colour of their own


def draw(data):
    """Draw the plane; returns the figure."""
    from matplotlib.colors import ListedColormap

    from .canvas import XI_REL, XI_REL_RATE
    from .canvas import panels as make

    colours = ["#1b3a5c", "#e8a33d", "#5fa777", "#b8412f", "#8a6bb1", "#cccccc"]
    figure, (plane,) = make(1, 1, (8, 6.5))
    labels = data.attractor_of.values.clip(max=SHOWN)
    plane.pcolormesh(data.gap, data.rate, labels, cmap=ListedColormap(colours), vmin=-0.5, vmax=SHOWN + 0.5, rasterized=True)
    for k in range(min(SHOWN, data.sizes["attractor"])):
        n, impacts, gap = (float(data[name][k]) for name in ("multiplicity", "impacts_per_period", "xi_rel_max"))
        kind = f"{int(n) if n > 1 else ''}T" if n else "not periodic"
        label = f"{kind}, {impacts:.2f} impacts per T, largest gap {gap:.3g}: {float(data.share[k]):.1%}"
        plane.plot([], [], "s", color=colours[k], label=label)
    plane.set(xlabel=rf"{XI_REL}(0)", ylabel=rf"{XI_REL_RATE}(0)", title=rf"$\eta = {float(data.attrs['eta']):.3f}$")
    plane.grid(False)
    plane.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.1))
    return figure
