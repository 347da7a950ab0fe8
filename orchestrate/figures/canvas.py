"""What the figures share: matplotlib without a screen, one look, and pictures written whole or not at all."""

from typing import Any

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402 - after the backend was chosen

from .files import write  # noqa: E402

LOOK: Any = {
    "axes.grid": True,
    "grid.alpha": 0.25,
    "axes.titlelocation": "left",
    "axes.titlesize": 9,
    "axes.labelsize": 10,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "savefig.dpi": 110,
}
plt.rcParams.update(LOOK)
BLACK, BLUE, RED, GREY = "black", "tab:blue", "tab:red", "0.55"
XI_REL, XI_REL_RATE = r"$\xi_{\mathrm{Rel}}$", r"$\xi'_{\mathrm{Rel}}$"


def panels(rows, columns, size, **more):
    """A figure with its axes as a flat list."""
    figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained", **more)
    return figure, list(axes.ravel())


def save(figure, path, formats=("png", "pdf")):
    """Write a figure as pictures beside each other, each whole or not at all, and close it.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    path : Path
        Without an ending.
    formats : sequence of str
    """
    try:
        for ending in formats:
            metadata = {"CreationDate": None} if ending == "pdf" else {"Software": None}
            write(figure, f"{path}.{ending}", format=ending, metadata=metadata)
    finally:
        plt.close(figure)


def relative(data, panel):
    """tau, xi_Rel and xi'_Rel of one panel of a curve dataset."""
    part = data.isel(point=data.panel_of.values == panel)
    state = part.state.values
    return part.tau.values, state[:, 1] - state[:, 0], state[:, 3] - state[:, 2]


def kind_of(multiplicity):
    """A response's kind in the paper's words."""
    return {0: "not periodic", 1: "$T$"}.get(int(multiplicity), f"${int(multiplicity)}T$")
