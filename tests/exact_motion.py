"""Solve the two oscillators in 50 digits, as sums of exponentials, to check the kernel.

Nothing here comes from the kernel: no omega, no mu, no branches of damping. Newton's law of each
mass, its characteristic roots, and mpmath.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import mpmath as mp
import numpy as np
from numpy.typing import NDArray

mp.mp.dps = 50

# Of the sum of a motion's terms: what rounding may take in the kernel. A pair is rotated 32 times
# at most before it is made anew, each time with two products, a sum and a constant that is rounded
# itself; a few more for the sum.
ROUNDING = 1.5e-14
LARGE = 1e5  # amplitudes that are the difference of others, at a resonance
BESIDE = mp.mpf("1e-24")  # a drive is that far from any resonance: wrong by as much times the age


class Signal:
    """Function of time ``Re sum c_k e^{s_k t} + sum p_k t^k / k!``."""

    def __init__(self, terms: Sequence[tuple[Any, Any]], polynomial: Sequence[Any]) -> None:
        self.terms, self.polynomial = terms, polynomial
        self._coarse = [(complex(c), complex(s)) for c, s in terms], [float(p) for p in polynomial]

    def __sub__(self, other: Signal) -> Signal:
        return self + -1 * other

    def __add__(self, other: Signal) -> Signal:
        pairs = zip(self.polynomial, other.polynomial, strict=True)
        return Signal(self.terms + other.terms, [a + b for a, b in pairs])

    def __rmul__(self, factor: Any) -> Signal:
        terms = [(factor * c, s) for c, s in self.terms]
        return Signal(terms, [factor * p for p in self.polynomial])

    def derivative(self) -> Signal:
        return Signal([(c * s, s) for c, s in self.terms], [*self.polynomial[1:], mp.mpf(0)])

    def __call__(self, t: Any) -> Any:
        t = mp.mpf(t)
        swinging = mp.re(sum(c * mp.exp(s * t) for c, s in self.terms))
        return swinging + taylor_polynomial(self.polynomial, t)

    def sample(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return values on an array of times in double precision; exactly where terms cancel."""
        terms, polynomial = self._coarse
        if max(abs(c) for c, _ in terms) > LARGE:
            return np.array([float(self(x)) for x in t])
        return sum((c * np.exp(s * t)).real for c, s in terms) + taylor_polynomial(polynomial, t)

    def fastest_rate(self) -> float:
        return max([abs(s) for _, s in self._coarse[0]] + [1e-3])


def taylor_polynomial(derivatives: Sequence[Any], t: Any) -> Any:
    """Return the value at t of a polynomial given by its derivatives at 0."""
    value: Any = 0
    for k in range(len(derivatives), 0, -1):
        value = derivatives[k - 1] + value * t / k
    return value


def box_acceleration(values: Mapping[str, float], phase: Any) -> Signal:
    a = mp.mpf(values.get("box_amplitude", 1.0))
    frequency = mp.mpf(values.get("box_frequency", 0.0))
    names = ("acceleration", "jerk", "snap", "crackle")
    cubic = [mp.mpf(values.get(f"box_{name}", 0.0)) for name in names]
    # -a Omega^2 sin
    return Signal([(mp.mpc(0, 1) * a * frequency**2 * mp.expj(phase), mp.mpc(0, frequency))], cubic)


def force(values: Mapping[str, float], half: int, phase: Any) -> Signal:
    """Return the force on a mass as a ``Signal``, from the FMU's inputs and a phase, rad."""
    name = f"force{half}"
    amplitude = mp.mpf(values.get(f"{name}_amplitude", 0.0))
    cubic = [mp.mpf(values.get(one, 0.0)) for one in (name, *(f"{name}_{k}" for k in (1, 2, 3)))]
    frequency = mp.mpc(0, mp.mpf(values.get("box_frequency", 0.0)))
    return Signal([(mp.mpc(0, -1) * amplitude * mp.expj(phase), frequency)], cubic)


def felt(values: Mapping[str, float], phase: Any, *halves: int) -> Signal:
    """Return the acceleration of a box that would drive one mass, or both together, as the box and
    the forces do.
    """
    felt = box_acceleration(values, phase)
    mass = sum(mp.mpf(values[f"m{half}"]) for half in halves)
    for half in halves:
        felt = felt - 1 / mass * force(values, half, phase)
    return felt


def avoid_resonance(s: Any, damping: Any, stiffness: Any) -> Any:
    """Return an exponent, moved by 1e-24 if the oscillator has just this one."""
    at_resonance = abs(s * s + damping * s + stiffness) < BESIDE * stiffness
    return s * (1 + BESIDE) if at_resonance else s


