"""Check the jump verdicts of `couple` on random drives against traced branches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from orchestrate import couple, drive_branch
from orchestrate.weak_drive import averaged
from tools.draws import NARROW, RATES, System, ramp_ends

from .held_speeds import RATE, held_speeds

KINDS = ("bonded", "delaminated")
WAYS = ("up", "down")
SAID = {"by held voltages": "lost", "undecided": "undecided"}
FOLD, TORUS, NONE, UNKNOWN = "fold", "Neimark-Sacker", "none", "unknown"
TOLERANCE = 2e-4  # of eta0: how far a bracket may lie from where the motion is lost
EARLY = 2e-3  # of eta0: how far before it the jump of a ramp may be seen
BESIDE = 6e-5  # of eta0: before and past a fold voltages are held, to see whether it is met
CHANGE = 8e-3  # of omega: least change of the speed between them where a fold is a jump
SAME = 4e-3  # of omega: speeds at one voltage that differ by more are of two motions
GRID = 4e-3  # of eta0: between voltages that are held there and back
AROUND = (0.06, 0.04)  # of eta0: of them, below the lowest fold and above the highest
SHORT = 0.25  # of a hold, on that grid
SLOW_RATE = 0.1 * RATE  # between holds, where those at the usual rate speak against an answer


SLOPES = (-0.6, 0.3)  # least slopes d eta0 / d Omega of drives that nearly have, or lack, folds


class Truth(NamedTuple):
    """Store where a slow ramp must lose its motion, by the traced branches."""

    kind: str  # `FOLD`, `TORUS`, `NONE` where it loses none, or `UNKNOWN`
    # voltages over K omega between which it may be lost
    low: float = np.nan
    high: float = np.nan
    further: tuple[float, ...] = ()  # voltages over K omega of other folds at which it jumps too
    # voltages over K omega of folds past which the speed falls back to that of another motion
    against: tuple[float, ...] = ()

    @property
    def places(self) -> tuple[tuple[float, float], ...]:
        """Return the voltage ranges in each of which a motion is lost, over K omega."""
        return ((self.low, self.high), *((fold, fold) for fold in self.further))


class Answer(NamedTuple):
    """Store what `couple` reports for one direction, with voltages over K omega."""

    said: str  # `"lost"`, `"none"`, `"undecided"` or `"not passed"`
    # where it is lost: the bracket of held voltages, or the one voltage of the record
    low: float
    high: float
    held: bool  # whether held voltages decided
    further: tuple[Answer, ...] = ()  # on further jumps of the direction, sure and undecided ones


def run_couple(system: System, rate: float) -> tuple[Answer, ...]:
    """Run `couple` at one rate; return its answers upward and downward."""
    structure, drive = system
    volts = drive.volts(structure)
    first, last = (end * volts for end in ramp_ends(system))
    rate *= volts * structure.omega
    run = couple(structure, drive, voltage=(first, last), rate=rate, progress=False)
    return tuple(read_answer(run, way, volts) for way in WAYS)


def read_answer(run: xr.Dataset, way: str, volts: float) -> Answer:
    """Read the answer on all jumps in one direction from a dataset."""
    answers = []
    for label in run.jump.values:
        if str(label).split()[0] == way:
            at = run.sel(jump=label)
            low, high = sorted(float(at[name]) / volts for name in ("jump_low", "jump_high"))
            said = SAID[str(at.decided.item())] if np.isfinite(low) else "none"
            held = str(at.decided.item()) != "by the record"
            answers.append(Answer(said, low, high, held))
    return answers[0]._replace(further=tuple(answers[1:]))


def trace_truths(system: System, kinds: Sequence[str] = KINDS) -> dict[tuple[str, str], Truth]:
    """Trace both structures' branches; return where each direction loses its motion."""
    structure, drive = system
    folds, omega = averaged.folds(*system), structure.omega
    resonance = averaged.resonance(*system)
    speeds = [fold.Omega for fold in folds] or [resonance]
    speed = ((min(speeds) - 0.1) * omega, (max(speeds) + 0.1) * omega)
    if len(folds) > 1 and abs(folds[0].eta0 - folds[-1].eta0) < NARROW:
        return dict.fromkeys(((kind, way) for kind in KINDS for way in WAYS), Truth(UNKNOWN))
    branch = drive_branch(structure, drive, speed=speed, longest=0.03, progress=False)
    units = drive.volts(structure), omega
    known = {
        (kind, way): first_loss_on_leg(branch.sel(structure=kind), kind, way, units)
        for kind in kinds
        for way in WAYS
    }
    delaminated = system.of_kind("delaminated")
    for way in WAYS if "delaminated" in kinds else ():
        if known["delaminated", way].kind != NONE:
            known["delaminated", way] = fold_that_is_met(delaminated, branch, way)
    return known


