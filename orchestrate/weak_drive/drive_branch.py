"""Branches of the coupled system: its stationary motions over the speed, stable and unstable.

Each point is a periodic motion of structure and motor together, the fluctuation of the speed
included, with the voltage that holds it and its Floquet multipliers. Where the voltage is largest
or smallest along the branch is a fold: a slow ramp's jump.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..access.exported import finder
from ..access.instance import Instance
from ..access.models import OSCILLATOR, SHAKER
from ..errors import InputError
from ..running.job import Inputs, Job, Table
from ..running.runner import answer
from ..structures.drive import Drive
from ..structures.structure import Structure
from . import averaged
from .couple import checked_motor
from .schedule import check
from .shooting import Orbit, Shooter

if TYPE_CHECKING:
    import xarray as xr
    from typing_extensions import Unpack

    from ..running.options import Running

KINDS = ("bonded", "delaminated")
FINEST = 1.0 / 32.0  # of the distance of two points: where a branch is not found closer, it ends
MULTIPLIERS = 4  # the largest ones, that are kept


@dataclass(frozen=True)
class DriveBranchJob(Job):
    """A branch of each structure over the same speeds.

    Attributes
    ----------
    structure : Structure
    drive : Drive
    speeds : tuple of float
        rad/s, rising.
    period : int
        Revolutions after which the motion repeats.
    steps : int
        Communication steps in a revolution.
    settle : float
        Time in which the first motion is found by simulation, s.
    """

    structure: Structure
    drive: Drive
    speeds: tuple[float, ...]
    period: int
    steps: int
    settle: float

    models: ClassVar[tuple[str, ...]] = (OSCILLATOR, SHAKER)
    item: ClassVar[str] = "branch"

    def count(self) -> int:
        """Bonded and delaminated."""
        return len(KINDS)

    def items(self, inputs: Inputs) -> Sequence[Structure]:
        """Both structures."""
        return self.structure.as_bonded(), self.structure.as_delaminated()

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[Structure], carry: Table | None
    ) -> Table:
        """The branches of some structures; NaN beyond the end of one."""
        rows = []
        for structure in items:
            with Instance(fmus[OSCILLATOR]) as one, Instance(fmus[SHAKER]) as other:
                period = 1 if structure.bonded else self.period
                shooter = Shooter((one, other), structure, self.drive, period, self.steps)
                rows.append(self.follow(shooter))
        return {"branch": np.array(rows)}

    def follow(self, shooter: Shooter) -> np.ndarray:
        """Voltage, amplitude and multipliers at each speed, shape (speeds, 2 + MULTIPLIERS)."""
        table = np.full((len(self.speeds), 2 + MULTIPLIERS), np.nan, dtype=complex)
        before, now = None, self.first(shooter)
        for i, speed in enumerate(self.speeds):
            if i:
                before, now = now, self.next(shooter, before, now, (i - 1, i))
            if now is None:
                break
            values = shooter.multipliers(now)[:MULTIPLIERS]
            table[i] = [now.voltage, shooter.amplitude(now, speed), *values]
        return table

    def first(self, shooter: Shooter) -> Orbit | None:
        """The motion at the first speed, from a simulation at the averaged theory's voltage."""
        speed = self.speeds[0]
        Omega = speed / self.structure.omega
        voltage = averaged.no_load_speed(self.structure, self.drive, Omega)
        volts = float(voltage) * self.drive.volts(self.structure)
        state = shooter.settle(volts, speed, self.settle)
        return shooter.orbit(Orbit(volts, state, np.empty((0, 0))), speed)

    def next(
        self, shooter: Shooter, before: Orbit | None, now: Orbit | None, ends: tuple[int, int]
    ) -> Orbit | None:
        """The motion at the next speed, by way of speeds between where they are too far apart."""
        low, high = (self.speeds[i] for i in ends)
        done, part = 0.0, 1.0
        slope = (now, 0.0) if before is None else (before, 1.0)
        while now is not None and done < 1.0:
            last, distance = slope
            share = part / distance if distance else 0.0
            guess = Orbit(
                now.voltage + share * (now.voltage - last.voltage) if last else now.voltage,
                now.state + share * (now.state - last.state) if last else now.state,
                now.jacobian,
            )
            found = shooter.orbit(guess, low + (done + part) * (high - low))
            if found is None:
                part *= 0.5
                if part < FINEST:
                    return None
                continue
            slope, now, done = (now, part), found, done + part
            part = min(2.0 * part, 1.0 - done)
        return now

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Both branches, and their bifurcations."""
        import xarray as xr

        branch = table["branch"]
        volts, largest = branch[..., 0].real, branch[..., 2:]
        known = np.isfinite(volts)
        stable = known & (np.nan_to_num(np.abs(largest[..., 0]), nan=np.inf) < 1.0)
        over = ("structure", "speed")
        parts = ((*over, "multiplier"), {"units": "1"})
        text = "Floquet multipliers of the largest size"
        variables = {
            "voltage": (over, volts, {"units": "V", "long_name": "voltage that holds the speed"}),
            "amplitude": (
                over,
                branch[..., 1].real,
                {"units": "m", "long_name": "half the range of x1 over a period"},
            ),
            "stable": (over, stable, {"units": "1", "long_name": "whether the motion is stable"}),
            "multiplier_real": (
                parts[0],
                largest.real,
                {**parts[1], "long_name": f"{text}, real part"},
            ),
            "multiplier_imag": (
                parts[0],
                largest.imag,
                {**parts[1], "long_name": f"{text}, imaginary part"},
            ),
        }
        coordinates = {
            "structure": ("structure", list(KINDS), {"long_name": "structure"}),
            "speed": ("speed", list(self.speeds), {"units": "rad/s", "long_name": "mean speed"}),
        }
        found = xr.Dataset(variables, coordinates, {"title": "Branches of the weak drive"})
        return found.assign(self.points(volts, largest))

    def points(self, volts: np.ndarray, largest: np.ndarray) -> dict[str, tuple[object, ...]]:
        """The bifurcations of both branches as variables over ``point``."""
        speeds = np.array(self.speeds)
        rows = [
            (kind, *point)
            for kind, row, values in zip(KINDS, volts, largest, strict=True)
            for point in bifurcations(speeds, row, values)
        ]
        names = ("point_structure", "point_kind", "point_speed", "point_voltage")
        units = ("1", "1", "rad/s", "V")
        texts = ("structure", "kind of bifurcation", "mean speed", "voltage")
        columns = list(zip(*rows, strict=True)) if rows else [(), (), (), ()]
        return {
            name: (
                "point",
                np.array(column, dtype=float if unit != "1" else str),
                {"units": unit, "long_name": text},
            )
            for name, column, unit, text in zip(names, columns, units, texts, strict=True)
        }


def bifurcations(
    speeds: np.ndarray, volts: np.ndarray, largest: np.ndarray
) -> list[tuple[str, float, float]]:
    """Folds, and where a multiplier leaves the unit circle elsewhere than at 1.

    Parameters
    ----------
    speeds, volts : ndarray, shape (n,)
        NaN where the branch is not known.
    largest : ndarray of complex, shape (n, k)
        Multipliers.

    Returns
    -------
    list of (str, float, float)
        Kind ("fold", "Neimark-Sacker", "period doubling"), speed in rad/s and voltage in V.
    """
    from scipy.interpolate import CubicSpline

    known = np.isfinite(volts)
    if known.sum() < 4:
        return []
    speeds, volts, largest = speeds[known], volts[known], largest[known]
    spline = CubicSpline(speeds, volts)
    folds = spline.derivative().roots(extrapolate=False)
    found = [("fold", float(speed), float(spline(speed))) for speed in folds]
    turned = np.abs(largest.imag) > 1e-6
    for kind, sizes in (
        ("Neimark-Sacker", np.where(turned, np.abs(largest), 0.0).max(axis=1)),
        ("period doubling", np.where(turned, 0.0, -largest.real).max(axis=1)),
    ):
        for i in np.flatnonzero(np.diff(np.sign(sizes - 1.0)) != 0.0):
            share = (1.0 - sizes[i]) / (sizes[i + 1] - sizes[i])
            speed = float(speeds[i] + share * (speeds[i + 1] - speeds[i]))
            found.append((kind, speed, float(spline(speed))))
    return sorted(found, key=lambda point: point[1])


def drive_branch(
    structure: Structure,
    drive: Drive,
    *,
    speed: tuple[float, float] | None = None,
    count: int = 100,
    period: int = 2,
    steps: int = 48,
    settle: float | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Stationary motions of structure and motor together, stable and unstable, over the speed.

    Parameters
    ----------
    structure : Structure
        Whether it is bonded does not matter: both kinds are answered.
    drive : Drive
    speed : (float, float), optional
        First and last mean speed, rad/s; by default 0.95 and 1.25 times the resonance.
    count : int
        Speeds.
    period : int
        Revolutions after which the delaminated motion repeats; 2 finds those of 1 too.
    steps : int
        Communication steps in a revolution.
    settle : float, optional
        Time of the simulation that finds the first motion, s; 600/omega by default.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        ``voltage`` (V), ``amplitude`` (m) and ``stable`` over ``structure`` and ``speed`` (rad/s),
        NaN beyond the end of a branch; real and imaginary part of the largest Floquet multipliers;
        bifurcations over ``point``: ``point_structure``, ``point_kind``, ``point_speed`` and
        ``point_voltage``.

    Raises
    ------
    InputError
        Where an argument is not what is expected.

    Notes
    -----
    At a given speed the voltage is one of the unknowns of Newton's method, so folds over the
    voltage are no obstacle. A branch that turns back over the speed ends there. The angle's own
    multiplier, 1 for every motion, is not among those given. Bifurcations are interpolated between
    the speeds: where the peak is narrow they need to be close.

    Examples
    --------
    >>> from orchestrate import Drive, Structure, drive_branch
    >>> quick = Structure.from_file("quick"), Drive.from_file("quick")
    >>> found = drive_branch(*quick, speed=(1.26, 1.34), count=6, progress=False)
    >>> bool(found.voltage.values[0].argmax() == 3)
    True
    """
    checked_motor(drive)
    omega = structure.omega
    resonance = averaged.resonance(structure, drive) * omega
    first, last = (0.95 * resonance, 1.25 * resonance) if speed is None else map(float, speed)
    if not (0.0 < first < last < math.inf):
        raise InputError(f"speed = {speed} rad/s: expected (first, last) with 0 < first < last")
    for name, number, least in (("count", count, 4), ("period", period, 1), ("steps", steps, 16)):
        if not isinstance(number, int) or number < least:
            raise InputError(f"{name} = {number}: expected a whole number >= {least}")
    settle = 600.0 / omega if settle is None else float(settle)
    check("settle", settle, "s", low=0.0)
    speeds = tuple(np.linspace(first, last, count).tolist())
    job = DriveBranchJob("drive_branch", structure, drive, speeds, period, steps, settle)
    return answer(job, running, finder(running))
