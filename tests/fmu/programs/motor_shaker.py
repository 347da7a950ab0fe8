"""Runs of ``MotorShaker``."""

import contextlib

import fmpy
import numpy as np
from driver import Refused, describe, open_fmu
from motor_shaker_mistakes import MISTAKES


def resumed(path):
    f = open_fmu(path).start(voltage=6.0, box_force=0.5, box_force_1=-3.0, armature_inductance=0.01)
    for k in range(1, 41):
        f.step(k * 0.0137)
        f.set(voltage=6.0 + 0.1 * k, box_force=0.3 * k)
    half = f.save()
    for k in range(41, 61):
        f.step(k * 0.0137)
    end = f.outputs()
    f.restore(*half)
    for k in range(41, 61):
        f.step(k * 0.0137)
    again = f.outputs()
    g = open_fmu(path).restore(*half)
    for k in range(41, 61):
        g.step(k * 0.0137)
    return [end, again, g.outputs()]


def initial_dependencies_are_true(path):
    base = {
        "angle_start": 0.4,
        "speed_start": 30.0,
        "position_start": 0.01,
        "velocity_start": 0.2,
        "voltage": 5.0,
        "box_force": 2.0,
        "box_force_1": 3.0,
    }
    inductive = {**base, "armature_inductance": 0.1, "current_start": 0.3}
    found = {}

    def at_start(values):
        f = open_fmu(path)
        f.set(**values)
        f.enter()
        try:
            return f.outputs()
        finally:
            f.free()

    settable = [v for v in describe(path).modelVariables if v.causality in ("parameter", "input")]
    for start in (base, inductive):
        plain = at_start(start)
        for v in settable:
            if v.type not in ("Real", "Float64"):  # the limit of evaluations decides no number
                continue
            other = at_start({**start, v.name: 1.25 * start.get(v.name, float(v.start)) + 0.001})
            found.setdefault(v.name, set()).update(key for key in plain if plain[key] != other[key])
    return {name: sorted(keys) for name, keys in found.items()}


def motion_is_that_of_the_equations(path, values):
    f = open_fmu(path).start(**values).step(0.25)
    return f.get("box_position", "box_velocity", "angle", "speed", "motor_energy")


def acceleration_belongs_to_the_inputs_as_set_now(path):
    f = open_fmu(path)
    f.set(voltage=0.0)
    f.enter()
    rows = []
    for force in (0.0, 11.0):
        f.set(box_force=force)
        rows.append(f.get("box_acceleration")[0])
    f.leave()
    f.set(box_force=0.0, voltage=6.0)
    f.step(0.1)
    for force in (2.0, 13.0):
        f.set(box_force=force)
        state = f.save()
        rows.append(f.get("box_acceleration")[0])
        f.restore(*state)
        rows.append(f.get("box_acceleration")[0])
    f.step(0.2)
    looked = f.outputs()
    g = open_fmu(path).start(voltage=0.0)
    g.set(voltage=6.0)
    g.step(0.1).set(box_force=13.0)
    return [rows, looked == g.step(0.2).outputs()]


def mistakes(path):
    other, texts = open_fmu(path, name="other").start(voltage=5.0), []
    for fail, _ in MISTAKES:
        f = open_fmu(path)
        try:
            fail(f)
            texts.append("accepted")
        except Refused as refusal:
            texts.append(" ".join(refusal.messages))
    return [texts, other.step(0.1).get("angle")[0]]


def failed_step_leaves_the_instance_where_it_was(path):
    f = open_fmu(path).start(voltage=5.0, armature_inductance=1e-4).step(0.01)
    before = f.outputs()
    with contextlib.suppress(Refused):
        f.step(10.0)
    f.time = 0.01
    kept = f.outputs() == before
    g = open_fmu(path).start(voltage=5.0, armature_inductance=1e-4).step(0.01).step(0.02)
    return [kept, f.step(0.02).outputs() == g.outputs()]


def steps(path, values, names):
    f = open_fmu(path).start(**values)
    return [f.step(k * 0.03125).get(*names) for k in range(1, 65)]


def reference_result(path, inputs, names):
    table = np.genfromtxt(inputs, delimiter=",", names=True)
    found = fmpy.simulate_fmu(path, stop_time=5.0, output_interval=0.005, input=table, output=names)
    return [float(found[name][-1]) for name in names]
