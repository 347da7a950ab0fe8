"""Maps over (eta, e), (eta, D) and (eta, kappa): where does a delamination show best?"""

import numpy as np

TITLE = "Parameter maps"
CAPTION = (
    "Impacts per period, multiplicity, largest xi_Rel and largest impulse (over m_1 omega a eta^2) over frequency and restitution, damping, and "
    "detuning kappa = k_2/k_1; the other parameters are those of Figure 6. A delamination shows best where the impulse is largest."
)
ARTEFACT = "Where an impact falls on the sampling phase itself, samples show either side of it, and a periodic response may count as another kind."
METHOD = (
    "Each point starts from rest and is followed until settled; impulses are those of single impacts, which the FMU reports at their times. "
    + ARTEFACT
)
PARAMETERS = ("e", "D", "kappa")
COLUMNS = (
    ("impacts_per_period", "impacts per $T$"),
    ("multiplicity", "multiplicity"),
    ("xi_rel_max", r"max $\xi_{Rel}$"),
    ("impulse_max", "largest impulse"),
)

SHADES = ["#1f77b4", "#ff7f0e", "#2ca02c", "#9467bd", "#8c564b", "#e377c2", "#bcbd22", "#17becf", "#222222"]  # 1 to 7, 8 and more, none


def draw(*maps):
    """One row of maps a parameter; returns the figure."""
    from matplotlib.colors import ListedColormap, LogNorm

    from .canvas import panels as make

    figure, axes = make(len(maps), len(COLUMNS), (15, 3.4 * len(maps)))
    for row, (parameter, data) in enumerate(zip(PARAMETERS, maps, strict=True)):
        for column, (name, title) in enumerate(COLUMNS):
            plane, values = axes[row * len(COLUMNS) + column], data[name].values
            shades: dict = {"norm": LogNorm(*np.quantile(values[values > 0.0], (0.01, 1.0)))}
            if name == "multiplicity":
                values, shades = np.where(values == 0, 9, np.minimum(values, 8)), {"vmin": 0.5, "vmax": 9.5, "cmap": ListedColormap(SHADES)}
            elif name == "impacts_per_period":
                shades = {"vmin": 0, "vmax": 10}
            picture = plane.pcolormesh(data.eta, data[parameter], values, rasterized=True, **shades)
            bar = figure.colorbar(picture, ax=plane)
            if name == "multiplicity":
                bar.set_ticks(range(1, 10), labels=["1", "2", "3", "4", "5", "6", "7", "8+", "none"])
            plane.set_title(title if row == 0 else "")
            plane.set_yscale("log" if parameter == "D" else "linear")
            plane.grid(False)
            label = r"$\kappa$" if parameter == "kappa" else f"${parameter}$"
            plane.set(ylabel="" if column else label, xlabel=r"$\eta$")
    return figure
