"""Extrapolate the jump voltages of ramps at several rates to rate 0, with an error.

A ramp's jump comes late, about as rate^(2/3): so it is where a fold is passed at a finite rate. The
time that the speed then takes on its way makes a term that grows as the rate itself. Both are
fitted to the voltages; at rate 0 is the voltage of the fold. Of the bonded structure that is known,
by the averaged theory: what its ramps miss, those of the delaminated one may miss as well. Where
held voltages had to decide at every rate, as where folds are close, they know the voltage at rate 0
themselves: it is taken from them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..access.exported import finder
from ..access.models import OSCILLATOR, SHAKER
from ..errors import InputError
from ..running.job import Inputs, Job, Table
from ..running.runner import answer
from ..structures.drive import Drive
from ..structures.structure import Structure
from . import averaged
from .couple import couple_job, require_motor, schedule_from_arguments, scheme_from_arguments
from .held import LOST
from .master import Scheme
from .schedule import Ramp, Schedule

if TYPE_CHECKING:
    import xarray as xr
    from typing_extensions import Unpack

    from ..running.options import Running

KINDS = ("bonded", "delaminated")
DIRECTIONS = ("up", "down")
USUAL_RATES = (1e-4, 5e-5, 2.5e-5)  # of eta0 in a time 1/omega
EXPONENT = 2.0 / 3.0


def extrapolate(rates: np.ndarray, voltages: np.ndarray) -> tuple[float, float]:
    """Extrapolate jump voltages to rate 0; return the voltage and its standard error.

    Examples
    --------
    >>> rates = np.array([1e-4, 3e-5, 1e-5])
    >>> voltage, error = extrapolate(rates, 1.5 + 10.0 * rates ** (2 / 3))
    >>> round(voltage, 9), error < 1e-9
    (1.5, True)
    """
    known = np.isfinite(voltages)
    count = int(known.sum())
    if count < 2:
        return float("nan"), float("nan")
    line, _ = fit_rate_powers(rates[known], voltages[known], (EXPONENT,))
    if count == 2:
        return line, float("nan")
    value, scatter = fit_rate_powers(rates[known], voltages[known], (EXPONENT, 1.0))
    return value, float(np.hypot(scatter, 0.5 * (value - line)))


def summarize_held(voltages: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Return middle and error of the brackets that held voltages found at several rates."""
    low, high = (voltages - errors).min(axis=0), (voltages + errors).max(axis=0)
    return np.stack([0.5 * (low + high), 0.5 * (high - low)], axis=1)


def fit_rate_powers(
    rates: np.ndarray, voltages: np.ndarray, exponents: tuple[float, ...]
) -> tuple[float, float]:
    """Fit jump voltages by powers of the rate; return the value at rate 0 and its error."""
    design = np.stack([np.ones(len(rates)), *(rates**power for power in exponents)], axis=1)
    design /= design.max(axis=0)
    solution = np.linalg.lstsq(design, voltages, rcond=None)[0]
    free = len(rates) - design.shape[1]
    if not free:
        return float(solution[0]), 0.0
    misfit = voltages - design @ solution
    covariance = float(misfit @ misfit) / free * np.linalg.inv(design.T @ design)
    return float(solution[0]), float(np.sqrt(covariance[0, 0]))


