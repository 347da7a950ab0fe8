"""The integration of benches against closed forms and an adaptive method with tight tolerances."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from tests.benches.integrator import equilibrium, integrate
from tests.benches.lumped import TURN, Faces, Halves, cubic_stiffness
from tests.benches.recipe import OPENED

HALVES = Halves(zeta1=0.03, zeta2=0.03)
LAWS = ("linear", "hunt-crossley", "hertz")
CLEARANCES = (0.0, 3e-4, -2e-4)  # m


def driven(frequency, seconds, step, level=5.0):
    """A sine at the ends and middles of steps."""
    steps = round(seconds / step)
    return level * np.sin(TURN * frequency * 0.5 * step * np.arange(2 * steps + 1))


def test_a_bonded_beam_has_the_closed_transfer_function():
    system, step, whole = HALVES.bonded(), 1.0 / 24_000.0, HALVES.bonded_beam()
    for frequency in (25.0, whole.f, 80.0):
        moved = integrate(system, driven(frequency, 4.0, step), step).acceleration
        r = frequency / whole.f
        ratio = (1.0 + 2j * whole.zeta * r) / (1.0 - r * r + 2j * whole.zeta * r)
        times = step * np.arange(moved.shape[1])
        closed = 5.0 * np.imag(ratio * np.exp(1j * TURN * frequency * times))
        assert np.abs(moved - closed)[:, -24_000:].max() < 2e-7 * 5.0 * abs(ratio)


def reference(system, base, times):
    """Speeds of two masses with contact at some times, by an adaptive method."""
    contacts, w, zeta = system.contacts, system.frequency, system.damping_ratio
    (k,), (c,) = contacts.stiffness, contacts.damping
    (gap_row,), (clearance,) = contacts.rows, contacts.clearance

    def slope(t, y):
        q, v = y[:2], y[2:]
        depth, speed = -(gap_row @ q) - clearance, -(gap_row @ v)
        force = k * depth + c * speed if contacts.law == "linear" else k * depth * (1 + c * speed)
        force *= math.sqrt(max(depth, 0.0)) if contacts.law == "hertz" else 1.0
        force = max(force, 0.0) if depth > 0.0 else 0.0
        forced = gap_row * force - system.participation * base(t)
        return np.concatenate([v, forced - w * w * q - 2 * zeta * w * v])

    start = np.concatenate([equilibrium(system), np.zeros(2)])
    tight = {"rtol": 1e-10, "atol": 1e-14, "max_step": 2e-4}
    return solve_ivp(slope, (0.0, times[-1]), start, "DOP853", times, **tight).y[2:]


def speeds(system, base, times, parts):
    """The same by the benches' integration, each time ``parts`` steps after the one before; in
    how many of the times between the faces touch, and part.
    """
    step = float(times[1] - times[0]) / parts
    q, v, found, struck = equilibrium(system), np.zeros(2), [np.zeros(2)], 0
    for begin in times[:-1]:
        moved = integrate(system, base(begin + 0.5 * step * np.arange(2 * parts + 1)), step, q, v)
        q, v = moved.position, moved.velocity
        struck += moved.largest_gap[0] > 0.0 and moved.largest_force[0] > 0.0
        found.append(v)
    return np.array(found).T, struck


@pytest.mark.parametrize(("law", "clearance"), [*zip(LAWS, CLEARANCES, strict=True)])
def test_motion_with_contact_is_that_of_an_adaptive_method(law, clearance):
    """Half a percent of the largest speed, 2 % where a dashpot's force jumps at each impact.

    Later motions part, as chaotic ones do. A quarter of the step leaves a third of it or less.
    """
    system = HALVES.delaminated(Faces(law=law, clearance=clearance))
    times = np.linspace(0.0, 0.25, 101)

    def base(t):
        return 8.0 * np.sin(TURN * 44.0 * np.asarray(t))

    known, worst = reference(system, base, times), []
    for steps in (60, 240):
        found, struck = speeds(system, base, times, round(steps * 1000.0 * float(times[1])))
        assert clearance < 0.0 or struck > 5
        worst.append(np.abs(found - known).max() / np.abs(known).max())
    stated = 2e-2 if law == "linear" else 5e-3
    assert worst[0] < stated and worst[1] < max(worst[0] / 3.0, 1e-6), worst


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("e", [0.3, 0.9])
def test_a_collision_has_the_restitution_that_was_asked_for(law, e):
    """Of two masses on nearly no springs."""
    speed, masses = 0.05, np.sqrt([1.5, 0.7])
    faces = Faces(law=law, restitution=e, speed=speed, frequency=800.0)
    halves = Halves(m1=1.5, m2=0.7, f1=1e-4, f2=1e-4, zeta1=0.0, zeta2=0.0)
    start = np.array([-5e-6, 0.0]) * masses, np.array([speed, 0.0]) * masses
    done = integrate(halves.delaminated(faces), np.zeros(8001), 1e-6, *start)
    v1, v2 = done.velocity / masses
    assert (v2 - v1) / speed == pytest.approx(e, rel=1e-3)
    assert 1.5 * v1 + 0.7 * v2 == pytest.approx(1.5 * speed, rel=1e-9)


@pytest.mark.parametrize(("part", "opens"), [(0.93, True), (1.07, False)])
def test_pressed_faces_part_where_the_dynamic_force_is_larger(part, opens):
    """It is what mass 1 needs beside its own spring to move as the bonded beam does; at rest the
    forces balance.
    """
    own, frequency, level = HALVES, 44.0, 5.0
    whole, w, w1 = own.bonded_beam(), TURN * frequency, TURN * own.f1
    r = frequency / whole.f
    moved = -level / (TURN * whole.f) ** 2 / (1.0 - r * r + 2j * whole.zeta * r)
    force = own.m1 * abs(level + (w1 * w1 - w * w + 2j * own.zeta1 * w1 * w) * moved)
    k1, k2 = own.m1 * w1**2, own.m2 * (TURN * own.f2) ** 2
    faces = Faces(law="linear", frequency=3000.0, clearance=-part * force * (1 / k1 + 1 / k2))
    system = own.delaminated(faces)
    x1, x2 = equilibrium(system) / np.sqrt([own.m1, own.m2])
    pressed = part * force * (1 / k1 + 1 / k2)
    pressed /= 1 / k1 + 1 / k2 + 1 / system.contacts.stiffness[0]
    assert (x1, x2) == pytest.approx((-pressed / k1, pressed / k2), rel=1e-6)
    base = driven(frequency, 1.5, 1e-5, level)
    base *= np.minimum(np.arange(len(base)) / 200_000.0, 1.0)  # so that it does not overshoot
    gap = integrate(system, base, 1e-5).largest_gap[0]
    assert (gap > OPENED) == opens and abs(gap) > 1e-9


@pytest.mark.parametrize("change", [0.3, -0.1])
def test_a_cubic_spring_changes_the_frequency_as_asked(change):
    """Its free period by an elliptic integral; dry friction takes the same from each swing."""
    f, amplitude, step = 45.0, 2e-3, 1e-5
    own = Halves(f1=f, f2=f, zeta1=0.0, zeta2=0.0)
    root, w2 = math.sqrt(own.bonded_beam().mass), (TURN * f) ** 2
    cubic = cubic_stiffness(change, f, amplitude)
    start = np.array([amplitude * root])
    moved = integrate(own.bonded(cubic=cubic), np.zeros(20_001), step, start)
    signs = np.flatnonzero(np.diff(np.signbit(moved.acceleration[0])))
    period = 2.0 * step * (signs[-1] - signs[0]) / (len(signs) - 1)
    part = cubic * amplitude**2
    exact = 4.0 * float(ellipk(0.5 * part / (w2 + part))) / math.sqrt(w2 + part)
    assert period == pytest.approx(exact, rel=1e-3)
    assert 1.0 / (f * period) - 1.0 == pytest.approx(change, rel=0.06)
    rubs = integrate(own.bonded(friction=0.4), np.zeros(2 * 8889 + 1), step, start)  # four periods
    expected = amplitude - 4 * 4.0 * 0.4 / w2
    assert abs(rubs.position[0] / root) == pytest.approx(expected, rel=5e-3)
