"""Short records of known structures."""

import functools

import numpy as np

import orchestrate
from orchestrate.diagnosis.evidence import Evidence
from orchestrate.diagnosis.order_windows import checked_base_and_faces, compute_orders

HALVES = {"m1": 1.5, "m2": 1.2, "f1": 30.0, "f2": 38.0, "zeta1": 0.02, "zeta2": 0.02, "e": 0.5}
BEAM = orchestrate.Structure.from_halves(**HALVES)
SWEEP = orchestrate.SweptSine(first=26.0, last=42.0, duration=10.0, acceleration=5.0)
RATE = 600.0


@functools.cache
def record(structure=BEAM, noise=0.0, both=True, seed=1, sweep=SWEEP, rate=RATE):
    """What sensors of a bandwidth of rate/2.4 read, with noise as a part of each channel's rms."""
    history = orchestrate.shake(structure, sweep, sample_rate=rate, progress=False)
    felt = orchestrate.measure(
        history, orchestrate.Sensor(bandwidth=rate / 2.4, sample_rate=rate), excitation=sweep
    )
    rng = np.random.default_rng(seed)
    names = ["box_acceleration", "acceleration1", *(["acceleration2"] if both else [])]
    channels = {name: felt[name].values for name in names}
    noisy = {
        name: values + noise * values.std() * rng.standard_normal(len(values))
        for name, values in channels.items()
    }
    return orchestrate.record(time=felt.time.values, **noisy)


def seen_at(one, other=None, structure=BEAM, **options):
    """What sensors read that stand where the mode is ``one`` and ``other`` times the mass's."""
    felt = record(structure, **options)
    base = felt.box_acceleration
    read = {"box_acceleration": base.values}
    for name, factor in (("acceleration1", one), ("acceleration2", other)):
        if factor is not None:
            read[name] = (base + factor * (felt[name] - base)).values
    return orchestrate.record(time=felt.time.values, **read)


def guess(**changes):
    """The beam, some percent off."""
    return BEAM.replace(f1=31.5, f2=36.5, zeta1=0.03, zeta2=0.015, e=0.6).replace(**changes)


def record_orders(record):
    return compute_orders(checked_base_and_faces(record))


def record_evidence(record):
    return Evidence.from_orders(record_orders(record))
