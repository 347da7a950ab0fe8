"""The rule by which fits and signs become a verdict, and the words for it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .misfit import soft_squares

Floats = NDArray[np.float64]
DELAMINATED = "delaminated"
NOT_SEEN = "no opening seen"
NOT_DESCRIBED = "not described"
UNDECIDED = "undecided"
RATIO = 1.5  # by which the delaminated misfit has to be smaller than the best sound one
# The same where two faces are seen to move apart, as those of no sound structure do
RATIO_OF_FACES_APART = 1.05
SOUND_DESCRIBES = 1.2  # largest misfit of a sound hypothesis that describes a record
DELAMINATED_DESCRIBES = 3.0  # of the delaminated one: real contacts are not the model's
DESCRIBES_FACES_APART = 4.0  # the same where two faces are seen to move apart
CERTAIN = 0.9  # share of the resampled records in which the ratio has to hold
RESAMPLED, BLOCKS, SEED = 1000, 20, 7
CLOSE = 1.25  # a factor: a quantity so near to its border may lie on the other side of it
MISFIT_MEANING = "A misfit of 1 is as far as noise and the usual error of a good model explain."
UNSURE = (0.02, 0.98)  # shares of resampled records between which the ratio is not sure


@dataclass(frozen=True)
class Findings:
    """Hold the quantities that the decision rule needs."""

    # order 2 over its detection threshold, the largest of all windows; above 1 it is seen
    excess: float
    order2: float  # its size there, over order 1
    apart: float  # difference of two sensors over its detection threshold; 0 with one sensor
    # power of one-sided bursts at high frequencies over its detection threshold; NaN where the
    # record is sampled too slowly to tell
    bursts: float
    # names of the best hypotheses of both kinds
    sound: str
    sound_misfit: float
    delaminated: str
    delaminated_misfit: float
    # of resampled records in which the delaminated one is better by the ratio that decides
    share: float
    sensors: int
    # level of the base, m/s2
    low: float
    high: float
    # frequencies, Hz
    first: float
    last: float
    # smallest opening at the sensor that would have been seen at every frequency, m
    smallest: float

    @property
    def ratio(self) -> float:
        """Misfit of the best sound hypothesis over that of the delaminated one."""
        return self.sound_misfit / self.delaminated_misfit

    @property
    def is_opening_seen(self) -> bool:
        """Whether order 2, or two faces that move differently, exceed their thresholds."""
        return self.excess > 1.0 or self.apart > 1.0

    @property
    def is_impact_heard(self) -> bool:
        """Whether bursts once a period, as of impacts, exceed their threshold."""
        return self.bursts > 1.0

    @property
    def deciding_ratio(self) -> float:
        """Ratio of misfits from which the delaminated model is taken for the better one."""
        return deciding_ratio(self.apart)

    @property
    def odds(self) -> float:
        """Odds of delaminated against sound, by the share of resampled records."""
        return (self.share * RESAMPLED + 0.5) / ((1.0 - self.share) * RESAMPLED + 0.5)

    @property
    def is_close(self) -> bool:
        """Whether the verdict hangs on a number near its border, or on a part of the record."""
        if self.is_opening_seen and UNSURE[0] < self.share < UNSURE[1]:
            return True
        names = ("excess", "apart", "bursts", "sound_misfit", "delaminated_misfit")
        return any(
            self.with_number_scaled(name, factor).verdict() != self.verdict()
            for name in names
            for factor in (CLOSE, 1.0 / CLOSE)
        )

    def with_number_scaled(self, name: str, factor: float) -> Findings:
        """Return the findings with one number multiplied by a factor."""
        made = replace(self, **{name: getattr(self, name) * factor})
        if made.ratio == self.ratio and made.deciding_ratio == self.deciding_ratio:
            return made
        return replace(made, share=float(made.ratio >= made.deciding_ratio))

    def verdict(self) -> str:
        """Apply the rule and return one of the four verdicts."""
        sound = self.sound_misfit <= SOUND_DESCRIBES
        describes = DESCRIBES_FACES_APART if self.apart > 1.0 else DELAMINATED_DESCRIBES
        delaminated = self.delaminated_misfit <= describes
        better = delaminated and self.ratio >= self.deciding_ratio
        if not self.is_opening_seen:
            if sound:
                return UNDECIDED if self.is_impact_heard else NOT_SEEN
            return UNDECIDED if better else NOT_DESCRIBED
        if better:
            return DELAMINATED if self.share >= CERTAIN else UNDECIDED
        if sound or delaminated:
            return UNDECIDED
        return NOT_DESCRIBED

    def reason(self) -> str:
        """Return sentences that say by which numbers the verdict was decided."""
        sentences = [
            f"Order 2 is up to {digits(100.0 * self.order2)} % of order 1, "
            f"{digits(self.excess)} times the size from which it counts as seen."
        ]
        if self.sensors > 1:
            apart = f"{digits(self.apart)} times the difference from which it counts as seen"
            sentences.append(f"The two faces differ by {apart}.")
        if math.isfinite(self.bursts):
            power = f"{digits(self.bursts)} times the power from which they count as impacts"
            sentences.append(f"Bursts once a period have {power}.")
        misfit = (
            f'The best sound model, "{self.sound}", has a misfit of {digits(self.sound_misfit)}'
        )
        if self.is_opening_seen:
            other = f'the model "{self.delaminated}" has {digits(self.delaminated_misfit)}'
            enough = f"{self.deciding_ratio:g} times is enough to decide"
            misfit += f", {other}: that is {self.ratio:.3g} times as large, where {enough}"
        sentences.append(f"{misfit}.")
        return " ".join([*sentences, MISFIT_MEANING, *self.heard_only(), *self.imperfection()])

    def heard_only(self) -> list[str]:
        """Return a sentence on impacts that move the sensor too little for order 2, if any."""
        if self.is_opening_seen or not self.is_impact_heard:
            return []
        return ["Something strikes once a period: faces away from the sensor, or a loose part."]

    def imperfection(self) -> list[str]:
        """Return a sentence on a model that decides but describes the record poorly, if it does."""
        described = self.ratio >= RATIO and self.delaminated_misfit <= DELAMINATED_DESCRIBES
        if self.verdict() != DELAMINATED or described:
            return []
        return [
            "What decides is that the faces move apart: two masses describe this structure only "
            "so well, and their numbers say little about it."
        ]

    def next_measurement(self) -> str:
        """Recommend, in a sentence, the measurement that would decide or confirm the verdict."""
        other = "an accelerometer on the other face" if self.sensors == 1 else "a slower sweep"
        return {
            DELAMINATED: "A sweep in the other direction and another level should give the same "
            "frequencies of the halves; a free clamp or a loose part would not.",
            NOT_SEEN: "A sweep at a higher level: faces that are pressed together open above a "
            "threshold only, and below it no record tells them from bonded ones.",
            NOT_DESCRIBED: "Sweeps up and down at two levels after the clamp is tightened and "
            "loose parts are taken away: what is seen is neither a sound beam nor this one.",
            UNDECIDED: f"Sweeps up and down at twice the level, with {other}.",
        }[self.verdict()]

    def seen_up_to(self) -> str:
        """Describe the range that was measured, and the smallest opening detectable in it."""
        opening = f"{digits(1e6 * self.smallest)} \u00b5m"
        text = (
            f"up to {self.high:.3g} m/s\u00b2 from {self.first:.3g} to {self.last:.3g} Hz; "
            f"faces at the sensor that part by {opening} would have been seen at every frequency; "
            "away from the sensor an opening may be larger"
        )
        if math.isnan(self.bursts):
            text += "; the record is sampled too slowly for the bursts of impacts"
        return text


def digits(value: float) -> str:
    """Format a number with two significant digits, without an exponent.

    Examples
    --------
    >>> digits(0.1234), digits(113.0)
    ('0.12', '110')
    """
    return f"{float(f'{value:.2g}'):.10g}"


def deciding_ratio(apart: float) -> float:
    """Return the ratio of misfits that decides: a smaller one where two faces move differently."""
    return RATIO_OF_FACES_APART if apart > 1.0 else RATIO


def resampled_share(sound: Floats, delaminated: Floats, ratio: float = RATIO) -> float:
    """Return the share of block-bootstrap samples in which the ratio of misfits is exceeded."""
    one, other = (soft_squares(values).mean(axis=(0, 1)) for values in (sound, delaminated))
    blocks = np.array_split(np.arange(len(one)), min(BLOCKS, len(one)))
    sums = np.array([[one[block].sum(), other[block].sum()] for block in blocks])
    rng = np.random.default_rng(SEED)
    chosen = rng.integers(0, len(sums), size=(RESAMPLED, len(sums)))
    first, second = sums[chosen].sum(axis=1).T
    return float(np.mean(np.sqrt(first / second) >= ratio))
