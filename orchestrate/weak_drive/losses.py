"""Collect all losses of stability on one ramp, and pick the jump and the further jumps.

The held course through the resonance may cross more than one loss, and the record may show more
than the passing of the resonance. Each is told by the same rules. The first sure one is the jump.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..response.labels import Variable
from ..running.job import Table
from .held import LOST, NOT_ASKED, UNDECIDED, HeldCourse, Verdict
from .jump_verdicts import describe_decision, is_jump
from .jumps import DOUBTFUL, JUMP, Passing

SLOTS = 6  # further jumps of a direction that a dataset tells
ROWS = 12  # verdicts of a direction that are stored beside that on the passing
MOST = 4  # further places of a direction at which voltages are held
THROUGH = -1  # place of a further verdict of the course through the resonance
AT_END = -2  # place of a verdict on the last stretch of a ramp, which jumps after its end
SAME = 2e-4  # of K omega: brackets so close are of one loss


class Loss(NamedTuple):
    """Store one loss of stability on a ramp, certain or suspected."""

    passing: Passing  # by rows of the run
    verdict: Verdict  # of held voltages
    voltage: float  # where it is, for the order of several, V

    @property
    def is_sure(self) -> bool:
        """Return whether the speed certainly jumps."""
        return is_jump(self.passing, self.verdict)


def empty_verdict_rows() -> np.ndarray:
    """Return the stored array that holds no verdicts, filled with NaN."""
    return np.full((ROWS, 4), math.nan)


def verdicts_to_rows(verdicts: Sequence[tuple[int, Verdict]]) -> np.ndarray:
    """Convert verdicts, each with the index of its suspected jump, to an array."""
    rows = empty_verdict_rows()
    for i, (place, verdict) in enumerate(verdicts[:ROWS]):
        rows[i] = (place, *verdict)
    return rows


def verdicts_from_rows(rows: np.ndarray) -> list[tuple[int, Verdict]]:
    """Convert the array of :func:`verdicts_to_rows` back to indices and verdicts."""
    known = rows[np.isfinite(rows[:, 0])]
    return [(int(row[0]), Verdict(int(row[1]), *row[2:])) for row in known.tolist()]


def drop_known_losses(
    verdicts: Sequence[Verdict], known: Sequence[Verdict], volts: float
) -> list[Verdict]:
    """Drop the verdicts whose brackets overlap losses that are already known."""

    def is_known(verdict: Verdict) -> bool:
        """Return whether a verdict's bracket overlaps a known loss."""
        low, high = sorted((verdict.low, verdict.high))
        ends = [sorted((other.low, other.high)) for other in known]
        return any(
            low <= end + SAME * volts and high >= begin - SAME * volts for begin, end in ends
        )

    return [verdict for verdict in verdicts if not is_known(verdict)]


def loss_verdicts(course: HeldCourse) -> list[Verdict]:
    """Return those verdicts of a held course that are losses or undecided."""
    return [
        verdict
        for verdict in (course.verdict, *course.further)
        if verdict.outcome in (LOST, UNDECIDED)
    ]


def is_crossed(losses: Sequence[Verdict], ends: np.ndarray, sign: float) -> bool:
    """Return whether the first loss of a held course may be what a record shows at a place.

    The last one is what it shows at the passing of the resonance. A place that begins beyond all of
    them is another loss.
    """
    if len(losses) < 2:
        return False
    before, after = sign * (ends - np.array([losses[-1].high, losses[0].low]))
    return bool(before <= 0.0 < after)


def ramp_position(table: Table, rows: np.ndarray, voltage: float) -> Passing:
    """Return where on a ramp a given voltage is reached, as a doubtful passing."""
    voltages = table["voltage"][rows]
    sign = math.copysign(1.0, voltages[-1] - voltages[0])
    half = float(np.interp(sign * voltage, sign * voltages, rows))
    row = min(math.ceil(half), int(rows[-1]) - 1)
    return Passing(row, max(row - 1, int(rows[0])), row + 1, DOUBTFUL, half)


