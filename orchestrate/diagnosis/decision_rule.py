"""The rule by which the records of a beam become a verdict, and the words for it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

from .impact_timing import FACES, NOTHING, SOFTER, STOP, Strikes
from .settings import SETTINGS, Settings

DELAMINATED = "delaminated"
NOT_SEEN = "no opening seen"
NOT_DESCRIBED = "not described"
UNDECIDED = "undecided"


@dataclass(frozen=True)
class Condition:
    """Hold whether a condition of a verdict is fulfilled, and what to say where it is not."""

    holds: bool
    reason: str  # a sentence: what stops the verdict
    advice: str = ""  # the measurement that would settle it, where that is not the usual one


@dataclass(frozen=True)
class Findings:
    """Hold what one record shows."""

    # order 2 over its detection threshold, the largest of all windows; above 1 it is seen
    excess: float
    order2: float  # its size there, over order 1
    # difference of two sensors over its detection threshold; 0 with one sensor, or where two modes
    # of a sound beam describe it
    apart: float
    strikes: Strikes
    sensors: int
    # level of the base, m/s2
    low: float
    high: float
    # frequencies, Hz
    first: float
    last: float
    smallest: float  # smallest opening at the sensor that would be seen at every frequency, m
    hidden: float  # largest order 2 that would not have been seen, over order 1
    clipped: float  # share of samples at repeated extreme values, of the channel that has most
    # response at an end of the sweep over the largest one, the larger of both ends
    end_response: float
    resonance: float  # frequency of that largest one, Hz
    guessed: tuple[float, float]  # lower and higher frequency of the guess's halves, Hz
    whose: str = "the guess's"  # these frequencies
    samples: float = math.inf  # in a period at the resonance
    settings: Settings = SETTINGS

    def usability_conditions(self) -> list[Condition]:
        """Return the conditions under which a record decides anything."""
        factor = factor_outside_range(self.resonance, *self.guessed)
        low, high = self.guessed
        most = 100.0 * self.settings.end_response
        away = f"a factor of {factor:.3g} from {self.whose} {low:.3g} to {high:.3g} Hz"
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
                self.samples >= self.settings.samples,
                f"The record has {digits(self.samples, self.settings.samples)} samples in a period "
                f"of {self.resonance:.3g} Hz, too few to tell what strikes.",
                f"The same sweep with {25.6 * self.resonance:.3g} samples a second or more.",
            ),
            Condition(
                factor <= self.settings.guess_factor,
                f"The response is largest at {self.resonance:.3g} Hz, {away}.",
                "A tighter clamp, or a guess of this beam; are the times of the record in s?",
            ),
        ]

    def no_opening_conditions(self) -> list[Condition]:
        most, heard = 100.0 * self.settings.hidden, self.strikes.what_strikes()
        alone = " Two modes of a sound beam do not describe how the sensors differ."
        return [
            Condition(
                self.excess <= 1.0 and self.apart <= 1.0,
                f"Something is seen to open.{alone if self.excess <= 1.0 else ''}",
                "Sensors exactly opposite each other, on the beam's axis, and a higher level."
                if self.excess <= 1.0
                else "",
            ),
            Condition(heard == NOTHING, f"Something strikes, by its timing: {heard}."),
            Condition(
                self.hidden <= self.settings.hidden,
                f"Noise hides an order 2 of up to {digits(100.0 * self.hidden, most)} % of order "
                f"1, where at most {digits(most)} % may be hidden.",
                "The same sweep with less noise, or at a higher level.",
            ),
        ]

    def violated_conditions(self) -> list[Condition]:
        """Return what keeps the record from being usable; if nothing, from showing no opening."""
        for conditions in (self.usability_conditions(), self.no_opening_conditions()):
            if broken := [one for one in conditions if not one.holds]:
                return broken
        return []

    @property
    def is_usable(self) -> bool:
        """Whether the record decides anything."""
        return all(one.holds for one in self.usability_conditions())

    def describe(self, strike: str) -> str:
        """Return a sentence with the numbers of the record and what strikes in it."""
        text = (
            f"At {self.high:.3g} m/s\u00b2 order 2 is up to {digits(100.0 * self.order2)} % of "
            f"order 1, {digits(self.excess, 1.0)} times the size from which it counts as seen"
        )
        if self.sensors > 1:
            text += f"; the two faces differ by {digits(self.apart, 1.0)} times what counts as seen"
        return f"{text}; {strike} ({self.strikes.format_quantities()})."


@dataclass(frozen=True)
class Beam:
    """Hold what all records of one beam show."""

    records: tuple[Findings, ...]

    def verdict(self) -> str:
        """Apply the rule and return one of the four verdicts.

        - "undecided" without a usable record: one whose channels are not saturated (`clipped`),
          whose sweep passes the resonance (`end_response`), which is the guess's (`guess_factor`),
          with `samples` in its period.
        - "delaminated": in a usable record faces strike (:meth:`.Strikes.what_strikes`; with one
          sensor by a guess or two levels, `doubled`); "undecided" if another one, of no lower level
          (`same_level`), contradicts.
        - "no opening seen": in all of them nothing is heard, order 2 and the difference of the
          faces are below their thresholds, and noise hides no order 2 of `hidden`.
        - "not described": the base strikes, or what is heard is not locked to the stroke, or kinks,
          and no stop or softer face strikes.
        - "undecided": all else. :meth:`reason` says what strikes, :meth:`next_measurement` how to
          tell a stop from a softer face.
        """
        if FACES in self.words:
            return UNDECIDED if self.contradicting else DELAMINATED
        if self.usable and not any(one.violated_conditions() for one in self.usable):
            return NOT_SEEN
        is_other = self.words & {"base strikes", "not locked", "kinks"}
        return NOT_DESCRIBED if is_other and not self.may_be_a_stop else UNDECIDED

    @property
    def may_be_a_stop(self) -> bool:
        """Whether something strikes that is a stop or a softer face, and no faces do."""
        return FACES not in self.words and bool(self.words & {STOP, SOFTER})

    @cached_property
    def words(self) -> set[str]:
        """What strikes in the usable records."""
        return {self.strike_words[one] for one in self.usable}

    @cached_property
    def usable(self) -> list[Findings]:
        """Usable records, the highest level first."""
        usable = [one for one in self.records if one.is_usable]
        return sorted(usable, key=lambda one: -one.high)

    @cached_property
    def strike_words(self) -> dict[Findings, str]:
        """What strikes in each record, with what all records say of the stiffness."""
        known = {"stiffness": 1.0} if self.has_two_levels else {}
        words = {}
        for one in self.records:
            changes = known if math.isnan(one.strikes.stiffness) else {}
            words[one] = replace(one.strikes, **changes).what_strikes()
        return words

    @property
    def has_two_levels(self) -> bool:
        """Whether the usable records are of two levels, which stand for an unknown frequency."""
        levels = [one.high for one in self.usable]
        return bool(levels) and levels[0] >= self.usable[0].settings.doubled * levels[-1]

    @cached_property
    def opening_level(self) -> float:
        """Lowest level of the base at which faces strike, m/s2; NaN where none do."""
        levels = [one.high for one in self.usable if self.strike_words[one] == FACES]
        return min(levels, default=math.nan)

    @cached_property
    def contradicting(self) -> list[Findings]:
        """Records of no lower level than the one at which faces strike that show otherwise."""
        level = self.opening_level  # NaN: none
        return [
            one
            for one in self.usable
            if one.high >= one.settings.same_level * level
            and self.strike_words[one] not in (FACES, SOFTER)
        ]

    def violated_conditions(self) -> list[Condition]:
        """Return what keeps the beam from a verdict, empty of one that is decided."""
        if self.verdict() not in (UNDECIDED, NOT_DESCRIBED):
            return []
        if self.contradicting:
            words = ", ".join(sorted({self.strike_words[one] for one in self.contradicting}))
            text = f"Faces strike in one record, another of no lower level contradicts: {words}."
            return [Condition(False, text)]
        return [stop for one in self.usable or self.records for stop in one.violated_conditions()]

    def reason(self) -> str:
        """Return sentences that say by which numbers the verdict was decided, or stopped."""
        sentences = [one.describe(self.strike_words[one]) for one in self.records]
        if len(self.records) > 1 and self.verdict() == DELAMINATED:
            sentences.append(f"Faces strike from {self.opening_level:.3g} m/s\u00b2 on.")
        return " ".join(
            dict.fromkeys([*sentences, *(one.reason for one in self.violated_conditions())])
        )

    def next_measurement(self) -> str:
        """Recommend, in a sentence, the measurement that would decide or confirm the verdict."""
        advice = [one.advice for one in self.violated_conditions() if one.advice]
        one_sensor = all(one.sensors == 1 for one in self.records)
        other = "an accelerometer on the other face" if one_sensor else "a slower sweep"
        second = "" if self.has_two_levels else ", or another sweep at twice the level"
        if self.may_be_a_stop and not one_sensor:
            return "Sensors nearer to where it may be open: faces between them strike both ways."
        if self.may_be_a_stop:
            return (
                f"The same sweep with {other}, exactly opposite{second}: blows of two faces are "
                "opposite, those of a stop are equal."
            )
        return {
            DELAMINATED: "A sweep in the other direction and another level should give the same "
            "frequencies of the halves; a free clamp or a loose part would not.",
            NOT_SEEN: "A sweep at a higher level: faces that are pressed together open above a "
            "threshold only, and below it no record tells them from bonded ones.",
            NOT_DESCRIBED: "Sweeps up and down at two levels after the clamp is tightened and "
            "loose parts are taken away: what is seen is neither a sound beam nor this one.",
            UNDECIDED: (advice or [f"Sweeps up and down at twice the level, with {other}."])[0],
        }[self.verdict()]


def digits(value: float, limit: float = math.nan) -> str:
    """Format a number with two significant digits, or with as many as tell it from a limit.

    Examples
    --------
    >>> digits(0.1234), digits(113.0), digits(1.2004, limit=1.2), digits(1.3, limit=1.2)
    ('0.12', '110', '1.2004', '1.3')
    """
    rounded = (float(f"{value:.{count}g}") for count in range(2, 17))
    return f"{next((one for one in rounded if one != limit), value):.10g}"


def factor_outside_range(value: float, low: float, high: float) -> float:
    """Return the factor by which a value lies below or above a range; at most 1 inside."""
    return max(value / high, low / value)
