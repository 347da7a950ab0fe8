"""Initialise an oscillator FMU with structure, excitation and start; sample its states."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..model import Excitation, Structure
from .impacts import STATE
from .instance import Instance

REST = (0.0, 0.0, 0.0, 0.0)
TOUCHING = 2.0**-50  # relative: a gap that is no more than the rounding of displacements
START_PARAMETERS = tuple(f"{name}_start" for name in STATE)
SAMPLE_SERIES = tuple(f"{name}_sample" for name in STATE)


def begin(
    instance: Instance,
    structure: Structure,
    excitation: Excitation,
    start: ArrayLike = REST,
    **values: float,
) -> None:
    """Reset an oscillator FMU; initialise it at time 0 by structure, excitation and start state."""
    start_state = to_rest(structure, four_numbers(start))
    state = dict(zip(START_PARAMETERS, start_state, strict=True))
    start_values = {**structure.parameters(), **state, **excitation.inputs(), "x_rel_max_on": False}
    instance.reset()
    instance.initialize(**{**start_values, **values})
    if instance.EVENTS:
        enter = instance.cache.get("enterStepMode") or instance.prepared("fmi3EnterStepMode")
        instance.cache["enterStepMode"] = enter
        enter()


def to_rest(structure: Structure, state: list[float]) -> list[float]:
    """Convert a start state from unloaded springs to the FMU's, from rest; all zeros mean rest."""
    if structure.gap_offset >= 0.0 or not any(state):
        return state
    (x1, x2, *velocities), (rest_1, rest_2) = state, structure.at_rest
    touching = float(gap_between(np.array(state), structure.gap_offset)) == 0.0
    return [x1 - rest_1, x1 - rest_1 if touching else x2 - rest_2, *velocities]


def gap_between(states: NDArray[np.float64], gap_offset: ArrayLike = 0.0) -> NDArray[np.float64]:
    """Return the gap x2 - x1 + offset of states (..., 4); rounding beside an offset is 0."""
    x1, x2 = states[..., 0], states[..., 1]
    gap: NDArray[np.float64] = x2 - x1
    if not np.any(gap_offset):
        return gap
    offset = np.asarray(gap_offset, dtype=float)
    gap = gap + offset
    size = np.abs(x1) + np.abs(x2) + np.abs(offset)
    return np.where((np.abs(gap) <= TOUCHING * size) & (offset != 0.0), 0.0, gap)


def four_numbers(start: ArrayLike) -> list[float]:
    """Return a start state as a list of floats x1, x2, v1, v2; raise unless it is four."""
    try:
        state = np.asarray(start, dtype=float)
    except (TypeError, ValueError):
        state = np.empty(0)
    if state.shape != (len(START_PARAMETERS),):
        raise InputError(f"start = {start!r}: expected 4 numbers, x1, x2, v1, v2")
    numbers: list[float] = state.tolist()
    return numbers


def sampled(instance: Instance, time: float, target: float, count: int) -> NDArray[np.float64]:
    """Step an FMU from ``time`` to ``target``; return ``count`` equidistant states (count, 4)."""
    step_capacity = samples_per_step(instance)
    states, width = np.empty((count, len(SAMPLE_SERIES))), (target - time) / count
    for done in range(0, count, step_capacity):
        size = min(step_capacity, count - done)
        instance.set(sample_count=size)
        instance.step(time + done * width, time + (done + size) * width)
        states[done : done + size] = last_samples(instance, size)
    return states


def samples_per_step(instance: Instance) -> int:
    """Return how many states the FMU can record inside one communication step."""
    return instance.size(*SAMPLE_SERIES) // len(SAMPLE_SERIES)


def last_samples(instance: Instance, count: int) -> NDArray[np.float64]:
    """Return the states recorded in the last step, shape (count, 4), valid until the next."""
    return instance.read(*SAMPLE_SERIES).reshape(len(SAMPLE_SERIES), -1)[:, :count].T
