"""A mass at a wall, by the public functions: published facts with their source, or by hand."""

import math

import numpy as np
import pytest

from orchestrate import Structure, simulate

# Luck and Mehta, Bouncing ball with a finite restitution: chattering, locking, and chaos, Phys.
# Rev. E 48 (1993) 3988: the peak acceleration over gravity at which a ball on a vibrating table,
# with e = 0.5, has its orbit of one impact a period, and at which that doubles its period; by hand
# pi (1 - e)/(1 + e), and the root of that squared and 4 (1 + e^2)^2/(1 + e)^4
SADDLE_NODE, PERIOD_DOUBLING = 1.0471976, 1.5268237
assert abs(SADDLE_NODE - math.pi / 3.0) < 5e-8
assert abs(PERIOD_DOUBLING - math.hypot(math.pi / 3.0, 2.0 * 1.25 / 2.25)) < 5e-8


def closing_speeds(acceleration, periods, e=0.5):
    """Closing speeds, over g T, of a ball that starts on the orbit of one impact a period."""
    frequency = 2.0 * math.pi
    ball = Structure.one_mass(m=1.0, k=1e-6, d=0.0, e=e, clearance=0.0, gamma=1e-6)
    phase = math.acos(min(SADDLE_NODE / acceleration, 1.0))  # of the table, which rises there
    motion = simulate(
        ball,
        frequency=frequency,
        amplitude=acceleration / frequency**2,
        box_acceleration=-1.0,
        phase=phase - math.pi,
        start=(0.0, 0.0, -e / (1.0 + e) * (1.0 + 1e-6), 0.0),
        periods=periods,
        points=4,
        progress=False,
    )
    return motion.impact_velocity.values


def test_ball_on_a_table_has_its_orbit_from_the_saddle_node_on():
    on = closing_speeds(SADDLE_NODE + 1e-4, 300)
    assert len(on) in (299, 300, 301) and on[-50:] == pytest.approx(1.0 / 1.5, rel=1e-3)
    lost = closing_speeds(SADDLE_NODE - 1e-3, 1000)
    assert len(lost) > 1500 and lost[-300:].max() < 0.6


def test_ball_on_a_table_doubles_its_period_where_published():
    steady = closing_speeds(PERIOD_DOUBLING - 1e-3, 3000)[-100:]
    doubled = closing_speeds(PERIOD_DOUBLING + 1e-3, 3000)[-100:]
    assert np.ptp(steady) < 1e-4 and steady == pytest.approx(1.0 / 1.5, rel=1e-4)
    assert np.ptp(doubled) > 5e-3
    assert np.ptp(doubled[::2]) < 1e-4 > np.ptp(doubled[1::2])


@pytest.mark.parametrize(("times", "growth"), [(2, 4.0 / 3.0), (4, 8.0 / 15.0)])
def test_elastic_mass_at_a_wall_resonates_at_even_multiples(times, growth):
    """Each impact adds the same speed: 4F/3 and 8F/15 for m = k = 1.

    By hand: ``x'' + x = F sin(n t)`` from x = 0 is again at x = 0 after half a period, faster by
    ``2 n F/(n^2 - 1)``, and n is even, so the force begins anew.
    """
    mass, force, speed = Structure.one_mass(m=1.0, k=1.0, d=0.0, e=1.0, clearance=0.0), 0.01, 0.3
    motion = simulate(
        mass,
        **{"frequency": float(times), "amplitude": 0.0, "force1": -force},
        start=(0.0, 0.0, -speed, 0.0),
        **{"periods": 20 * times, "points": 4, "progress": False},
    )
    count = np.arange(1, 31)
    assert motion.impact_velocity.values[:30] == pytest.approx(speed + growth * force * count)
    assert motion.impact_time.values[:30] == pytest.approx(math.pi * count, rel=1e-9)