def oscillator_motion(
    mass: Any, damping: Any, stiffness: Any, x: Any, v: Any, acceleration: Signal
) -> Signal:
    """Return an oscillator's displacement in the box as a ``Signal``, from x and v at 0."""
    mass, damping, stiffness = mp.mpf(mass), mp.mpf(damping), mp.mpf(stiffness)
    d, k = damping / mass, stiffness / mass
    exponents = [(c, avoid_resonance(s, d, k)) for c, s in acceleration.terms]
    forced = [(-c / (s * s + d * s + k), s) for c, s in exponents]
    cubic = [mp.mpf(0)] * 4
    # mass q'' + damping q' + stiffness q = -mass p: exact after four rounds, p being a cubic
    for _ in range(4):
        first, second = [*cubic[1:], 0], [*cubic[2:], 0, 0]
        rows = zip(acceleration.polynomial, first, second, strict=True)
        cubic = [(-mass * p - damping * q1 - mass * q2) / stiffness for p, q1, q2 in rows]
    part = Signal(forced, cubic)
    half = damping / (2 * mass)
    split = mp.sqrt(mp.mpc(half * half - stiffness / mass))
    if split == 0:
        split = mp.mpf(10) ** (-mp.mp.dps // 3)  # critical damping as a limit: wrong by its square
    fast, slow = -half - split, -half + split
    c, w = x - part(0), v - part.derivative()(0)
    free = [((w - fast * c) / (slow - fast), slow), ((slow * c - w) / (slow - fast), fast)]
    return Signal(forced + free, cubic)


def free_motion(
    values: Mapping[str, float], state: Sequence[Any], phase: Any
) -> tuple[Signal, Signal]:
    """Return both masses' displacements in flight, from a state (x1, v1, x2, v2)."""
    x1, v1, x2, v2 = (mp.mpf(value) for value in state)
    one, two = felt(values, phase, 1), felt(values, phase, 2)
    first = oscillator_motion(values["m1"], values["d1"], values["k1"], x1, v1, one)
    if values.get("wall"):
        return first, Signal([], [mp.mpf(0)] * 4)
    return first, oscillator_motion(values["m2"], values["d2"], values["k2"], x2, v2, two)


def gap_signal(values: Mapping[str, float], first: Signal, second: Signal) -> Signal:
    constant = [mp.mpf(values.get("clearance", 0.0)), 0, 0, 0]
    return second - first + Signal([], constant)


def contact_motion(
    values: Mapping[str, float], x: Any, v: Any, phase: Any
) -> tuple[Signal, Signal]:
    """Return mass 1's motion in contact, and the force with which it pushes mass 2."""
    # with a clearance the spring of mass 2 is loaded: that moves the position both swing around
    m1, d1, k1 = (mp.mpf(values[name]) for name in ("m1", "d1", "k1"))
    load = mp.mpf(values["k2"]) * mp.mpf(values.get("clearance", 0.0)) / (k1 + values["k2"])
    if values.get("wall"):
        common = Signal([], [mp.mpf(values.get("clearance", 0.0)), 0, 0, 0])
    else:
        both = felt(values, phase, 1, 2)
        common = oscillator_motion(
            *(m1 + values["m2"], d1 + values["d2"], k1 + values["k2"], mp.mpf(x) - load),
            *(mp.mpf(v), both),
        ) + Signal([], [load, 0, 0, 0])
    speed = common.derivative()
    inertia = m1 * (speed.derivative() + felt(values, phase, 1))
    return common, -1 * (inertia + d1 * speed + k1 * common)


def refine_root(signal: Signal, low: Any, high: Any) -> Any:
    return mp.findroot(signal, (mp.mpf(low), mp.mpf(high)), solver="anderson", verify=False)


def first_root(signal: Signal, stop: float, start: float = 0.0) -> Any | None:
    """Return a signal's first root in ``start < t <= stop``; None without one."""
    spacing = 0.02 / signal.fastest_rate()
    fine = start + np.geomspace(1e-8, 1.0, 60) * min(spacing, stop - start)
    t = np.concatenate([fine, np.arange(fine[-1] + spacing, stop, spacing), [stop]])
    h = signal.sample(t)
    slope = signal.derivative()
    near = 1e-3 * np.abs(h).max()
    for i in range(1, len(t)):
        if h[i] <= 0.0:
            return refine_root(signal, t[i - 1], t[i])
        if i + 1 < len(t) and h[i] <= min(h[i - 1], h[i + 1]) and h[i] < near:
            bottom = refine_root(slope, t[i - 1], t[i + 1])
            if signal(bottom) < 0:
                return refine_root(signal, t[i - 1], bottom)
    return None