@dataclass(frozen=True)
class JumpVoltagesJob(Job):
    """Run ramps at several rates for the bonded and the delaminated structure."""

    structure: Structure
    drive: Drive
    schedules: tuple[Ramp, ...]  # one for each rate, slowest first
    scheme: Scheme

    models: ClassVar[tuple[str, ...]] = (OSCILLATOR, SHAKER)
    item: ClassVar[str] = "ramp"

    def items(self, inputs: Inputs) -> Sequence[tuple[Structure, Ramp]]:
        """Return the structure and the schedule of each ramp, the slowest first."""
        both = (self.structure.as_bonded(), self.structure.as_delaminated())
        return [(structure, schedule) for schedule in self.schedules for structure in both]

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[tuple[Structure, Ramp]], previous: Any
    ) -> Table:
        """Run some ramps; return their jump voltages and the speeds before."""
        rows = []
        for structure, schedule in items:
            job = couple_job(structure, self.drive, schedule, self.scheme)
            data = job.dataset(job.run_here(fmus), {})
            held = data[["held_jumps", "held_error"]].where(data.held_verdict == LOST)
            columns = (data.jumps, data.jump_speed_before, held.held_jumps, held.held_error)
            rows.append([column.values for column in columns])
        return {"jumps": np.array(rows).reshape(-1, 4, len(DIRECTIONS))}

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Build the dataset of jump voltages over the rate and at rate 0."""
        import xarray as xr

        rates = np.array([schedule.rate for schedule in self.schedules])
        shaped = table["jumps"].reshape(len(rates), len(KINDS), 4, len(DIRECTIONS))
        at_rates, speeds, held, held_errors = (shaped[:, :, column] for column in range(4))
        ends = np.array(
            [
                [
                    extrapolate(rates, at_rates[:, kind, direction])
                    for direction in range(len(DIRECTIONS))
                ]
                for kind in range(len(KINDS))
            ]
        )
        ends[..., 1] = np.hypot(ends[..., 1], self.distance_from_folds(ends[0, :, 0]))
        decided = np.isfinite(held).all(axis=0)
        ends[decided] = summarize_held(held[:, decided], held_errors[:, decided])
        every, each = ("rate", "structure", "jump"), ("structure", "jump")
        late = "voltage at which the speed jumps on the ramp"
        before = "mean speed where it leaves its branch"
        variables = {
            "voltage": (every, at_rates, {"units": "V", "long_name": late}),
            "speed_before": (every, speeds, {"units": "rad/s", "long_name": before}),
            "jumps": (each, ends[..., 0], {"units": "V", "long_name": "the same at rate 0"}),
            "held": (each, decided, {"long_name": "whether that is where held voltages lose it"}),
            "standard_error": (
                each,
                ends[..., 1],
                {"units": "V", "long_name": "standard error of the voltage at rate 0"},
            ),
        }
        coordinates = {
            "rate": ("rate", rates, {"units": "V/s", "long_name": "change of the voltage"}),
            "structure": ("structure", list(KINDS), {"long_name": "structure"}),
            "jump": ("jump", list(DIRECTIONS), {"long_name": "direction in which the speed jumps"}),
        }
        return xr.Dataset(variables, coordinates, {"title": "Jump voltages of the weak drive"})

    def distance_from_folds(self, bonded: np.ndarray) -> np.ndarray:
        """Return how far bonded jumps at rate 0 lie from the averaged folds, V.

        0 where there is no jump, or the averaged theory has no folds.
        """
        folds = averaged.folds(self.structure.as_bonded(), self.drive)
        if not folds:
            return np.zeros(len(DIRECTIONS))
        volts = self.drive.volts(self.structure)
        known = [volts * fold.eta0 for fold in (folds[0], folds[-1])]
        return np.nan_to_num(np.abs(np.abs(bonded) - known))


def jump_voltages(
    structure: Structure,
    drive: Drive,
    *,
    voltage: tuple[float, float],
    rates: Sequence[float] | None = None,
    back: bool = True,
    settle: float | None = None,
    step: float | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Find the voltages of the speed's jumps, bonded and delaminated, at ramp rate 0.

    Parameters
    ----------
    structure : Structure
        Whether it is bonded does not matter: both kinds are answered.
    drive : Drive
    voltage : (float, float)
        Ends of the ramps, V.
    rates : sequence of float, optional
        V/s; three or more give a standard error. By default (1e-4, 5e-5, 2.5e-5) K omega^2.
    back : bool
        Whether the ramps come back: the jump down too.
    settle : float, optional
        Time at the first voltage before, s; 300/omega by default.
    step : float, optional
        Communication step, s; controlled by its defect by default.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`; the ramps
        run side by side.

    Returns
    -------
    xarray.Dataset
        ``jumps`` and ``standard_error`` (V) over ``structure`` and ``jump``, and the ``voltage`` of
        each ramp over ``rate`` (V/s) too; NaN where there is no jump. ``held`` says where held
        voltages lost the motion at every rate: the middle of their brackets is told then, and half
        of what these span as the error.

    Raises
    ------
    InputError
        Where an argument is not what is expected.

    Notes
    -----
    Voltages are fitted with a constant and terms in rate^(2/3) and in the rate. The error is made
    of the scatter around the fit, half of what the last term changes, and how far the ramps of the
    bonded structure end from the folds of the averaged theory: the delaminated one's lag nearly
    as much. A slow loss of stability, which a ramp does not see, is not in it. With a clearance
    the voltages of the delaminated structure depend on how large it is beside the amplitude.

    Examples
    --------
    >>> from orchestrate import Drive, Structure, jump_voltages
    >>> quick = Structure.from_file("quick"), Drive.from_file("quick")
    >>> few = dict(rates=[4e-4, 2e-4], back=False, step=0.2, settle=100.0, progress=False)
    >>> found = jump_voltages(*quick, voltage=(1.3, 1.7), **few)
    >>> bool(found.jumps.sel(structure="bonded", jump="up") > 1.57)
    True
    """
    require_motor(drive)
    unit = drive.volts(structure) * structure.omega
    volt_rates = [rate * unit for rate in USUAL_RATES] if rates is None else list(rates)
    if len(set(volt_rates)) < 2:
        raise InputError(f"rates = {rates}: expected two different ones or more, in V/s")
    schedules = tuple(
        require_ramp(
            schedule_from_arguments(structure, drive, voltage, None, rate, settle, 0.0, back)
        )
        for rate in sorted(volt_rates)
    )
    scheme = scheme_from_arguments(structure, step)
    job = JumpVoltagesJob("jump_voltages", structure, drive, schedules, scheme)
    return answer(job, running, finder(running))


def require_ramp(schedule: Schedule) -> Ramp:
    """Return the schedule if it is a ramp; raise an error otherwise."""
    if not isinstance(schedule, Ramp):
        raise InputError("voltage: expected (first, last) in V, the ends of ramps")
    return schedule
