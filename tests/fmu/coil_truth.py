"""The electrodynamic shaker's equations written once more, and solved by scipy from event to event.

What the amplifier does is written as a rule of the instant: of the state, the command and the sides
of the limits that act. Nothing is shared with the kernel.
"""

import numpy as np
from scipy.integrate import solve_ivp

from fmu_src.models.electrodynamic_shaker.variables import VARIABLES

DEFAULTS = {v.name: float(v.start) for v in VARIABLES if not v.calculated}
STATES = ("box_position", "box_velocity", "current", "energy")


def polynomial(p, name, t):
    a, b, c, d = (p[key] for key in (name, *(f"{name}_{i}" for i in (1, 2, 3))))
    return a + t * (b + t * (c / 2 + t * d / 6)), b + t * (c + t * d / 2)


class Shaker:
    """The shaker with its amplifier: state x, v, i, amplifier's work, heat, loss, force's work."""

    def __init__(self, **values):
        self.p = {**DEFAULTS, **values}
        self.current_control = bool(self.p["current_control"])
        names = ("voltage_limit", "current_limit")
        limits = [self.p[name] or np.inf for name in names]  # 0: none
        self.limit, self.other_limit = limits[::-1] if self.current_control else limits
        self.clipped, self.held = 0, 0

    def source(self, t):
        if self.clipped:
            return self.clipped * self.limit, 0.0
        return polynomial(self.p, "command", t)

    def electric(self, t, state):
        p, (_, v, i, *_) = self.p, state
        R, L, Bl = p["coil_resistance"], p["coil_inductance"], p["force_factor"]
        (source, slope), held = self.source(t), self.held * self.other_limit if self.held else 0.0
        if self.current_control != bool(self.held):
            i, rate = (held, 0.0) if self.held else (source, slope)
            return i, rate, R * i + L * rate + Bl * v
        u = held if self.held else source
        if L:
            return i, (u - R * i - Bl * v) / L, u
        return (u - Bl * v) / R, 0.0, u

    def acceleration(self, t, state):
        p, (x, v, *_) = self.p, state
        force = p["force_factor"] * self.electric(t, state)[0] + polynomial(p, "box_force", t)[0]
        force -= p["suspension_damping"] * v + p["suspension_stiffness"] * x
        return force / p["table_mass"]

    def right_hand_side(self, t, state):
        p, v = self.p, state[1]
        i, rate, u = self.electric(t, state)
        heat, loss = p["coil_resistance"] * i * i, p["suspension_damping"] * v * v
        work = polynomial(p, "box_force", t)[0] * v
        return [v, self.acceleration(t, state), rate, u * i, heat, loss, work]

    def excess(self, t, state):
        """What holding leaves of the source: beyond 0 on the side that is held."""
        p, (_, v, i, *_) = self.p, state
        R, L, Bl = p["coil_resistance"], p["coil_inductance"], p["force_factor"]
        source, slope = self.source(t)
        if self.current_control:  # what following takes, over the voltage limit
            return source - i if L else R * source + Bl * v - self.held * self.other_limit
        return source - R * self.held * self.other_limit - Bl * v

    def other(self, t, state):
        i, _, u = self.electric(t, state)
        return u if self.current_control else i

    def events(self):
        """Functions of which one is zero where a limit begins or ends to act."""
        found, other, both = [], self.other_limit, (1, -1)
        if np.isfinite(self.limit):
            clip = lambda k: lambda t, _: k * self.command(t) - self.limit  # noqa: E731
            found += [("command", k, clip(k)) for k in ((self.clipped,) if self.clipped else both)]
        if np.isfinite(other) and self.held:
            found.append(("held", self.held, lambda t, s: self.held * self.excess(t, s)))
        elif np.isfinite(other):
            reach = lambda k: lambda t, s: k * self.other(t, s) - other  # noqa: E731
            found += [("free", k, reach(k)) for k in both]
        return found

    def command(self, t):
        return polynomial(self.p, "command", t)[0]

    def begin(self, t, state):
        """Decide what acts from a start, or from a jump of the command, on."""
        command = self.command(t)
        self.clipped = int(np.sign(command)) if abs(command) > self.limit else 0
        self.hold(t, state)
        if self.current_control and not np.isfinite(self.other_limit):  # it jumps from zero
            state[3] += 0.5 * self.p["coil_inductance"] * self.source(t)[0] ** 2

    def hold(self, t, state):
        self.held, L = 0, self.p["coil_inductance"]
        if not np.isfinite(self.other_limit):
            return
        if self.current_control and L and state[2] != self.source(t)[0]:
            self.held = int(np.sign(self.source(t)[0] - state[2]))
            return
        if self.current_control or not L or abs(state[2]) >= self.other_limit:
            other = self.other(t, state)
            if abs(other) >= self.other_limit:
                self.held = int(np.sign(other))
                if self.held * self.excess(t, state) < 0:
                    self.held = 0

    def run(self, state, start, stop):
        """State at ``stop``; how often what acts changed is in ``changes``."""
        state, t, self.changes = np.array(state, float), start, 0
        while t < stop:
            events = self.events()
            for kind, _, event in events:
                rising = kind == "free" or (kind == "command" and not self.clipped)
                event.terminal, event.direction = True, 1 if rising else -1
            asked = {"events": [event for *_, event in events], "rtol": 1e-13, "atol": 1e-15}
            found = solve_ivp(self.right_hand_side, (t, stop), state, "DOP853", **asked)
            t, state = found.t[-1], found.y[:, -1].copy()
            if found.status == 1:
                self.changes += 1
                kind, side, _ = events[[bool(len(times)) for times in found.t_events].index(True)]
                self.change(kind, side, t, state)
        return state

    def change(self, kind, side, t, state):
        L = self.p["coil_inductance"]
        if kind == "free":
            self.held = side
            if L and not self.current_control:
                state[2] = side * self.other_limit
            return
        if kind == "held":
            self.held = 0
            if self.current_control and L:
                state[2] = self.source(t)[0]
                if abs(self.other(t, state)) > self.other_limit:
                    self.held = int(np.sign(self.other(t, state)))
            return
        follows = self.current_control and not self.held
        self.clipped = 0 if self.clipped else side
        if follows:
            state[2] = self.source(t)[0]
        if follows or not self.current_control:
            self.hold(t, state)
