"""A test that decides: the rule of ``detect`` on rehearsals of a guess and its sound twin."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ..constants import GRAVITY
from ..errors import InputError
from ..fmu import make_fmu_finder
from ..laboratory.analysis.channels import BOX, Channels, analysis_attributes
from ..laboratory.pieces import Floats
from ..laboratory.sensors import CHANNELS, Sensor, measure, sensors_by_channel
from ..laboratory.shake import shake
from ..laboratory.swept_sine import SweptSine
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import checked_numbers
from ..model.ranges import checked_range
from ..response.labels import variable, yes_or_no
from ..response.questions import checked_structure
from ..running.executors import InlineExecutor
from ..running.job import Job, Table, refuse_unsupported_structure
from ..running.options import Running
from ..running.runner import compute_dataset
from .decision_rule import DELAMINATED, NOT_DESCRIBED, NOT_SEEN, UNDECIDED, Beam
from .detect import record_findings
from .impact_timing import TIMING
from .opening_force import largest_unit_opening_force, max_steady_sweep_rate
from .search_job import RecordData
from .undamaged import SoundStructure

WORDS = (DELAMINATED, NOT_SEEN, NOT_DESCRIBED, UNDECIDED)
USUAL_NOISE = 1e-3  # (m/s2)/sqrt(Hz)
USUAL_LEVELS = tuple(float(f"{level:.2g}") for level in np.geomspace(0.01, 1.0, 9))  # g


@dataclass(frozen=True)
class PlanSettings:
    """How far, slow and finely a test is swept."""

    # of the bonded resonance, and a tenth beyond those of the halves
    lowest: float = 0.65
    highest: float = 1.4
    beyond: float = 0.1
    windows: float = 5.0  # of the timing, while the sweep crosses the resonance's width
    # in a period of the highest frequency: fewer do not show when something strikes; and the
    # sensors' bandwidth over their sampling rate
    samples: float = 25.6
    bandwidth: float = 0.39
    longest: float = 120.0  # s
    periods: float = 5400.0  # of the bonded resonance, of a sweep as slow as ISO 7626-2 asks for


PLAN = PlanSettings()
HERE: Running = {"jobs": 1, "cluster": InlineExecutor(), "progress": False}  # in a worker


def plan_test(
    structure: Structure,
    *,
    sensor: Sensor | dict[str, Sensor] | None = None,
    levels: ArrayLike | None = None,
    g: ArrayLike | None = None,
    frequencies: ArrayLike | None = None,
    reserve: float = 2.0,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Rehearse a test, and recommend the lowest level at which :func:`orchestrate.detect` decides.

    Parameters
    ----------
    structure : Structure
        A guess of the delaminated beam; its sound twin is its bonded form.
    sensor : Sensor or mapping of str to Sensor
        As for :func:`orchestrate.measure`; its noise must be known. By default two of
        1e-3 (m/s2)/sqrt(Hz), of usual accelerometers, with 25.6 samples in a period of the highest
        frequency.
    levels : array_like
        Peak accelerations of the box, m/s2; nine from 0.01 to 1 g by default.
    g : array_like
        The same in g.
    frequencies : array_like
        Hz, ascending, two at least: the sweep goes from the first to the last. By default from 0.65
        to 1.4 times the bonded resonance, and a tenth beyond both halves' natural frequencies.
    reserve : float
        Of the recommended level over the lowest one that decides: the beam is not the guess.
    **running
        ``jobs``, ``progress``, ``store`` and others, see
        :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over ``level`` in m/s2: ``verdict`` and ``sound_verdict`` of the rule on the guess and on
        its sound twin, ``decides`` (whether both are right), ``heard`` and ``sound_heard`` (how far
        strikes rise over noise, which one sensor tells from ``threshold`` on), ``opening``, the
        largest gap in m, ``closing_force`` in N (faces pressed together by more stay shut),
        ``overload``, whether the readings reach the sensor's range. Scalars ``recommended_level``
        (``reserve`` times the lowest level from which all decide, or the next higher one) and
        ``second_level`` (twice that, or the next higher one), ``recommended_first``,
        ``recommended_last``, ``recommended_duration`` and ``recommended_rate`` (samples a second)
        of a swept sine; ``counts``, whether both levels decide; ``opening_level`` in m/s2 from
        which a preloaded structure opens (0 without).

    Raises
    ------
    InputError

    Notes
    -----
    Structure and twin are shaken (once, where their motion is proportional to the level), measured
    at each level by the sensors, with 25.6 samples in a period of the highest frequency at most,
    and judged by :meth:`orchestrate.diagnosis.decision_rule.Beam.verdict`. The sweep stays five
    windows of the impact timing in the resonance, is as slow as ISO 7626-2 asks for in up to 5400
    periods, and takes two minutes at most. Where no level decides, the highest without overload is
    recommended.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_halves(m1=0.15, m2=0.12, f1=42.0, f2=53.0, zeta1=0.02)
    >>> plan = orchestrate.plan_test(beam, g=[0.1, 0.2, 0.4], progress=False)
    >>> bool(plan.counts), plan.sound_verdict.values.tolist()
    (True, ['no opening seen', 'no opening seen', 'no opening seen'])
    """
    refuse_unsupported_structure("plan_test", checked_structure(structure))
    if structure.bonded:
        raise InputError("structure: bonded; expected a guess of the delaminated one")
    sound = SoundStructure.from_structure(structure)
    frequencies = default_sweep_range(structure) if frequencies is None else frequencies
    hertz = checked_positive_array("frequencies", frequencies, "Hz")
    if len(hertz) < 2 or not (np.diff(hertz) > 0.0).all():
        raise InputError(f"frequencies = {frequencies!r}: expected two at least, ascending, in Hz")
    first, last = float(hertz[0]), float(hertz[-1])
    if levels is not None and g is not None:
        raise InputError("levels and g: expected one of them")
    if levels is None:
        levels = GRAVITY * checked_positive_array("g", USUAL_LEVELS if g is None else g, "g")
    wanted = np.unique(checked_positive_array("levels", levels, "m/s2"))
    job = PlanJob(
        name=f"plan_{structure.label()}",
        structure=structure,
        sensors=checked_sensors(default_sensor(last) if sensor is None else sensor, last),
        levels=tuple(wanted.tolist()),
        first=first,
        last=last,
        duration=sweep_duration(sound.f, sound.zeta, first, last),
        reserve=checked_range("reserve", reserve, low=1.0, high=1e3),
    )
    return compute_dataset(job, running, make_fmu_finder(running))


