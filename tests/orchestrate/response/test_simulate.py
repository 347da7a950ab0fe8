"""Motions in time against SciPy's integrator, momentum, and Newton's law of each mass."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orchestrate.errors import InputError
from orchestrate.model import Structure
from orchestrate.response.simulate import simulate

PAPER = Structure.nondimensional()
OWN = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=2.9, e=0.6)
STRONG = Structure.nondimensional(D1=0.3, D2=1.2, mu=0.4, kappa=2.0, e=0.5)
BOX = {"frequency": 130.0, "amplitude": 1e-3}
START = (-1e-3, 2e-3, 0.05, -0.1)

pytestmark = pytest.mark.usefixtures("exported")


def right_side(structure, box, phase, bonded):
    """Newton's law of each mass relative to the box, or of both as one."""
    s, (a, speed) = structure, (box["amplitude"], box["frequency"])

    def field(t, y):
        drive = a * speed**2 * np.sin(speed * t + phase)
        a1 = drive - (s.k1 * y[0] + s.d1 * y[2]) / s.m1
        a2 = drive - (s.k2 * y[1] + s.d2 * y[3]) / s.m2
        if bonded:
            a1 = a2 = (s.m1 * a1 + s.m2 * a2) / (s.m1 + s.m2)
        return [y[2], y[3], a1, a2]

    return field


def integrated(structure, box, phase, times, start):
    """States at ``times`` and impact times, by an integrator that knows events."""
    field = right_side(structure, box, phase, structure.bonded)

    def gap(t, y):
        return y[1] - y[0]

    gap.terminal, gap.direction = True, -1.0
    events = None if structure.bonded else gap
    states, impacts, time, state = [], [], times[0], np.array(start)
    while time < times[-1]:
        found = solve_ivp(
            field,
            (time, times[-1]),
            state,
            method="DOP853",
            events=events,
            rtol=1e-12,
            atol=1e-15,
            dense_output=True,
        )
        inside = times[(times >= time) & (times <= found.t[-1])]
        twice = bool(states) and len(inside) > 0 and inside[0] == time
        states.append(found.sol(inside)[:, int(twice) :])
        time, state = found.t[-1], found.y[:, -1]
        if found.status == 1:
            impacts.append(time)
            impulse = (1 + structure.e) * (state[2] - state[3])
            impulse *= structure.m1 * structure.m2 / (structure.m1 + structure.m2)
            state[2] -= impulse / structure.m1
            state[3] += impulse / structure.m2
            state[0] = state[1] = state[:2].mean()
    return np.hstack(states), np.array(impacts)


@pytest.mark.parametrize("phase", [0.0, 2.0])
@pytest.mark.parametrize("structure", [OWN, OWN.as_bonded(), OWN.replace(d1=200.0, e=0.9)])
def test_against_an_integrator_with_events(structure, phase):
    start = (1e-3, 1e-3, -0.1, -0.1) if structure.bonded else START
    motion = simulate(structure, **BOX, periods=4, points=50, start=start, phase=phase)
    states, impacts = integrated(structure, BOX, phase, motion.time.values, start)
    found = np.array([motion[name].values for name in ("x1", "x2", "v1", "v2")])
    np.testing.assert_allclose(found, states, atol=1e-8 * np.abs(states).max())
    np.testing.assert_allclose(motion.impact_time, impacts, rtol=1e-9)
    assert len(impacts) == 0 if structure.bonded else len(impacts) >= 2


@pytest.mark.parametrize("structure", [PAPER, OWN, STRONG, OWN.as_bonded()])
@pytest.mark.parametrize("eta", [0.4, 0.9])
def test_newtons_law_of_each_mass_with_the_contact_force(structure, eta):
    m = simulate(structure, eta=eta, transient=30, periods=2, points=1000)
    np.testing.assert_allclose(m.a1_abs, m.a1 + m.box_acceleration, rtol=1e-12, atol=1e-9)
    np.testing.assert_array_equal(m.x_rel, m.x2 - m.x1)
    force = np.where(m.in_contact, m.contact_force, 0.0)
    left = structure.m1 * m.a1_abs + structure.k1 * m.x1 + structure.d1 * m.v1 + force
    right = structure.m2 * m.a2_abs + structure.k2 * m.x2 + structure.d2 * m.v2 - force
    size = 1e-12 * float(structure.k2 * np.abs(m.x2).max())
    if structure.bonded:  # glued, the masses may pull each other as well
        left, right = left + right, 0.0 * right
    assert np.abs(left).max() < size
    assert np.abs(right).max() < size


@pytest.mark.parametrize("structure", [PAPER, OWN, STRONG])
def test_momentum_jumps_by_the_impulse(structure):
    m = simulate(structure, eta=1.7, transient=30, periods=1, points=20_000)
    assert m.sizes["impact"]
    time, step = m.time.values, float(m.time[1] - m.time[0])
    for moment, impulse, speed in zip(
        m.impact_time.values, m.impulse.values, m.impact_velocity.values, strict=True
    ):
        after = int(np.searchsorted(time, moment))
        lost = [
            float(m[f"v{i}"][after] - m[f"v{i}"][after - 1]) - float(m[f"a{i}"][after]) * step
            for i in (1, 2)
        ]
        size = 1e-3 * impulse
        assert structure.m1 * lost[0] == pytest.approx(-impulse, abs=size)
        assert structure.m2 * lost[1] == pytest.approx(impulse, abs=size)
        expected = (1.0 + structure.e) * structure.m1 * structure.m2
        expected *= speed / (structure.m1 + structure.m2)
        assert impulse == pytest.approx(expected, rel=1e-12)


def test_the_impulse_that_begins_contact_is_plastic():
    m = simulate(PAPER, eta=0.4, transient=50, periods=1)
    sticking = m.sticks.values.astype(bool)
    assert sticking.sum() == 1
    np.testing.assert_allclose(m.impulse[sticking], 0.5 * m.impact_velocity[sticking])
    np.testing.assert_allclose(m.impulse[~sticking], 0.85 * m.impact_velocity[~sticking])


@pytest.mark.parametrize(
    ("asked", "text"),
    [
        ({"eta": [1.0, 2.0]}, "eta: 2 values; expected one number"),
        ({"eta": 1.0, "periods": 0}, "periods = 0"),
        ({"eta": 1.0, "points": 2.5}, r"points = 2\.5"),
        ({"eta": 1.0, "phase": np.nan}, "phase = nan"),
        ({"eta": 1.0, "start": (1.0, 0.0, 0.0, 0.0)}, "x2 >= x1"),
    ],
)
def test_what_is_refused(asked, text):
    with pytest.raises(InputError, match=text):
        simulate(PAPER, **asked)
