"""Find whether a motor switched on from rest passes the resonance or is captured by it.

The voltage is switched on at once. Where it is low the speed settles below the resonance: the motor
is captured, though at the same voltage it would stay beyond, once there. The border between is
found by bisection. Each start is simulated until the speed has settled (:mod:`.capture_rule`);
starts that do not settle in time are undecided and widen the interval.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, fields
from functools import partial
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..fmu.exported import make_fmu_finder
from ..lazy import Unpack, xr
from ..model.arguments import checked_integer, checked_list, checked_pair
from ..model.drive import Drive
from ..model.ranges import DRIVE, checked_range
from ..model.structure import Structure
from ..response.labels import parameter_variable, variable, yes_or_no
from ..running.job import Fmus, Table
from ..running.options import Running
from ..running.runner import compute_dataset
from . import averaged
from .capture_rule import (
    DECISIONS,
    NO_LOAD,
    UNDECIDED,
    CaptureOutcome,
    default_time_limit,
    make_settling_test,
)
from .controllers import Controller
from .couple import make_couple_job, require_motor, scheme_from_arguments
from .master import Scheme
from .run import DriveJob, MotorJob, MotorRun, motor_run_starter
from .schedule import Constant

DRIVE_NAMES = tuple(field.name for field in fields(Drive))


class System(NamedTuple):
    """Store a structure together with its drive."""

    structure: Structure
    drive: Drive


@dataclass(frozen=True)
class CaptureJob(DriveJob):
    """Run starts from rest at several voltages for each value of a parameter."""

    asked: ClassVar[str] = "capture"
    over: str  # empty for none
    values: tuple[float, ...]
    voltages: tuple[float, ...]  # V, rising
    tolerance: float
    time: float  # 0: by the system's time constants
    stay: int
    scheme: Scheme
    control: Controller | None = None

    item: ClassVar[str] = "value"

    def items(self) -> Sequence[System]:
        system = System(self.structure, self.drive)
        return [replace_parameter(system, self.over, value) for value in self.values] or [system]

    def work(self, fmus: Fmus, items: Sequence[System], previous: Any) -> Table:
        rows, borders = [], []
        with motor_run_starter(fmus) as start_run:
            for system in items:
                start = partial(self.run_from_rest, start_run, system)
                outcomes = [start(voltage) for voltage in self.voltages]
                rows.append(outcomes)
                low, high = bracket_threshold(self.voltages, outcomes, start, self.tolerance)
                borders.append([*low, *high])
        return {"outcomes": np.array(rows, dtype=float), "borders": np.array(borders)}

    def run_from_rest(
        self, start_run: Callable[[MotorJob], MotorRun], system: System, voltage: float
    ) -> CaptureOutcome:
        test = make_settling_test(*system, self.stay, self.nondimensional_tolerance(system))
        if voltage <= system.drive.motor_constant * test.threshold:
            return CaptureOutcome(NO_LOAD)
        schedule = Constant(voltage, self.time_limit(system))
        job = make_couple_job(*system, schedule, self.scheme, 0.0, self.control)
        steps, first, times, speeds = range(job.step_count()), 0, np.zeros(0), np.zeros(0)
        with closing(start_run(job)) as run:
            while first < len(steps):
                piece = steps[first : first + max(500, first // 5)]
                rows = run.run_steps_by_revolution(piece)
                times, speeds = np.append(times, rows["time"]), np.append(speeds, rows["speed"])
                outcome = test.judge_record(times, speeds)
                if outcome.decision != UNDECIDED:
                    return outcome
                first = piece.stop
        return CaptureOutcome(UNDECIDED)

    def time_limit(self, system: System) -> float:
        """Return the longest simulated time of a start, s; after it it is undecided."""
        return self.time or default_time_limit(*system, self.nondimensional_tolerance(system))

    def nondimensional_tolerance(self, system: System) -> float:
        """Return the tolerance of the border over K omega."""
        return self.tolerance / system.drive.volts(system.structure)

    def dataset(self, table: Table) -> xr.Dataset:
        kept = (slice(None),) if self.over else (0,)
        along = (self.over,) if self.over else ()
        decisions, passes, times, speeds = np.moveaxis(table["outcomes"][kept], -1, 0)
        low, below, high, beyond = np.moveaxis(table["borders"][kept], -1, 0)
        over = (*along, "voltage")
        text = "time from which the speed stays beyond the resonance; NaN where it does not"
        how = "how the outcome was decided"
        edge = "voltage from which a motor switched on from rest passes the resonance"
        folds = np.array([self.highest_fold_voltage(system) for system in self.items()])[kept]
        known = "voltage above which no motion below the resonance exists, by the averaged theory"
        volts = np.array([drive.volts(structure) for structure, drive in self.items()])
        # the averaged theory's own error of a fold, with room
        above = low - folds > 2e-4 * volts[kept]
        variables = {
            "passes": yes_or_no(over, passes > 0, "whether the motor passes the resonance"),
            "decision": (over, np.vectorize(DECISIONS.get)(decisions), {"long_name": how}),
            "passage_time": variable(over, times, "s", text),
            "speed": variable(over, speeds, "rad/s", "mean speed at which the motor has settled"),
            "border": variable(along, 0.5 * (low + high), "V", edge, tolerance=self.tolerance),
            "border_low": variable(along, low, "V", "highest voltage below it that is captured"),
            "border_high": variable(along, high, "V", "lowest voltage above it that passes"),
            "speed_low": variable(along, below, "rad/s", "mean speed at border_low"),
            "speed_high": variable(along, beyond, "rad/s", "mean speed at border_high"),
            "fold": variable(along, folds, "V", known),
            "above_fold": yes_or_no(along, above, "whether the border lies above that fold"),
        }
        tried = variable("voltage", np.array(self.voltages), "V", "voltage switched on from rest")
        coordinates = {"voltage": tried}
        if self.over in DRIVE:
            of = DRIVE[self.over]
            coordinates[of.name] = variable(of.name, np.array(self.values), of.unit, of.description)
        elif self.over:
            coordinates[self.over] = parameter_variable(self.over, self.over, self.values)
        title = f"Capture at the resonance from rest, {self.structure.kind} structure"
        return xr.Dataset(variables, coordinates, {"title": title})

    def highest_fold_voltage(self, system: System) -> float:
        """Return the voltage of the highest fold by averaged theory, V; NaN if unknown."""
        structure, drive = system
        if not structure.bonded or self.control is not None:
            return math.nan
        folds = averaged.folds(structure, drive)
        return max((fold.eta0 for fold in folds), default=math.nan) * drive.volts(structure)


class BracketEnd(NamedTuple):
    """Store one end of the bracket of the threshold: its voltage, V, and final speed, rad/s."""

    voltage: float = math.nan
    speed: float = math.nan


def bracket_threshold(
    voltages: Sequence[float],
    outcomes: Sequence[CaptureOutcome],
    start: Callable[[float], CaptureOutcome],
    tolerance: float,
) -> tuple[BracketEnd, BracketEnd]:
    """Bracket by bisection the voltage from which a start passes the resonance."""
    # an undecided start is neither captured nor passes: the bracket is wider then
    captured = [i for i, outcome in enumerate(outcomes) if outcome.is_captured]
    if not captured or not outcomes[-1].passed:
        return BracketEnd(), BracketEnd()
    last = captured[-1]
    first = 1 + max(i for i, outcome in enumerate(outcomes) if not outcome.passed)
    low, high = (BracketEnd(voltages[i], outcomes[i].speed) for i in (last, first))
    doubtful = (voltages[last + 1], voltages[first - 1]) if first - last > 1 else None
    while True:
        begin, end = doubtful or (high.voltage, low.voltage)
        if begin - low.voltage > tolerance:
            middle = 0.5 * (low.voltage + begin)
        elif doubtful and high.voltage - end > tolerance:
            middle = 0.5 * (end + high.voltage)
        else:
            return low, high
        outcome = start(middle)
        if outcome.is_captured:
            low = BracketEnd(middle, outcome.speed)
            doubtful = None if middle > begin else doubtful
        elif outcome.passed and middle > end:
            high = BracketEnd(middle, outcome.speed)
        else:  # undecided, or passes below an undecided one
            doubtful = (min(middle, begin), max(middle, end)) if doubtful else (middle, middle)


def replace_parameter(system: System, over: str, value: float) -> System:
    if over in DRIVE_NAMES:
        return system._replace(drive=system.drive.replace(**{over: value}))
    return system._replace(structure=system.structure.replace(**{over: value}))


def checked_parameter_values(
    over: str | None, values: ArrayLike | None, system: System
) -> tuple[float, ...]:
    if (over is None) != (values is None):
        raise InputError(f"over = {over!r} and values = {values!r}: expected both, or none of them")
    if over is None:
        return ()
    numbers = checked_list("values", values)
    if len(set(numbers)) != len(numbers):
        raise InputError(f"values = {values!r}: expected one number or more, each once")
    for value in numbers:
        replace_parameter(system, over, value)
    return numbers


def capture(
    structure: Structure,
    drive: Drive,
    *,
    voltage: tuple[float, float],
    over: str | None = None,
    values: ArrayLike | None = None,
    count: int = 9,
    tolerance: float = 1e-4,
    time: float | None = None,
    stay: int = 100,
    control: Controller | None = None,
    step: float | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Find the voltage from which a motor switched on from rest passes the resonance.

    Parameters
    ----------
    structure : Structure
    drive : Drive
    voltage : (float, float)
        Lowest and highest voltage that is switched on, V.
    over : str, optional
        A second parameter, of the drive in SI (such as ``"rotor_inertia"``) or of the structure
        (such as ``"D"``), that takes ``values``.
    values : array_like, optional
    count : int
        Voltages that are tried for each value before the border is sought between them.
    tolerance : float
        Largest error of the border found by bisection, V.
    time : float, optional
        Time after which a start that has not settled is undecided, s; by default 600 times the
        slowest time constant of motor and dampers, and ten times what the speed takes to creep
        past the fold, ``tolerance`` above it. A start ends as soon as it is decided.
    stay : int
        Fewest revolutions on one side of the resonance before a speed counts as settled there.
    control : Controller, optional
        Takes a part of the voltage; see :mod:`orchestrate.weak_drive.controllers`.
    step : float, optional
        Communication step, s; controlled by its defect by default, with a controller 0.1/omega at
        most.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`; the values
        run side by side.

    Returns
    -------
    xarray.Dataset
        Over the parameter and ``voltage`` (V): ``passes`` (0 or 1), ``passage_time`` (s), ``speed``
        (rad/s) where the motor has settled, and ``decision``, how it was decided: the speed
        "converged", or stayed "bounded" as an irregular motion does, or the
        "no-load speed" lies below the resonance. Neither passed nor captured are "undecided" starts
        (not settled within ``time``) and those "settled at the resonance"; ``passes`` is 0 then.

        Over the parameter: ``border`` (V), half way between ``border_low``, the highest voltage
        below it that captures, and ``border_high``, the lowest above it that passes. They are no
        further apart than ``tolerance``, unless starts between them are neither. NaN where none
        captures, or the highest does not pass. With impacts there may be several borders: this is
        the highest. ``speed_low`` and ``speed_high`` (rad/s) are the speeds there: close to each
        other where the speed passes without a gap. ``fold`` (V), bonded and without a controller:
        by the averaged theory no motion below the resonance exists above it, and ``above_fold``
        says where the border lies higher all the same, by more than the theory's error.

    Raises
    ------
    InputError
        Where an argument is not what is expected.

    Notes
    -----
    Beyond the resonance is half way between the speeds of the averaged theory's folds, moved with
    the resonance where that of the delaminated structure lies clearly apart. A speed
    that is there may swing back, and one that hardly changes may be creeping past a fold: what
    counts as settled is stated in :mod:`orchestrate.weak_drive.capture_rule`.

    Examples
    --------
    >>> from orchestrate import Drive, Structure, capture
    >>> quick = Structure.from_file("quick").as_bonded(), Drive.from_file("quick")
    >>> few = dict(count=2, tolerance=0.05, step=0.2, progress=False)
    >>> found = capture(*quick, voltage=(1.5, 1.6), **few)
    >>> found.passes.values.tolist(), 1.5 < float(found.border) < 1.6
    ([0, 1], True)
    """
    require_motor(structure, drive)
    system = System(structure, drive)
    parameter_values = checked_parameter_values(over, values, system)
    low, high = checked_pair("voltage", voltage, "(lowest, highest) in V")
    for end in (low, high):
        checked_range("voltage", end, "V", low=0.0)
    if not low < high:
        raise InputError(f"voltage = ({low:g}, {high:g}) V: expected (lowest, highest)")
    voltages = tuple(np.linspace(low, high, checked_integer("count", count, 2)).tolist())
    checked_range("tolerance", tolerance, "V", low=0.0, open_low=True)
    if time is not None:
        checked_range("time", time, "s", low=0.0, open_low=True)
    stay = checked_integer("stay", stay, 1)
    scheme = scheme_from_arguments(structure, step, sampled=control is not None)
    what = (structure, drive, over or "", parameter_values, voltages)
    how = (float(tolerance), float(time or 0.0), stay, scheme, control)
    job = CaptureJob("capture", *what, *how)
    for each in job.items():  # refused now, not amid the work
        make_couple_job(*each, Constant(voltages[-1], job.time_limit(each)), scheme, 0.0, control)
    return compute_dataset(job, running, make_fmu_finder(running))
