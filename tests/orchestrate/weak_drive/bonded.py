"""The bonded system by Runge and Kutta, apart from the library: voltages held over each step."""

import math


def rates(system, state, voltage):
    """Right-hand side; a state is x, v, y, y', phi, phi'."""
    structure, s = system
    x, v, y, w, phi, speed = state
    mass = structure.m1 + structure.m2
    pull = (structure.k1 + structure.k2) * x + (structure.d1 + structure.d2) * v
    unbalance = s.unbalance_mass * s.unbalance_radius
    c = unbalance * math.cos(phi)
    p = unbalance * speed * speed * math.sin(phi) - s.box_damping * w - s.box_stiffness * y + pull
    torque = s.motor_constant * (voltage - s.motor_constant * speed) / s.armature_resistance
    determinant = s.box_mass * s.rotor_inertia - c * c
    a = (s.rotor_inertia * p - c * torque) / determinant
    turn = (s.box_mass * torque - c * p) / determinant
    return (v, -pull / mass - a, w, a, speed, turn)


def advanced(state, slopes, h):
    """A state a step further."""
    return tuple(value + h * slope for value, slope in zip(state, slopes, strict=True))


def step(system, state, voltage, h):
    """One step of the classical fourth-order method."""
    a = rates(system, state, voltage)
    b = rates(system, advanced(state, a, 0.5 * h), voltage)
    c = rates(system, advanced(state, b, 0.5 * h), voltage)
    d = rates(system, advanced(state, c, h), voltage)
    mean = tuple((p + 2 * q + 2 * r + s) / 6 for p, q, r, s in zip(a, b, c, d, strict=True))
    return advanced(state, mean, h)


def run(system, law, h, count, parts=1):
    """Speeds and voltages of a start from rest; ``law`` gives the voltage from time and speed."""
    state, speeds, voltages = (0.0,) * 6, [], []
    for i in range(count):
        voltage = law(i * h, state[5])
        for _ in range(parts):
            state = step(system, state, voltage, h / parts)
        speeds.append(state[5])
        voltages.append(voltage)
    return speeds, voltages
