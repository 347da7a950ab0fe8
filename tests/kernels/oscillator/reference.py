"""Whole trajectories without the kernel: event by event in high precision, and by an ODE solver
with event location.

Flights begin and end as in the corrected (12)-(20), in SI units; the masses stick where the
flights that are left last less than ``gamma`` over the faster half's frequency.
"""

import mpmath as mp

from tests import exact_motion as truth

FLIGHT, CONTACT = "flight", "contact"


def collide(values, v1, v2):
    """Newton's restitution."""
    m1, m2, e = values["m1"], values["m2"], values["e"]
    common = (m1 * v1 + m2 * v2) / (m1 + m2)
    return common - e * m2 / (m1 + m2) * (v1 - v2), common + e * m1 / (m1 + m2) * (v1 - v2)


def opening(values, x, v, phase):
    """Acceleration with which the gap would open with both masses at ``x`` and velocity ``v``."""
    driven = (truth.felt(values, phase, 1) - truth.felt(values, phase, 2))(0)
    return driven + (
        (values["k1"] * x + values["d1"] * v) / values["m1"]
        - (values["k2"] * x + values["d2"] * v) / values["m2"]
    )


def event_by_event(values, state, stop):
    """Events in high precision from a flight, and the state at ``stop``: x1, v1, x2, v2.

    Events are (time, kind): "impact", "stick", "release".
    """
    fastest = mp.sqrt(max(mp.mpf(values[f"k{i}"]) / values[f"m{i}"] for i in "12"))
    left = mp.mpf(values["gamma"]) * (1 - mp.mpf(values["e"])) / fastest
    time, mode, events, blind = mp.mpf(0), FLIGHT, [], 0.0
    while True:
        phase = mp.mpf(values.get("phase_start", 0.0)) + values["box_frequency"] * time
        if mode == FLIGHT:
            first, second = truth.free_motion(values, state, phase)
            event = second - first
        else:
            first, event = truth.contact_motion(values, state[0], state[1], phase)
            second = first
        end = truth.first_root(event, float(stop - time), blind)
        age = stop - time if end is None else end
        state = first(age), first.derivative()(age), second(age), second.derivative()(age)
        if end is None:
            return events, state
        time, blind = time + end, 0.0
        x, v1, v2 = state[0], state[1], state[3]
        if mode == CONTACT:
            # the gap opens with the third power of time: below rounding at first
            mode, blind = FLIGHT, 1e-3
            events.append((time, "release"))
            continue
        w1, w2 = collide(values, v1, v2)
        total = mp.mpf(values["m1"]) + values["m2"]
        phase += values["box_frequency"] * end
        pull = opening(values, x, w1 + (w2 - w1) * mp.mpf(values["m2"]) / total, phase)
        if pull < 0 and 2 * (w2 - w1) < left * -pull:
            w1 = w2 = collide({**values, "e": 0}, v1, v2)[0]
            mode = CONTACT
        events.append((time, "stick" if mode == CONTACT else "impact"))
        state = x, w1, x, w2
