"""The motion with a clearance by an ODE solver with event location, written without the kernel.

SI units, displacements from the unloaded springs; inputs may change on the way. Phases of flight
and of permanent contact are integrated one after the other (DOP853). Flights from no gap are begun
without event location, which would find the start itself, and in short steps, so that their ends
are not stepped over.
"""

import numpy as np
from scipy.integrate import solve_ivp

FLIGHT, CONTACT = "flight", "contact"
CUBICS = {
    "box": ("box_acceleration", "box_jerk", "box_snap", "box_crackle"),
    **{half: (f"force{half}", *(f"force{half}_{k}" for k in (1, 2, 3))) for half in (1, 2)},
}
ZERO = (  # unless given
    *(name for names in CUBICS.values() for name in names),
    *("clearance", "stroke", "phase_start", "x1_start", "x2_start", "v1_start", "v2_start"),
    *("box_amplitude", "box_frequency", "force1_amplitude", "force2_amplitude"),
)
TOLERANCE = 1e-12


class Motion:
    """One motion, from rest or from start values, impact by impact.

    ``state`` is x1, v1, x2, v2 at ``time``, ``mode`` FLIGHT or CONTACT; ``impacts`` are times,
    ``sticks`` whether contact follows, ``releases`` the number of its ends.
    """

    def __init__(self, values, acceleration=None):
        self.p = p = {**dict.fromkeys(ZERO, 0.0), "wall": False, **values}
        self.since = dict.fromkeys(CUBICS, 0.0)  # when each cubic began
        self.read_drives()
        self.phase, self.begun = p["phase_start"], 0.0  # of the harmonics, at that time
        self.share = (0.0, 1.0) if p["wall"] else (p["m1"], p["m2"])  # in what is common
        self.acceleration = acceleration or (lambda _: 0.0)  # of the box, beside the harmonic one
        other = 0.0 if p["wall"] else p["k2"] / p["m2"]
        self.own = np.sqrt(max(p["k1"] / p["m1"], other))
        self.total = sum(self.share)
        softness = 1.0 / p["k1"], 0.0 if p["wall"] else 1.0 / p["k2"]
        preload = max(0.0, -p["clearance"]) / sum(softness)
        x1, x2 = p["x1_start"] - preload * softness[0], p["x2_start"] + preload * softness[1]
        self.state = np.array([x1, p["v1_start"], x2, p["v2_start"]])
        pushes = p["force1_amplitude"], p["force2_amplitude"], p["force1"], p["force2"]
        self.size = np.abs(self.state).max() + abs(p["box_amplitude"]) + abs(p["clearance"])
        self.size = self.size + max(map(abs, pushes)) / p["k1"] or 1.0
        fastest = max(p["box_frequency"], self.own)
        self.time, self.impacts, self.longest = 0.0, [], 0.2 / fastest
        self.releases, self.sticks = 0, []
        self.step = self.longest
        self.stroke = p["stroke"] or np.inf
        gap, v1, v2 = self.gap(0.0, self.state), p["v1_start"], p["v2_start"]
        self.side = 1 if gap < 0.5 * self.stroke else -1  # of the impact or contact, -1 outside
        closed = min(gap, self.stroke - gap) <= 1e-14 * self.size
        self.mode, self.hop = FLIGHT, 0.0
        if closed and v1 == v2:
            self.part_or_stay()

    def gap(self, _, y):
        return y[2] - y[0] + self.p["clearance"]

    def set(self, **values):
        """Change inputs now: a cubic begins; whether the masses stay together is decided again."""
        p = self.p
        self.phase += p["box_frequency"] * (self.time - self.begun)
        self.begun = self.time
        for kind, names in CUBICS.items():
            if any(name in values for name in names):
                self.since[kind] = self.time
        p |= values
        self.read_drives()
        if self.mode == CONTACT:
            self.releases += self.part_or_stay()
        return self

    def read_drives(self):
        p = self.p
        self.cubics = {kind: [p[name] for name in names] for kind, names in CUBICS.items()}
        self.amplitudes = {half: p[f"force{half}_amplitude"] for half in (1, 2)}
        self.shaking = p["box_amplitude"] * p["box_frequency"] ** 2

    def part_or_stay(self):
        """Touching with one velocity: whether the masses part, now or a moment later."""
        soon, pull = 0.02 * self.longest, self.opening(self.time, *self.state[:2])
        if abs(pull) <= 1e-14 * self.own**2 * self.size:
            ends = self.time, self.time + soon
            tight = {"rtol": TOLERANCE, "atol": 1e-20 * self.size}
            after = solve_ivp(self.contact, ends, self.state, "DOP853", **tight).y[:, -1]
            pull = self.opening(ends[1], *after[:2])
        self.mode, self.hop = (FLIGHT, soon) if pull > 0.0 else (CONTACT, 0.0)
        return pull > 0.0

    def harmonic(self, t):
        return np.sin(self.phase + self.p["box_frequency"] * (t - self.begun))

    def cubic(self, kind, t):
        s = t - self.since[kind]
        c0, c1, c2, c3 = self.cubics[kind]
        return c0 + s * (c1 + s * (c2 / 2.0 + s * c3 / 6.0))

    def box(self, t):
        return self.acceleration(t) + self.cubic("box", t) - self.shaking * self.harmonic(t)

    def force(self, half, t):
        return self.amplitudes[half] * self.harmonic(t) + self.cubic(half, t)

    def accelerations(self, t, y):
        """Of each mass alone, relative to the box; a wall has none."""
        p, box = self.p, self.box(t)
        one = (self.force(1, t) - p["k1"] * y[0] - p["d1"] * y[1]) / p["m1"] - box
        if p["wall"]:
            return one, 0.0
        return one, (self.force(2, t) - p["k2"] * y[2] - p["d2"] * y[3]) / p["m2"] - box

    @property
    def apart(self):
        """Displacement of mass 2 less that of mass 1 where they touch."""
        return (0.0 if self.side > 0 else self.stroke) - self.p["clearance"]

    def opening(self, t, x1, v):
        """Acceleration with which the masses would part if they were free, mass 1 at x1."""
        one, two = self.accelerations(t, (x1, v, x1 + self.apart, v))
        return self.side * (two - one)

    def flight(self, t, y):
        one, two = self.accelerations(t, y)
        return y[1], one, y[3], two

    def contact(self, t, y):
        one, two = self.accelerations(t, (y[0], y[1], y[0] + self.apart, y[1]))
        both = (self.share[0] * one + self.share[1] * two) / self.total
        return y[1], both, y[1], both

    def integrate(self, field, stop, **more):
        """On to ``stop`` or to an event; whether there was one."""
        more = {"rtol": TOLERANCE, "atol": 1e-2 * TOLERANCE * self.size, **more}
        done = solve_ivp(field, (self.time, stop), self.state, "DOP853", **more)
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
            ends = [self.touch, self.touch_outside][: 1 + (self.stroke < np.inf)]
            if self.integrate(self.flight, leg, events=ends, max_step=self.step):
                self.side = 1 if self.gap(0.0, self.state) < 0.5 * self.stroke else -1
                self.strike()
            self.step = min(2.0 * self.step, self.longest)
        return self

    def touch(self, t, y):
        return self.gap(t, y)

    touch.terminal, touch.direction = True, -1

    def touch_outside(self, t, y):
        return self.stroke - self.gap(t, y)

    touch_outside.terminal, touch_outside.direction = True, -1

    def release(self, t, y):
        return self.opening(t, y[0], y[1])

    release.terminal, release.direction = True, 1

    def strike(self):
        p, (x1, v1, x2, v2) = self.p, self.state
        one, two = self.share
        face = (one * x1 + two * (x2 - self.apart)) / self.total
        common = (one * v1 + two * v2) / self.total
        closing, pull = self.side * (v1 - v2), self.opening(self.time, face, common)
        parting = p["e"] * closing / (1.0 + p.get("e_slope", 0.0) * closing)
        self.impacts.append(self.time)
        self.sticks.append(False)
        left = p["gamma"] / self.own  # s: all flights that are left
        if pull < 0.0 and 2.0 * parting < left * (1.0 - p["e"]) * -pull:
            self.mode, parting, self.sticks[-1] = CONTACT, 0.0, True
        else:
            self.hop = 2.0 * parting / -pull if pull < 0.0 else 4.0 * self.longest
            self.hop = min(self.hop, self.stroke / parting) if parting else self.hop
        parting *= self.side
        after = common - two / self.total * parting, common + one / self.total * parting
        self.state = np.array([face, after[0], face + self.apart, after[1]])
