"""Records for tests: of signals that are known, and of shaken structures."""

import math
from functools import lru_cache

import numpy as np
import xarray as xr

import orchestrate
from orchestrate import Random, SweptSine, shake

from ..files import BEAM, CHANNELS

HEAVY, DAMPED, LIGHT = (BEAM.replace(zeta1=zeta, zeta2=zeta) for zeta in (0.1, 0.04, 0.01))
SWEEP = SweptSine(first=30.0, last=60.0, duration=20.0, acceleration=5.0)
ANALYSES = (
    *("frf", "psd", "track_orders", "harmonics", "spectrogram"),
    *("shock_spectrum", "probability_density"),
)


def make(rate, *channels, begin=0.0, **attributes):
    """A record of some channels at equal times."""
    time = begin + np.arange(len(channels[0])) / rate
    names = zip(CHANNELS, channels, strict=False)
    return xr.Dataset(
        {name: ("time", np.asarray(values)) for name, values in names},
        {"time": time},
        {"sample_rate": rate, **attributes},
    )


def of_shaken(data):
    """The record of a shaken structure: accelerations between impacts."""
    return make(
        data.attrs["sample_rate"], data.box_acceleration.values, data.a1_abs.values, data.a2_abs
    )


def transfer(structure, frequency):
    """Acceleration of the bonded masses over the box's."""
    m, k, d = (getattr(structure, x + "1") + getattr(structure, x + "2") for x in "mkd")
    w = 2.0 * math.pi * np.asarray(frequency)
    return (k + 1j * w * d) / (k - m * w**2 + 1j * w * d)


@lru_cache
def random_record(structure, seed, duration, rate=500.0):
    """Random vibration from 10 to 150 Hz, after the start is forgotten."""
    noise = Random(psd=[(10.0, 0.2), (150.0, 0.2)], duration=duration, seed=seed)
    data = shake(structure, noise, sample_rate=rate, progress=False)
    return of_shaken(data).sel(time=slice(2.0, None))


@lru_cache
def swept_record(structure, sweep=SWEEP, rate=1000.0):
    """A swept sine."""
    return of_shaken(shake(structure, sweep, sample_rate=rate, progress=False))


@lru_cache
def analyses():
    """The answers of all analyses of one record."""
    return {name: getattr(orchestrate, name)(swept_record(LIGHT)) for name in ANALYSES}
