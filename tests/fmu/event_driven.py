"""The motion with a clearance by an ODE solver with event location, written without the kernel.

SI units, displacements from the unloaded springs. Phases of flight and of permanent contact are
integrated one after the other (DOP853). Flights from no gap are begun without event location, which
would find the start itself, and in short steps, so that their ends are not stepped over.
"""

import numpy as np
from scipy.integrate import solve_ivp

FLIGHT, CONTACT = "flight", "contact"
TOLERANCE = 1e-12


class Motion:
    """One motion, from rest or from start values, impact by impact.

    ``state`` is x1, v1, x2, v2 at ``time``, ``mode`` FLIGHT or CONTACT; ``impacts`` are times,
    ``sticks`` whether contact follows, ``releases`` the number of its ends.
    """

    def __init__(self, values, acceleration=None):
        self.p = p = {
            "clearance": 0.0,
            "phase_start": 0.0,
            "v1_start": 0.0,
            "v2_start": 0.0,
            **values,
        }
        self.acceleration = acceleration or (lambda _: 0.0)  # of the box, beside the harmonic one
        self.own = max(np.sqrt(p["k1"] / p["m1"]), np.sqrt(p["k2"] / p["m2"]))
        self.total = p["m1"] + p["m2"]
        preload = max(0.0, -p["clearance"]) * p["k1"] * p["k2"] / (p["k1"] + p["k2"])
        x1, x2 = p["x1_start"] - preload / p["k1"], p["x2_start"] + preload / p["k2"]
        self.state = np.array([x1, p["v1_start"], x2, p["v2_start"]])
        self.size = np.abs(self.state).max() + p["box_amplitude"] + abs(p["clearance"])
        fastest = max(p["box_frequency"], self.own)
        self.time, self.impacts, self.longest = 0.0, [], 0.2 / fastest
        self.releases, self.sticks = 0, []
        self.step = self.longest
        closed = self.gap(0.0, self.state) <= 1e-14 * self.size
        pressed = closed and p["v1_start"] == p["v2_start"] and self.opening(x1, p["v1_start"]) < 0
        self.mode, self.hop = (CONTACT, 0.0) if pressed else (FLIGHT, 0.0)

    def gap(self, _, y):
        return y[2] - y[0] + self.p["clearance"]

    def accelerations(self, y):
        """In space, of each mass alone."""
        p = self.p
        return -(p["k1"] * y[0] + p["d1"] * y[1]) / p["m1"], -(p["k2"] * y[2] + p["d2"] * y[3]) / p[
            "m2"
        ]

    def opening(self, x1, v):
        """Acceleration of the gap if the masses were free, together with mass 1 at x1."""
        one, two = self.accelerations((x1, v, x1 - self.p["clearance"], v))
        return two - one

    def drive(self, t):
        p = self.p
        phase = p["box_frequency"] * t + p["phase_start"]
        harmonic = p["box_amplitude"] * p["box_frequency"] ** 2 * np.sin(phase)
        return harmonic - self.acceleration(t)

    def flight(self, t, y):
        one, two = self.accelerations(y)
        return y[1], self.drive(t) + one, y[3], self.drive(t) + two

    def contact(self, t, y):
        one, two = self.accelerations((y[0], y[1], y[0] - self.p["clearance"], y[1]))
        both = self.drive(t) + (self.p["m1"] * one + self.p["m2"] * two) / self.total
        return y[1], both, y[1], both

    def integrate(self, field, stop, **more):
        """On to ``stop`` or to an event; whether there was one."""
        done = solve_ivp(
            *(field, (self.time, stop), self.state, "DOP853"),
            **{"rtol": TOLERANCE, "atol": 1e-2 * TOLERANCE * self.size, **more},
        )
        self.time, self.state = done.t[-1], done.y[:, -1]
        return done.status == 1

    def run(self, stop):
        """On to a time."""
        while self.time < stop:
            if self.mode == CONTACT:
                step = 0.1 * self.longest  # the force may be above zero for a short time
                if self.integrate(self.contact, stop, events=self.release, max_step=step):
                    self.mode, self.hop = FLIGHT, 0.02 * self.longest
                    self.releases += 1
                continue
            if self.hop:
                self.step = min(0.25 * self.hop, self.longest)
                self.integrate(self.flight, min(stop, self.time + self.step))
                self.hop = 0.0
                continue
            leg = min(stop, self.time + 8.0 * self.step)
            if self.integrate(self.flight, leg, events=self.touch, max_step=self.step):
                self.strike()
            self.step = min(2.0 * self.step, self.longest)
        return self

    def touch(self, t, y):
        return self.gap(t, y)

    touch.terminal, touch.direction = True, -1

    def release(self, _, y):
        return self.opening(y[0], y[1])

    release.terminal, release.direction = True, 1

    def strike(self):
        """Newton's restitution, and the end of chattering."""
        p, (x1, v1, x2, v2) = self.p, self.state
        face = (p["m1"] * x1 + p["m2"] * (x2 + p["clearance"])) / self.total
        common = (p["m1"] * v1 + p["m2"] * v2) / self.total
        closing, pull = v1 - v2, self.opening(face, common)
        parting = p["e"] * closing / (1.0 + p.get("e_slope", 0.0) * closing)
        self.impacts.append(self.time)
        self.sticks.append(False)
        left = p["gamma"] / self.own  # s: all flights that are left
        if pull < 0.0 and 2.0 * parting < left * (1.0 - p["e"]) * -pull:
            self.mode, parting, self.sticks[-1] = CONTACT, 0.0, True
        else:
            self.hop = 2.0 * parting / -pull if pull < 0.0 else 4.0 * self.longest
        after = common - p["m2"] / self.total * parting, common + p["m1"] / self.total * parting
        self.state = np.array([face, after[0], face - p["clearance"], after[1]])