def default_sweep_range(structure: Structure) -> tuple[float, float]:
    """Return the frequencies in Hz between which a sweep passes the resonance."""
    f, halves = SoundStructure.from_structure(structure).f, (structure.f1, structure.f2)
    low, high = (1.0 - PLAN.beyond) * min(halves), (1.0 + PLAN.beyond) * max(halves)
    return min(PLAN.lowest * f, low), max(PLAN.highest * f, high)


def default_sensor(last: float, noise: float = USUAL_NOISE, range: float = math.inf) -> Sensor:
    """Return an accelerometer that samples a sweep up to ``last`` Hz as the rule needs it."""
    rate = PLAN.samples * last
    return Sensor(bandwidth=PLAN.bandwidth * rate, sample_rate=rate, noise=noise, range=range)


def sweep_duration(f: float, zeta: float, first: float, last: float) -> float:
    """Return the duration, s, of a sweep that shows a resonance and what strikes in it."""
    seen, heard = (
        max_steady_sweep_rate(f, zeta),
        2.0 * zeta * f**2 / (PLAN.windows * TIMING.periods),
    )
    steady, timed = ((last - first) / max(rate, 1e-9) for rate in (seen, heard))
    return min(max(timed, min(steady, PLAN.periods / f)), PLAN.longest)


