"""Derivatives of inputs and outputs in FMI 2.0, and of outputs in FMI 3.0."""

import math

import numpy as np
import pytest

from ..fmu.driver import MODELS
from ..fmu.programs.driver import COMMON, harmonic, open_fmu

OSCILLATOR, MOTOR_SHAKER, COIL = MODELS
INTEGRALS = ["box_impulse", "box_impulse_moment"]
ORDERS = {"box_jerk": 1, "box_snap": 2, "box_crackle": 3}


def cubic(k):
    values = {"box_acceleration": 0.2 * math.sin(k), "box_jerk": 0.1 * math.cos(2 * k)}
    return values | {"box_snap": -0.05 * math.sin(3 * k), "box_crackle": 0.02 * math.cos(k)}


@pytest.mark.parametrize("used", [{"box_snap"}, set(ORDERS)], ids=["snap", "all"])
def test_input_derivatives_are_the_variables_for_them(fmus, used):
    """Through impacts, over steps of changing length."""
    with open_fmu(fmus["fmi2"]) as fmu, open_fmu(fmus["fmi2"]) as twin:
        for one in (fmu, twin):
            one.start(**harmonic(1.13))
        for k in range(400):
            values = {n: x * (n in {*used, "box_acceleration"}) for n, x in cubic(k).items()}
            fmu.set(box_acceleration=values["box_acceleration"])
            given = [*ORDERS.values()], [values[name] for name in ORDERS]
            fmu.fmu.setRealInputDerivatives([fmu.reference("box_acceleration")] * 3, *given)
            twin.set(**values)
            for one in (fmu, twin):
                one.step(one.time + 0.1 + 0.05 * math.sin(k))
            assert fmu.get(*COMMON, *ORDERS) == twin.get(*COMMON, *ORDERS)
        assert fmu.one("impact_count") > 5


def test_two_inputs_have_derivatives(exported, fmus):
    """Each input's cubic begins where its own derivatives are set."""
    path = exported / "fmi2" / "ElectrodynamicShaker.fmu"
    fmu, twin = (
        open_fmu(path).start(command=1.0, command_1=4.0, coil_inductance=0.01).step(0.25)
        for _ in range(2)
    )
    fmu.fmu.setRealInputDerivatives([fmu.reference("box_force")], [1], [3.0])
    twin.set(box_force_1=3.0)
    names = ("voltage", "current", "box_position", "box_force_work")
    assert fmu.step(0.5).get(*names) == twin.step(0.5).get(*names)
    assert fmu.one("voltage") == pytest.approx(3.0)  # the command runs on


WRONG = [  # references' names, orders, values, and what the message has
    (["x1"], [1], [0.5], "box_acceleration"),
    (["box_amplitude"], [1], [0.5], "box_acceleration"),
    (["box_jerk"], [1], [0.5], "box_acceleration"),
    (["box_acceleration"] * 2, [1, 0], [0.5, 0.5], "orders 1 to 3"),
    (["box_acceleration"] * 2, [1, 4], [0.5, 0.5], "orders 1 to 3"),
    (["box_acceleration"] * 2, [1, -(2**31)], [0.5, 0.5], "orders 1 to 3"),
    (["box_acceleration"], [1], [math.nan], "box_jerk = nan"),
    (["box_acceleration"], [2], [math.inf], "box_snap = inf"),
    (["box_acceleration"], [3], [-1e101], "box_crackle = -1e+101"),
]


@pytest.mark.parametrize(("names", "orders", "values", "words"), WRONG)
def test_wrong_input_derivatives_are_refused_all_of_them(fmus, names, orders, values, words):
    f = open_fmu(fmus["fmi2"]).start()
    references = [f.reference(name) for name in names]
    assert words in f.refused("setRealInputDerivatives", references, orders, values)
    assert f.get(*ORDERS) == [0.0] * 3


STEP = 1e-3  # of the difference quotient: the error of order 4 is near the rounding
MOTIONS = {
    "flight": (OSCILLATOR, {**harmonic(1.13), "x2_start": 0.5, "box_acceleration": 0.1}, 0.5),
    "contact": (OSCILLATOR, {**harmonic(0.4), "m2": 1.5, "d2": 0.3, "k2": 1.6}, 0.3),
    "bonded": (OSCILLATOR, {**harmonic(0.4), "m2": 1.5, "d2": 0.3, "bonded": True}, 2.7),
    "motor": (MOTOR_SHAKER, {"speed_start": 3.0, "voltage": 0.4, "box_force": 0.1}, 0.4),
    "lag": (MOTOR_SHAKER, {"speed_start": 3.0, "voltage": 0.4, "armature_inductance": 1.0}, 0.4),
    "coil": (COIL, {"command": 5.0, "command_1": -3.0, "box_force_2": 4.0}, 0.4),
    "lagging coil": (COIL, {"command": 5.0, "command_1": -3.0, "coil_inductance": 0.05}, 0.4),
    "held coil": (COIL, {"command": 9.0, "voltage_limit": 4.0, "coil_inductance": 0.05}, 0.4),
    "commanded": (COIL, {"command": 0.5, "command_1": 2.0, "current_control": True}, 0.4),
}


def rates(fmu, names):
    get = fmu.fmu.getOutputDerivatives if fmu.third else fmu.fmu.getRealOutputDerivatives
    references = [fmu.variables[name].valueReference for name in names]
    return list(get(references, [1] * len(names)))


@pytest.mark.parametrize("motion", MOTIONS)
def test_every_continuous_output_has_its_derivative(exported, version, motion):
    """As ``maxOutputDerivativeOrder`` promises: against difference quotients of order 4."""
    model, values, time = MOTIONS[motion]
    with open_fmu(exported / version / f"{model}.fmu") as fmu:
        outputs = [v for v in fmu.variables.values() if v.causality == "output"]
        smooth = [v.name for v in outputs if v.variability == "continuous" and not v.dimensions]
        fmu.start(**values)
        # sums over the last step begin anew with each
        names = [name for name in smooth if name not in ("x_rel_max", *INTEGRALS)]
        around = []
        for k in range(-2, 3):
            fmu.step(time + k * STEP)
            around.append(fmu.get(*names))
            if k == 0:
                found = rates(fmu, names)
        a, b, _, c, d = map(np.array, around)
        expected = (a - 8.0 * b + 8.0 * c - d) / (12.0 * STEP)
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-9)


def test_other_output_derivatives_are_refused(fmus, version):
    f = open_fmu(fmus[version]).start()
    refuse = "getOutputDerivatives" if f.third else "getRealOutputDerivatives"
    orders = [("x1", 0), ("x1", 2), ("x1", -1), ("m1", 1), ("impact_time", 1), ("impact_count", 1)]
    for name, order in orders:
        f.refused(refuse, [f.reference(name)], [order])
