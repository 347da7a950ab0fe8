"""Figures 6, 10, 11: stroboscopic samples of the gap over the frequency ratio, semi-logarithmic."""

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402 - after the backend was chosen

from .files import write  # noqa: E402

METHOD = (
    "One sequential sweep upwards, 0.1 <= eta <= 8.0 by 0.001, each frequency started from the end of the last, stroboscopic samples taken inside "
    "the FMU's steps after the periods dropped."
)


def draw(dataset, path):
    """Draw an orbit diagram into a file.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of :func:`orchestrate.orbit.dataset`.
    path : Path
        PNG file; written whole or not at all.
    """
    figure = picture(dataset)
    try:
        write(figure, path, dpi=150, format="png")
    finally:
        plt.close(figure)


def picture(dataset):
    """An orbit diagram in the paper's manner, with the impacts per period below it; returns the figure."""
    order = np.argsort(dataset.eta.values, kind="stable")
    eta = dataset.eta.values[order]
    samples = dataset.xi_rel.values[order]
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(12, 8), sharex=True, height_ratios=(3, 1), layout="constrained")
    shown = np.where(samples > 0.0, samples, np.nan)
    top.plot(np.repeat(eta, samples.shape[1]), shown.ravel(), ",k", alpha=0.6, rasterized=True)
    top.set_yscale("log")
    if np.isfinite(shown).any():
        top.set_ylim(max(np.nanmin(shown), 1e-5) / 1.5, np.nanmax(shown) * 1.5)
    top.set_ylabel(r"$\xi_{\mathrm{Rel}}(nT)$")
    first, last = int(dataset.sample.values[0]), int(dataset.sample.values[-1])
    attributes = dataset.attrs
    top.set_title(f"$e = {attributes['e']:g}$, $D = {attributes['D']:g}$, $n = {first}(1){last}$", loc="left")
    bottom.plot(eta, dataset.impacts_per_period.values[order], ",k", rasterized=True)
    bottom.set_yscale("log")
    bottom.set_ylabel("impacts per $T$")
    bottom.set_xlabel(r"$\eta$")
    bottom.set_xlim(eta.min(), eta.max() if eta.max() > eta.min() else eta.min() + 1e-3)
    for axes in (top, bottom):
        axes.grid(True, which="major", alpha=0.3)
    return figure