@dataclass(frozen=True, kw_only=True)
class PlanJob(Job):
    """Rehearse a sweep at each level with a structure and its sound twin."""

    asked: ClassVar[str] = "plan_test"
    item: ClassVar[str] = "level"
    structure: Structure
    sensors: tuple[tuple[str, Sensor], ...]
    levels: tuple[float, ...]  # m/s2
    first: float  # Hz
    last: float
    duration: float  # s
    reserve: float

    def items(self) -> Sequence[float]:
        return self.levels

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[float], previous: Table | None
    ) -> Table:
        pair = self.structure, self.structure.as_bonded()
        rows = [[self.rehearse(one, level, fmus) for one in pair] for level in items]
        names = ("word", "heard", "opening", "peak")
        return dict(zip(names, np.moveaxis(np.array(rows), 2, 0), strict=True))

    def rehearse(
        self, structure: Structure, level: float, fmus: Mapping[str, Path]
    ) -> tuple[float, float, float, float]:
        """Measure and judge; return the verdict's number, heard, largest gap and reading."""
        # in the other structures everything grows with the level, but the noise
        at = level if structure.has_scale and not structure.bonded else 1.0
        felt, gap = shake_and_measure(self, structure, at, tuple(fmus.items()))
        times = level / at
        rows = {
            name: own.add_noise_and_digitize(times * felt[name].values, list(CHANNELS).index(name))
            for name, own in self.sensors
        }
        peak = max(float(np.abs(row).max()) for name, row in rows.items() if name != BOX)
        rate, values = dict(self.sensors)[BOX].rate, np.array(list(rows.values()))
        data = Channels(felt.time.values, rate, tuple(rows), values, "record")
        try:
            findings = record_findings(RecordData.from_channels(data), self.structure, True)
        except InputError:  # noise leaves no sine
            return float(WORDS.index(UNDECIDED)), math.nan, times * gap, peak
        word = Beam((findings,)).verdict()
        return float(WORDS.index(word)), findings.strikes.heard, times * gap, peak

    def dataset(self, table: Table) -> xr.Dataset:
        words = [[WORDS[int(one)] for one in row] for row in table["word"]]
        right = np.array([row == [DELAMINATED, NOT_SEEN] for row in words])
        guess_words, sound_words = zip(*words, strict=True)
        ranges = np.array([one.range for name, one in self.sensors if name != BOX]).min()
        cut = table["peak"].max(axis=1) >= ranges
        levels = np.array(self.levels)
        level, second, counts = recommended_levels(levels, right & ~cut, ~cut, self.reserve)
        ends = np.array([self.first, self.last])
        force = float(largest_unit_opening_force(self.structure, ends).max())
        text, rate = "rehearsed verdict on the", dict(self.sensors)[BOX].rate
        heard, over = table["heard"], "how far strikes rise over noise, of the"
        shut, opens = "preload above which the faces stay shut", "level from which the faces open"
        return xr.Dataset(
            {
                "verdict": ("level", list(guess_words), {"long_name": f"{text} guess"}),
                "sound_verdict": ("level", list(sound_words), {"long_name": f"{text} twin"}),
                "decides": yes_or_no("level", right, "whether both verdicts are right"),
                "heard": variable("level", heard[:, 0], "1", f"{over} guess"),
                "sound_heard": variable("level", heard[:, 1], "1", f"{over} sound twin"),
                "threshold": variable((), TIMING.heard, "1", "from here something strikes"),
                "opening": variable("level", table["opening"][:, 0], "m", "largest gap"),
                "closing_force": variable("level", levels * force, "N", shut),
                "overload": yes_or_no("level", cut, "whether readings reach the sensor's range"),
                "opening_level": variable((), self.structure.preload / force, "m/s2", opens),
                "recommended_level": variable((), level, "m/s2", "level to test at"),
                "second_level": variable((), second, "m/s2", "second level to test at"),
                "recommended_first": variable((), self.first, "Hz", "frequency to begin at"),
                "recommended_last": variable((), self.last, "Hz", "frequency to end at"),
                "recommended_duration": variable((), self.duration, "s", "time of the sweep"),
                "recommended_rate": variable((), rate, "Hz", "samples a second"),
                "counts": yes_or_no((), counts, "whether both recommended levels decide"),
            },
            {"level": variable("level", levels, "m/s2", "peak acceleration of the box")},
            analysis_attributes("plan_test", "Plan of a test", self.structure.label()),
        )


