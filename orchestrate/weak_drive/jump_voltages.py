"""Find the voltages at which the speed jumps at rate 0, and how late ramps of some rates show it.

The voltages at rate 0 are those of the hysteresis loop (:mod:`.hysteresis`), on the slowest ramp. A
ramp shows its jump late, about as rate^(2/3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..errors import InputError
from ..fmu.exported import make_fmu_finder
from ..lazy import Unpack, xr
from ..model.arguments import checked_list
from ..model.drive import Drive
from ..model.ranges import STRUCTURE
from ..model.structure import Structure
from ..response.labels import variable
from ..running.job import Fmus, Table
from ..running.options import Running
from ..running.runner import compute_dataset
from .capture import System, checked_parameter_values
from .couple import (
    DIRECTIONS,
    KINDS,
    CoupleJob,
    make_couple_job,
    require_motor,
    schedule_from_arguments,
    scheme_from_arguments,
)
from .hysteresis import Jump
from .master import Scheme
from .ramp_record import RampRecord
from .run import DriveJob
from .schedule import Ramp

IGNORED = ("clearance", "e", "e_slope", "gamma")  # by the bonded structure
COLUMNS = ("jumps", "jump_low", "jump_high")


@dataclass(frozen=True)
class JumpVoltagesJob(DriveJob):
    """Run ramps at several rates for the bonded and the delaminated structure."""

    asked: ClassVar[str] = "jump_voltages"
    schedules: tuple[Ramp, ...]  # one for each rate, slowest first
    scheme: Scheme
    over: str = ""  # a parameter that the bonded structure ignores
    values: tuple[float, ...] = ()

    item: ClassVar[str] = "structure"

    def items(self) -> Sequence[Structure]:
        bonded, parted = super().items()
        varied = [parted.replace(**{self.over: value}) for value in self.values] or [parted]
        return [bonded, *varied]

    def work(self, fmus: Fmus, items: Sequence[Structure], previous: Any) -> Table:
        rows, shown, decided = [], [], []
        for structure in items:
            slowest = make_couple_job(structure, self.drive, self.schedules[0], self.scheme)
            table = slowest.run_all_chunks(fmus)
            first = slowest.dataset(table).sel(jump=list(DIRECTIONS))
            rows.append([first[name].values for name in COLUMNS])
            decided.append(first.decided.values.astype("U20"))
            runs = [(slowest, table)]
            for schedule in self.schedules[1:]:
                job = make_couple_job(structure, self.drive, schedule, self.scheme, hold=0.0)
                runs.append((job, job.run_all_chunks(fmus)))
            jumps = list(zip((True, False), slowest.jumps_by_direction(table), strict=True))
            shown.append(
                [[ramp_jump_voltage_and_speed(*run, *each) for each in jumps] for run in runs]
            )
        return {"jumps": np.array(rows), "decided": np.array(decided), "shown": np.array(shown)}

    def dataset(self, table: Table) -> xr.Dataset:
        rates = np.array([schedule.rate for schedule in self.schedules])
        count = 1 + max(1, len(self.values))  # of structures
        at: Any = np.arange(len(KINDS))  # of both kinds among them; the bonded one at each value
        each: tuple[str, ...] = ("structure", "jump")
        if self.over:
            at = np.stack([np.zeros(count - 1, dtype=int), np.arange(1, count)])
            each = ("structure", self.over, "jump")
        every = ("rate", *each)
        jumps, low, high = np.moveaxis(table["jumps"][at], -2, 0)
        voltages, speeds = np.moveaxis(table["shown"].swapaxes(0, 1)[:, at], -1, 0)
        late = "voltage at which the speed jumps on the ramp"
        before = "mean speed where it leaves its branch"
        error = "half of the bracket of that voltage, by held voltages"
        halves = np.where(np.isfinite(jumps), 0.5 * np.abs(high - low), np.nan)
        how = "how jump or none was decided"
        variables = {
            "voltage": variable(every, voltages, "V", late),
            "speed_before": variable(every, speeds, "rad/s", before),
            "jumps": variable(each, jumps, "V", "the same at rate 0"),
            "standard_error": variable(each, halves, "V", error),
            "decided": (each, table["decided"][at], {"long_name": how}),
        }
        coordinates = {
            "rate": variable("rate", rates, "V/s", "change of the voltage"),
            "structure": ("structure", list(KINDS), {"long_name": "structure"}),
            "jump": ("jump", list(DIRECTIONS), {"long_name": "direction in which the speed jumps"}),
        }
        if self.over:
            quantity = STRUCTURE[self.over]
            words = (np.array(self.values), quantity.unit, quantity.description)
            coordinates[self.over] = variable(self.over, *words)
        return xr.Dataset(variables, coordinates, {"title": "Jump voltages of the weak drive"})


def ramp_jump_voltage_and_speed(
    job: CoupleJob, table: Table, up: bool, jumps: Sequence[Jump]
) -> list[float]:
    """Return the voltage at which a ramp shows the first jump and the speed before, or NaN."""
    if not jumps:
        return [math.nan, math.nan]
    before, half, _ = RampRecord(job, table, up).row_positions_of_jump(*jumps[0][1:])
    rows = np.arange(len(table["time"]))
    at = ((half, "voltage"), (before, "speed"))
    return [float(np.interp(row, rows, table[name])) for row, name in at]


def jump_voltages(
    structure: Structure,
    drive: Drive,
    *,
    voltage: tuple[float, float],
    rates: Sequence[float] | None = None,
    back: bool = True,
    settle: float | None = None,
    step: float | None = None,
    over: str | None = None,
    values: Sequence[float] | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Find the voltages of the speed's jumps, bonded and delaminated, at ramp rate 0.

    Parameters
    ----------
    structure : Structure
        ``bonded`` is ignored: results are returned for both, bonded and delaminated.
    drive : Drive
    voltage : (float, float)
        Ends of the ramps, V.
    rates : sequence of float, optional
        Of the ramps, V/s, by default (1e-4, 5e-5, 2.5e-5) K omega^2. The hysteresis loop that
        decides begins at the beginnings of the slowest one.
    back : bool
        Whether the ramps come back: the jump down too.
    settle : float, optional
        Time at the first voltage before, s; 300/omega by default.
    step : float, optional
        Communication step, s; controlled by its defect by default.
    over : str, optional
        A parameter that the bonded structure ignores: ``"clearance"``, ``"e"``, ``"e_slope"`` or
        ``"gamma"``. The bonded structure is computed once.
    values : sequence of float, optional
        Its values, which are a dimension of the result then.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`; the
        structures run side by side.

    Returns
    -------
    xarray.Dataset
        ``jumps`` (V) over ``structure`` and ``jump``: the first voltage at which the motion is
        lost, with half of its bracket as ``standard_error``; NaN where there is no jump or it is
        undecided, as ``decided`` says. Over ``rate`` (V/s) too the ``voltage`` at which each ramp
        shows a jump.

    Raises
    ------
    InputError
        Where an argument is not what is expected.

    Notes
    -----
    The rule is that of :mod:`orchestrate.weak_drive.hysteresis`, as for :func:`couple`. With a
    clearance the voltages of the delaminated structure depend on how large it is compared with the
    amplitude.

    Examples
    --------
    >>> from orchestrate import Drive, Structure, jump_voltages
    >>> quick = Structure.from_file("quick"), Drive.from_file("quick")
    >>> few = dict(rates=[4e-4, 2e-4], back=False, step=0.2, settle=100.0, progress=False)
    >>> found = jump_voltages(*quick, voltage=(1.3, 1.7), **few)
    >>> bool(found.jumps.sel(structure="bonded", jump="up") > 1.57)
    True
    """
    require_motor(structure, drive)
    unit = drive.volts(structure) * structure.omega
    usual = [rate * unit for rate in (1e-4, 5e-5, 2.5e-5)]
    volt_rates = checked_list("rates", usual if rates is None else rates)
    every = (
        schedule_from_arguments(structure, drive, voltage, None, rate, settle, 0.0, back)
        for rate in sorted(set(volt_rates))
    )
    schedules = tuple(schedule for schedule in every if isinstance(schedule, Ramp))
    if not schedules:
        raise InputError("voltage: expected (first, last) in V, the ends of ramps")
    scheme = scheme_from_arguments(structure, step)
    if over not in (None, *IGNORED):
        expected = f"expected {' or '.join(IGNORED)}, which the bonded structure ignores"
        raise InputError(f"over = {over!r}: {expected}")
    varied = checked_parameter_values(over, values, System(structure, drive))
    job = JumpVoltagesJob("jump_voltages", structure, drive, schedules, scheme, over or "", varied)
    return compute_dataset(job, running, make_fmu_finder(running))
