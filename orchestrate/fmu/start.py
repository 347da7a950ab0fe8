"""Initialise an oscillator FMU with structure, excitation and start; gaps of states."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import NOT_NUMBERS, InputError
from ..model import Excitation, Structure
from .instance import Instance
from .oscillator import START_PARAMETERS, relative_to_rest, respond_library

REST = (0.0, 0.0, 0.0, 0.0)


def start_motion(
    instance: Instance,
    structure: Structure,
    excitation: Excitation,
    start: ArrayLike = REST,
    **values: float,
) -> None:
    """Reset an oscillator FMU; initialise it at time 0 by structure, excitation and start state."""
    start_state = relative_to_rest(structure, checked_four_numbers(start))
    state = dict(zip(START_PARAMETERS, start_state, strict=True))
    start_values = {**structure.parameters(), **state, **excitation.inputs(), "x_rel_max_on": False}
    instance.reset()
    instance.initialize(**{**start_values, **values})


def gaps_of_states(states: NDArray[np.float64], gap_offset: ArrayLike = 0.0) -> NDArray[np.float64]:
    """Return the gap x2 - x1 + offset of states (..., 4); rounding at an offset is 0."""
    rows, offsets = (np.ascontiguousarray(part, dtype=float) for part in (states, gap_offset))
    gaps = np.empty(rows.shape[:-1])
    addresses = rows.ctypes.data, gaps.size, offsets.ctypes.data, offsets.size == 1
    respond_library().find_gaps(*addresses, gaps.ctypes.data)
    return gaps


def checked_four_numbers(start: ArrayLike) -> list[float]:
    """Return a start state as a list; raise unless it is four numbers."""
    try:
        state = np.asarray(start, dtype=float)
    except NOT_NUMBERS:
        state = np.empty(0)
    if state.shape != (len(START_PARAMETERS),):
        raise InputError(f"start = {start!r}: expected 4 numbers, x1, x2, v1, v2")
    numbers: list[float] = state.tolist()
    return numbers
