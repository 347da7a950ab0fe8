"""Sampled time and phase curves of a motion, with the states just before and after each impact."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..access import STATE, EventInstance, Impacts, Instance, begin, sampled
from .equations import in_touch
from .questions import Point

FLIGHT, SEQUENCE, CONTACT = 0, 1, 2  # the three states of Figure 5
KINDS = {FLIGHT: "separate motion", SEQUENCE: "sequence of impacts", CONTACT: "permanent contact"}


class SampledCurve(NamedTuple):
    """A sampled motion with its jumps: times, states, kind; two points at an impact."""

    tau: NDArray[np.float64]  # time in units of 1/omega
    state: NDArray[np.float64]  # xi_1, xi_2, xi_1', xi_2'
    kind: NDArray[np.int8]  # of `KINDS`


def simulate_curve(
    fmu: Path,
    point: Point,
    start: ArrayLike,
    transient: int,
    periods: int,
    points: int,
) -> SampledCurve:
    """Simulate a motion after a transient; return samples and both sides of its impacts."""
    span = point.excitation.period
    first, last = transient * span, (transient + periods) * span
    with EventInstance(fmu) as instance:
        begin(instance, *point, start)
        instance.advance(0.0, first)
        impacts = instance.impacts(first, last)
    with Instance(fmu) as instance:
        begin(instance, *point, start)
        if transient:
            instance.step(0.0, first)
        end_state = np.array([instance.get(*STATE)])
        states = np.concatenate([end_state, sampled(instance, first, last, periods * points)])
    return merge_by_time(np.linspace(first, last, len(states)), states, impacts, point)


def merge_by_time(
    grid: NDArray[np.float64], states: NDArray[np.float64], impacts: Impacts, point: Point
) -> SampledCurve:
    """Merge samples and the states just before and after impacts into one curve, by time."""
    count = len(impacts.time)
    time = np.concatenate([grid, impacts.time, impacts.time])
    rank = np.repeat([0, 1, 2], [len(grid), count, count])
    order = np.lexsort((rank, time))
    pieces = [states, impacts.before(point.structure), impacts.state]
    state, time = np.concatenate(pieces)[order], time[order]
    kind = classify_points(time, state, impacts, point.structure.gap_offset)
    omega = point.structure.omega
    return SampledCurve(omega * time - omega * grid[0], state / point.scale, kind)


def classify_points(
    time: NDArray[np.float64], state: NDArray[np.float64], impacts: Impacts, gap_offset: float = 0.0
) -> NDArray[np.int8]:
    """Classify each point as flight, chattering or permanent contact (states of Figure 5).

    A sequence of impacts is what leads to permanent contact: flights each shorter than the one
    before it.
    """
    kind = np.full(len(time), FLIGHT, dtype=np.int8)
    flights = np.diff(impacts.time)
    for stick in np.flatnonzero(impacts.sticks).tolist():
        first = stick
        while first > 1 and flights[first - 1] < flights[first - 2]:
            if impacts.sticks[first - 1]:
                break
            first -= 1
        begins = impacts.time[max(first - 1, 0)]
        kind[(time >= begins) & (time <= impacts.time[stick])] = SEQUENCE
    kind[in_touch(state, gap_offset)] = CONTACT
    return kind
