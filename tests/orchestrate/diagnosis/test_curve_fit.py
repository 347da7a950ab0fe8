"""Fits to resonance curves, against closed forms and motions that are computed one by one."""

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import orchestrate
from orchestrate.diagnosis.curve_evidence import CurveData
from orchestrate.diagnosis.hypotheses import Bonded

from .records import BEAM, guess

LIMIT = {"jobs": 1, "progress": False}
TURN = 2.0 * np.pi
LEVEL = 5.0
TRUTH = np.array([30.0, 38.0])


def transmissibility(hertz, f, zeta):
    ratio = hertz / f
    return (1.0 + 2j * zeta * ratio) / (1.0 - ratio**2 + 2j * zeta * ratio)


@functools.cache
def settled_orders(count=40):
    """Complex orders 1 to 3 of both faces over the base, from one simulation a frequency."""
    hertz, start = np.linspace(28.0, 40.0, count), None
    found = np.empty((2, 3, count), dtype=complex)
    for column, w in enumerate(TURN * hertz):
        box = {"frequency": w, "amplitude": LEVEL / w**2}
        motion = orchestrate.simulate(
            BEAM, **box, periods=8, transient=150, points=64, start=start, progress=False
        )
        time = motion.time.values[:-1]
        for row, name in enumerate(("x1", "x2")):
            for order in (1, 2, 3):
                line = 2j * np.mean(motion[name].values[:-1] * np.exp(-1j * order * w * time))
                found[row, order - 1, column] = (order * w) ** 2 * line
        found[:, 0, column] += LEVEL
        start = [float(motion[name][-1]) for name in ("x1", "x2", "v1", "v2")]
        start[1] = max(start[:2])
    return hertz, found


def noisy(values, rng, size=0.02):
    return values * np.exp(size * (rng.standard_normal(values.shape) * (1 + 0j)))


def test_a_bonded_curve_has_the_closed_form_s_numbers():
    hertz = np.linspace(28.0, 40.0, 25)
    for phases in (np.asarray, np.abs):
        ratio = phases(transmissibility(hertz, 33.8, 0.02))
        curve = orchestrate.resonance_curve(
            frequency=hertz, level=LEVEL, amplitude1=ratio, unit="1"
        )
        answer = orchestrate.fit(curve, BEAM, hypothesis="bonded", **LIMIT)
        np.testing.assert_allclose(answer.value, [33.8, 0.02], rtol=3e-3)
        assert float(answer.misfit) < 0.05 and "time" not in answer.coords


@pytest.mark.slow
def test_a_hardening_curve_upwards_has_its_cube():
    w, zeta, cube = TURN * 33.0, 0.02, 2e5
    hertz, state, size = np.linspace(28.0, 40.0, 25), [0.0, 0.0], []
    for f in hertz:  # an integration of its own, by the phase of the base

        def rate(t, y, f=f):
            spring = w * w * (y[0] + cube * y[0] ** 3)
            return [y[1], -2.0 * np.sin(TURN * f * t) - spring - 2.0 * zeta * w * y[1]]

        ends = np.linspace(40.0, 44.0, 257)[:-1] / f
        done = solve_ivp(rate, (0.0, 44.0 / f), state, t_eval=[*ends, 44.0 / f], rtol=1e-7)
        state = done.y[:, -1]
        size.append(2.0 * abs(np.mean(done.y[0][:-1] * np.exp(-1j * TURN * f * ends))))
    curve = orchestrate.resonance_curve(
        frequency=hertz, level=2.0, amplitude1=size, unit="m", relative=True
    )
    answer = orchestrate.fit(curve, BEAM, hypothesis="curved", **LIMIT)
    found = answer.value.sel(parameter=["f", "zeta", "cube"]).values
    assert (abs(found / [33.0, zeta, cube] - 1.0) < [0.01, 0.1, 0.2]).all(), found


@pytest.mark.slow
def test_order_1_of_one_face_alone_does_not_state_the_halves():
    hertz = np.linspace(28.0, 40.0, 25)
    ratio = abs(transmissibility(hertz, 33.8, 0.02))
    curve = orchestrate.resonance_curve(frequency=hertz, level=LEVEL, amplitude1=ratio, unit="1")
    answer = orchestrate.fit(curve, guess(), **LIMIT)
    assert np.isnan(answer.value).all() and "order 2 is not in the curve" in answer.attrs["reason"]
    with pytest.raises(orchestrate.InputError, match="record: no acceleration of the base"):
        orchestrate.detect(curve, guess())


@pytest.mark.slow
def test_intervals_of_curves_with_noise_hold_the_truth():
    """Of both faces, and of one."""
    hertz, orders = settled_orders()
    truth, inside = np.array([30.0, 38.0, 0.02, 0.02, 0.5]), []
    for seed in range(30):
        sizes = abs(noisy(orders, np.random.default_rng(seed)))
        both = {"amplitude1": sizes[0], **({"amplitude2": sizes[1]} if seed % 5 else {})}
        curve = orchestrate.resonance_curve(frequency=hertz, level=LEVEL, **both)
        answer = orchestrate.fit(curve, guess(), **LIMIT)
        answer = answer.sel(parameter=["f1", "f2", "zeta1", "zeta2", "e"])
        inside.append(abs(answer.value.values - truth) < 1.96 * answer.standard_error.values)
        np.testing.assert_allclose(answer.value[:2], TRUTH, rtol=0.02)
    assert np.mean(inside) >= 0.9 and orchestrate.plot(answer) is not None


@pytest.mark.parametrize("phases", [np.asarray, np.abs])
def test_some_points_of_a_curve_have_the_residuals_that_they_have_among_all(phases):
    hertz = np.linspace(28.0, 40.0, 25)
    ratio = phases(transmissibility(hertz, 33.8, 0.02))
    curve = orchestrate.resonance_curve(frequency=hertz, level=LEVEL, amplitude1=ratio, unit="1")
    whole, chosen = CurveData.from_curve(curve, BEAM).evidence(), hertz < 33.0
    motion = Bonded().displacements({"f": 34.0, "log_zeta": -4.0}, whole, None)
    part, expected = (
        one.residuals_of_orders(one.ideal_orders(motion))
        for one in (whole.select_windows(chosen), whole)
    )
    np.testing.assert_allclose(part, expected[..., chosen], rtol=1e-9)
