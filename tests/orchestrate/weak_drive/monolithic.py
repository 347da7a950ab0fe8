"""Structure, box and motor as one system of equations, solved by scipy with events.

This is what the co-simulation has to agree with. A state is x1, v1, x2, v2, y, y', phi, phi' and
the motor's current. With a clearance, x1 and x2 count from the unloaded springs; inside,
the second mass is moved by the clearance, so that the gap is their difference.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

TOLERANCE = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13}
ROUNDING = 4e-16  # of displacements: a gap that is no more is none


class Monolith:
    """The whole system; a voltage or one at a time in s, and the tolerances of ``solve_ivp``."""

    def __init__(self, structure, drive, voltage, tolerance=None):
        self.o, self.s, self.tolerance = structure, drive, tolerance or TOLERANCE
        self.voltage = voltage if callable(voltage) else lambda time: voltage
        self.unbalance = drive.unbalance_mass * drive.unbalance_radius
        self.clearance = 0.0 if structure.bonded else structure.clearance

    def pulls(self, state):
        x1, v1, x2, v2 = state[:4]
        o = self.o
        return o.k1 * x1 + o.d1 * v1, o.k2 * (x2 - self.clearance) + o.d2 * v2

    def electric(self, w, i, time):
        """Torque of the motor, and the rate of its current."""
        s = self.s
        drop = self.voltage(time) - s.motor_constant * w
        if s.armature_inductance > 0.0:
            rate = (drop - s.armature_resistance * i) / s.armature_inductance
            return s.motor_constant * i, rate
        return s.motor_constant * drop / s.armature_resistance, 0.0

    def rates(self, state, together, time=0.0):
        state = np.asarray(state).tolist()  # plain floats take half the time
        _, v1, _, v2, y, v, phi, w, i = state
        s, o = self.s, self.o
        p1, p2 = self.pulls(state)
        torque, current_rate = self.electric(w, i, time)
        c = self.unbalance * math.cos(phi)
        p = self.unbalance * w * w * math.sin(phi) - s.box_damping * v - s.box_stiffness * y
        p += p1 + p2
        determinant = s.box_mass * s.rotor_inertia - c * c
        a = (s.rotor_inertia * p - c * torque) / determinant
        turn = (s.box_mass * torque - c * p) / determinant
        if together:
            a1 = a2 = -(p1 + p2) / (o.m1 + o.m2) - a
        else:
            a1, a2 = -p1 / o.m1 - a, -p2 / o.m2 - a
        return [v1, a1, v2, a2, v, a, w, turn, current_rate]

    def parting(self, state):
        """Acceleration of the gap, were the masses free: negative where they are pressed."""
        p1, p2 = self.pulls(state)
        return p1 / self.o.m1 - p2 / self.o.m2

    def strike(self, state):
        """State after an impact, and whether the masses stick."""
        o, (x1, v1, x2, v2), after = self.o, state[:4], list(state)
        both = o.m1 + o.m2
        common = (o.m1 * v1 + o.m2 * v2) / both
        rebound = o.e * (v1 - v2) / (1.0 + o.e_slope * (v1 - v2))
        after[0] = after[2] = (o.m1 * x1 + o.m2 * x2) / both
        after[1] = after[3] = common
        pressed = self.parting(after)
        left = o.gamma / np.sqrt(max(o.k1 / o.m1, o.k2 / o.m2))
        sticks = pressed < 0.0 and 2.0 * rebound < left * (1.0 - o.e) * -pressed
        if not sticks:
            after[1] = common - rebound * o.m2 / both
            after[3] = common + rebound * o.m1 / both
        return np.array(after), sticks

    def solve(self, state, times):
        """States at ``times`` from ``state`` at the first of them, and the number of impacts."""
        rows, state = [np.array(state)], np.array(state)
        state[2] += self.clearance
        if abs(state[2] - state[0]) <= ROUNDING * (abs(state[0]) + abs(self.clearance)):
            state[2] = state[0]
        together, impacts, now = self.o.bonded or state[2] == state[0], 0, times[0]
        while now < times[-1]:
            found = self.phase(now, state, times, together)
            part = np.reshape(found.y, (len(state), -1)).T
            rows += list(part - self.clearance * (np.arange(len(state)) == 2))
            if not (found.t_events and found.t_events[0].size):
                break
            now, state = found.t_events[0][0], found.y_events[0][0]
            if together:
                together, state = False, state.copy()
            else:
                impacts += 1
                state, together = self.strike(state)
            if not together:  # else a flight within one step of the solver ends where it begins
                state[2] += 8.0 * ROUNDING * (1.0 + abs(state[2]))
        return np.array(rows), impacts

    def bonded_run(self, law, h, count):
        """Speeds and voltages from rest by Runge and Kutta; ``law`` of time and speed gives the
        voltage, which is held over each step of two parts.
        """
        y, speeds, voltages, h = np.zeros(9), [], [], 0.5 * h
        for i in range(2 * count):
            if i % 2 == 0:
                voltages.append(law(i * h, y[7]))
                self.voltage = lambda _: voltages[-1]
            a = np.array(self.rates(y, True))
            b = np.array(self.rates(y + 0.5 * h * a, True))
            c = np.array(self.rates(y + 0.5 * h * b, True))
            y = y + h / 6.0 * (a + 2.0 * (b + c) + self.rates(y + h * c, True))
            speeds.append(y[7])
        return np.array(speeds[1::2]), np.array(voltages)

    def phase(self, now, state, times, together):
        def end(t, z):
            return self.parting(z) if together else z[2] - z[0]

        end.terminal, end.direction = True, 1.0 if together else -1.0
        asked = {"t_eval": times[times > now], "events": None if self.o.bonded else end}
        rates = lambda t, z: self.rates(z, together, t)  # noqa: E731
        return solve_ivp(rates, (now, times[-1]), state, **asked, **self.tolerance)
