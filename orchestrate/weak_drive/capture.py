"""Capture: whether a motor switched on from rest passes the resonance, or hangs at it.

The voltage is switched on at once. Where it is low the speed stays below the resonance: the motor
is captured, though at the same voltage it would stay beyond, once there. The border between is
found by bisection.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..access.exported import finder
from ..access.instance import Instance
from ..access.models import OSCILLATOR, SHAKER
from ..errors import InputError
from ..response.labels import Variable, parameter, variable, yes_or_no
from ..running.job import Inputs, Job, Table
from ..running.runner import answer
from ..structures.drive import Drive
from ..structures.ranges import DRIVE
from ..structures.structure import Structure
from . import averaged
from .controllers import Controller
from .couple import Run, checked_motor, couple_job, scheme_of
from .master import Scheme
from .schedule import Constant, check

if TYPE_CHECKING:
    import xarray as xr
    from typing_extensions import Unpack

    from ..running.options import Running

DRIVE_NAMES = tuple(field.name for field in fields(Drive))


class System(NamedTuple):
    """A structure and what shakes it."""

    structure: Structure
    drive: Drive


@dataclass(frozen=True)
class CaptureJob(Job):
    """Starts from rest; one item is one value of the parameter.

    Attributes
    ----------
    structure : Structure
    drive : Drive
    over : str
        Parameter of drive or structure that takes ``values``; empty for none.
    values : tuple of float
    voltages : tuple of float
        V, rising.
    tolerance : float
        Of the border, V.
    time : float
        After which a motor that has not passed is captured, s.
    stay : int
        Revolutions beyond the resonance after which it has passed.
    scheme : Scheme
    control : Controller, optional
    """

    structure: Structure
    drive: Drive
    over: str
    values: tuple[float, ...]
    voltages: tuple[float, ...]
    tolerance: float
    time: float
    stay: int
    scheme: Scheme
    control: Controller | None = None

    models: ClassVar[tuple[str, ...]] = (OSCILLATOR, SHAKER)
    item: ClassVar[str] = "value"

    def count(self) -> int:
        """Values of the parameter."""
        return max(1, len(self.values))

    def items(self, inputs: Inputs) -> Sequence[System]:
        """Structure and drive of each value."""
        system = System(self.structure, self.drive)
        return [with_value(system, self.over, value) for value in self.values] or [system]

    def work(self, fmus: Mapping[str, Path], items: Sequence[System], carry: Any) -> Table:
        """Passage times at all voltages, and the border, of some values."""
        rows, borders = [], []
        for system in items:
            times = [self.start(fmus, system, voltage) for voltage in self.voltages]
            rows.append(times)
            borders.append(self.border(fmus, system, times))
        return {"passage_time": np.array(rows), "border": np.array(borders)}

    def border(self, fmus: Mapping[str, Path], system: System, times: Sequence[float]) -> float:
        """The voltage above which the motor passes, from the highest that captures it, V."""
        ends = [
            pair
            for pair, (before, after) in zip(pairwise(self.voltages), pairwise(times), strict=True)
            if math.isnan(before) and not math.isnan(after)
        ]
        if not ends or math.isnan(times[-1]):
            return math.nan
        low, high = ends[-1]
        while high - low > self.tolerance:
            middle = 0.5 * (low + high)
            if math.isnan(self.start(fmus, system, middle)):
                low = middle
            else:
                high = middle
        return 0.5 * (low + high)

    def start(self, fmus: Mapping[str, Path], system: System, voltage: float) -> float:
        """Time after which the motor has passed, s; NaN where it is captured."""
        schedule = Constant(voltage, self.time)
        job = couple_job(*system, schedule, self.scheme, 0.0, self.control)
        divide = averaged.dividing_speed(*system) * system.structure.omega
        with Instance(fmus[OSCILLATOR]) as oscillator, Instance(fmus[SHAKER]) as shaker:
            run = Run(job, oscillator, shaker)
            try:
                return first_stay(run, range(job.steps()), divide, self.stay)
            finally:
                run.master.close()

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Passed or captured over voltage and parameter, and the border."""
        import xarray as xr

        kept = (slice(None),) if self.over else (0,)
        along = (self.over,) if self.over else ()
        times, border = table["passage_time"][kept], table["border"][kept]
        over = (*along, "voltage")
        text = "time after which the motor has passed the resonance; NaN where it is captured"
        edge = "voltage from which a motor switched on from rest passes the resonance"
        variables = {
            "passes": yes_or_no(over, np.isfinite(times), "whether the motor passes the resonance"),
            "passage_time": variable(over, times, "s", text),
            "border": variable(along, border, "V", edge, tolerance=self.tolerance),
        }
        volts = variable("voltage", np.array(self.voltages), "V", "voltage switched on from rest")
        coordinates = {"voltage": volts}
        if self.over:
            coordinates[self.over] = axis(self.over, self.values)
        state = "bonded" if self.structure.bonded else "delaminated"
        title = f"Capture at the resonance from rest, {state} structure"
        return xr.Dataset(variables, coordinates, {"title": title})