def gather_losses(
    table: Table,
    rows: np.ndarray,
    passing: Passing | None,
    primary: Verdict,
    places: Sequence[Passing],
    further: Sequence[tuple[int, Verdict]],
) -> tuple[Loss | None, list[Loss]]:
    """Combine record and verdicts: return the loss at the resonance, and all others."""
    through = [verdict for place, verdict in further if place == THROUGH]
    covered = [
        places[place] for place, verdict in further if place >= 0 and verdict.outcome == NOT_ASKED
    ]
    at_end = [verdict for place, verdict in further if place == AT_END]
    main, others = None, losses_in_ramp_order(table, rows, [], at_end) if at_end else []
    if passing is not None:
        shown = sorted([*covered, passing])
        *before, last = losses_in_ramp_order(table, rows, shown, [primary, *through])
        main, others = last, [*before, *others]
    for place, look in enumerate(places):
        about_place = [verdict for other, verdict in further if other == place]
        untold = Verdict(NOT_ASKED if look.look == JUMP else UNDECIDED)
        losses_here = [verdict for verdict in about_place if verdict.outcome in (LOST, UNDECIDED)]
        if losses_here or not about_place:
            others += losses_in_ramp_order(table, rows, [look], losses_here or [untold])
    return main, others


def losses_in_ramp_order(
    table: Table, rows: np.ndarray, passings: Sequence[Passing], verdicts: Sequence[Verdict]
) -> list[Loss]:
    """Assign verdicts to places in the record, both in the order of the ramp.

    The last verdict belongs to the last place. Earlier losses that the record does not show are put
    where the ramp reaches their voltages.
    """
    voltages = table["voltage"]
    sign = math.copysign(1.0, voltages[rows[-1]] - voltages[rows[0]])
    ordered = sorted(verdicts, key=lambda verdict: sign * np.nan_to_num(verdict.low))
    losses = []
    for i, verdict in enumerate(reversed(ordered)):
        middle = 0.5 * (verdict.low + verdict.high)
        shown = i < len(passings)
        passing = passings[-1 - i] if shown else ramp_position(table, rows, middle)
        seen = float(np.interp(passing.half, np.arange(len(voltages)), voltages))
        losses.append(Loss(passing, verdict, middle if math.isfinite(middle) else seen))
    return losses[::-1]


def pick_jump(
    main: Loss | None, others: Sequence[Loss], sign: float
) -> tuple[Loss | None, list[Loss]]:
    """Pick the first certain loss as the jump, else the main one; return it and the rest."""
    known = [*([main] if main else []), *others]
    sure = [loss for loss in known if loss.is_sure]
    first = min(sure, key=lambda loss: sign * loss.voltage, default=main)
    further = [
        loss
        for loss in known
        if loss is not first and (loss.is_sure or loss.verdict.outcome == UNDECIDED)
    ]
    return first, sorted(further, key=lambda loss: sign * loss.voltage)


def further_jump_variables(table: Table, further: Sequence[Sequence[Loss]]) -> dict[str, Variable]:
    """Build the dataset's variables of the further jumps in both directions."""
    shape = len(further), SLOTS
    names = ("further_jumps", "further_time", "further_held", "further_error")
    numbers = {name: np.full(shape, math.nan) for name in names}
    decided = np.full(shape, "", dtype=object)
    rows = np.arange(len(table["voltage"]))
    for i, losses in enumerate(further):
        for j, loss in enumerate(losses[:SLOTS]):
            passing, (_, low, high) = loss.passing, loss.verdict
            decided[i, j] = describe_decision(passing, loss.verdict)
            if loss.is_sure:
                for name, column in (("further_jumps", "voltage"), ("further_time", "time")):
                    numbers[name][i, j] = np.interp(passing.half, rows, table[column])
            elif not math.isfinite(low + high):
                low, high = table["voltage"][[passing.before, passing.after]]
            numbers["further_held"][i, j] = 0.5 * (low + high)
            numbers["further_error"][i, j] = 0.5 * abs(high - low)
    texts = {
        "further_jumps": ("V", "voltage at which the speed jumps besides, on the ramp"),
        "further_time": ("s", "time of that voltage"),
        "further_held": ("V", "voltage at which the motion is lost though it is held, or may be"),
        "further_error": ("V", "half the bracket of that voltage"),
    }
    dims = ("jump", "order")
    columns: dict[str, Any] = {
        name: (dims, numbers[name], {"units": unit, "long_name": text})
        for name, (unit, text) in texts.items()
    }
    columns["further_decided"] = (
        dims,
        decided.astype(str),
        {"long_name": "how the further jump was told; empty where there is none"},
    )
    counts = [len(losses) for losses in further]
    text = "further jumps, sure and undecided ones"
    columns["further_count"] = ("jump", counts, {"units": "1", "long_name": text})
    return columns