def fold_that_is_met(system: System, branch: xr.Dataset, way: str) -> Truth:
    """Find by held voltages at which delaminated fold a slow ramp jumps.

    Branches have more folds than a ramp meets; and where it meets one it may go on with another
    motion of nearly the same speed. So voltages are held closely before and past each fold, in one
    course that begins far away: wider steps than these may land on other motions. A fold is met
    where the speed before it is that of the branch, and it is a jump where the speed past it is
    another. Unknown without any; where there are more, all count.
    """
    sign = 1.0 if way == "up" else -1.0
    folds = sorted(delaminated_folds(system, branch, way), reverse=way == "down")
    if not folds:
        return Truth(UNKNOWN)
    course = [voltage + side * sign * BESIDE for voltage, _ in folds for side in (-1.0, 1.0)]
    course = sort_in_direction(course, way)
    speeds = dict(zip(course, held_speeds(system, course_start(system, way), course), strict=True))
    met, against = [], []
    for voltage, speed in folds:
        before, past = (speeds[voltage + side * sign * BESIDE] for side in (-1.0, 1.0))
        change = sign * (past - before)
        if abs(before - speed) < CHANGE and abs(change) > CHANGE:
            (met if change > 0.0 else against).append((change, voltage))
    if not met:
        return Truth(UNKNOWN)
    *others, largest = (voltage for _, voltage in sorted(met))
    return Truth(FOLD, largest, largest, tuple(others), tuple(voltage for _, voltage in against))


def delaminated_folds(system: System, branch: xr.Dataset, way: str) -> list[tuple[float, float]]:
    """Return voltage and speed of the delaminated folds that end motions in one direction."""
    structure, drive = system
    units = drive.volts(structure), structure.omega
    legs = branch.sel(structure="delaminated")
    names = ("voltage", "speed")
    points = np.stack([legs[name].values / unit for name, unit in zip(names, units, strict=True)])
    points = np.nan_to_num(points, nan=np.inf)
    own = branch.bifurcation_structure.values == "delaminated"
    own &= branch.bifurcation_kind.values == FOLD
    folds = []
    for i in np.flatnonzero(own):
        fold = np.array(
            [
                float(branch[f"bifurcation_{name}"][i]) / unit
                for name, unit in zip(names, units, strict=True)
            ]
        )
        leg, point = np.unravel_index(
            np.argmin(np.abs(points - fold[:, np.newaxis, np.newaxis]).max(axis=0)),
            points.shape[1:],
        )
        around = points[0, leg, max(0, point - 1) : point + 2]
        is_highest = fold[0] >= np.median(around[np.isfinite(around)])
        if is_highest == (way == "up"):
            folds.append((float(fold[0]), float(fold[1])))
    return folds


def course_start(system: System, way: str) -> float:
    """Return the voltage at which a course in one direction starts, over K omega."""
    return ramp_ends(system)[WAYS.index(way)]


def sort_in_direction(voltages: Sequence[float], way: str) -> list[float]:
    """Sort voltages in the order of a direction."""
    return sorted(voltages, reverse=way == "down")


def contradiction(system: System, answer: Answer, way: str) -> str:
    """Test an answer by separate held voltages; return the contradiction or empty text."""
    if answer.said == "lost" and answer.held:
        return bracket_contradiction(system, answer, way)
    return grid_contradiction(system, answer, way) if answer.said in ("lost", "none") else ""


def bracket_contradiction(system: System, answer: Answer, way: str) -> str:
    """Test a bracket by held voltages, at two rates; return any contradiction.

    A motion with a narrow basin is thrown out of it by the ramp between two holds, long before it
    ends: what speaks against an answer has to do so on a slow way too.
    """
    for rate in (RATE, SLOW_RATE):
        problem = bracket_problem(system, answer, way, rate)
        if not problem:
            break
    return problem


