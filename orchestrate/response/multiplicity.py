"""Multiplicity of a response (period in excitation periods), decided by how deviations decay.

A tolerance alone decides little: a transient that turns round, or that changes sides as next to a
period doubling, comes back closer after some periods than after one; a torus comes back as close as
one likes after enough of them; and a narrow period doubling stays within any tolerance. So
:func:`decide_multiplicity` asks how deviations develop: those of a response that repeats have died,
or die away.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

MIN_RELATIVE_GAP = (
    2.0**-20
)  # of the motion's size: smaller gaps are not compared with their own size
ROUNDING = 1e-9  # of the motion's size: what is left of deviations that have died, with room
IRREGULAR, REPEATED, UNDECIDED = 0, 1, 2
DECIDED = {IRREGULAR: "irregular", REPEATED: "repeated", UNDECIDED: "undecided"}
BLOCKS = 5  # parts of the later half from each of which to the next a dying deviation shrinks
CHANCE_LOG_RATIO = 0.05  # logarithm of a ratio of deviations, of which chance makes as much
MAX_DRIFT = (
    1e-4  # of a distance that stays: change over the samples seen, of one that dies it is more
)
MAX_DYING_RATIO = 0.8  # ratio of deviations late and early, below which they die
MIN_VISITS = 5  # a quarter of the samples over it: periods after which states are seen often enough
MAX_CONTRACTION = 0.5  # ratio of deviations that shrink, beyond chance
NEGLIGIBLE = (
    1e-3  # of the tolerance: a deviation that counts as none where it is seen a few times only
)
Floats = NDArray[np.float64]


class Repetition(NamedTuple):
    """Multiplicity of a response, and the largest deviation of states so many periods apart."""

    multiplicity: int  # least n such that the state repeats after n periods; 0: none
    # largest difference of states n periods apart over the motion's size; infinity where there is
    # no n
    deviation: float


class Decision(NamedTuple):
    """Multiplicity of a response, and how it was decided: irregular, repeated or undecided."""

    multiplicity: int  # where it is undecided, the best guess
    decided: int  # of `DECIDED`


def scale_states(samples: ArrayLike, frequency: float = 1.0, gap: float | None = None) -> Floats:
    """Divide states by the motion's size, so that differences compare with a tolerance.

    Notes
    -----
    The length is the largest of all displacements and velocities over the frequency in the later
    half of the samples. That of one co-ordinate would not do: at the sampled phase it may pass 0.
    Masses move by many times the gap between them, and impacts depend on the gap: it is compared
    with the largest gap, and its rate with the larger one of that times the frequency and the
    sampled rates. All is homogeneous in the amplitude.
    """
    states = np.array(samples, dtype=float)
    states[:, 2:] /= frequency
    later = states[len(states) // 2 :]
    size = float(np.abs(later).max(initial=0.0)) or 1.0
    if gap is None:
        return states / size
    gap_and_rate = states[:, 1::2] - states[:, ::2]  # the gap, and its rate over the frequency
    of_gap = max(gap, MIN_RELATIVE_GAP * size)
    of_rate = max(of_gap, float(np.abs(gap_and_rate[len(states) // 2 :, 1]).max(initial=0.0)))
    return np.column_stack([states / size, gap_and_rate / (of_gap, of_rate)])


def find_repetition(states: Floats, tolerance: float) -> Repetition:
    """Find the least n after which states repeat within a tolerance; return n, deviation.

    Notes
    -----
    Only the later half of the samples is compared: at low damping and high frequency a transient
    outlives hundreds of periods. A quasi-periodic response narrower than the tolerance counts as
    periodic. Where no n up to a quarter of the samples does, the response is irregular: n is 0.
    """
    later, limit = later_half(states)
    for n in repeating_periods(later, limit, tolerance):
        return Repetition(n, float(deviations(later, n).max()))
    return Repetition(0, np.inf)


def decide_multiplicity(states: Floats, tolerance: float) -> Decision:
    """Decide a response's multiplicity: its deviations must have died or be decaying.

    Notes
    -----
    Deviations in the later half of the samples are compared, those early in it with those late.
    Where n is above a quarter of them a state comes back too seldom for that: such a deviation
    counts as none below a thousandth of the tolerance.
    """
    later, limit = later_half(states)
    many = later.shape[1] // 4
    nearly = drifting = 0
    for n in repeating_periods(later, limit, tolerance):
        away = deviations(later, n)
        if n > many:
            if not (nearly or drifting) and away.max() <= NEGLIGIBLE * tolerance:
                return Decision(n, REPEATED)
            nearly = nearly or (0 if drifting else n)
            break
        spread = float(spread_over_returns(later, n))
        died = spread <= ROUNDING
        left = ROUNDING if died else remaining_change(later, n, spread)
        minimum = max(4.0 * left, spread / MAX_DRIFT if died else tolerance)
        if left <= tolerance and has_persistent_difference(later, n, minimum):
            return Decision(n, REPEATED)
        if spread <= tolerance or abs(np.log(growth_ratio(away))) > CHANCE_LOG_RATIO:
            nearly = nearly or n
        else:
            drifting = n
    ratio = MAX_DYING_RATIO if nearly else MAX_CONTRACTION
    shorter = range(1, min(nearly or many, many // MIN_VISITS) + 1)
    guess = next((n for n in shorter if contraction_ratio(later, n) < ratio), nearly)
    return Decision(guess, UNDECIDED if guess else IRREGULAR)


def later_half(states: Floats) -> tuple[Floats, int]:
    """Return the later half of states, transposed, and the largest number of periods to test."""
    return np.ascontiguousarray(states[len(states) // 2 :].T), max(1, len(states) // 4)


def repeating_periods(later: Floats, limit: int, tolerance: float) -> Iterator[int]:
    """Yield all period numbers n for which states n apart agree within the tolerance."""
    first = np.abs(later[:, 1 : limit + 1] - later[:, :1]).max(axis=0, initial=0.0)
    for n in ((first <= tolerance).nonzero()[0] + 1).tolist():
        if np.abs(later[:, n:] - later[:, :-n]).max() <= tolerance:
            yield n


def deviations(later: Floats, n: int) -> Floats:
    """Return the largest difference of each state from the state n periods before."""
    away: Floats = np.abs(later[:, n:] - later[:, :-n]).max(axis=0)
    return away


def growth_ratio(deviation: Floats) -> float:
    """Return the maximum of the later half of deviations over that of the earlier half."""
    half = max(1, len(deviation) // 2)
    early, late = float(deviation[:half].max()), float(deviation[-half:].max())
    return late / early if early and late else 1.0


def spread_over_returns(states: Floats, n: int) -> Floats:
    """Return how far states lie apart at most that n, 2n, 3n ... periods separate."""
    count = states.shape[-1]
    again = states[..., count - n : count - n + -count % n]  # fills the last n periods
    turns = np.concatenate([states, again], axis=-1).reshape(*states.shape[:-1], -1, n)
    same = turns.swapaxes(-1, -2).copy()  # what is n periods apart beside each other is quicker
    spread: Floats = (same.max(axis=-1) - same.min(axis=-1)).max(axis=(-1, -2))
    return spread


def remaining_change(later: Floats, n: int, spread: float) -> float:
    """Estimate how far n-periodic states still drift (geometric series); infinite if steady.

    Like a geometric series: what shrinks by q over the samples seen and has moved by ``spread``
    still moves by ``spread q/(1 - q)``, less where it turns round.
    """
    ratio = contraction_ratio(later, n)
    q = ratio**2  # over twice the time
    return spread * q / (1.0 - q) if ratio < MAX_DYING_RATIO else np.inf


def contraction_ratio(later: Floats, n: int) -> float:
    """Return the late spread of states n periods apart over the early one; 1 if unknown.

    The spread over many periods sees a deviation that turns round, and that is small after one turn
    of n periods by chance, at its full size.
    """
    half = later.shape[1] // 2
    if 4 * n > half:  # seen too seldom: from the deviations themselves
        away = deviations(later, n)
        blocks = [float(part.max()) for part in np.array_split(away, BLOCKS) if len(part)]
        steady = len(blocks) == BLOCKS and bool((np.diff(blocks) < 0.0).all())
        return growth_ratio(away) if steady else 1.0
    early, late = spread_over_returns(np.array([later[:, :half], later[:, -half:]]), n).tolist()
    return late / early if early else 1.0


def has_persistent_difference(later: Floats, n: int, minimum: float) -> bool:
    """Return whether states a divisor of n periods apart keep a steady difference.

    Next to a period doubling the deviation after half the periods dies slowly: while it does,
    nothing tells the response from the doubled one.
    """
    fractions = (deviations(later, divisor) for divisor in range(1, n) if n % divisor == 0)
    return all(
        away[-n:].max() > minimum and abs(np.log(growth_ratio(away))) < CHANCE_LOG_RATIO
        for away in fractions
    )
