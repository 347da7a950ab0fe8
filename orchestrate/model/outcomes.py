"""What a motion has been found to be: one list of outcomes, for all answers."""

from __future__ import annotations

from enum import IntEnum


class Outcome(IntEnum):
    """How a motion's period was decided; the numbers are those of CF flags in datasets.

    - *repeated*: states n periods apart agree, and their deviation has died or dies.
    - *orbit*: Newton's method confirms it by a stable orbit that the FMU runs through.
    - *irregular*: no number of periods repeats, or its states drift: chaos, a torus, a transient.
    - *undecided*: all else, such as a sweep's states that nearly repeat, or near an unstable orbit.
    - *absent*: there is no such motion at this value, or no motion from this start.
    """

    IRREGULAR = 0
    REPEATED = 1
    UNDECIDED = 2
    ORBIT = 3
    ABSENT = 4


IRREGULAR, REPEATED, UNDECIDED, ORBIT, ABSENT = Outcome
WORDS: dict[int, str] = {outcome: outcome.name.lower() for outcome in Outcome}