def bracket_problem(system: System, answer: Answer, way: str, rate: float) -> str:
    """Hold voltages around a bracket at one rate; return any contradiction.

    An irregular motion may be lost before: so the first two are further away. Where the speed does
    not change over the bracket, it has to have changed from there to it by more than a branch does
    that is as steep as between those two.
    """
    sign = 1.0 if way == "up" else -1.0
    stays, lost = sort_in_direction((answer.low, answer.high), way)
    far, past = stays - sign * EARLY, lost + sign * TOLERANCE
    course = (far - sign * EARLY, far, stays, past, stays)
    first, before, there, beyond, back = held_speeds(
        system, course_start(system, way), course, rate=rate
    )
    steep = abs(before - first) < CHANGE  # else a motion was lost between the two
    expected = before + (before - first) * steep
    if abs(beyond - there) < SAME and abs(beyond - expected) < SAME:
        return f"lost at {stays:.5f}, but past it, held, the speed goes on as from {far:.5f}"
    if abs(back - there) < SAME and abs(back - expected) < SAME:
        return f"lost at {stays:.5f}, but the speed comes back there"
    return ""


def grid_contradiction(system: System, answer: Answer, way: str) -> str:
    """Hold a grid of voltages there and back; return any contradiction.

    A jump through the resonance leaves the speed behind the voltage until it jumps: on the way
    there the speed has passed less far than on the way back. Two motions the other way round are
    lost against the way of the voltage: they exchange beside the resonance, and no verdict is about
    them.
    """
    low, high = ramp_ends(system)
    sign = 1.0 if way == "up" else -1.0
    first = np.fmin(low + 0.15, answer.low) - AROUND[0]
    last = np.fmax(high - 0.15, answer.high) + AROUND[1]
    ends = max(first, low), min(last, high)
    voltages = sort_in_direction(np.arange(*ends, GRID).tolist(), way)
    there_and_back = [*voltages, *voltages[::-1]]
    speeds = held_speeds(system, course_start(system, way), there_and_back, SHORT)
    behind = sign * (speeds[::-1][: len(voltages)] - speeds[: len(voltages)])
    if answer.said == "lost":
        unlike = (behind >= SAME) | np.isnan(behind)
        return "" if unlike.any() else "lost, but held speeds come back everywhere"
    if not (behind > CHANGE).any():
        return ""
    voltage = voltages[int(np.nanargmax(behind))]
    return f"none, but two motions last at {voltage:.5f}: speeds {np.nanmax(behind):.4f} apart"


def first_loss_on_leg(branch: xr.Dataset, kind: str, way: str, units: tuple[float, float]) -> Truth:
    """Read from one traced branch where its motion is first lost in a direction.

    Unknown where that is no fold: of the delaminated structure, whose impacts may become irregular
    there without any change of the speed.
    """
    volts, omega = units
    leg = branch.isel(leg=0)
    if way == "down" and str(leg.end.item()) != "limit":
        leg = branch.isel(leg=1)
    count = int(np.isfinite(leg.voltage.values).sum())
    voltage, speed = (leg[name].values[:count] for name in ("voltage", "speed"))
    stable = leg.stable.values[:count]
    whole = str(leg.end.item()) == "limit"
    if way == "down" and int(branch.leg.size) and leg.leg.item() == branch.leg.values[0]:
        voltage, speed, stable = voltage[::-1], speed[::-1], stable[::-1]
    if not count or not stable[0]:
        return Truth(UNKNOWN)
    if stable.all():
        return Truth(NONE) if whole else Truth(UNKNOWN)
    i = int(np.argmin(stable))
    own = branch.bifurcation_structure.values == kind
    own &= branch.bifurcation_revolutions.values == float(leg.revolutions[0])  # not a branch beside
    kinds = branch.bifurcation_kind.values[own]
    places = np.stack([branch.bifurcation_voltage.values, branch.bifurcation_speed.values])[:, own]
    scaled = places / np.array([[volts], [omega]])
    near = 0.5 * np.array([voltage[i - 1] + voltage[i], speed[i - 1] + speed[i]])
    away = np.abs(scaled - (near / [volts, omega])[:, np.newaxis]).max(axis=0)
    if not away.size or away.min() > 0.05:
        return Truth(UNKNOWN)
    first = int(away.argmin())
    if kinds[first] == FOLD:
        return Truth(FOLD, scaled[0, first], scaled[0, first])
    folds = scaled[0, kinds == FOLD]
    if kind == "bonded" and kinds[first] == TORUS and folds.size:
        last = folds.max() if way == "up" else folds.min()
        low, high = sorted([scaled[0, first], float(last)])
        return Truth(TORUS, low, high)
    return Truth(UNKNOWN)


