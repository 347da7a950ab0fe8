"""Compute acceleration spectra while a motor of limited power is captured by the resonance.

The voltage is taken slowly to a value below the jump and held. Then the absolute displacement is
sampled over whole revolutions, and its spectrum multiplied by the square of the frequency: an
impact is a kink of the displacement, and so is not missed between samples.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from ..constants import TURN
from ..errors import InputError
from ..fmu.exported import make_fmu_finder
from ..lazy import Unpack, xr
from ..model.arguments import checked_integer, checked_number
from ..model.drive import Drive
from ..model.ranges import checked_range
from ..model.structure import Structure
from ..response.labels import variable
from ..response.spectra import amplitude_spectrum
from ..running.job import Fmus, Table
from ..running.options import Running
from ..running.runner import compute_dataset
from . import averaged, own_resonance
from .couple import KINDS, make_couple_job, require_motor, scheme_from_arguments
from .master import MAX_STEPS
from .run import DriveJob, open_motor_run
from .schedule import Ramp


@dataclass(frozen=True)
class DriveSpectraJob(DriveJob):
    """Compute the spectra of the bonded and the delaminated structure."""

    asked: ClassVar[str] = "drive_spectra"
    approach: Ramp  # how the voltage gets where it is held
    hold: float
    step: float
    revolutions: int
    points: int
    highest: float

    def orders(self) -> np.ndarray:
        """Return the spectral lines as multiples of the motor's speed."""
        orders = np.arange(self.revolutions * self.points // 2 + 1) / self.revolutions
        return np.asarray(orders[orders <= self.highest])

    def work(self, fmus: Fmus, items: Sequence[Structure], previous: Table | None) -> Table:
        spectra, speeds = [], []
        for structure in items:
            displacement, speed = self.record_displacements_and_speed(fmus, structure)
            frequency, amplitude = amplitude_spectrum(displacement, TURN / speed / self.points)
            spectra.append((frequency**2 * amplitude)[:, : len(self.orders())])
            speeds.append(speed)
        return {"acceleration": np.array(spectra), "speed": np.array(speeds)}

    def record_displacements_and_speed(
        self, fmus: Fmus, structure: Structure
    ) -> tuple[np.ndarray, float]:
        """Simulate ramp and hold; return displacements (2, samples), m, and mean speed, rad/s."""
        scheme = scheme_from_arguments(structure, self.step, 0.0)
        job = make_couple_job(structure, self.drive, self.approach, scheme)
        steps = range(math.ceil((self.approach.duration + self.hold) / self.step))
        with open_motor_run(job, fmus) as run:
            ends = run.run_steps_by_revolution(steps)["time"][-self.revolutions - 1 :]
            if len(ends) < 2:
                raise InputError(
                    f"the motor completed no two revolutions at {self.approach.last:g} V: "
                    "raise the voltage or the duration"
                )
            speed = float(TURN * (len(ends) - 1) / (ends[-1] - ends[0]))
            # on at equal steps
            voltages = [self.approach.last] * (self.revolutions * self.points)
            record = run.master.run(voltages, h=TURN / speed / self.points)
        x1, x2, box = (record[name][record.ends] for name in ("x1", "x2", "box_position"))
        rest_1, rest_2 = structure.at_rest
        return np.array([x1 - rest_1 + box, x2 - rest_2 + box]), speed

    def is_captured(self, fmus: Fmus) -> bool:
        short, structure = replace(self, revolutions=8, points=4), self.structure.as_delaminated()
        threshold = own_resonance.dividing_speed(structure, self.drive) * structure.omega
        return short.record_displacements_and_speed(fmus, structure)[1] < threshold

    def dataset(self, table: Table) -> xr.Dataset:
        orders, speeds = self.orders(), table["speed"]
        text, along = "amplitude of the absolute acceleration", ("kind", "mass", "order")
        lines = np.outer(speeds, orders)
        variables = {
            "acceleration": variable(along, table["acceleration"], "m/s2", text),
            "speed": variable("kind", speeds, "rad/s", "mean speed of the motor"),
        }
        coordinates = {
            "kind": ("kind", list(KINDS), {"long_name": "structure"}),
            "mass": variable("mass", [1, 2], "1", "mass"),
            "order": variable("order", orders, "1", "multiple of the speed"),
            "line": variable(("kind", "order"), lines, "rad/s", "frequency of the line"),
        }
        title = f"Spectra of the weak drive at {self.approach.last:g} V"
        return xr.Dataset(variables, coordinates, {"title": title})


def voltage_between_jumps(structure: Structure, drive: Drive, share: float = 0.6) -> float:
    folds = averaged.folds(structure, drive)
    if not folds:
        raise InputError("voltage: expected one, in V; by the averaged theory there is no jump")
    up, down = folds[0].eta0, folds[-1].eta0
    return (down + share * (up - down)) * drive.volts(structure)


def drive_spectra(
    structure: Structure,
    drive: Drive,
    *,
    voltage: float | None = None,
    begin: float | None = None,
    rate: float | None = None,
    hold: float | None = None,
    step: float | None = None,
    revolutions: int = 64,
    points: int = 512,
    highest: float = 12.0,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Compute spectra of both masses' absolute accelerations under a weak motor.

    Parameters
    ----------
    structure : Structure
        ``bonded`` is ignored: results are returned for both, bonded and delaminated.
    drive : Drive
    voltage : float, optional
        V; by default 0.6 of the way between the jumps of the averaged theory, see
        ``voltage_between_jumps``, or less where the delaminated structure has jumped by then.
    begin : float, optional
        Voltage from which it is approached, V; 0.85 of it by default.
    rate : float, optional
        Of the approach, V/s; 1e-4 K omega^2 by default.
    hold : float, optional
        Time at the voltage before the record, s; 800/omega by default.
    step : float, optional
        Communication step until the record begins, s; 0.1/omega by default.
    revolutions, points : int
        Revolutions in the record, which make the lines' distance, and samples in each.
    highest : float
        Highest line, as a multiple of the motor's speed.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        ``acceleration`` (m/s2) over ``kind`` (bonded, delaminated), ``mass`` (1, 2) and ``order``,
        multiples of the motor's mean ``speed`` (rad/s); ``line`` has the frequencies in rad/s.

    Raises
    ------
    InputError
        Where a number is out of its range, or the motor does not turn.

    Notes
    -----
    What lies above half the sampling rate folds back; for a kink it falls with the square of the
    frequency.

    Examples
    --------
    >>> from orchestrate import Drive, Structure
    >>> from orchestrate.weak_drive.drive_spectra import drive_spectra
    >>> quick = Structure.from_file("quick"), Drive.from_file("quick")
    >>> short = dict(begin=1.29, hold=50.0, revolutions=8, points=64, jobs=1)
    >>> found = drive_spectra(*quick, voltage=1.3, **short)
    >>> found.acceleration.dims, bool(found.acceleration.sel(order=1.0, mass=1).min() > 1.0)
    (('kind', 'mass', 'order'), True)
    """
    require_motor(structure, drive)
    omega, volts = structure.omega, drive.volts(structure)
    speed = 1e-4 * volts * omega if rate is None else checked_number("rate", rate)
    revolutions = checked_integer("revolutions", revolutions, 1)
    points = checked_integer("points", points, 4)
    highest = checked_number("highest", highest)
    if not 0.0 < highest <= points / 2:
        raise InputError(f"highest = {highest}: expected 0 < highest <= points/2 = {points / 2:g}")
    step = scheme_from_arguments(structure, step, 0.0).h
    hold = 800.0 / omega if hold is None else hold
    checked_range("hold", hold, "s", low=0.0, high=MAX_STEPS * step)
    record = (revolutions, points, highest)
    shares = (0.6, 0.45, 0.3, 0.15) if voltage is None else ()
    tried = [voltage_between_jumps(structure, drive, share) for share in shares]
    tried = tried or [checked_number("voltage", voltage)]
    jobs = []
    for target in tried:
        first = 0.85 * target if begin is None else checked_number("begin", begin)
        approach = Ramp(first, target, speed, settle=300.0 / omega, back=False)
        jobs.append(
            DriveSpectraJob("drive_spectra", structure, drive, approach, hold, step, *record)
        )
    find_fmu = make_fmu_finder(running)
    if voltage is None:
        fmus = {model: find_fmu(model).path for model in DriveSpectraJob.models}
        jobs = [next((job for job in jobs if job.is_captured(fmus)), jobs[-1])]
    return compute_dataset(jobs[0], running, find_fmu)
