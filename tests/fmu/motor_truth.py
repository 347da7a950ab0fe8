"""The shaker's equations written once more, and solved by scipy."""

import numpy as np
from scipy.integrate import solve_ivp

from fmu_src.models.motor_shaker.variables import VARIABLES

DEFAULTS = {v.name: float(v.start) for v in VARIABLES if not v.calculated}
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
        f0, f1, f2, f3 = (p[f"box_force{order}"] for order in ("", "_1", "_2", "_3"))
        force = f0 + t * (f1 + t * (f2 / 2 + t * f3 / 6))
        coupled = unbalance * np.cos(phi)
        matrix = [[p["box_mass"], coupled], [coupled, p["rotor_inertia"]]]
        force += unbalance * w * w * np.sin(phi) - p["box_damping"] * v - p["box_stiffness"] * y
        a, b = np.linalg.solve(matrix, [force, K * current])
        return [v, a, w, b, (p["voltage"] - R * current - K * w) / L if L else 0.0, K * current * w]

    return f


def solve(values, start, stop):
    """State at ``stop`` from ``start`` = (y, y', phi, phi', i) at 0, and the motor's work."""
    tight = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}
    return solve_ivp(right_hand_side(values), (0.0, stop), [*start, 0.0], **tight).y[:, -1]
