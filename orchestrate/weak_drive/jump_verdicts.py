"""Decide for each voltage direction whether the speed jumps, and explain the decision.

For a bonded structure the averaged theory knows where the motion is lost. A verdict that it
contradicts by more than its own error is not given: the direction is undecided.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

from ..structures.drive import Drive
from ..structures.structure import Structure
from . import averaged
from .held import FOLLOWS, LEFT_BEFORE, LOST, NOT_ASKED, UNDECIDED, Verdict
from .jumps import DOUBTFUL, JUMP, SMOOTH, UNFINISHED, Passing

STEEP = (
    0.3  # least slope d eta0 / d Omega, bonded, below which a delaminated motion may have a fold
)
THEORY_ERROR = 5e-4  # of eta0, of the averaged theory's folds
NARROW = 2e-4  # of eta0: two folds so close may be none, so far as the averaged theory knows
FOLLOWS_TEXT = "no jump: at held voltages too the speed passes the resonance without a gap"
LEFT_BEFORE_TEXT = "left its branch before the ramp: it does so at the first voltage, held, too"
SMOOTH_TEXT = "no jump: the speed follows the voltage through the resonance"


class AveragedPrediction(NamedTuple):
    """Store where averaged theory predicts that the bonded structure loses stability."""

    # voltages over K omega where a motion may be lost: a Neimark-Sacker point and the fold after
    # it, or one of them; empty where none is lost
    losses: tuple[float, ...]
    narrow: bool  # whether its folds are so close that there may be none
    slope: float  # least slope d eta0 / d Omega of all motions
    # the same as `losses` at the box's own resonance, below that of the structure
    box_losses: tuple[float, ...] = ()


@lru_cache(maxsize=64)
def averaged_predictions(
    structure: Structure, drive: Drive
) -> tuple[AveragedPrediction, AveragedPrediction]:
    """Return the averaged theory's predictions for rising and for falling voltage."""
    folds = averaged.folds(structure, drive)
    narrow = bool(folds) and abs(folds[0].eta0 - folds[-1].eta0) < NARROW
    slope = averaged.smallest_slope(structure, drive)
    box = averaged.folds(structure, drive, 0.0, averaged.calm_speed(structure, drive))
    limits = averaged.stability_limits(structure, drive)
    up, down = (
        AveragedPrediction(
            tuple(candidate.eta0 for candidate in (limits[i], *folds[end]) if candidate),
            narrow,
            slope,
            tuple(fold.eta0 for fold in box[end]),
        )
        for i, end in enumerate((slice(None, 1), slice(-1, None)))
    )
    return up, down


def is_doubtful(passing: Passing, bonded: bool, theory: AveragedPrediction) -> bool:
    """Return whether a passage has to be checked by holding voltages."""
    if passing.look == JUMP:
        return bonded and not theory.losses
    if passing.look == SMOOTH:
        return bool(theory.losses) or (not bonded and theory.slope < STEEP)
    return passing.look in (DOUBTFUL, UNFINISHED)


def check_against_theory(verdict: Verdict, theory: AveragedPrediction, volts: float) -> Verdict:
    """Change a bonded structure's verdict to undecided if averaged theory objects."""
    if theory.narrow or verdict.outcome not in (LOST, FOLLOWS):
        return verdict
    if verdict.outcome == FOLLOWS:
        return verdict if not theory.losses else Verdict(UNDECIDED)
    if theory.losses:
        low, high = sorted(abs(voltage) / volts for voltage in (verdict.low, verdict.high))
        first, last = min(theory.losses) - THEORY_ERROR, max(theory.losses) + THEORY_ERROR
        if low <= last and high >= first:
            return verdict
    return verdict._replace(outcome=UNDECIDED)


def check_further(verdict: Verdict, theory: AveragedPrediction, volts: float) -> Verdict:
    """Check a verdict on a further jump, which may be at the box's own resonance too."""
    at_box = check_against_theory(verdict, theory._replace(losses=theory.box_losses), volts)
    return at_box if at_box.outcome == LOST else check_against_theory(verdict, theory, volts)


def explain_no_jump(held: Verdict, final: Verdict, theory: AveragedPrediction, hold: float) -> str:
    """Explain in words why a passage of the resonance is not reported as a jump."""
    if final.outcome == UNDECIDED:
        return explain_undecided(held, theory, hold)
    texts = {FOLLOWS: FOLLOWS_TEXT, LEFT_BEFORE: LEFT_BEFORE_TEXT}
    return texts.get(int(final.outcome), SMOOTH_TEXT)


def explain_undecided(held: Verdict, theory: AveragedPrediction, hold: float) -> str:
    """Explain in words why a direction is undecided, and what would help."""
    if held.outcome == UNDECIDED:
        known = math.isfinite(held.low) and math.isfinite(held.high)
        between = f" between {held.low:.5g} and {held.high:.5g} V" if known else ""
        return (
            f"undecided{between}: voltages held for {hold:.4g} s at most do not tell; a longer "
            "hold may"
        )
    middle = 0.5 * (held.low + held.high)
    ours = f"lose the motion at {middle:.5g} V" if held.outcome == LOST else "lose no motion"
    theirs = "loses it elsewhere" if held.outcome == LOST and theory.losses else "loses it"
    theirs = theirs if theory.losses else "does not"
    return f"undecided: held voltages {ours}, the averaged theory {theirs}; see drive_branch"


def describe_decision(passing: Passing | None, final: Verdict) -> str:
    """Say whether the ramp's record or held voltages decided; empty without a passage."""
    if passing is None:
        return ""
    if final.outcome == UNDECIDED:
        return "undecided"
    return "by the record" if final.outcome == NOT_ASKED else "by held voltages"


def is_jump(passing: Passing | None, final: Verdict) -> bool:
    """Return whether record and verdict together show a jump of the speed."""
    if passing is None:
        return False
    return final.outcome == LOST or (final.outcome == NOT_ASKED and passing.look == JUMP)
