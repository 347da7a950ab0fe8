"""Campaign on standard errors: 95 % intervals of fits on noisy simulated records."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import orchestrate
from orchestrate.errors import VibroimpactError

from . import roc
from .campaign import BatchOutcome, Campaign
from .diagnosis_rows import FITTED, WITHIN

RATE, DURATION = 900.0, 12.0  # Hz, s
ENDS = (0.75, 1.3)  # of the sweep, over the common frequency
NOISE = (0.01, 0.05)  # over the root mean square of each channel
OFF = 0.1  # of a guess's frequencies, at most
COLUMNS = ("noise", "misfit", *FITTED)


class IntervalCampaign(Campaign):
    """Campaign: how often stated 95 % intervals of fits hold the truth."""

    name = "intervals"
    title = "Do stated intervals hold the truth?"
    asks = (
        "`fit` on records of the model itself: two halves 10 to 40 % apart, damping ratios of 0.8 "
        "to 2 %, restitution of 0.35 to 0.85, a sweep of 12 s, two sensors, noise of 1 to 5 %, "
        "guesses off by up to 10 %. Intervals of 1.96 standard errors on both sides are to hold "
        "the truth in 92 to 98 % of the trials, of each number. A finding is a fit without an "
        "answer. Of real contacts: [above](#trust-diagnosis)."
    )
    unit = "trials"
    target = 300
    batch = 1
    measures = "error in standard errors"
    package = True

    def run(self, fmu: Path, seed: int, count: int) -> BatchOutcome:
        """Fit ``count`` noisy records; return the outcome."""
        rows, notes, worst = [], [], 0.0
        for number in range(count):
            rng = np.random.default_rng([seed, number])
            try:
                row = fit_noisy_record(rng)
            except VibroimpactError as error:
                notes.append(f"seed {seed}, trial {number}: {error}")
                continue
            rows.append(row)
            worst = max([worst, *(abs(value) for value in row[2:] if value is not None)])
        return BatchOutcome(count, len(notes), worst, notes=tuple(notes), rows=tuple(rows))

    def report(self, rows: Sequence[Sequence[Any]]) -> list[str]:
        """Return Markdown lines on how many intervals held the truth, by parameter."""
        lines = [
            "| number | intervals of 95 % that hold the truth | median error in standard errors |",
            "|---|---|---|",
        ]
        for column, name in enumerate(FITTED, 2):
            known = np.array([abs(row[column]) for row in rows if row[column] is not None])
            if len(known):
                part = roc.format_share(int((known <= WITHIN).sum()), len(known))
                lines.append(f"| `{name}` | {part} | {np.median(known):.2f} |")
        unknown = sum(row[2] is None for row in rows)
        return [*lines, "", f"In {unknown} of {len(rows)} records no opening was seen.", ""]


def fit_noisy_record(rng: np.random.Generator) -> list[float | None]:
    """Fit a noisy record; return noise, misfit, and errors over their standard errors."""
    middle, apart = rng.uniform(33.0, 50.0), math.sqrt(rng.uniform(1.1, 1.4))
    first, second = rng.permutation([middle / apart, middle * apart]).tolist()
    zeta = np.exp(rng.uniform(math.log(0.008), math.log(0.02), 2)).tolist()
    m1 = float(rng.uniform(0.5, 3.0))
    truth = {"f1": first, "f2": second, "zeta1": zeta[0], "zeta2": zeta[1]}
    truth["e"] = float(rng.uniform(0.35, 0.85))
    masses = {"m1": m1, "m2": m1 * float(rng.uniform(0.6, 1.67))}
    beam = orchestrate.Structure.from_halves(**masses, **truth)
    noise = float(rng.uniform(*NOISE))
    record = simulate_record(beam, middle, noise, rng)
    off = {name: truth[name] * float(rng.uniform(1.0 - OFF, 1.0 + OFF)) for name in ("f1", "f2")}
    guess = orchestrate.Structure.from_halves(**masses, **off, zeta1=0.012, zeta2=0.012, e=0.6)
    answer = orchestrate.fit(record, guess, jobs=1, progress=False)
    errors = answer.standard_error.sel(parameter=list(FITTED)).values.tolist()
    values = answer.value.sel(parameter=list(FITTED)).values.tolist()
    errors_in_sigma = [
        round_digits((value - truth[name]) / error)
        if math.isfinite(value) and error > 0.0
        else None
        for name, value, error in zip(FITTED, values, errors, strict=True)
    ]
    return [round_digits(noise), round_digits(float(answer.misfit)), *errors_in_sigma]


def simulate_record(
    beam: orchestrate.Structure, middle: float, noise: float, rng: np.random.Generator
) -> Any:
    """Simulate what sensors on base and halves read, with noise, in a swept sine."""
    low, high = (end * middle for end in ENDS)
    sweep = orchestrate.SweptSine(first=low, last=high, duration=DURATION, acceleration=5.0)
    history = orchestrate.shake(beam, sweep, sample_rate=RATE, progress=False)
    sensor = orchestrate.Sensor(bandwidth=400.0, sample_rate=RATE)
    felt = orchestrate.measure(history, sensor, excitation=sweep)
    read = {}
    for name in ("box_acceleration", "acceleration1", "acceleration2"):
        values = felt[name].values
        read[name] = values + noise * values.std() * rng.standard_normal(len(values))
    return orchestrate.record(time=felt.time.values, **read)


def round_digits(value: float) -> float:
    """Return a number rounded to three significant digits."""
    return float(f"{value:.3g}")
