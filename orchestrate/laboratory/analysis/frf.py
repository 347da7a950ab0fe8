"""Frequency response functions of the masses over the box's acceleration, and their coherence.

SciPy estimates the spectra: pyFRF 1.5 takes sampling rates that are whole numbers alone, divides
by omega^2 on the way (no line at 0 Hz), and does not know the error of overlapping segments.
"""

from __future__ import annotations

import numpy as np

from ...errors import InputError
from ...lazy import xr
from ...response.labels import variable, yes_or_no
from .channels import (
    BOX,
    Channels,
    Floats,
    attributes,
    averaging,
    channel_coordinate,
    frequency_coordinate,
)

ESTIMATORS = ("H1", "H2", "Hv")
EXCITED = 1e-2  # of the largest power density of the box: below, a response has no meaning


def frf(
    record: xr.Dataset,
    *,
    resolution: float | None = None,
    window: str = "hann",
    overlap: float = 0.5,
) -> xr.Dataset:
    """Estimate the frequency response functions of a record.

    Parameters
    ----------
    record : xarray.Dataset
        Over ``time``: ``box_acceleration``, ``acceleration1`` and, where measured,
        ``acceleration2`` in m/s2; or a result of :func:`orchestrate.shake`.
    resolution : float, optional
        Distance of the lines, Hz. A segment takes 1/resolution: it should be several times as long
        as a free vibration takes to decay. By default 16 segments fit into the record.
    window : str
        ``"hann"``, ``"hamming"``, ``"blackman"``, ``"blackmanharris"``, ``"flattop"`` or
        ``"boxcar"``.
    overlap : float
        Part of a segment that the next one shares.

    Returns
    -------
    xarray.Dataset
        ``magnitude`` and ``phase`` in rad over ``estimator`` (H1, H2, Hv), ``channel`` and
        ``frequency`` in Hz; ``coherence``, and ``random_error``, the standard deviation of the
        magnitude relative to it, over ``channel`` and ``frequency``; ``box_psd`` in m2/s4/Hz
        and ``excited``, whether that is a hundredth of its largest value at least (0 Hz is not);
        scalars ``averages`` and ``resolution``.

    Notes
    -----
    H1 is right where the noise is on the response, H2 where it is on the box's channel, Hv where
    both channels have the same (Shin and Hammond, Fundamentals of Signal Processing, 2008, 9.2).
    The random error is ``sqrt((1 - c)/(2 c n))`` for a coherence c and n independent averages
    (Bendat and Piersol, Random Data, 4th ed., 9.2.4). Mean values are removed from each segment.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam").as_bonded()
    >>> noise = orchestrate.Random(psd=[(2.0, 0.01), (30.0, 0.01)], duration=60.0, seed=1)
    >>> answer = orchestrate.frf(orchestrate.shake(beam, noise), resolution=0.25)
    >>> float(answer.magnitude.sel(estimator="H1", channel="acceleration1").idxmax())
    12.5
    """
    from scipy.signal import csd, welch

    channels = Channels.from_record(record, (BOX,))
    names, responses = channels.responses()
    if not names:
        raise InputError("record: no acceleration1; expected it beside the box's, in m/s2")
    segments = averaging(channels, resolution, window, overlap, fewest=2)
    rate, options = channels.sample_rate, segments.options
    frequency, box = welch(channels.box, rate, **options)
    response = welch(responses, rate, **options)[1]
    cross = csd(channels.box, responses, rate, **options)[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        estimates = estimate(box, response, cross)
        coherence = np.minimum(np.abs(cross) ** 2 / (box * response), 1.0)
        error = np.sqrt((1.0 - coherence) / (2.0 * coherence * segments.independent))
    excited = (box >= EXCITED * box.max()) & (frequency > 0.0)
    over_all = ("estimator", "channel", "frequency")
    over_channels = ("channel", "frequency")
    text = "standard deviation of the magnitude over the magnitude"
    return xr.Dataset(
        {
            "magnitude": variable(over_all, np.abs(estimates), "1", "acceleration over the box's"),
            "phase": variable(over_all, np.angle(estimates), "rad", "phase against the box's"),
            "coherence": variable(over_channels, coherence, "1", "coherence with the box"),
            "random_error": variable(over_channels, error, "1", text),
            "box_psd": variable("frequency", box, "m2/s4/Hz", "power spectral density of the box"),
            "excited": yes_or_no(
                "frequency", excited, "whether the box shakes the structure there"
            ),
            "averages": variable((), segments.independent, "1", "independent averages"),
            "resolution": variable((), segments.resolution, "Hz", "distance of the lines"),
        },
        {
            "estimator": (
                "estimator",
                np.array(ESTIMATORS),
                {"long_name": "estimator: noise on the response, on the box, on both"},
            ),
            **channel_coordinate(names),
            **frequency_coordinate(frequency),
        },
        attributes("frf", "Frequency response", channels.title, window=window, overlap=overlap),
    )


def estimate(box: Floats, response: Floats, cross: Floats) -> Floats:
    """Estimate H1, H2 and Hv from spectra of the box, of the responses, and between them."""
    power = np.abs(cross) ** 2
    difference = response - box
    root = np.sqrt(difference**2 + 4.0 * power)
    # both forms are the same number; each is taken where its difference does not cancel
    total = np.where(
        difference > 0.0,
        (difference + root) / (2.0 * np.conj(cross)),
        2.0 * cross / (root - difference),
    )
    return np.stack([cross / box, response / np.conj(cross), total])
