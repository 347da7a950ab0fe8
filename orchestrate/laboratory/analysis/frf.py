"""Frequency response functions of the masses over the box or a force, and their coherence.

SciPy estimates the spectra: pyFRF 1.5 takes only sampling rates that are whole numbers, divides
by omega^2 on the way (no line at 0 Hz), and does not know the error of overlapping segments.
"""

from __future__ import annotations

import numpy as np

from ...errors import InputError
from ...lazy import xr
from ...response.labels import Variable, variable, yes_or_no
from ..record import FORCES
from .channels import (
    BOX,
    Channels,
    Floats,
    channel_coordinate,
    checked_finite,
    divide_into_segments,
    frequency_coordinate,
)
from .knocks import Knocks

ESTIMATORS = ("H1", "H2", "Hv")
EXCITED = 1e-2  # of the largest power density of the excitation: below, a response has no meaning
KINDS = {  # of excitation: its name, density and unit, and the response's and its unit
    BOX: ("box", "box_psd", "m2/s4/Hz", "acceleration over the box's", "1"),
    **{
        name: (f"force on mass {name[-1]}", "force_psd", "N2/Hz", "acceleration over force", "1/kg")
        for name in FORCES
    },
}


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
        ``acceleration2`` in m/s2; or a result of :func:`orchestrate.shake`. Without the box's
        acceleration ``force1`` or ``force2`` in N stands for it.
    resolution : float, optional
        Distance of the lines, Hz. A segment takes 1/resolution: it should be several times as long
        as a free vibration takes to decay. By default 16 segments fit into the record; of knocks
        one reaches to the next.
    window : str
        ``"hann"``, ``"hamming"``, ``"blackman"``, ``"blackmanharris"``, ``"flattop"`` or
        ``"boxcar"``. Knocks of a hammer have a force window and an exponential one in place of it
        (:class:`orchestrate.laboratory.analysis.knocks.Knocks`).
    overlap : float
        Part of a segment that the next one shares; of knocks none.

    Returns
    -------
    xarray.Dataset
        ``magnitude`` (over a force in 1/kg) and ``phase`` in rad over ``estimator`` (H1, H2, Hv),
        ``channel`` and ``frequency`` in Hz; ``coherence``, and ``random_error``, the standard
        deviation of the magnitude relative to it, over ``channel`` and ``frequency``; ``box_psd``
        in m2/s4/Hz (of a force ``force_psd`` in N2/Hz) and ``excited``, whether that is a hundredth
        of its largest value at least (0 Hz is not); scalars ``averages``, ``resolution`` and, of
        knocks, ``window_decay`` in 1/s, which the exponential window adds to that of the structure.
        The coherence of a single knock, which would be 1, is NaN.

    Warns
    -----
    UserWarning
        Where knocks are double hits, which are left out.

    Notes
    -----
    H1 is right where the noise is on the response, H2 where it is on the excitation, Hv where
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
    channels = Channels.from_record(record)
    driving, drive = driving_channel(record, channels)
    names, responses = channels.responses()
    if not names:
        raise InputError("record: no acceleration1, m/s2; frf needs it and the excitation")
    knocks = None if driving == BOX else Knocks.find_in_force(drive, channels, resolution)
    if knocks is not None:
        window, overlap = "force and exponential", 0.0
        averages, spacing = float(len(knocks.starts)), channels.sample_rate / knocks.length
        spectra = knocks.compute_spectra(drive, responses)
    else:
        segments = divide_into_segments(channels, resolution, window, overlap, fewest=2)
        averages, spacing = segments.independent_count, segments.resolution
        spectra = segments.compute_spectra(drive, responses, channels.sample_rate)
    made = frf_variables(driving, averages, *spectra)
    made["resolution"] = variable((), spacing, "Hz", "distance of the lines")
    if knocks is not None:
        text = "rate at which the exponential window falls"
        made["window_decay"] = variable((), knocks.window_decay, "1/s", text)
    text = f"estimator: noise on the response, on the {KINDS[driving][0]}, on both"
    estimator: Variable = "estimator", np.array(ESTIMATORS), {"long_name": text}
    coordinates = {
        "estimator": estimator,
        "channel": channel_coordinate(names),
        "frequency": frequency_coordinate(spectra[0]),
    }
    settings = {"window": window, "overlap": overlap, "excitation": driving}
    return channels.result("frf", "Frequency response", made, coordinates, **settings)


def driving_channel(record: xr.Dataset, channels: Channels) -> tuple[str, Floats]:
    """Return name and values of the channel that excites: the box's, or a force."""
    if BOX in channels.names and np.ptp(channels.box) > 0.0:
        return BOX, channels.box
    forces = [name for name in FORCES if name in record]
    if len(forces) != 1:
        steady = f"{BOX} does not change" if BOX in channels.names else f"no {BOX}"
        lacking = " and ".join(forces) or steady
        text = f"expected {BOX} over time, in m/s2, or one of force1 and force2, in N"
        raise InputError(f"record: {lacking}; {text}")
    return forces[0], checked_finite(forces[0], record[forces[0]], channels.time)


def frf_variables(
    driving: str,
    averages: float,
    frequency: Floats,
    drive_psd: Floats,
    response_psd: Floats,
    cross: Floats,
) -> dict[str, Variable]:
    """Return the estimates and their errors from spectra of what drives and of the responses."""
    with np.errstate(divide="ignore", invalid="ignore"):
        estimates = h1_h2_and_hv(drive_psd, response_psd, cross)
        coherence = np.minimum(np.abs(cross) ** 2 / (drive_psd * response_psd), 1.0)
        coherence = np.where(averages > 1.0, coherence, np.nan)
        error = np.sqrt((1.0 - coherence) / (2.0 * coherence * averages))
    word, density, density_unit, quotient, unit = KINDS[driving]
    excited = (drive_psd >= EXCITED * drive_psd.max()) & (frequency > 0.0)
    over_all = ("estimator", "channel", "frequency")
    over_channels = ("channel", "frequency")
    text = "standard deviation of the magnitude over the magnitude"
    density_text = f"power spectral density of the {word}"
    excited_text = f"whether the {word} shakes the structure there"
    return {
        "magnitude": variable(over_all, np.abs(estimates), unit, quotient),
        "phase": variable(over_all, np.angle(estimates), "rad", f"phase against the {word}'s"),
        "coherence": variable(over_channels, coherence, "1", f"coherence with the {word}"),
        "random_error": variable(over_channels, error, "1", text),
        density: variable("frequency", drive_psd, density_unit, density_text),
        "excited": yes_or_no("frequency", excited, excited_text),
        "averages": variable((), averages, "1", "independent averages"),
    }


def h1_h2_and_hv(drive_psd: Floats, response_psd: Floats, cross: Floats) -> Floats:
    """Estimate H1, H2 and Hv from spectra of what drives, of the responses, and between them."""
    power = np.abs(cross) ** 2
    difference = response_psd - drive_psd
    root = np.sqrt(difference**2 + 4.0 * power)
    # both forms are the same number; each is taken where its difference does not cancel
    forms = (difference + root) / (2.0 * np.conj(cross)), 2.0 * cross / (root - difference)
    total = np.where(difference > 0.0, *forms)
    return np.stack([cross / drive_psd, response_psd / np.conj(cross), total])