def error_in_answer(answer: Answer, known: Truth, way: str) -> str:
    """Compare an answer with the truth; return the error or empty text."""
    if known.kind == UNKNOWN or answer.said == "not passed":
        return ""
    sure = [each for each in (answer, *answer.further) if each.said == "lost"]
    if known.kind == NONE:
        return f"lost at {sure[0].low:.5f}, but no motion is lost" if sure else ""
    if answer.said == "none" and not sure:
        return f"none, but a motion is lost at {known.low:.5f}"
    if answer.said == "undecided":
        return ""
    for place in known.places:
        if not any(matches_range(each, place, way) for each in (*sure, *answer.further)):
            return f"lost at {sure[0].low:.5f} to {sure[0].high:.5f}, in truth at {place[0]:.5f}"
    return ""


def matches_range(answer: Answer, place: tuple[float, float], way: str) -> bool:
    """Return whether an answer's bracket matches a range where a motion is lost."""
    early, late = (EARLY, np.inf) if not answer.held else (TOLERANCE, TOLERANCE)
    before, after = (early, late) if way == "up" else (late, early)
    return place[0] - before <= answer.high and answer.low <= place[1] + after


def is_left_against_the_way(answer: Answer, known: Truth, way: str) -> bool:
    """Return whether an answer tells the end of a motion past which chance has the next one.

    The held course that knows the truth came to a motion less far along there, and lost that one
    later; a ramp may come to the motion beyond at once.
    """
    sure = [each for each in (answer, *answer.further) if each.said == "lost"]
    return any(matches_range(each, (fold, fold), way) for each in sure for fold in known.against)


def answers_without_truth(answer: Answer, known: Truth, way: str) -> list[Answer]:
    """Return the certain answers that the traced branches neither confirm nor deny."""
    sure = [each for each in (answer, *answer.further) if each.said == "lost"]
    if known.kind == UNKNOWN:
        return sure or [answer]
    if known.kind == NONE or not answer.further:
        return []
    return [
        each for each in sure if not any(matches_range(each, place, way) for place in known.places)
    ]


def check_answers(
    system: System, kind: str, known: dict[str, Truth], rates: Sequence[float] = RATES
) -> Iterator[tuple[str, str]]:
    """Check the answers on one structure at all rates; yield each with any error."""
    said: dict[str, set[str]] = {way: set() for way in WAYS}
    for rate in rates:
        for way, answer in zip(WAYS, run_couple(system, rate), strict=True):
            new = answer.said not in said[way]
            for each in answers_without_truth(answer, known[way], way) if new else ():
                problem = contradiction(system, each, way)
                yield (
                    "held by themselves",
                    f"{kind}, {way}, rate {rate:g}: {problem}" * bool(problem),
                )
            said[way].add(answer.said)
            by = "by held voltages" if answer.held else "by the record"
            decided = answer.said in ("lost", "none")
            name = f"{answer.said} {by}" if decided else answer.said
            wrong = error_in_answer(answer, known[way], way)
            if wrong and is_left_against_the_way(answer, known[way], way):
                name, wrong = "lost against the way", contradiction(system, answer, way)
            yield name, f"{kind}, {way}, rate {rate:g}: {wrong}" * bool(wrong)
            for each in answer.further:
                yield f"further jump {each.said}", ""
    for way in WAYS:
        if {"lost", "none"} <= said[way]:
            yield "", f"{kind}, {way}: lost at some rates, none at others"


def judge(
    system: System, rates: Sequence[float], kinds: Sequence[str] = KINDS
) -> Iterator[tuple[str, str]]:
    """Check both structures of one drive; yield each answer with any error."""
    known = trace_truths(system, kinds)
    for kind in kinds:
        of_kind = {way: known[kind, way] for way in WAYS}
        for way in WAYS:
            yield f"truth {of_kind[way].kind}", ""
        yield from check_answers(system.of_kind(kind), kind, of_kind, rates)
