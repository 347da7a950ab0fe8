"""A co-simulation master for two FMUs: the structure in its box, and the motor that shakes the box.

The structure's ``box_force`` R depends on its states only, the box's acceleration on R: there is no algebraic loop, but what each side
assumes of the other over a step decides everything. ``ALGORITHMS`` has the schemes by name:

=====================  ===================================================================================================
jacobi                 both at once, each with the other's last value: what tools do by default. Negative damping.
jacobi-derivative      both at once, with the last value and derivative
gauss-seidel           oscillator first with a quadratic extrapolation, shaker with a cubic of the true mean and moment
rollback               as gauss-seidel, then back to the step's beginning and once more with the acceleration found (default)
iterated               the same until nothing changes: the reference
=====================  ===================================================================================================

The cubic has the ends, the mean and the first moment that ``box_impulse`` and ``box_impulse_moment`` give: exact on average through
impacts too, where R jumps. With ``matched=False`` it is a parabola through communication points instead, as schemes that only know values have.
"""

import math
from dataclasses import dataclass

from .channel import Channel
from .errors import UserError
from .exchange import (
    E_FORCE,
    E_MOTOR,
    IMPULSE,
    JERK,
    MOMENT,
    OSCILLATOR_INPUTS,
    OSCILLATOR_OUTPUTS,
    SHAKER_INPUTS,
    SHAKER_OUTPUTS,
    A,
    R,
    V,
    Y,
)
from .ledger import Ledger
from .polynomials import end_slope, matched_cubic, parabola, work

MOST_ITERATIONS = 40
SHORTEST = 1e-3  # of the scheme's step: shorter ones are not halved
CONVERGED = 1e-14  # change of the force between two iterations, over its size
BEGIN = (1, 1, 2, 4, 8)  # parts of the first step in sixteenths, of schemes that cannot iterate: nothing is known yet to extrapolate from
PASSES = {"gauss-seidel": 1, "rollback": 2, "iterated": MOST_ITERATIONS}
ALGORITHMS = ("jacobi", "jacobi-derivative", *PASSES)


@dataclass(frozen=True)
class Scheme:
    """How a step is done.

    Attributes
    ----------
    algorithm : str
        Of ``ALGORITHMS``.
    h : float
        Communication step, s.
    matched : bool
        Exchange forces and accelerations that are exact on average; else through points only.
    tolerance : float
        Halve steps whose defect is larger than this part of the work exchanged in them; 0: never. Needs a scheme that goes back.
    """

    algorithm: str = "rollback"
    h: float = 0.1
    matched: bool = True
    tolerance: float = 0.0

    def __post_init__(self):
        if self.algorithm not in ALGORITHMS:
            raise UserError(f"algorithm {self.algorithm}: allowed are {', '.join(ALGORITHMS)}")
        if not (math.isfinite(self.h) and self.h > 0.0):
            raise UserError(f"communication step {self.h}: allowed is a number > 0")
        if not (math.isfinite(self.tolerance) and self.tolerance >= 0.0):
            raise UserError(f"tolerance {self.tolerance}: allowed is a number >= 0, 0 for steps as they are")
        if self.tolerance and PASSES.get(self.algorithm, 1) == 1:
            raise UserError(
                f"tolerance {self.tolerance} with algorithm {self.algorithm}, which cannot go back: allowed is 0, or rollback or iterated"
            )