@lru_cache(maxsize=2)  # the structure and its twin
def shake_and_measure(
    job: PlanJob, structure: Structure, level: float, fmus: tuple[tuple[str, Path], ...]
) -> tuple[xr.Dataset, float]:
    """Shake a structure; return what sensors without noise or limits read, and the largest gap."""
    sine = SweptSine(first=job.first, last=job.last, duration=job.duration, acceleration=level)
    here: Running = {**HERE, "fmu": {name: str(path) for name, path in fmus}}
    history = shake(structure, sine, sample_rate=20.0 * job.last, **here)
    ideal = {
        name: replace(own, noise=0.0, range=math.inf, resolution=0.0) for name, own in job.sensors
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of a low level: it is no other unit
        felt = measure(history, ideal, excitation=sine)
    return felt, 0.0 if structure.bonded else float(history.x_rel.max())


def recommended_levels(
    levels: Floats, right: np.ndarray, usable: np.ndarray, reserve: float
) -> tuple[float, float, bool]:
    """Return the level that is recommended, a second one, and whether both decide.

    - All usable levels from the lowest one that decides on have to decide.
    - The recommended one is the next at or above ``reserve`` times that, the second one the next at
      or above twice the recommended one.
    - Where there is none, the highest usable level stands for it, or the lowest of all.
    """
    top = int(np.flatnonzero(usable)[-1]) if usable.any() else 0
    wrong = np.flatnonzero(usable & ~right)
    least = int(wrong[-1]) + 1 if len(wrong) else 0
    if least > top or not (usable & right)[least : top + 1].any():
        return float(levels[top]), float(levels[top]), False

    def at_or_above(level: float) -> float:
        above = levels[: top + 1][levels[: top + 1] >= level * (1.0 - 1e-9)]
        return float(above[0] if len(above) else levels[top])

    recommended = at_or_above(reserve * levels[least])
    return recommended, at_or_above(2.0 * recommended), True


# -- what is asked --------------------------------------------------------------------------------


def checked_positive_array(name: str, values: ArrayLike, unit: str) -> Floats:
    """Return numbers as an array; raise unless all are finite and > 0."""
    return np.atleast_1d(np.asarray(checked_numbers(name, values, positive=f" > 0, in {unit}")))


def checked_sensors(
    sensor: Sensor | dict[str, Sensor], last: float
) -> tuple[tuple[str, Sensor], ...]:
    """Return sensors with a noise, one of the box too, as fast as the rule needs to ``last`` Hz."""
    sensors = sensors_by_channel(sensor)
    responses = {name: one for name, one in sensors.items() if name != BOX}
    if not responses:
        raise InputError("sensor: only on the box; expected one on acceleration1 or acceleration2")
    for name, one in responses.items():
        if not one.noise:
            text = "expected its density in (m/s2)/sqrt(Hz), > 0: without it every level counts"
            raise InputError(f"sensor on {name}: noise = 0.0; {text}")
    every, rate = {BOX: next(iter(responses.values())), **sensors}, PLAN.samples * last
    widest = PLAN.bandwidth * rate
    if every[BOX].rate > rate:
        every = {
            name: replace(one, bandwidth=min(one.bandwidth, widest), sample_rate=rate)
            for name, one in every.items()
        }
    return tuple(every.items())
