"""The rule by which fits and signs become a verdict, and the words for it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..laboratory.pieces import Floats
from .misfit import soft_squares
from .settings import SETTINGS, Settings

DELAMINATED = "delaminated"
NOT_SEEN = "no opening seen"
NOT_DESCRIBED = "not described"
UNDECIDED = "undecided"
RESAMPLED = 1000
MISFIT_MEANING = "A misfit of 1 is as far as noise and the usual error of a good model explain."


@dataclass(frozen=True)
class Condition:
    """Hold whether a condition of a verdict is fulfilled, and what to say where it is not."""

    holds: bool
    otherwise: str  # A sentence: what stops the verdict
    advice: str = ""  # the measurement that would settle it, where that is not the usual one


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
    hidden: float  # largest order 2 that would not have been seen, over order 1
    clipped: float  # share of samples at repeated extreme values, of the channel that has most
    # response at an end of the sweep over the largest one, the larger of both ends
    end_response: float
    resonance: float  # frequency of that largest one, Hz
    guessed: tuple[float, float]  # lower and higher frequency of the guess's halves, Hz
    settings: Settings = SETTINGS
    alike: str = ""  # as of the best sound hypothesis

    def verdict(self) -> str:
        """Apply the rule and return one of the four verdicts.

        - A record of a saturated channel (`clipped`), of a sweep that does not pass the resonance
          (`end_response`), or of one far from the guess's (`guess_factor`) is "undecided".
        - "delaminated": order 2 is seen and bursts are `heard`, or two faces move apart; the misfit
          is at most `delaminated` and `ratio` times smaller than the best sound one; of faces that
          move apart `ratio_apart` times if order 2 or bursts exceed their thresholds, else
          `ratio_difference`; in `share` of records made of blocks.
        - "no opening seen": order 2, the difference of the faces and bursts, where the sampling
          tells them, are below their thresholds, a sound misfit is at most `sound`, noise hides no
          order 2 of `hidden`.
        - "not described": no sound misfit is at most `sound`, and the delaminated one exceeds its
          limit in the second bullet.
        - "undecided": all else.
        """
        usable = all(one.holds for one in self.record_conditions())
        delaminated = all(one.holds for one in self.delaminated_conditions())
        not_seen = all(one.holds for one in self.no_opening_conditions())
        if usable and (delaminated or not_seen):
            return DELAMINATED if delaminated else NOT_SEEN
        described = self.sound_misfit <= self.settings.sound
        described |= self.delaminated_misfit <= self.settings.delaminated
        return UNDECIDED if described or not usable else NOT_DESCRIBED

    def record_conditions(self) -> list[Condition]:
        """Return the conditions under which a record decides anything."""
        factor = factor_outside(self.resonance, *self.guessed)
        low, high = self.guessed
        most = 100.0 * self.settings.end_response
        away = f"a factor of {factor:.3g} from the guess's {low:.3g} to {high:.3g} Hz"
        return [
            Condition(
                self.clipped <= self.settings.clipped,
                f"{digits(100.0 * self.clipped)} % of a channel's samples are at its extreme "
                "values: it is saturated.",
                "The same sweep with a larger range of the sensors, or at a lower level.",
            ),
            Condition(
                self.end_response <= self.settings.end_response,
                "The sweep does not pass the resonance: the response at one of its ends is "
                f"{digits(100.0 * self.end_response, most)} % of the largest one, at "
                f"{self.resonance:.3g} Hz, where {digits(most)} % "
                "shows it as passed.",
                "A sweep that passes the resonance, from well below it to well above it.",
            ),
            Condition(
                factor <= self.settings.guess_factor,
                f"The response is largest at {self.resonance:.3g} Hz, {away}.",
                "None yet: are the times of the record in s, and is the guess one of this beam?",
            ),
        ]

    def delaminated_conditions(self) -> list[Condition]:
        """Return the conditions of "delaminated"."""
        enough, most = self.deciding_ratio, self.settings.delaminated
        alone = "is all that is seen, as two modes of a sound beam show it too: it decides"
        alike = f": {self.alike} about as well" if self.alike else ""
        ratio, advice = f"The ratio is {self.ratio:.3g}, where {enough:g} is enough{alike}.", ""
        if self.is_difference_alone:
            ratio = f"The faces' difference {alone} from a ratio of {enough:g} on."
            advice = "Sensors exactly opposite each other, on the beam's axis, and a higher level."
        strike = f"Faces that strike make bursts of {self.settings.heard:g} times the threshold"
        untold = "; the record is sampled too slowly for them" if math.isnan(self.bursts) else ""
        return [
            Condition(self.is_opening_seen, "Neither order 2 nor a difference of faces is seen."),
            Condition(
                self.apart > 1.0 or self.bursts >= self.settings.heard,  # NaN: not told
                f"{strike}{untold}.",
                "Sweeps at twice the level, of 12 samples a period or more, with both sensors.",
            ),
            Condition(
                self.delaminated_misfit <= most,
                f"The delaminated model's misfit is {digits(self.delaminated_misfit, most)}, where "
                f"at most {most:g} describes a record.",
            ),
            Condition(self.ratio >= enough, ratio, advice),
            Condition(
                self.ratio < enough or self.share >= self.settings.share,
                f"The ratio exceeds {enough:g} in {self.share:.2g} of the records that are put "
                f"together of its blocks, where {self.settings.share:g} is enough.",
            ),
        ]

    def no_opening_conditions(self) -> list[Condition]:
        """Return the conditions of "no opening seen"."""
        sound, most = self.settings.sound, 100.0 * self.settings.hidden
        return [
            Condition(not self.is_opening_seen, "Something is seen to open."),
            Condition(
                not self.is_impact_heard,
                "Something strikes once a period: faces away from the sensor, or a loose part.",
            ),
            Condition(
                self.sound_misfit <= self.settings.sound,
                f"The best sound model's misfit is {digits(self.sound_misfit, sound)}, where at "
                f"most {sound:g} describes a record.",
            ),
            Condition(
                self.hidden <= self.settings.hidden,
                f"Noise hides an order 2 of up to {digits(100.0 * self.hidden, most)} % of order "
                f"1, where at most {digits(most)} % may be hidden.",
                "The same sweep with less noise, or at a higher level.",
            ),
        ]

    @property
    def stops(self) -> list[Condition]:
        """Return the unmet conditions that stop a verdict: the record's, else the nearest one's."""
        nearest = (
            self.delaminated_conditions() if self.is_opening_seen else self.no_opening_conditions()
        )
        for conditions in (self.record_conditions(), nearest):
            broken = [one for one in conditions if not one.holds]
            if broken and self.verdict() in (UNDECIDED, NOT_DESCRIBED):
                return broken
        return []

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
    def is_difference_alone(self) -> bool:
        """Whether two faces move differently, as in two modes, and nothing else is seen."""
        return self.apart > 1.0 and not (self.excess > 1.0 or self.is_impact_heard)

    @property
    def deciding_ratio(self) -> float:
        """Return the ratio of misfits from which the delaminated model is taken to be better."""
        if self.is_difference_alone:
            return self.settings.ratio_difference
        return self.settings.ratio_apart if self.apart > 1.0 else self.settings.ratio

    @property
    def is_described(self) -> bool:
        """Whether a delaminated verdict's model is so much better that its numbers are stated."""
        return self.ratio >= self.settings.ratio

    def reason(self) -> str:
        """Return sentences that say by which numbers the verdict was decided, or stopped."""
        sentences = [
            f"Order 2 is up to {digits(100.0 * self.order2)} % of order 1, "
            f"{digits(self.excess, 1.0)} times the size from which it counts as seen."
        ]
        if self.sensors > 1:
            apart = f"{digits(self.apart, 1.0)} times the difference from which it counts as seen"
            sentences.append(f"The two faces differ by {apart}.")
        if math.isfinite(self.bursts):
            power = f"{digits(self.bursts, 1.0)} times the power from which they count as impacts"
            sentences.append(f"Bursts once a period have {power}.")
        misfit = f'The best sound model, "{self.sound}", has a misfit of {self.sound_misfit:.3g}'
        if self.is_opening_seen:
            other = f'the model "{self.delaminated}" has {self.delaminated_misfit:.3g}'
            enough = f"{self.deciding_ratio:g} times is enough to decide"
            ratio = digits(self.ratio, self.deciding_ratio)
            misfit += f", {other}: the first is {ratio} times the second, where {enough}"
        sentences.append(f"{misfit}.")
        stops = [one.otherwise for one in self.stops]
        return " ".join([*sentences, MISFIT_MEANING, *stops, *self.imperfection()])

    def imperfection(self) -> list[str]:
        """Return a sentence on a model that decides but describes the record poorly, if it does."""
        if self.verdict() != DELAMINATED or self.is_described:
            return []
        return [
            "What decides is that the faces move apart: two masses describe this structure only "
            "so well, and their numbers are not stated."
        ]

    def next_measurement(self) -> str:
        """Recommend, in a sentence, the measurement that would decide or confirm the verdict."""
        advice = [one.advice for one in self.stops if one.advice]
        other = "an accelerometer on the other face" if self.sensors == 1 else "a slower sweep"
        return {
            DELAMINATED: "A sweep in the other direction and another level should give the same "
            "frequencies of the halves; a free clamp or a loose part would not.",
            NOT_SEEN: "A sweep at a higher level: faces that are pressed together open above a "
            "threshold only, and below it no record tells them from bonded ones.",
            NOT_DESCRIBED: "Sweeps up and down at two levels after the clamp is tightened and "
            "loose parts are taken away: what is seen is neither a sound beam nor this one.",
            UNDECIDED: (advice or [f"Sweeps up and down at twice the level, with {other}."])[0],
        }[self.verdict()]

    def seen_up_to(self) -> str:
        """Describe the range that was measured, and the smallest opening detectable in it."""
        opening = f"{digits(1e6 * self.smallest)} \u00b5m"
        text = (
            f"up to {self.high:.3g} m/s\u00b2 from {self.first:.3g} to {self.last:.3g} Hz; "
            f"faces that touch and part by {opening} at the sensor would have been seen at every "
            "frequency; away from the sensor, or of faces that never touch, it may be larger"
        )
        if math.isnan(self.bursts):
            text += "; the record is sampled too slowly for the bursts of impacts"
        return text


