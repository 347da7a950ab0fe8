"""A mass at a wall, by the public functions: published facts with their source, or by hand."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import orchestrate
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
    lost = closing_speeds(SADDLE_NODE - 1e-3, 500)
    assert len(lost) > 600 and lost[-150:].max() < 0.6


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


pytestmark = pytest.mark.usefixtures("exported")
QUICK = {"progress": False, "jobs": 1}


def test_grazing_is_degenerate_at_even_fractions_of_the_natural_frequency():
    """At ``2 w_d/n`` curves of folds and period doublings leave that of grazing: Simpson and Ghosh,
    Resonant grazing bifurcations revisited, arXiv:2602.22797. The parameters are our own.
    """
    mass = Structure.one_mass(m=1.0, k=1.0, d=0.1, e=0.8, clearance=1.0)
    given = {"frequency": 0.9, "amplitude": 0.0, "force1": 0.65, **QUICK}
    start = orchestrate.orbit(mass, **given)
    along = orchestrate.branch(
        mass, start=start, over="force1", limits=(0.2, 0.7), longest=0.3, **QUICK
    )
    (grazing,) = np.flatnonzero(along.bifurcation_kind.values == 3)
    names, limits = ("force1", "frequency"), ((0.05, 1.0), (0.63, 1.03))
    given = {"over": names, "limits": limits, "longest": 0.2, **QUICK}
    curve = orchestrate.border(mass, start=along, bifurcation=int(grazing), **given)
    linear = np.hypot(1.0 - curve.frequency**2, 0.1 * curve.frequency)
    assert np.abs(curve.force1 - linear).max() < 1e-13
    found = np.sort(curve.codimension_two_frequency.values) / math.sqrt(1.0 - 0.05**2)
    assert found == pytest.approx([2 / 3, 2 / 3, 1.0, 1.0], rel=1e-12)


def test_symmetric_orbit_between_two_rigid_stops():
    """``x'' + 0.05 x' + x = sin(1.6 t)`` between stops at -0.5 and 0.5 with e = 0.8: half a period
    after an impact the mass is at the other stop, as fast. Own numbers: no source is known.
    """

    def other_end(unknowns):
        phase, speed = unknowns
        stop, settings = math.pi / 1.6, {"rtol": 1e-13, "atol": 1e-15}
        rates = lambda t, y: (y[1], math.sin(1.6 * t + phase) - 0.05 * y[1] - y[0])  # noqa: E731
        x, v = solve_ivp(rates, (0.0, stop), (-0.5, speed), "DOP853", **settings).y[:, -1]
        return x - 0.5, 0.8 * v - speed

    phase, speed = fsolve(other_end, (4.8, 0.7), xtol=1e-13)
    assert (phase, speed) == pytest.approx((4.830390589, 0.673311763), abs=1e-9)
    mass = Structure.one_mass(m=1.0, k=1.0, d=0.05, e=0.8, clearance=0.5, stroke=1.0)
    given = {"frequency": 1.6, "amplitude": 0.0, "force1": 1.0, **QUICK}
    found = orchestrate.orbit(mass, **given)
    assert found.node_kind.values.tolist() == [0, 3] and found.fmu_same_impacts and found.stable
    assert found.node_phase.values == pytest.approx([phase - math.pi, phase], abs=1e-9)
    assert 0.8 * found.impact_velocity.values == pytest.approx(speed, abs=1e-9)


def test_falling_ball_bounces_in_a_geometric_series():
    """Bounce n comes ``2 (1 - e^n)/(1 - e) - 1`` falling times after the start, e = 0.5."""
    ball = Structure.one_mass(m=2.0, k=1e-9, d=0.0, e=0.5, clearance=0.0, gamma=1e-9)
    start, fall = (-1.0, 0.0, 0.0, 0.0), math.sqrt(2.0 / 9.81)
    motion = simulate(
        ball,
        **{"frequency": 1.0, "amplitude": 0.0, "box_acceleration": -9.81, "start": start},
        **{"periods": 1, "points": 400, "progress": False},
    )
    times, n = motion.impact_time.values / fall, np.arange(1, 11)
    assert times[:10] == pytest.approx(4.0 * (1.0 - 0.5**n) - 1.0, rel=1e-9)
    assert times[-1] == pytest.approx(3.0, rel=1e-4) and bool(motion.sticks[-1])
    speeds = motion.impact_velocity.values[:10] / (9.81 * fall)
    assert speeds == pytest.approx(0.5 ** (n - 1), rel=1e-9)
    later = motion.time.values > 3.001 * fall
    assert motion.in_contact.values[later].all() and not motion.x1.values[later].any()
