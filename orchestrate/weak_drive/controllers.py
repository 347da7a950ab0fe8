"""Control the motor's voltage by its measured speed, within the available voltage.

The schedule says how much voltage there is. A controller takes a part of it, once a communication
step: it sees the speed at the step's beginning and holds its voltage over the step, as a digital
one does.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

from ..model.ranges import checked_range
from .polynomials import Cubic

ControllerState = tuple[float, ...]


class Measurement(NamedTuple):
    """Store what a controller measures at the beginning of a communication step."""

    time: float  # s
    speed: float  # of the motor, at this instant, rad/s
    available: float  # voltage of the schedule over the step, V: the most a controller may take
    h: float  # length of the step, s


@dataclass(frozen=True)
class Controller(ABC):
    """Define the interface of a control law for the motor's voltage."""

    @abstractmethod
    def begin(self, speed: float) -> ControllerState:
        """Return the controller's initial state for a motor at a given speed, rad/s."""

    @abstractmethod
    def update(
        self, measured: Measurement, state: ControllerState
    ) -> tuple[float, ControllerState]:
        """Compute the voltage over one step, V, and the controller's next state."""


class InputControl(ABC):
    """Define the interface of a control law for an input of a drive, see ``cosimulate``."""

    @abstractmethod
    def begin(self) -> ControllerState:
        """Return the controller's initial state."""

    @abstractmethod
    def update(
        self, time: float, h: float, acceleration: float, state: ControllerState
    ) -> tuple[Cubic, ControllerState]:
        """Return the input over a step as a cubic, from the box's acceleration at its beginning."""

    @abstractmethod
    def abort_time(self, state: ControllerState) -> float:
        """Return the time at which the controller gave up, s; NaN if it did not."""


@dataclass(frozen=True, kw_only=True)
class SpeedControl(Controller):
    """Control the speed by a proportional-integral law with a limited voltage.

    The voltage is ``gain`` times the deviation w_r - w of the speed and its integral over
    ``reset_time``, between 0 and what the source gives; while that limits it, the integral stands
    still.

    Attributes
    ----------
    speed : float
        That is wanted in the end, rad/s.
    gain : float
        V s/rad, > 0; several times the motor constant, which a speed takes without a load.
    reset_time : float
        s, > 0; infinite for proportional control only.
    rise : float
        Rate at which the wanted speed changes from that at the start, rad/s2; infinite: at once.

    Raises
    ------
    InputError

    Examples
    --------
    >>> control = SpeedControl(speed=100.0, gain=0.3, reset_time=0.5)
    >>> voltage, state = control.update(Measurement(0.0, 90.0, 12.0, 0.001), control.begin(90.0))
    >>> round(voltage, 6)  # 0.3 (10 + 10 * 0.001/0.5)
    3.006
    """

    speed: float
    gain: float
    reset_time: float = math.inf
    rise: float = math.inf

    def __post_init__(self) -> None:
        checked_range("speed", self.speed, "rad/s")
        checked_range("gain", self.gain, "V.s/rad", low=0.0, open_low=True)
        for name, unit in (("reset_time", "s"), ("rise", "rad/s2")):
            if getattr(self, name) != math.inf:
                checked_range(name, getattr(self, name), unit, low=0.0, open_low=True)

    def begin(self, speed: float) -> ControllerState:
        return (self.speed if self.rise == math.inf else speed), 0.0

    def update(
        self, measured: Measurement, state: ControllerState
    ) -> tuple[float, ControllerState]:
        """Compute the limited proportional-integral voltage, V, and the next state."""
        setpoint, integral = state
        deviation = setpoint - measured.speed
        grown = integral + deviation * measured.h / self.reset_time
        demand = self.gain * (deviation + grown)
        low, high = sorted((0.0, measured.available))  # which may be negative
        voltage = min(max(demand, low), high)
        leaves = (demand - voltage) * deviation < 0.0
        if voltage == demand or leaves:  # not limited, or leaving that
            integral = grown
        step = self.rise * measured.h
        return voltage, (setpoint + min(max(self.speed - setpoint, -step), step), integral)


@dataclass(frozen=True, kw_only=True)
class SpeedGradient(Controller):
    """Swing the rotor so that it passes the resonance with less voltage.

    The source is fully on while the rotor turns faster than a running mean of its own speed, else
    only ``low`` of it: always in the sense in which the energy of its slow swinging about that mean
    grows. Beyond ``passed`` the source is fully on.

    Attributes
    ----------
    filter_time : float
        Of the running mean psi, T psi' = w - psi, s, > 0: longer than a revolution; about the
        period of the slow swinging.
    passed : float
        Mean speed from which the resonance is passed, rad/s, > 0.
    low : float
        Part of the voltage while the rotor is slower than its mean, from 0 to 1.

    Raises
    ------
    InputError

    Notes
    -----
    After the speed-gradient method: A. Fradkov, O. Tomchina, D. Tomchin, Controlled passage through
    resonance in mechanical systems, Journal of Sound and Vibration 330 (2011) 1065-1073. There the
    threshold is one of energy; here, of the filtered speed.

    Examples
    --------
    >>> control = SpeedGradient(filter_time=0.2, passed=120.0)
    >>> fast, slow = (Measurement(1.0, speed, 6.0, 0.001) for speed in (91.0, 89.0))
    >>> control.update(fast, (90.0,))[0], control.update(slow, (90.0,))[0]
    (6.0, 0.0)
    """

    filter_time: float
    passed: float
    low: float = 0.0

    def __post_init__(self) -> None:
        checked_range("filter_time", self.filter_time, "s", low=0.0, open_low=True)
        checked_range("passed", self.passed, "rad/s", low=0.0, open_low=True)
        checked_range("low", self.low, "of the voltage", low=0.0, high=1.0)

    def begin(self, speed: float) -> ControllerState:
        return (speed,)

    def update(
        self, measured: Measurement, state: ControllerState
    ) -> tuple[float, ControllerState]:
        """Apply full voltage while the speed exceeds its running mean, else a low part."""
        (mean,) = state
        mean -= (measured.speed - mean) * math.expm1(-measured.h / self.filter_time)
        direction = math.copysign(1.0, measured.available)
        on = direction * mean > self.passed or direction * (measured.speed - mean) >= 0.0
        return measured.available * (1.0 if on else self.low), (mean,)
