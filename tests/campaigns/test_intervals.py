"""Stated 95 % intervals of ``fit`` on noisy records of the model itself hold the truth."""

import math
from collections import Counter

import numpy as np
import pytest
import xarray as xr
from scipy.stats import binomtest

import orchestrate
from orchestrate.errors import VibroimpactError

from .findings import expect_none

RATE, DURATION = 900.0, 12.0  # Hz, s
FITTED = ("f1", "f2", "zeta1", "zeta2", "e")
WITHIN = 1.96  # standard errors
HOLDS = (0.92, 0.98)  # of the trials, for each number


def simulate_record(
    beam: orchestrate.Structure, middle: float, noise: float, rng: np.random.Generator
) -> xr.Dataset:
    """Simulate what sensors on base and halves read, with noise, in a swept sine."""
    sweep = orchestrate.SweptSine(
        first=0.75 * middle, last=1.3 * middle, duration=DURATION, acceleration=5.0
    )
    history = orchestrate.shake(beam, sweep, sample_rate=RATE, progress=False)
    sensor = orchestrate.Sensor(bandwidth=400.0, sample_rate=RATE)
    felt = orchestrate.measure(history, sensor, excitation=sweep)
    read = {}
    for name in ("box_acceleration", "acceleration1", "acceleration2"):
        values = felt[name].values
        read[name] = values + noise * values.std() * rng.standard_normal(len(values))
    return orchestrate.record(time=felt.time.values, **read)


def fit_noisy_record(rng: np.random.Generator) -> dict[str, float]:
    """Fit a noisy record, by a guess up to 10 % off; return each error over its stated one."""
    middle, apart = rng.uniform(33.0, 50.0), math.sqrt(rng.uniform(1.1, 1.4))
    first, second = rng.permutation([middle / apart, middle * apart]).tolist()
    zeta = np.exp(rng.uniform(math.log(0.008), math.log(0.02), 2)).tolist()
    m1 = float(rng.uniform(0.5, 3.0))
    truth = {"f1": first, "f2": second, "zeta1": zeta[0], "zeta2": zeta[1]}
    truth["e"] = float(rng.uniform(0.35, 0.85))
    masses = {"m1": m1, "m2": m1 * float(rng.uniform(0.6, 1.67))}
    beam = orchestrate.Structure.from_halves(**masses, **truth)
    record = simulate_record(beam, middle, float(rng.uniform(0.01, 0.05)), rng)
    off = {name: truth[name] * float(rng.uniform(0.9, 1.1)) for name in ("f1", "f2")}
    guess = orchestrate.Structure.from_halves(**masses, **off, zeta1=0.012, zeta2=0.012, e=0.6)
    answer = orchestrate.fit(record, guess, jobs=1, progress=False).sel(parameter=list(FITTED))
    errors = answer.value.values - [truth[name] for name in FITTED]
    return dict(zip(FITTED, (errors / answer.standard_error.values).tolist(), strict=True))


@pytest.mark.slow
@pytest.mark.budget(3)  # trials: of fewer no share is unlikely
def test_intervals_hold_the_truth(exported, seed, budget):
    """A finding is a share outside 92 to 98 % at a level of 0.1 %, or a fit without an answer."""
    counts, findings = Counter[str](), []
    for number in range(budget):
        try:
            errors = fit_noisy_record(np.random.default_rng([seed, number]))
        except VibroimpactError as error:
            findings.append(f"trial {number}: {error}")
            continue
        for name, error in errors.items():
            counts += {name: math.isfinite(error), f"{name} in its interval": abs(error) <= WITHIN}
    for name in FITTED:
        held, of = counts[f"{name} in its interval"], counts[name]
        findings += [f"{name}: only {held} of {of}"] * is_unlikely(held, of, HOLDS[0], "less")
        findings += [f"{name}: {held} of {of}"] * is_unlikely(held, of, HOLDS[1], "greater")
    expect_none(findings, counts)


def is_unlikely(held: int, of: int, share: float, side: str) -> bool:
    """Return whether a share of so many would be on that side by chance once in a thousand."""
    return not of or bool(binomtest(held, of, share, side).pvalue < 1e-3)
