"""Trace the branches of stationary motions of the weak drive, round folds, with stability.

Each point is a periodic motion of structure and motor together, the fluctuation of the speed
included, with the voltage that holds it and its Floquet multipliers. Where the voltage is largest
or smallest along the branch is a fold: a slow ramp's jump, unless a pair of multipliers has left
the unit circle before (Neimark-Sacker).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from ..dynamics.bifurcation_kinds import KINDS, Kind
from ..dynamics.continuation import SOLVER_ERRORS
from ..dynamics.tracer import LIMIT, Bifurcation, BranchSegment, ContinuationSettings
from ..errors import InputError
from ..fmu.exported import make_fmu_finder
from ..fmu.instance import Instance
from ..fmu.models import MOTOR_SHAKER, OSCILLATOR
from ..lazy import Unpack, xr
from ..model.arguments import checked_integer, checked_pair
from ..model.drive import Drive
from ..model.ranges import checked_range
from ..model.structure import Structure
from ..response.labels import Variable, variable
from ..running.job import Fmus, Table
from ..running.options import Running
from ..running.runner import compute_dataset
from . import averaged, own_resonance
from .couple import KINDS as STRUCTURES
from .couple import require_motor
from .drive_tracer import (
    ENDS,
    HALVED,
    NO_START,
    NOT_BEGUN,
    DriveTracer,
    Motion,
    find_doubled_motion,
    find_motion_near,
)
from .master import MAX_STEPS
from .run import DriveJob
from .shooting import Shooter

LEGS = ("from below", "from above", "first doubled", "second doubled")
BIFURCATIONS = (Kind.FOLD, Kind.FLIP, Kind.TORUS, Kind.TOUCHING, Kind.GRAZING)  # located
MULTIPLIERS = 4  # the largest ones, that are kept
COLUMNS: dict[str, tuple[str, str]] = {  # numbers of a motion, with units
    "speed": ("rad/s", "mean speed"),
    "voltage": ("V", "voltage that holds the speed"),
    "amplitude": ("m", "half the range of x1 over a period"),
    "impacts": ("1", "impacts in a revolution"),
    "revolutions": ("1", "revolutions after which the motion repeats"),
}
Leg = BranchSegment[Motion]


@dataclass(frozen=True)
class DriveBranchJob(DriveJob):
    """Trace the branches of the bonded and the delaminated structure."""

    asked: ClassVar[str] = "drive_branch"
    speeds: tuple[float, float]
    longest: float
    most: int
    period: int
    steps: int
    settle: float

    item: ClassVar[str] = "branch"

    def work(self, fmus: Fmus, items: Sequence[Structure], previous: Table | None) -> Table:
        rows = []
        for structure in items:
            with Instance(fmus[OSCILLATOR]) as oscillator, Instance(fmus[MOTOR_SHAKER]) as shaker:
                shooter = self.make_shooter((oscillator, shaker), structure)
                rows.append(self.trace_legs(shooter))
                shooter.close()
        columns = {
            "points": lambda leg: self.motion_table(leg.points),
            "events": lambda leg: self.motion_table([each.point for each in leg.bifurcations]),
            "kinds": self.bifurcation_codes,
            "ends": lambda leg: ENDS.index(leg.end),
        }
        return {
            k: np.array([[f(leg) for leg in legs] for legs in rows]) for k, f in columns.items()
        }

    def max_period_in_revolutions(self, structure: Structure) -> int:
        """Return the longest period that is traced, in revolutions."""
        return 1 if structure.bonded else self.period

    def make_shooter(self, fmus: tuple[Instance, Instance], structure: Structure) -> Shooter:
        low, high = (speed / structure.omega for speed in self.speeds)
        sizes = averaged.relative_amplitude(structure, self.drive, np.linspace(low, high, 2001))
        length = float(sizes.max()) * self.drive.length
        turns = self.max_period_in_revolutions(structure)
        return Shooter(fmus, structure, self.drive, turns, self.steps, length)

    def trace_legs(self, shooter: Shooter) -> list[Leg]:
        low, high = (speed / shooter.structure.omega for speed in self.speeds)
        turns = self.max_period_in_revolutions(shooter.structure)
        trace = partial(self.trace_leg, shooter, (low, high))
        below = trace(partial(self.simulate_and_find_motion, shooter, low, up=True))
        passed = below.end == LIMIT and below.points[-1].coordinates[1] > 0.5 * (low + high)
        above = Leg(end=NOT_BEGUN)
        if not passed:
            above = trace(partial(self.simulate_and_find_motion, shooter, high, up=False))
        legs = [below, above]
        for leg in (below, above):
            for flip in leg.bifurcations:
                if len(legs) < len(LEGS) and self.needs_doubled_leg(flip, legs, turns):
                    legs.append(trace(partial(find_doubled_motion, shooter, flip.point)))
        return [*legs, *(Leg(end=NOT_BEGUN) for _ in LEGS[len(legs) :])]

    def needs_doubled_leg(self, flip: Bifurcation[Motion], legs: Sequence[Leg], turns: int) -> bool:
        if flip.kind != Kind.FLIP or 2 * flip.point.period.revolutions > turns:
            return False
        ends = [leg.points[-1].coordinates for leg in legs if leg.end == HALVED]
        at = flip.point.coordinates
        return not any(np.abs(at - end).max() < 2.0 * self.longest for end in ends)

    def trace_leg(
        self, shooter: Shooter, speeds: tuple[float, float], find_start: Callable[[], Motion]
    ) -> Leg:
        try:
            start = find_start()
        except SOLVER_ERRORS:
            return Leg(end=NO_START)
        settings = ContinuationSettings(self.longest, self.most - 1)
        return DriveTracer(shooter, start, speeds, settings).trace(start)

    def simulate_and_find_motion(self, shooter: Shooter, speed: float, up: bool) -> Motion:
        """Find the motion at a speed, over omega, that is followed to higher or lower ones."""
        voltage = float(averaged.stationary_voltage(shooter.structure, self.drive, speed))
        omega = shooter.structure.omega
        state = shooter.simulate_at_speed(voltage * shooter.volts, speed * omega, self.settle)
        turns = self.max_period_in_revolutions(shooter.structure)
        shooter.set_revolutions(turns)
        motion = find_motion_near(shooter, np.append(state, [voltage, speed]), up)
        for part in (part for part in range(1, turns) if turns % part == 0):
            if np.abs(shooter.state_change_after(motion.root.unknowns, part)).max() < 1e-6:
                shooter.set_revolutions(part)
                return find_motion_near(shooter, motion.root.unknowns, up)
        return motion

    def motion_table(self, motions: Sequence[Motion]) -> np.ndarray:
        table = np.full((self.most, len(COLUMNS) + MULTIPLIERS), np.nan, dtype=complex)
        volts, omega = self.drive.volts(self.structure), self.structure.omega
        for row, motion in zip(table, motions, strict=False):
            voltage, speed = motion.coordinates
            turns = motion.period.revolutions
            sizes = motion.period.amplitude, motion.period.impacts / turns, turns
            row[:] = [speed * omega, voltage * volts, *sizes, *motion.multipliers[:MULTIPLIERS]]
        return table

    def bifurcation_codes(self, leg: Leg) -> np.ndarray:
        """Return the kinds of a leg's bifurcations as integers, padded with -1."""
        numbers = np.full(self.most, -1)
        codes = [BIFURCATIONS.index(each.kind) for each in leg.bifurcations][: self.most]
        numbers[: len(codes)] = codes
        return numbers

    def dataset(self, table: Table) -> xr.Dataset:
        points = table["points"]
        points = points[:, :, : max(1, int(np.isfinite(points[..., 0]).sum(axis=2).max()))]
        along = ("structure", "leg", "point")
        variables = motion_variables(along, points)
        largest = np.nan_to_num(np.abs(points[..., len(COLUMNS)]), nan=np.inf)
        text = "whether the motion is stable"
        # multipliers are known to 1e-7
        variables["stable"] = variable(along, largest < 1.0 - 1e-7, "1", text)
        ends = np.array(ENDS)[table["ends"]]
        variables["end"] = variable(along[:2], ends, "1", "why the branch ends")
        kinds = table["kinds"]
        located = kinds >= 0
        located_motions = motion_variables(("bifurcation",), table["events"][located])
        structures = np.array(STRUCTURES)[np.argwhere(located)[:, 0]]
        names = np.array([KINDS[kind] for kind in BIFURCATIONS])[kinds[located]]
        at = ("bifurcation",)
        located_motions["structure"] = variable(at, structures, "1", "structure")
        located_motions["kind"] = variable(at, names, "1", "kind of bifurcation")
        variables |= {f"bifurcation_{name}": values for name, values in located_motions.items()}
        coordinates = {
            "structure": ("structure", list(STRUCTURES), {"long_name": "structure"}),
            "leg": ("leg", list(LEGS), {"long_name": "where the branch was begun"}),
        }
        return xr.Dataset(variables, coordinates, {"title": "Branches of the weak drive"})


