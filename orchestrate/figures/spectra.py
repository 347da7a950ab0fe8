"""Spectra of the absolute acceleration of mass 1, bonded against delaminated, as in the paper's Figure 3."""

TITLE = "Spectra (the paper's Figure 3)"
CAPTION = (
    "Amplitude spectra of the absolute acceleration of mass 1, bonded (blue) and delaminated (black), at the resonance peak and at two other "
    "frequencies; e = 0.7, D = 0.005. Red: what sampled accelerations show, without the impacts' impulses."
)
METHOD = (
    "64 settled periods, 1024 states each sampled inside the FMU; the acceleration's spectrum is omega^2 times that of the absolute displacement, "
    "which holds the impulses as kinks. A Hann window."
)
FLOOR = 1e-4  # of the largest amplitude


def draw(data):
    """One panel a frequency; returns the figure."""
    from .canvas import BLACK, BLUE, RED
    from .canvas import panels as make

    figure, axes = make(data.sizes["eta"], 1, (11, 3.0 * data.sizes["eta"]), sharex=True)
    for index, plane in enumerate(axes):
        part = data.isel(eta=index)
        top = float(part.amplitude.max())
        for kind, colour, width in (("delaminated", BLACK, 0.9), ("sampled", RED, 0.6), ("bonded", BLUE, 1.6)):
            label = {"sampled": "delaminated, sampled acceleration"}.get(kind, kind)
            plane.semilogy(data.order, part.amplitude.sel(kind=kind), color=colour, linewidth=width, label=label)
        plane.set(title=rf"$\eta = {float(part.eta):.3f}$", ylabel="amplitude", ylim=(FLOOR * top, 2.0 * top))
    axes[0].legend(fontsize=8)
    axes[-1].set_xlabel(r"multiples of $\eta$")
    axes[-1].set_xlim(0, float(data.order.max()))
    return figure
