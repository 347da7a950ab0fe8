"""A motion under a box acceleration that is given as cubics, impact by impact.

Each cubic is set where it begins and runs on, so the motion does not depend on where it is read.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .channel import Channel
from .events import EVENT_OUTPUTS, EventInstance, Impacts

CUBIC = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
PLAYED = ("x1", "x2", "v1", "v2", "x_rel", "v_rel", "contact_force")


class Played(NamedTuple):
    """Sampled motion and impacts that :func:`play` returns.

    Attributes
    ----------
    rows : ndarray, shape (n, 7)
        In the order of ``PLAYED``.
    touching : ndarray of bool, shape (n,)
        Whether the masses were in permanent contact.
    impacts : Impacts
    """

    rows: NDArray[np.float64]
    touching: NDArray[np.bool_]
    impacts: Impacts


def play(
    instance: EventInstance,
    nodes: NDArray[np.float64],
    derivatives: NDArray[np.float64],
    samples: NDArray[np.float64],
) -> Played:
    """Compute the motion under a box acceleration given as consecutive cubics.

    Parameters
    ----------
    instance : EventInstance
        At the first node.
    nodes : ndarray, shape (n + 1,)
        Where the cubics begin and where the last one ends, s.
    derivatives : ndarray, shape (n, 4)
        Of each at its beginning, m/s2 to m/s5.
    samples : ndarray
        When the motion is read: from the first node to the last, ascending, s.
    """
    channel = Channel(instance, CUBIC, PLAYED)
    events = Channel(instance, (), EVENT_OUTPUTS)
    step, handle, touch = instance.stepper(), instance.event_handler(), instance.flag("in_contact")
    rows, touching = np.empty((len(samples), len(PLAYED))), np.empty(len(samples), dtype=bool)
    times: list[float] = []
    after: list[list[float]] = []
    sticks: list[bool] = []

    def advance(time: float, target: float) -> float:
        while time < target:
            event, time = step(time, target - time)
            if event:
                times.append(time)
                after.append(events.get())
                sticks.append(touch())
                handle()
        return time

    def read(index: int) -> None:
        rows[index], touching[index] = channel.get(), touch()

    time, done = float(nodes[0]), 0
    ends = np.searchsorted(samples, nodes[1:], side="left").tolist()
    for cubic, target, last in zip(derivatives.tolist(), nodes[1:].tolist(), ends, strict=True):
        channel.put(*cubic)
        for index in range(done, last):
            time = advance(time, float(samples[index]))
            read(index)
        time, done = advance(time, target), last
    for index in range(done, len(samples)):  # at the last node
        read(index)
    channel.close()
    table = np.array(after).reshape(-1, len(EVENT_OUTPUTS))
    contacts = np.array(sticks, dtype=bool)
    impacts = Impacts(np.array(times), table[:, :4], table[:, 4], contacts)
    return Played(rows, touching, impacts)
