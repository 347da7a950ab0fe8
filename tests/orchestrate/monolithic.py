"""Structure, box and motor as one system of equations, solved by scipy with events: what the co-simulation has to agree with."""

import numpy as np
from scipy.integrate import solve_ivp

TOLERANCE = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13}


class Monolith:
    """The whole system; a state is x1, v1, x2, v2, y, y', phi, phi'.

    Parameters
    ----------
    oscillator, shaker : dict
        The FMUs' parameters.
    voltage : float
    """

    def __init__(self, oscillator, shaker, voltage):
        self.o, self.s, self.voltage = oscillator, shaker, voltage
        self.unbalance = shaker["unbalance_mass"] * shaker["unbalance_radius"]

    def pulls(self, state):
        """Forces of the springs and dampers on the box."""
        x1, v1, x2, v2 = state[:4]
        o = self.o
        return o["k1"] * x1 + o["d1"] * v1, o["k2"] * x2 + o["d2"] * v2

    def rates(self, state, together):
        """Right-hand side in flight, or in contact."""
        _, v1, _, v2, y, v, phi, w = state
        s, o = self.s, self.o
        p1, p2 = self.pulls(state)
        torque = s["motor_constant"] * (self.voltage - s["motor_constant"] * w) / s["armature_resistance"]
        c = self.unbalance * np.cos(phi)
        p = self.unbalance * w * w * np.sin(phi) - s["box_damping"] * v - s["box_stiffness"] * y + p1 + p2
        determinant = s["box_mass"] * s["rotor_inertia"] - c * c
        a = (s["rotor_inertia"] * p - c * torque) / determinant
        turn = (s["box_mass"] * torque - c * p) / determinant
        if together:
            a1 = a2 = -(p1 + p2) / (o["m1"] + o["m2"]) - a
        else:
            a1, a2 = -p1 / o["m1"] - a, -p2 / o["m2"] - a
        return np.array([v1, a1, v2, a2, v, a, w, turn])

    def parting(self, state):
        """Acceleration of the gap that the masses would have, each free: negative where they are pressed together."""
        p1, p2 = self.pulls(state)
        return p1 / self.o["m1"] - p2 / self.o["m2"]

    def strike(self, state):
        """State after an impact, and whether the masses stick."""
        o, (x1, v1, x2, v2) = self.o, state[:4]
        common, closing, after = (o["m1"] * v1 + o["m2"] * v2) / (o["m1"] + o["m2"]), v1 - v2, list(state)
        x = (o["m1"] * x1 + o["m2"] * x2) / (o["m1"] + o["m2"])
        rebound = o["e"] * closing
        after[0] = after[2] = x
        after[1] = after[3] = common
        pressed = self.parting(after)
        sticks = pressed < 0.0 and 2.0 * rebound < o["gamma"] * np.sqrt(o["m1"] / o["k1"]) * -pressed
        if not sticks:
            after[1], after[3] = common - rebound * o["m2"] / (o["m1"] + o["m2"]), common + rebound * o["m1"] / (o["m1"] + o["m2"])
        return np.array(after), sticks

    def solve(self, state, times):
        """States at ``times``, from ``state`` at the first of them, in flight or (gap 0) in contact; and the number of impacts."""
        together, impacts, now = state[2] == state[0], 0, times[0]
        rows, state = [np.array(state)], np.array(state)
        while now < times[-1]:
            event = (lambda t, z: self.parting(z)) if together else (lambda t, z: z[2] - z[0])
            event.terminal, event.direction = True, 1.0 if together else -1.0
            wanted = times[times > now]
            found = solve_ivp(lambda t, z, c=together: self.rates(z, c), (now, times[-1]), state, t_eval=wanted, events=event, **TOLERANCE)
            rows += list(found.y.T)
            if not found.t_events[0].size:
                break
            now, state = found.t_events[0][0], found.y_events[0][0]
            if together:
                together, state = False, state.copy()
                state[2] += 1e-15
            else:
                impacts += 1
                state, together = self.strike(state)
        return np.array(rows), impacts