class Master:
    """Two initialised instances, stepped together.

    Parameters
    ----------
    oscillator, shaker : Instance
    setup : Setup
    scheme : Scheme
    start_time : float
        Of both instances, s.

    Attributes
    ----------
    time : float
    x, s : list of float
        Outputs of both sides at ``time``, in the order of ``OSCILLATOR_OUTPUTS`` and ``SHAKER_OUTPUTS``.
    ledger : Ledger
    halved : int
        Steps that the tolerance has halved.
    """

    def __init__(self, oscillator, shaker, setup, scheme, start_time=0.0):
        self.oscillator = Channel(oscillator, OSCILLATOR_INPUTS, OSCILLATOR_OUTPUTS)
        self.shaker = Channel(shaker, SHAKER_INPUTS, SHAKER_OUTPUTS)
        self.scheme = scheme
        self.time, self.halved = start_time, 0
        self.x, self.s = self.oscillator.get(), self.shaker.get()
        self.voltage = math.nan
        self.slope = 0.0  # of the force, at the present communication point
        self.force_before = self.h_before = 0.0
        self.acceleration_before = (0.0, 0.0)  # and its derivative
        self.ledger = Ledger(setup, self.x, self.s)
        self._step = {"jacobi": self._jacobi, "jacobi-derivative": self._jacobi_derivative}.get(scheme.algorithm, self._seidel)

    def step(self, voltage, h=None):
        """One communication step at a constant voltage (V), of length ``h`` (s) instead of the scheme's where given."""
        h = h or self.scheme.h
        begin = self.time
        for part in (16,) if self.h_before or PASSES.get(self.scheme.algorithm, 1) > 1 else BEGIN:
            self._one_step(voltage, h * part / 16)
        self.time = begin + h

    def _one_step(self, voltage, h):
        if voltage != self.voltage:  # the acceleration belongs to the inputs as set now
            self.voltage = voltage
            self.s = self._look(self.x)
        x, s = self.x, self.s
        acceleration, x_new, s_new = self._step(h)
        force = self.force_of(x, x_new, h)
        defect = s_new[E_FORCE] - s[E_FORCE] - work(force, s[V], acceleration, h)
        exchanged = abs(s_new[E_FORCE] - s[E_FORCE]) + abs(s_new[E_MOTOR] - s[E_MOTOR])
        if self.scheme.tolerance and abs(defect) > self.scheme.tolerance * exchanged and h > SHORTEST * self.scheme.h:
            self.oscillator.restore()
            self.shaker.restore()
            self.halved += 1
            self._one_step(voltage, 0.5 * h)
            self._one_step(voltage, 0.5 * h)
            return
        self.slope = end_slope(force, h)
        self.ledger.add(x, x_new, acceleration, defect, h)
        jerk = s[JERK] if self.h_before else acceleration[1]  # at the start the force's slope was not known
        self.force_before, self.acceleration_before, self.h_before = x[R], (s[A], jerk), h
        self.time += h
        self.x, self.s = x_new, self._look(x_new)

    def _look(self, x):
        """The shaker's outputs with the force at the present point, and its slope, as inputs."""
        self.shaker.put(x[R], self.slope, 0.0, 0.0, self.voltage)
        return self.shaker.get()

    # -- what each side assumes of the other --------------------------------------------------------------------------

    def force_of(self, x, x_new, h):
        """The force over a step that the oscillator has done: with its ends, mean and moment."""
        return matched_cubic(x[R], x_new[R], x_new[IMPULSE] / h, x_new[MOMENT] / (h * h), h)

    def _given_force(self, x_new, h):
        """The force as the shaker is told it."""
        if self.scheme.matched:
            return self.force_of(self.x, x_new, h)
        return parabola(self.force_before, self.x[R], x_new[R], self.h_before, h)

    def _given_acceleration(self, s_new, h):
        """The acceleration over a step that the shaker has done, as the oscillator is told it."""
        s = self.s
        if not self.scheme.matched:
            return parabola(self.acceleration_before[0], s[A], s_new[A], self.h_before, h)
        mean = (s_new[V] - s[V]) / h
        return matched_cubic(s[A], s_new[A], mean, mean - ((s_new[Y] - s[Y]) / h - s[V]) / h, h)

    def _extrapolated_acceleration(self):
        """Value and derivative now, curvature from the value before; where a rollback follows, a cubic with the derivative before too."""
        a, jerk, h = self.s[A], self.s[JERK], self.h_before
        if not h:
            return a, jerk, 0.0, 0.0
        bend = (self.acceleration_before[0] - a + jerk * h) / (h * h)
        if self.scheme.algorithm == "gauss-seidel":
            return a, jerk, 2.0 * bend, 0.0
        twist = ((self.acceleration_before[1] - jerk) / h + 2.0 * bend) / h
        return a, jerk, 2.0 * (bend + twist * h), 6.0 * twist

    # -- the schemes --------------------------------------------------------------------------------------------------

    def _both(self, acceleration, force, h):
        """Both sides at once."""
        self.oscillator.put(*acceleration)
        self.oscillator.step(self.time, h)
        self.shaker.put(*force, self.voltage)
        self.shaker.step(self.time, h)
        return acceleration, self.oscillator.get(), self.shaker.get()

    def _jacobi(self, h):
        return self._both((self.s[A], 0.0, 0.0, 0.0), (self.x[R], 0.0, 0.0, 0.0), h)

    def _jacobi_derivative(self, h):
        rate = (self.x[R] - self.force_before) / self.h_before if self.h_before else 0.0
        return self._both((self.s[A], self.s[JERK], 0.0, 0.0), (self.x[R], rate, 0.0, 0.0), h)

    def _seidel(self, h):
        """Oscillator, then shaker; once, twice, or until the force does not change."""
        passes = PASSES[self.scheme.algorithm]
        passes = MOST_ITERATIONS if passes > 1 and not self.h_before else passes
        acceleration, last = self._extrapolated_acceleration(), None
        if passes > 1:
            self.oscillator.save()
            self.shaker.save()
        for i in range(passes):
            if i:
                self.oscillator.restore()
                self.shaker.restore()
            self.oscillator.put(*acceleration)
            self.oscillator.step(self.time, h)
            x_new = self.oscillator.get()
            force = self._given_force(x_new, h)
            self.shaker.put(*force, self.voltage)
            self.shaker.step(self.time, h)
            if i + 1 == passes or (last and self._settled(x_new, last)):
                return acceleration, x_new, self.shaker.get()
            last = x_new
            self.shaker.put(x_new[R], end_slope(force, h), 0.0, 0.0, self.voltage)
            acceleration = self._given_acceleration(self.shaker.get(), h)
        raise AssertionError("the last pass returns")

    @staticmethod
    def _settled(x, last):
        """Whether an iteration has changed nothing but roundings."""
        return all(abs(x[i] - last[i]) <= CONVERGED * (abs(x[i]) + abs(last[i])) for i in (R, IMPULSE, MOMENT))

    def memory(self):
        """What the master itself remembers, as a list of floats: with both FMUs' states, all that a run goes on from."""
        own = [self.time, self.voltage, self.slope, self.force_before, self.h_before, *self.acceleration_before]
        return [*own, *self.ledger.memory(), *self.x, *self.s]

    def remember(self, numbers):
        """The inverse of :meth:`memory`."""
        self.time, self.voltage, self.slope, self.force_before, self.h_before = numbers[:5]
        self.acceleration_before = (numbers[5], numbers[6])
        self.ledger.remember(numbers[7 : -len(self.x) - len(self.s)])
        self.x, self.s = numbers[-len(self.x) - len(self.s) : -len(self.s)], numbers[-len(self.s) :]

    def close(self):
        """Free the states kept in the FMUs."""
        self.oscillator.close()
        self.shaker.close()