def first_stay(run: Run, steps: range, divide: float, stay: int) -> float:
    """Time at which the speed has been above ``divide`` for some revolutions, s; NaN: never."""
    beyond, piece = 0, 200
    for first in range(0, len(steps), piece):
        rows = run.revolve(steps[first : first + piece])
        for time, speed in zip(rows["time"], rows["speed"], strict=True):
            beyond = beyond + 1 if abs(speed) > divide else 0
            if beyond == stay:
                return float(time)
    return math.nan


def with_value(system: System, over: str, value: float) -> System:
    """A system with another value of one parameter, of its drive or its structure.

    Raises
    ------
    InputError
        Where neither has it, or it does not take the value.
    """
    if over in DRIVE_NAMES:
        return system._replace(drive=system.drive.replace(**{over: value}))
    return system._replace(structure=system.structure.replace(**{over: value}))


def axis(over: str, values: ArrayLike) -> Variable:
    """The coordinate along a parameter."""
    if over in DRIVE:
        numbers = np.asarray(values, dtype=float)
        return variable(over, numbers, DRIVE[over].unit, DRIVE[over].description)
    return parameter(over, over, values)


def voltages_of(voltage: tuple[float, float], count: int) -> tuple[float, ...]:
    """Voltages at equal distances.

    Raises
    ------
    InputError
    """
    try:
        low, high = (float(value) for value in voltage)
    except (TypeError, ValueError):
        raise InputError(f"voltage = {voltage!r}: expected (lowest, highest) in V") from None
    check("voltage", low, "V", low=0.0)
    check("voltage", high, "V", low=0.0)
    if not low < high:
        raise InputError(f"voltage = ({low:g}, {high:g}) V: expected (lowest, highest)")
    if not isinstance(count, int) or isinstance(count, bool) or count < 2:
        raise InputError(f"count = {count!r}: expected a whole number >= 2")
    return tuple(np.linspace(low, high, count).tolist())


def values_of(over: str | None, values: ArrayLike | None, system: System) -> tuple[float, ...]:
    """The parameter's values, each tried on the system.

    Raises
    ------
    InputError
    """
    if (over is None) != (values is None):
        raise InputError(f"over = {over!r} and values = {values!r}: expected both, or none of them")
    if over is None:
        return ()
    try:
        found = tuple(np.asarray(values, dtype=float).ravel().tolist())
    except (TypeError, ValueError):
        raise InputError(f"values = {values!r}: expected numbers, such as [1.0, 2.0]") from None
    if not found or len(set(found)) != len(found):
        raise InputError(f"values = {values!r}: expected one number or more, each once")
    for value in found:
        with_value(system, over, value)
    return found


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
    stay: int = 20,
    control: Controller | None = None,
    step: float | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Whether a motor switched on from rest passes the resonance, and the voltage it takes.

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
        Of the border, V.
    time : float, optional
        After which a motor that has not passed is captured, s; 1500/omega by default.
    stay : int
        Revolutions beyond the resonance after which it has passed.
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
        ``passes`` (0 or 1) and ``passage_time`` (s) over the parameter and ``voltage`` (V), and
        over the parameter ``border`` (V): half way between two voltages not further apart than
        ``tolerance`` of which one captures and one passes. It is NaN where all voltages pass, or
        the highest captures. With impacts there may be several borders: this is the highest.

    Raises
    ------
    InputError
        Where an argument is not what is expected.

    Notes
    -----
    Beyond the resonance is half way between the speeds of the averaged theory's folds.

    Examples
    --------
    >>> from orchestrate import Drive, Structure, capture
    >>> quick = Structure.from_file("quick").as_bonded(), Drive.from_file("quick")
    >>> few = dict(count=2, tolerance=0.05, time=500.0, step=0.2, progress=False)
    >>> found = capture(*quick, voltage=(1.5, 1.6), **few)
    >>> found.passes.values.tolist(), 1.5 < float(found.border) < 1.6
    ([0, 1], True)
    """
    checked_motor(drive)
    system = System(structure, drive)
    found = values_of(over, values, system)
    voltages = voltages_of(voltage, count)
    check("tolerance", tolerance, "V", low=0.0, exclusive=True)
    longest = 1500.0 / structure.omega if time is None else time
    check("time", longest, "s", low=0.0, exclusive=True)
    if not isinstance(stay, int) or isinstance(stay, bool) or stay < 1:
        raise InputError(f"stay = {stay!r}: expected a whole number >= 1")
    scheme = scheme_of(structure, step, sampled=control is not None)
    couple_job(structure, drive, Constant(voltages[-1], longest), scheme, 0.0, control)
    job = CaptureJob(
        "capture",
        *(structure, drive, over or "", found, voltages),
        *(float(tolerance), float(longest), stay, scheme, control),
    )
    return answer(job, running, finder(running))
