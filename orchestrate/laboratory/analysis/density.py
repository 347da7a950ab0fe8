"""How often which acceleration occurs: its probability density, skewness and kurtosis."""

from __future__ import annotations

import warnings
from functools import partial

import numpy as np

from ...lazy import xr
from ...model.ranges import checked_range
from ...response.labels import Variable, variable
from .channels import Channels, Floats

PARTS = 16  # of the record, for standard errors


def probability_density(record: xr.Dataset, *, bins: int = 100) -> xr.Dataset:
    """Estimate the probability density of the acceleration of each channel of a record.

    Parameters
    ----------
    record : xarray.Dataset
        As for :func:`orchestrate.frf`.
    bins : int
        Of equal width from the least to the largest acceleration of a channel.

    Returns
    -------
    xarray.Dataset
        ``density`` in s2/m over ``channel`` and ``bin``, with the coordinate ``acceleration`` in
        m/s2, the middle of each bin; over ``channel``: ``mean`` and ``standard_deviation`` in m/s2,
        ``skewness`` (0 for a symmetric density), ``kurtosis`` (3 for a Gaussian one, 1.5 for a
        sine), ``skewness_error`` and ``kurtosis_error``.

    Notes
    -----
    Standard errors come from 16 parts of the record: the standard deviation of the parts' values
    over the square root of their number. They say nothing where the record is not stationary. A
    channel that does not move has skewness and kurtosis NaN.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam")
    >>> noise = orchestrate.Random(psd=[(2.0, 0.01), (30.0, 0.01)], duration=60.0, seed=1)
    >>> answer = orchestrate.probability_density(orchestrate.shake(beam, noise))
    >>> abs(float(answer.skewness.sel(channel="box_acceleration"))) < 0.2
    True
    """
    channels = Channels.from_record(record)
    number = round(checked_range("bins", bins, low=4, high=100_000))
    counted = [np.histogram(channel, number, density=True) for channel in channels.values]
    middles = np.stack([0.5 * (edges[:-1] + edges[1:]) for _, edges in counted])
    density = np.stack([heights for heights, _ in counted])
    over = ("channel", "bin")
    return channels.result(
        "probability_density",
        "Probability density",
        {
            "density": variable(over, density, "s2/m", "probability density"),
            **moments_with_errors(channels.values),
        },
        {
            "bin": variable("bin", np.arange(number), "1", "number of the bin"),
            "acceleration": variable(over, middles, "m/s2", "acceleration in the bin's middle"),
        },
    )


def moments_with_errors(values: Floats) -> dict[str, Variable]:
    """Compute the moments of channels; skewness and kurtosis of a constant one are NaN."""
    from scipy.stats import kurtosis, skew

    made = {
        "mean": variable("channel", values.mean(axis=1), "m/s2", "mean value"),
        "standard_deviation": variable("channel", values.std(axis=1), "m/s2", "standard deviation"),
    }
    errors, parts = {}, np.array_split(values, PARTS, axis=1)
    powers = {"skewness": ("third", skew), "kurtosis": ("fourth", partial(kurtosis, fisher=False))}
    for name, (power, moment) in powers.items():
        text = f"{power} moment over the deviation's {power} power"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # of a part that does not move
            whole, *some = (
                np.where(np.ptp(part, axis=1) > 0.0, moment(part, axis=1), np.nan)
                for part in (values, *parts)
            )
        error = np.std(some, axis=0, ddof=1) / PARTS**0.5
        made[name] = variable("channel", whole, "1", text)
        text = f"standard error of the {name}"
        errors[f"{name}_error"] = variable("channel", error, "1", text)
    return made | errors
