"""Runs of ``ElectrodynamicShaker``."""

import contextlib

import fmpy
import numpy as np
from driver import Refused, describe, open_fmu
from electrodynamic_shaker_mistakes import MISTAKES

BASE = {
    **{"position_start": 1e-3, "velocity_start": 0.2, "current_start": 0.3},
    **{"command": 1.5, "command_1": 3.0, "command_2": -20.0, "box_force": 2.0, "box_force_1": 3.0},
}
FOLLOWING = {  # a constant current, whose change would take more voltage than there is
    **{"current_control": True, "coil_inductance": 0.1, "voltage_limit": 6.0},
    **{"current_start": 0.3, "command": 0.3, "command_1": 0.0, "command_2": 0.0},
}
KINDS = [  # of amplifier, and what limits it from the start
    FOLLOWING,
    {},
    {"coil_inductance": 0.1},
    {"current_control": True, "coil_inductance": 0.1},
    {"current_control": True, "coil_inductance": 0.1, "voltage_limit": 5.0},
    {"current_control": True, "voltage_limit": 5.0},
    {"current_control": True, "voltage_limit": 12.0},
    {"current_limit": 0.2, "coil_inductance": 0.1, "current_start": 0.2, "command": 20.0},
    {"current_limit": 0.2},
    {"voltage_limit": 1.0},
]
NOT_OF_THE_MOTION = ("evaluations",)


def of_the_motion(f):
    """Outputs to the last bit, those of the last step alone left out."""
    found = {name: float(value).hex() for name, value in f.outputs().items()}
    return {name: value for name, value in found.items() if name not in NOT_OF_THE_MOTION}


def grids(path, values, end):
    """Outputs at the end of runs with other communication points, in one process."""
    rows = []
    times = [0.0, *np.sort(np.random.default_rng(5).uniform(0.0, end, 40)), end]
    for points in ([end], np.linspace(0.0, end, 1001)[1:], times[1:]):
        f = open_fmu(path).start(**values)
        for time in points:
            f.step(float(time))
        rows.append(of_the_motion(f))
        f.free()
    return rows


def resumed(path, values):
    """Outputs of a run with new cubics, of its second half again, and of that by another one; and
    whether limits acted.
    """
    f = open_fmu(path).start(**values)
    limited = []

    def go(instance, first, last):
        for k in range(first, last):
            limited.extend(instance.step(k * 0.0137).get("limited"))
            instance.set(command=2.0 - 0.1 * k, command_1=500.0 - 10.0 * k, box_force=0.3 * k)
        return of_the_motion(instance)

    go(f, 1, 41)
    half = f.save()
    end = go(f, 41, 61)
    again = go(f.restore(*half), 41, 61)
    return [end, again, go(open_fmu(path).restore(*half), 41, 61), len(set(limited)) == 2]


def moved(plain, other):
    """Outputs that differ by more than rounding."""
    return {
        name
        for name, value in plain.items()
        if abs(value - other[name]) > 1e-12 * (abs(value) + abs(other[name]))
    }


def changes_of(variable, value):
    """Other values of a variable."""
    if variable.type == "Boolean":
        return [value in (False, "false")]
    value = float(value)
    return [0.75 * value, 1.25 * value + 0.001, value + 20.0, value - 20.0]


def initial_dependencies_are_true(path):
    """Outputs that move at the start, by the start value that is changed."""
    found, f = {}, open_fmu(path)

    def at_start(values):
        f.reset()
        f.set(**values)
        f.enter()
        return f.outputs()

    known = describe(path).modelVariables
    settable = [v for v in known if v.causality in ("parameter", "input")]
    for kind in KINDS:
        start = {**BASE, **kind}
        plain = at_start(start)
        for v in settable:
            if v.name == "evaluation_limit":  # decides no number
                continue
            for value in changes_of(v, start.get(v.name, v.start)):
                with contextlib.suppress(Refused):
                    other = at_start({**start, v.name: value})
                    found.setdefault(v.name, set()).update(moved(plain, other))
    return {name: sorted(keys) for name, keys in found.items()}


def dependencies_are_true(path):
    """Outputs that move between steps, by the input that is set to another value than the others,
    which are set to what they are.
    """
    found = {}
    for kind in KINDS:
        f = open_fmu(path).start(**{**BASE, **kind}).step(0.01)
        inputs = {v.name: v for v in describe(path).modelVariables if v.causality == "input"}
        values, state = {name: f.get(name)[0] for name in inputs}, f.save()

        def as_set(other, f=f, values=values, state=state):
            f.restore(*state)
            f.set(**{**values, **other})
            return f.outputs()

        plain = as_set({})
        for name, variable in inputs.items():
            for value in changes_of(variable, values[name]):
                other = as_set({name: value})
                found.setdefault(name, set()).update(moved(plain, other))
        f.free()
    return {name: sorted(keys) for name, keys in found.items()}


def motion(path, values, end, names):
    return open_fmu(path).start(**values).step(end).get(*names)


def inputs_as_set_now(path):
    """Accelerations at two forces, and after each a restored state; whether reading and setting
    once more changes nothing.
    """
    f = open_fmu(path).start(command=1.0).step(0.1)
    rows = []
    for force in (2.0, 13.0):
        f.set(box_force=force)
        state = f.save()
        rows.append(f.get("box_acceleration")[0])
        f.restore(*state)
        rows.append(f.get("box_acceleration")[0])
    f.set(command=7.0)
    rows.append(f.get("voltage")[0])
    f.set(command=3.0)
    g = open_fmu(path).start(command=1.0).step(0.1)
    g.set(command=3.0, box_force=13.0)
    return [rows, of_the_motion(f.step(0.2)) == of_the_motion(g.step(0.2))]


def mistakes(path):
    other, texts = open_fmu(path, name="other").start(command=5.0), []
    for fail, _ in MISTAKES:
        f = open_fmu(path)
        try:
            fail(f)
            texts.append("accepted")
        except Refused as refusal:
            texts.append(" ".join(refusal.messages))
    return [texts, other.step(0.1).get("box_position")[0]]


def a_stop_leaves_the_instance_where_it_was(path):
    """Whether a step into a stop changed nothing, and one before it is done as if it had not
    been.
    """
    values = {"command": 40.0, "travel_limit": 0.01}
    f = open_fmu(path).start(**values).step(0.01)
    before = of_the_motion(f)
    with contextlib.suppress(Refused):
        f.step(10.0)
    f.time = 0.01
    kept = of_the_motion(f) == before
    g = open_fmu(path).start(**values).step(0.01).step(0.02)
    return [kept, of_the_motion(f.step(0.02)) == of_the_motion(g)]


def reference_result(path, inputs, names):
    table = np.genfromtxt(inputs, delimiter=",", names=True)
    found = fmpy.simulate_fmu(path, stop_time=3.0, output_interval=0.005, input=table, output=names)
    return [float(found[name][-1]) for name in names]
