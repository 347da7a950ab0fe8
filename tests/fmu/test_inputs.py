"""Inputs that change: continuous phase, constant and piecewise cubic accelerations, against
solutions of the equations of motion.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from .driver import run

MASSES = {"m1": 1.0, "m2": 1.5, "k1": 1.0, "k2": 1.4, "d1": 0.05, "d2": 0.03}


def test_phase_is_continuous_when_the_frequency_changes(fmu, tmp_path):
    """The phase is the integral of box_frequency, from phase_start on; positions and velocities do
    not jump either.
    """
    found = run("inputs.phase_is_continuous_when_the_frequency_changes", fmu, cwd=tmp_path)
    for frequency, (before, after, expected, phase) in zip(
        (0.4, 3.0, 0.0, 1e3, 0.7, 0.7), found, strict=True
    ):
        # a time's rounding times the acceleration
        assert after == pytest.approx(before, abs=1e-12 + 2e-15 * frequency**2)
        assert 0.0 <= phase < 2.0 * math.pi
        assert math.remainder(phase - expected, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-11)


def test_constant_acceleration_ends_in_static_displacement(fmu, tmp_path):
    """Pushed apart, mass i comes to rest at -m_i g/k_i; pressed together, both at -(m1 + m2) g/(k1
    + k2), with the force that takes.
    """
    parted, pressed = run(
        "inputs.constant_acceleration_ends_in_static_displacement",
        fmu,
        {**MASSES, "m2": 1.2, "d2": 0.06},
        cwd=tmp_path,
    )
    k1, k2, m1, m2 = 1.0, 1.4, 1.0, 1.2
    assert parted["x1"] == pytest.approx(-0.5 * m1 / k1, rel=1e-12)
    assert parted["x2"] == pytest.approx(-0.5 * m2 / k2, rel=1e-12)
    assert not parted["in_contact"] and parted["contact_force"] == 0.0
    together = 0.5 * (m1 + m2) / (k1 + k2)
    assert pressed["x1"] == pressed["x2"] == pytest.approx(together, rel=1e-12)
    assert pressed["in_contact"] and pressed["impact_count"] == 0
    # what its spring does not carry of mass 1
    assert pressed["contact_force"] == pytest.approx(0.5 * m1 - k1 * together, rel=1e-9)
    for outputs in (parted, pressed):
        assert outputs["v1"] == pytest.approx(0.0, abs=1e-12)


def signal(t):
    """Box acceleration of the next test, smooth and without a period, and its first three
    derivatives.
    """
    parts = ((0.8, 0.9, 0.3), (0.5, 1.7, 1.1), (-0.3, 2.3, 0.0))
    return [
        sum(a * w**n * math.cos(w * t + p + 0.5 * math.pi * n) for a, w, p in parts)
        for n in range(4)
    ]


def motion(acceleration, end, values, times):
    """x1, v1, x2, v2 at ``times`` by integration to 1e-12 with event location."""
    m1, m2, k1, k2, d1, d2 = (values[name] for name in ("m1", "m2", "k1", "k2", "d1", "d2"))

    def right(t, y):
        g = acceleration(t)
        return [y[1], -(d1 * y[1] + k1 * y[0]) / m1 - g, y[3], -(d2 * y[3] + k2 * y[2]) / m2 - g]

    def gap(t, y):
        return y[2] - y[0]

    gap.terminal, gap.direction = True, -1
    t, y, rows, impacts = 0.0, [values["x1_start"], 0.0, values["x2_start"], 0.0], {}, 0
    while t < end:
        part = solve_ivp(
            right,
            (t, end),
            y,
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
            events=gap,
            dense_output=True,
        )
        rows.update({s: part.sol(s) for s in times if t <= s <= part.t[-1]})
        t, y = part.t[-1], part.y[:, -1].copy()
        if part.status == 1:
            impacts += 1
            common, closing = (m1 * y[1] + m2 * y[3]) / (m1 + m2), y[1] - y[3]
            y[1] = common - m2 * values["e"] * closing / (m1 + m2)
            y[3] = common + m1 * values["e"] * closing / (m1 + m2)
            y[0] = y[2] = y[0] - 1e-15
            y[2] += 1e-14  # clear of the event
    return np.array([rows[s] for s in times]), impacts


def test_piecewise_cubic_acceleration_against_integration(fmu, tmp_path):
    """With value and three derivatives set at each step the FMU follows a smooth signal to the
    fourth power of the step.
    """
    values = {**MASSES, "e": 0.8, "x1_start": -0.5, "x2_start": 0.5}
    times = [0.5 * k for k in range(1, 41)]
    expected, impacts = motion(lambda t: signal(t)[0], times[-1], values, times)
    steps = (2.0**-3, 2.0**-5)
    signals = [[step, [signal(k * step) for k in range(int(times[-1] / step))]] for step in steps]
    found = run(
        "inputs.piecewise_cubic_acceleration_against_integration",
        fmu,
        values,
        signals,
        cwd=tmp_path,
    )
    errors = []
    for at, (count, contacts) in found:
        assert count == impacts > 5
        assert contacts == 0
        errors.append(np.max(np.abs(np.array(at) - expected)))
    coarse, fine = errors
    assert coarse < 3e-4
    assert fine < 1e-6
    assert coarse / fine > 100  # 4^4 = 256 in the limit


def test_cubic_input_over_one_step_is_exact(fmu, tmp_path):
    """The cubic holds over the whole step, far beyond small ones: bonded, against the closed form x
    = polynomial + decaying part.
    """
    g = [0.3, -0.2, 0.15, -0.05]
    x1, v1, x2, v2, impulse, moment = run(
        "inputs.cubic_input_over_one_step_is_exact", fmu, g, cwd=tmp_path
    )

    def right(t, y):
        force = 2.2 * y[0] + 0.02 * y[1]
        return [
            y[1],
            -0.5 * force - (g[0] + t * (g[1] + t * (g[2] / 2 + t * g[3] / 6))),
            force,
            t * force,
        ]

    expected = solve_ivp(right, (0.0, 5.0), [0.0] * 4, method="DOP853", rtol=1e-13, atol=1e-14).y[
        :, -1
    ]
    assert [x1, v1, impulse, moment] == pytest.approx(expected, abs=1e-11)
    assert (x2, v2) == (x1, v1)


def test_a_resonance_without_damping_grows_with_time(fmu, tmp_path):
    """x = (sin t - t cos t)/2: neither refused, nor lost in the difference of two large motions."""
    times = [0.5, 1.0, 31.25, 32.0, 4000.0]
    found = run("inputs.resonance_without_damping", fmu, times, cwd=tmp_path)
    for t, (x1, v1, force) in zip(times, found, strict=True):
        exact = 0.5 * (math.sin(t) - t * math.cos(t))
        assert abs(x1 - exact) <= 1e-15 * (4.0 + t) ** 2
        assert abs(v1 - 0.5 * t * math.sin(t)) <= 1e-15 * (4.0 + t) ** 2
        assert force == pytest.approx(1.5 * x1, rel=1e-14)


@pytest.mark.parametrize("name", ["box_acceleration", "box_jerk", "box_snap", "box_crackle"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_each_derivative_moves_masses_from_rest(fmu, tmp_path, name, sign):
    """From rest at the touching point only the first derivative that does not vanish decides: apart
    for +, pressed together for -.
    """
    outputs = run("inputs.each_derivative_moves_masses_from_rest", fmu, name, sign, cwd=tmp_path)
    assert outputs["impact_count"] == outputs["contact_count"] == 0
    assert outputs["in_contact"] == (sign < 0)
    assert (outputs["x_rel"] > 0.0) == (sign > 0)
