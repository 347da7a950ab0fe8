"""The shaker's equations written once more, and solved by scipy."""

import numpy as np
from scipy.integrate import solve_ivp

DEFAULTS = {
    "box_mass": 5.5,
    "box_stiffness": 309.375,
    "box_damping": 4.125,
    "unbalance_mass": 0.025,
    "unbalance_radius": 0.02,
    "rotor_inertia": 5e-5,
    "motor_constant": 0.06,
    "armature_resistance": 12.0,
    "armature_inductance": 0.0,
    "evaluation_limit": 1e7,
    "voltage": 0.0,
    "box_force": 0.0,
    "box_force_1": 0.0,
    "box_force_2": 0.0,
    "box_force_3": 0.0,
}
STATES = ("box_position", "box_velocity", "angle", "speed", "motor_current")


def right_hand_side(values):
    """``f(t, state)`` with the state y, y', phi, phi', i, then the motor's work."""
    p = {**DEFAULTS, **values}
    unbalance = p["unbalance_mass"] * p["unbalance_radius"]
    K, R, L = p["motor_constant"], p["armature_resistance"], p["armature_inductance"]

    def f(t, s):
        y, v, phi, w, current, _ = s
        if L == 0.0:
            current = (p["voltage"] - K * w) / R
        force = (
            p["box_force"]
            + p["box_force_1"] * t
            + p["box_force_2"] * t**2 / 2
            + p["box_force_3"] * t**3 / 6
        )
        matrix = [
            [p["box_mass"], unbalance * np.cos(phi)],
            [unbalance * np.cos(phi), p["rotor_inertia"]],
        ]
        right = [
            unbalance * w * w * np.sin(phi) - p["box_damping"] * v - p["box_stiffness"] * y + force,
            K * current,
        ]
        a, b = np.linalg.solve(matrix, right)
        return [v, a, w, b, (p["voltage"] - R * current - K * w) / L if L else 0.0, K * current * w]

    return f


def solve(values, start, stop):
    """State at ``stop`` from ``start`` = (y, y', phi, phi', i) at 0, and the motor's work."""
    found = solve_ivp(
        right_hand_side(values), (0.0, stop), [*start, 0.0], method="DOP853", rtol=1e-13, atol=1e-15
    )
    return found.y[:, -1]
