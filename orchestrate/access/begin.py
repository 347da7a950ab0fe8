"""How a motion of the oscillator begins, and its states at equal times."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..structures import Excitation, Structure
from .events import STATE
from .instance import Instance

REST = (0.0, 0.0, 0.0, 0.0)
STARTS = tuple(f"{name}_start" for name in STATE)
SERIES = tuple(f"{name}_sample" for name in STATE)


def begin(
    instance: Instance,
    structure: Structure,
    excitation: Excitation,
    start: ArrayLike = REST,
    **values: float,
) -> None:
    """Reset an instance of ``TwoMassImpactOscillator`` and initialise it at time 0.

    Parameters
    ----------
    instance : Instance
    structure : Structure
    excitation : Excitation
    start : array-like of 4 floats
        x1, x2 in m, v1, v2 in m/s.
    **values
        Further start values and inputs, by the FMU's names. ``x_rel_max`` is off unless asked for
        here (``x_rel_max_on=True``).

    Raises
    ------
    InputError
        Where ``start`` has another length, or the FMU lacks a variable.
    FmuError
        Where the FMU refuses a value; masses that overlap among them.
    """
    state = dict(zip(STARTS, four_numbers(start), strict=True))
    given = {**structure.parameters(), **state, **excitation.inputs(), "x_rel_max_on": False}
    instance.reset()
    instance.initialize(**{**given, **values})
    if instance.EVENTS:
        instance.call("enterStepMode")


def four_numbers(start: ArrayLike) -> list[float]:
    """A start as plain floats."""
    try:
        state = np.asarray(start, dtype=float)
    except (TypeError, ValueError):
        state = np.empty(0)
    if state.shape != (len(STARTS),):
        raise InputError(f"start = {start!r}: expected 4 numbers, x1, x2, v1, v2")
    found: list[float] = state.tolist()
    return found


def sampled(instance: Instance, time: float, target: float, count: int) -> NDArray[np.float64]:
    """States at ``count`` equal parts of a span, the last at its end, taken inside few steps.

    Parameters
    ----------
    instance : Instance
        At ``time``.
    time, target : float
        s.
    count : int

    Returns
    -------
    ndarray, shape (count, 4)
        x1, x2 in m, v1, v2 in m/s.
    """
    room = room_for_samples(instance)
    states, width = np.empty((count, len(SERIES))), (target - time) / count
    for done in range(0, count, room):
        size = min(room, count - done)
        instance.set(sample_count=size)
        instance.step(time + done * width, time + (done + size) * width)
        states[done : done + size] = last_samples(instance, size)
    return states


def room_for_samples(instance: Instance) -> int:
    """States that an instance keeps of a step."""
    return instance.size(*SERIES) // len(SERIES)


def last_samples(instance: Instance, count: int) -> NDArray[np.float64]:
    """The states of the last step, shape (count, 4), valid until the next call."""
    return instance.read(*SERIES).reshape(len(SERIES), -1)[:, :count].T
