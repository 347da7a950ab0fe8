"""One periodic orbit: by Newton's method, what makes a root a motion, and the FMU's word on it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from ..access import EventInstance
from .closed_form import ClosedForm, Floats
from .continuation import NoConvergenceError, Root, corrected, held
from .families import Family, Setting
from .guesses import Guess, from_phases, start
from .impact_sequence import CLOSING, IMPACT, PHASE, TURN, Ring, Sequence
from .turning_points import in_order, nearest, phase_zero, turning_points, weakest_force

SAME_PHASE = 1e-6  # rad: impacts of the FMU at these are the orbit's own
SAME_ORBIT = 1e-6  # of the nodes over their size: an orbit is as at its beginning again
PHASES = 24  # at which a single impact is tried


@dataclass(frozen=True)
class Verdict:
    """What the FMU makes of an orbit.

    Attributes
    ----------
    same : bool
        Whether it has the same impacts, contacts included, from the orbit's state at phase 0 on.
    away : float
        How far from that state it is after the orbit's periods, over a eta^2.
    """

    same: bool
    away: float


def solve(
    setting: Setting, guess: Guess, values: Floats, *, most: int = 25, furthest: float = 100.0
) -> tuple[Family, Root]:
    """The orbit of a guess's sequence at values of the parameters, by Newton's method.

    Raises
    ------
    NoConvergenceError
        Where there is none near.
    """
    sequence, nodes = guess
    family = Family.near(setting, sequence, nodes)
    unknowns = np.append(nodes.ravel(), values)
    across = held(family, family.size)
    return family, corrected(family, unknowns, across, most=most, furthest=furthest)


def why_no_motion(ring: Ring) -> str:
    """Why a root of the equations is no motion; empty where it is one."""
    if (ring.durations <= 0.0).any():
        return "its impacts are out of order"
    closing = ring.nodes[~ring.sequence.releases, CLOSING] if ring.count else np.ones(1)
    if not (closing > 0.0).all():
        return "an impact has no closing speed"
    if nearest(ring, turning_points(ring))[0] < 0.0:
        return "the masses would go through each other"
    if weakest_force(ring) < 0.0:
        return "the contact would pull"
    return ""


def least_periods(ring: Ring) -> int:
    """The least number of periods after which an orbit closes, wherever its impacts lie: phases are
    compared on a circle, so that one at phase 0 may be told as 2 pi.
    """
    periods, count = ring.sequence.periods, ring.count
    kinds, span = np.array(ring.sequence.kinds), TURN * ring.sequence.periods
    size = float(np.abs(ring.nodes[:, 1:]).max(initial=0.0)) or 1.0
    for part in range(1, periods):
        if periods % part or count * part % periods:
            continue
        shift = count * part // periods
        away = np.roll(ring.nodes, -shift, axis=0) - ring.nodes
        away[:, PHASE] -= TURN * part
        away[:, PHASE] -= span * np.round(away[:, PHASE] / span)
        away[:, 1:] /= size
        same = (np.roll(kinds, -shift) == kinds).all()
        if same and np.abs(away).max(initial=0.0) < SAME_ORBIT:
            return part
    return periods


def verdict(instance: EventInstance, setting: Setting, values: Floats, ring: Ring) -> Verdict:
    """Run the orbit through in the FMU."""
    point = setting.point(values)
    state = phase_zero(ring)[0]
    start(instance, point, ring.form, state * point.scale)
    end = ring.sequence.periods * point.excitation.period
    found = instance.impacts(0.0, end)
    after = instance.read("x1", "x2", "v1", "v2") / point.scale
    away = float(np.abs(after - state).max())
    wanted, first = in_order(ring.nodes, ring.sequence.periods)
    kinds = np.roll(np.array(ring.sequence.kinds, dtype=int), -first)
    impacts = kinds != 2
    if len(found.time) != impacts.sum():
        return Verdict(False, away)
    phases = point.excitation.frequency * found.time
    near = np.abs(phases - wanted[impacts, PHASE]).max(initial=0.0) < SAME_PHASE
    sticking = (found.sticks == (kinds[impacts] == 1)).all()
    return Verdict(bool(near and sticking), away)


def first_motion(
    setting: Setting, guesses: Iterable[Guess], values: Floats, *, stable: bool = False
) -> tuple[Family, Root]:
    """The first orbit that Newton's method finds and that is a motion of just its periods.

    Parameters
    ----------
    setting : Setting
    guesses : iterable of Guess
    values : ndarray
    stable : bool
        Whether a stable one that comes later goes before an unstable one.

    Raises
    ------
    NoConvergenceError
        Where no guess leads to one, with the reason of the first.
    """
    reason, unstable = "", None
    for guess in guesses:
        try:
            family, root = solve(setting, guess, values)
        except NoConvergenceError as error:
            reason = reason or str(error)
            continue
        ring = family.ring(root.unknowns)
        why = why_no_motion(ring) or why_shorter(ring, guess[0].periods)
        if not why and (not stable or ring.stable):
            return family, root
        unstable = unstable or (None if why else (family, root))
        reason = reason or why
    if unstable:
        return unstable
    raise NoConvergenceError(reason or "there is no impact to begin with")


def why_shorter(ring: Ring, periods: int) -> str:
    """Why an orbit is none of so many periods; empty where it is one."""
    shorter = least_periods(ring)
    return f"the orbit found repeats after {shorter} already" if shorter < periods else ""


def single_impacts(form: ClosedForm, periods: int) -> Iterator[Guess]:
    """Guesses with one impact in all, at phases all around."""
    sequence = Sequence(periods, (IMPACT,))
    for phase in np.arange(PHASES) * TURN / PHASES:
        yield from_phases(form, sequence, np.array([phase]))