def motion_variables(dims: tuple[str, ...], numbers: np.ndarray) -> dict[str, Variable]:
    variables: dict[str, Variable] = {
        name: variable(dims, numbers[..., i].real, unit, text)
        for i, (name, (unit, text)) in enumerate(COLUMNS.items())
    }
    largest = numbers[..., len(COLUMNS) :]
    text = "Floquet multipliers of the largest size"
    for part, name in (("real", "real"), ("imag", "imaginary")):
        values = getattr(largest, part), "1", f"{text}, {name} part"
        variables[f"multiplier_{part}"] = variable((*dims, "multiplier"), *values)
    return variables


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
    """Trace stationary motions of structure and motor, stable and unstable, round folds.

    Parameters
    ----------
    structure : Structure
        ``bonded`` is ignored: results are returned for both, bonded and delaminated.
    drive : Drive
    speed : (float, float), optional
        Range of the mean speed, rad/s; by default 0.95 and 1.25 times the resonance.
    longest : float
        Longest step along the branch, without a unit: displacements over the averaged theory's
        largest amplitude, voltage over K omega and speed over omega: 0.05 makes about 70 points.
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
    flight grazes: there the smallest closing speed, or the smallest gap at which the masses turn
    away from each other, falls to 0. The grazing is a bifurcation of the answer where the last
    motion is nearer to it than 1e-4; other motions that are nearer to the last one are left out.

    A motion is accepted by what it leaves of the equations, 1e-9 of the amplitude at most (1e-13 is
    usual), and by its impacts, which are those of the motion before. Derivatives are by differences
    of two sizes that agree, on both sides of a motion or on the one where the same impacts occur;
    where none agree, 2e-6 of the amplitude from where an impact vanishes, the branch is not
    followed further. ``stable`` is false within 1e-7 of the unit circle.

    Under a preload (``clearance`` below 0) the delaminated structure moves as the bonded one while
    the contact force lasts, and its branch goes on without a gap: the masses part for a
    moment in each revolution, chatter, and stick. Such motions are begun in contact. ``impacts``
    counts all of a chattering. Where a chattering no longer comes to its end, a branch ends with
    ``"loss of permanent contact"``.

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
    require_motor(structure, drive)
    omega = structure.omega
    low, high = (
        speed * omega for speed in own_resonance.lower_and_higher_resonance(structure, drive)
    )
    expected = "(first, last) in rad/s, with 0 < first < last"
    pair = (0.95 * low, 1.25 * high) if speed is None else speed
    first, last = checked_pair("speed", pair, expected)
    if not 0.0 < first < last:
        raise InputError(f"speed = {speed} rad/s: expected {expected}")
    checked_range("longest", longest, "", low=1e-4, high=1.0)
    settle = 600.0 / omega if settle is None else settle
    checked_range("settle", settle, "s", low=0.0, high=MAX_STEPS * 0.1 / omega)
    least = (("most", most, 2), ("period", period, 1), ("steps", steps, 16))
    most, period, steps = (checked_integer(*count) for count in least)
    own = (float(longest), most, period, steps, settle)
    job = DriveBranchJob("drive_branch", structure, drive, (first, last), *own)
    return compute_dataset(job, running, make_fmu_finder(running))
