"""Branches of the coupled system: its stationary motions round all folds, stable and unstable.

Each point is a periodic motion of structure and motor together, the fluctuation of the speed
included, with the voltage that holds it and its Floquet multipliers. Where the voltage is largest
or smallest along the branch is a fold: a slow ramp's jump, unless a pair of multipliers has left
the unit circle before (Neimark-Sacker).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..access.exported import finder
from ..access.instance import Instance
from ..access.models import OSCILLATOR, SHAKER
from ..dynamics.continuation import NoConvergenceError
from ..errors import InputError
from ..running.job import Inputs, Job, Table
from ..running.runner import answer
from ..structures.drive import Drive
from ..structures.structure import Structure
from . import averaged
from .couple import checked_motor
from .drive_walk import (
    ENDS,
    FLIP,
    HALVED,
    LIMIT,
    NONE,
    NOT_BEGUN,
    TESTS,
    Bifurcation,
    Leg,
    Motion,
    Pace,
    doubled,
    follow,
    motion_near,
)
from .grazing import FLIGHT, IMPACT
from .schedule import check
from .shooting import Shooter

if TYPE_CHECKING:
    import xarray as xr
    from typing_extensions import Unpack

    from ..running.options import Running

KINDS = ("bonded", "delaminated")
LEGS = ("from below", "from above", "first doubled", "second doubled")
REPEATS = 1e-6  # of the unit: change of a motion in a part of its period, after which it repeats
EVENTS = (*TESTS, FLIGHT, IMPACT)
KNOWN = 1e-7  # to which multipliers are known: on the unit circle no motion is called stable
MULTIPLIERS = 4  # the largest ones, that are kept
TOLD: dict[str, tuple[str, str]] = {  # of a motion, with units
    "speed": ("rad/s", "mean speed"),
    "voltage": ("V", "voltage that holds the speed"),
    "amplitude": ("m", "half the range of x1 over a period"),
    "impacts": ("1", "impacts in a revolution"),
    "revolutions": ("1", "revolutions after which the motion repeats"),
}
Variable = tuple[Any, np.ndarray, dict[str, str]]


@dataclass(frozen=True)
class DriveBranchJob(Job):
    """The branches of both structures over the same range of speeds.

    Attributes
    ----------
    structure : Structure
    drive : Drive
    speeds : (float, float)
        rad/s, rising.
    pace : Pace
    period : int
        Most revolutions after which the delaminated motion repeats.
    steps : int
        Communication steps in a revolution.
    settle : float
        Time in which the first motion is found by simulation, s.
    """

    structure: Structure
    drive: Drive
    speeds: tuple[float, float]
    pace: Pace
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
        """Branches of some structures: each a row of legs, NaN beyond a leg's end."""
        found = []
        for structure in items:
            with Instance(fmus[OSCILLATOR]) as one, Instance(fmus[SHAKER]) as other:
                found.append(self.legs((one, other), structure))
        motions = [[leg.motions for leg in legs] for legs in found]
        events = [[[event.motion for event in leg.bifurcations] for leg in legs] for legs in found]
        kinds = [[[event.kind for event in leg.bifurcations] for leg in legs] for legs in found]
        return {
            "points": np.array([[self.rows(part) for part in row] for row in motions]),
            "events": np.array([[self.rows(part) for part in row] for row in events]),
            "kinds": np.array([[self.codes(part) for part in row] for row in kinds]),
            "ends": np.array([[ENDS.index(leg.end) for leg in legs] for legs in found]),
        }

    def legs(self, fmus: tuple[Instance, Instance], structure: Structure) -> list[Leg]:
        """The branch from the lowest speed and, where that ends on the way, from the highest; then
        those of twice the period off the first doublings of both.
        """
        omega, drive = structure.omega, self.drive
        low, high = (speed / omega for speed in self.speeds)
        sizes = averaged.amplitude(structure, drive, np.linspace(low, high, 2001))
        length = float(sizes.max()) * drive.length
        turns = 1 if structure.bonded else self.period
        shooter = Shooter(fmus, structure, drive, turns, self.steps, length)
        below = self.leg(shooter, (low, high), up=True)
        passed = below.end == LIMIT and below.motions[-1].root.unknowns[-1] > 0.5 * (low + high)
        above = Leg(end=NOT_BEGUN) if passed else self.leg(shooter, (low, high), up=False)
        found = [below, above]
        for leg in (below, above):
            for flip in leg.bifurcations:
                if len(found) < len(LEGS) and self.is_to_double(flip, found, structure):
                    found.append(self.doubled_leg(shooter, flip.motion, (low, high)))
        return [*found, *(Leg(end=NOT_BEGUN) for _ in LEGS[len(found) :])]

    def is_to_double(self, flip: Bifurcation, legs: Sequence[Leg], structure: Structure) -> bool:
        """Whether a branch of twice the period begins here that is wanted, and not known yet."""
        turns = 1 if structure.bonded else self.period
        if flip.kind != FLIP or 2 * flip.motion.period.revolutions > turns:
            return False
        place = flip.motion.root.unknowns[-2:]
        ends = [leg.motions[-1].root.unknowns[-2:] for leg in legs if leg.end == HALVED]
        return not any(np.abs(place - end).max() < 2.0 * self.pace.longest for end in ends)

    def doubled_leg(self, shooter: Shooter, flip: Motion, speeds: tuple[float, float]) -> Leg:
        """The branch of twice the period off a period doubling."""
        try:
            return follow(shooter, doubled(shooter, flip), speeds, self.pace)
        except NoConvergenceError:
            return Leg(end=NONE)

    def leg(self, shooter: Shooter, speeds: tuple[float, float], up: bool) -> Leg:
        """The branch from one of two speeds over omega, which a simulation is held at.

        It is followed with the shortest period after which it repeats.
        """
        speed = speeds[0] if up else speeds[1]
        voltage = float(averaged.no_load_speed(shooter.structure, self.drive, speed))
        omega = shooter.structure.omega
        state = shooter.settle(voltage * shooter.volts, speed * omega, self.settle)
        guess = np.append(state, [voltage, speed])
        turns = 1 if shooter.structure.bonded else self.period
        try:
            shooter.repeat_after(turns)
            start = motion_near(shooter, guess, up)
            for part in (part for part in range(1, turns) if turns % part == 0):
                if np.abs(shooter.change_in(start.root.unknowns, part)).max() < REPEATS:
                    shooter.repeat_after(part)
                    start = motion_near(shooter, start.root.unknowns, up)
                    break
        except NoConvergenceError:
            return Leg(end=NONE)
        return follow(shooter, start, speeds, self.pace)

    def rows(self, motions: Sequence[Motion]) -> np.ndarray:
        """Numbers of motions, NaN beyond them, shape (most, numbers)."""
        table = np.full((self.pace.most, len(TOLD) + MULTIPLIERS), np.nan, dtype=complex)
        volts, omega = self.drive.volts(self.structure), self.structure.omega
        for row, motion in zip(table, motions, strict=False):
            voltage, speed = motion.root.unknowns[-2:]
            period = motion.period
            impacts = period.impacts / period.revolutions
            told = (speed * omega, voltage * volts, period.amplitude, impacts, period.revolutions)
            row[:] = [*told, *motion.multipliers[:MULTIPLIERS]]
        return table

    def codes(self, kinds: Sequence[str]) -> np.ndarray:
        """Kinds as numbers, -1 beyond them."""
        numbers = np.full(self.pace.most, -1)
        known = [EVENTS.index(kind) for kind in kinds][: self.pace.most]
        numbers[: len(known)] = known
        return numbers

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Both branches, and their bifurcations."""
        import xarray as xr

        points = table["points"]
        points = points[:, :, : max(1, int(np.isfinite(points[..., 0]).sum(axis=2).max()))]
        along = ("structure", "leg", "point")
        found = told(along, points)
        stable = np.nan_to_num(np.abs(points[..., len(TOLD)]), nan=np.inf) < 1.0 - KNOWN
        found["stable"] = (along, stable, labels("1", "whether the motion is stable"))
        ends = np.array(ENDS)[table["ends"]]
        found["end"] = (along[:2], ends, labels("1", "why the branch ends"))
        kinds = table["kinds"]
        chosen = kinds >= 0
        places = np.argwhere(chosen)
        found |= {
            f"bifurcation_{name}": values
            for name, values in told(("bifurcation",), table["events"][chosen]).items()
        }
        for name, values, text in (
            ("structure", np.array(KINDS)[places[:, 0]], "structure"),
            ("kind", np.array(EVENTS)[kinds[chosen]], "kind of bifurcation"),
        ):
            found[f"bifurcation_{name}"] = (("bifurcation",), values, labels("1", text))
        coordinates = {
            "structure": ("structure", list(KINDS), {"long_name": "structure"}),
            "leg": ("leg", list(LEGS), {"long_name": "where the branch was begun"}),
        }
        return xr.Dataset(found, coordinates, {"title": "Branches of the weak drive"})


def labels(unit: str, text: str) -> dict[str, str]:
    """Attributes of a variable."""
    return {"units": unit, "long_name": text}


def told(dims: tuple[str, ...], numbers: np.ndarray) -> dict[str, Variable]:
    """Numbers of motions as variables: the last axis is shared out."""
    found: dict[str, Variable] = {
        name: (dims, numbers[..., i].real, labels(unit, text))
        for i, (name, (unit, text)) in enumerate(TOLD.items())
    }
    largest = numbers[..., len(TOLD) :]
    text = "Floquet multipliers of the largest size"
    parts = {"real": largest.real, "imag": largest.imag}
    for part, values in parts.items():
        word = "real" if part == "real" else "imaginary"
        found[f"multiplier_{part}"] = (
            (*dims, "multiplier"),
            values,
            labels("1", f"{text}, {word} part"),
        )
    return found


def drive_branch(
    structure: Structure,
    drive: Drive,
    *,
    speed: tuple[float, float] | None = None,
    longest: float = 0.05,
    most: int = 200,
    period: int = 2,
    steps: int = 48,
    settle: float | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Stationary motions of structure and motor together, stable and unstable, round all folds.

    Parameters
    ----------
    structure : Structure
        Whether it is bonded does not matter: both kinds are answered.
    drive : Drive
    speed : (float, float), optional
        Range of the mean speed, rad/s; by default 0.95 and 1.25 times the resonance.
    longest : float
        Longest step along the branch, displacements over the averaged theory's largest amplitude,
        voltage over K omega and speed over omega: 0.05 makes about 70 points.
    most : int
        Most points in one direction.
    period : int
        Most revolutions after which the delaminated motion repeats. A motion that repeats after a
        part of them is followed as such, and where its period doubles, the branch of twice the
        period too.
    steps : int
        Communication steps in a revolution.
    settle : float, optional
        Time of the simulation that finds the first motion, s; 600/omega by default.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        ``speed`` (rad/s), ``voltage`` (V), ``amplitude`` (m), ``impacts`` in a revolution and
        ``stable`` over ``structure``, ``leg`` and ``point``, NaN beyond the end of a leg, and
        ``end`` says why it ends; ``revolutions`` after which it repeats; real and imaginary part of
        the largest Floquet multipliers. The same of bifurcations over ``bifurcation``, with
        ``bifurcation_structure`` and ``bifurcation_kind``: fold, period doubling, Neimark-Sacker,
        grazing of a flight (the masses touch once more) or of an impact (one vanishes). The leg
        from the lowest speed goes up; where it does not arrive at the highest, another one goes
        down from there. Off the first two period doublings go the branches of twice the period.

    Raises
    ------
    InputError
        Where an argument is not what is expected.

    Notes
    -----
    Voltage and speed are both unknowns of Newton's method, and Keller's pseudo-arclength equation
    is the one that is missing then. Bifurcations are roots on the branch, of the tangent's voltage
    (fold) and of products of the multipliers (the others), to 1e-6 of a step. The angle's own
    multiplier, 1 for every motion, is not among those given. A branch ends where an impact or a
    flight grazes; it is told by the smallest closing speed and the smallest gap of a turning, which
    fall to 0 there, and is a bifurcation where less than 1e-4 is left of the way. Of motions nearer
    than that to the last one only that is kept.

    A motion is accepted by what it leaves of the equations, 1e-9 of the amplitude at most (1e-13 is
    usual), and by its impacts, which are those of the motion before. Derivatives are by differences
    of two sizes that agree, on both sides of a motion or on the one where the same impacts occur;
    where none agree, 2e-6 of the amplitude from where an impact vanishes, the branch is not
    followed further. ``stable`` is false within 1e-7 of the unit circle.

    Examples
    --------
    >>> from orchestrate import Drive, Structure, drive_branch
    >>> quick = Structure.from_file("quick"), Drive.from_file("quick")
    >>> found = drive_branch(*quick, speed=(1.29, 1.32), longest=0.2, progress=False)
    >>> bonded = found.bifurcation_structure == "bonded"
    >>> found.bifurcation_kind[bonded].values.tolist()
    ['fold']
    >>> found.bifurcation_voltage[bonded].values.round(4).tolist()
    [1.5831]
    """
    checked_motor(drive)
    omega = structure.omega
    resonance = averaged.resonance(structure, drive) * omega
    first, last = (0.95 * resonance, 1.25 * resonance) if speed is None else map(float, speed)
    if not (0.0 < first < last < math.inf):
        raise InputError(f"speed = {speed} rad/s: expected (first, last) with 0 < first < last")
    for name, number, least in (("most", most, 2), ("period", period, 1), ("steps", steps, 16)):
        if not isinstance(number, int) or number < least:
            raise InputError(f"{name} = {number}: expected a whole number >= {least}")
    check("longest", longest, "", low=1e-4, high=1.0)
    settle = 600.0 / omega if settle is None else float(settle)
    check("settle", settle, "s", low=0.0)
    job = DriveBranchJob(
        "drive_branch",
        structure,
        drive,
        (first, last),
        Pace(float(longest), most),
        period,
        steps,
        settle,
    )
    return answer(job, running, finder(running))