def digits(value: float, limit: float = math.nan) -> str:
    """Format a number with two significant digits, or with as many as tell it from a limit.

    Examples
    --------
    >>> digits(0.1234), digits(113.0), digits(1.2004, limit=1.2), digits(1.3, limit=1.2)
    ('0.12', '110', '1.2004', '1.3')
    """
    rounded = (float(f"{value:.{count}g}") for count in range(2, 17))
    return f"{next((one for one in rounded if one != limit), value):.10g}"


def factor_outside(value: float, low: float, high: float) -> float:
    """Return by which factor a value lies below or above a range; at most 1 inside."""
    return max(value / high, low / value)


def resampled_share(sound: Floats, delaminated: Floats, ratio: float) -> float:
    """Return the share of block-bootstrap samples in which the ratio of misfits is exceeded."""
    one, other = (soft_squares(values).mean(axis=(0, 1)) for values in (sound, delaminated))
    blocks = np.array_split(np.arange(len(one)), min(20, len(one)))
    sums = np.array([[one[block].sum(), other[block].sum()] for block in blocks])
    rng = np.random.default_rng(7)
    chosen = rng.integers(0, len(sums), size=(RESAMPLED, len(sums)))
    first, second = sums[chosen].sum(axis=1).T
    return float(np.mean(np.sqrt(first / second) >= ratio))
