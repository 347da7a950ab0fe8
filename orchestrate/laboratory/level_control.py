"""A vibration controller: the fundamental of a shaker's table is held at the level of a sine."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..constants import TURN
from ..errors import InputError
from ..lazy import xr
from ..model import Shaker, Structure
from ..model.arguments import Positive, check_and_convert_fields, checked_positive
from ..response.equations import absolute_accelerations_unforced
from ..response.labels import states_over_time, variable
from ..weak_drive.controllers import ControllerState, InputControl
from ..weak_drive.cosimulate import cosimulate
from ..weak_drive.polynomials import Cubic
from .signals import Sine

RECORDED = ("current", "voltage", "power")


@dataclass(frozen=True, kw_only=True)
class LevelControl(InputControl):
    """Hold the fundamental of a table's acceleration at the level of a sine, as shakers' do.

    - The fundamental is what a tracking filter passes: twice the acceleration times sine and cosine
      of the phase, each through a first-order low-pass of ``averaging`` periods.
    - The command is a sine. Its amplitude follows ``ln(level/fundamental)`` with a time constant of
      ``compression`` periods, and changes by a factor ``fastest`` a period at most.
    - It is never larger than ``limit``.
    - Where the fundamental has been off the level by more than a factor ``tolerance`` for
      ``patience`` periods in a row, the control aborts: no command from then on. Until the level is
      first met, ``rise`` periods are granted in addition.

    Parameters
    ----------
    sine : SweptSine or SteppedSine
        Phase and level, m/s2, over time.
    start, limit : float
        Amplitude of the command at the beginning, and the largest, V or A.
    averaging, compression, patience, rise : float
        Periods.
    fastest, tolerance : float
        Factors, > 1.

    Notes
    -----
    The control follows in some ``averaging + compression`` periods. Where the beam's resonance
    changes the table's load faster, the level is off: with the defaults, and a sweep that spends
    80, 40, 16 periods in the half-power width of a bonded beam (0.02, 0.042, 0.1 Hz/s at 12.5 Hz
    and 0.5 % damping, a table of 5 kg under a beam of 3 kg), it is 0.91 to 1.15, 0.84 to 1.28, 0.73
    to 1.52 of the one wanted; delaminated 0.93 to 1.10, 0.87 to 1.21, 0.76 to 1.43.

    Examples
    --------
    >>> import orchestrate
    >>> sweep = orchestrate.SweptSine(first=8.0, last=9.0, duration=4.0, acceleration=0.2)
    >>> beam = orchestrate.Structure.from_file("beam")
    >>> shaker = orchestrate.Shaker.from_file("shaker_100N").replace(table_mass=5.0)
    >>> control = orchestrate.LevelControl(sine=sweep, start=0.1, limit=30.0)
    >>> run = orchestrate.cosimulate(
    ...     beam, shaker, inputs={"command": control}, duration=4.0, step=2e-3, estimate=False
    ... )
    >>> bool(run.control_aborted.isnull())
    True
    """

    sine: Sine
    start: Positive
    limit: float = math.inf
    averaging: Positive = 4.0
    compression: Positive = 10.0
    patience: Positive = 20.0
    rise: Positive = 100.0
    fastest: float = 1.2
    tolerance: Positive = 2.0

    def __post_init__(self) -> None:
        if not isinstance(self.sine, Sine):
            raise InputError(f"sine = {self.sine!r}: expected a SweptSine or SteppedSine")
        check_and_convert_fields(self)
        for name in ("fastest", "tolerance"):
            if not 1.0 < getattr(self, name) < math.inf:
                raise InputError(f"{name} = {getattr(self, name)!r}: expected a factor > 1")
        if not self.start <= self.limit:
            raise InputError(f"limit = {self.limit!r}: expected at least start = {self.start!r}")
        if not np.all(self.sine.level(np.zeros(1)) > 0.0):
            raise InputError("acceleration = 0.0 m/s2: expected a level > 0 to control")

    def begin(self) -> ControllerState:
        """Return amplitude, filtered sine and cosine, periods off the level, time of the abort."""
        return self.start, 0.0, 0.0, -self.rise, math.nan

    def update(
        self, time: float, h: float, acceleration: float, state: ControllerState
    ) -> tuple[Cubic, ControllerState]:
        """Return the command over a step as a cubic, from the box's acceleration at its start."""
        amplitude, sine, cosine, off, aborted = state
        if not math.isnan(aborted):
            return (0.0, 0.0, 0.0, 0.0), state
        phase, end = self.sine.phase(np.array([time, time + h])).tolist()
        periods, level = (end - phase) / TURN, float(self.sine.level(time))
        share = -math.expm1(-periods / self.averaging)
        sine += share * (2.0 * acceleration * math.sin(phase) - sine)
        cosine += share * (2.0 * acceleration * math.cos(phase) - cosine)
        ratio = level / max(math.hypot(sine, cosine), 1e-9 * level)
        most = math.log(self.fastest)
        rate = min(max(math.log(ratio) / self.compression, -most), most)
        amplitude = min(amplitude * math.exp(rate * periods), self.limit)
        is_met = 1.0 / self.tolerance < ratio < self.tolerance
        off = 0.0 if is_met else off + periods
        if off > self.patience:
            return (0.0, 0.0, 0.0, 0.0), (amplitude, sine, cosine, off, time)
        rate, s, c = (end - phase) / h, amplitude * math.sin(phase), amplitude * math.cos(phase)
        cubic = (s, rate * c, -(rate**2) * s, -(rate**3) * c)
        return cubic, (amplitude, sine, cosine, off, aborted)

    def abort_time(self, state: ControllerState) -> float:
        """Return the time of the abort, s; NaN if there was none."""
        return state[-1]


def sine_and_control(
    structure: Structure, excitation: object, shaker: Shaker
) -> tuple[Sine, LevelControl]:
    """Return the sine that a shaker's table is to follow, and its control."""
    if not isinstance(shaker, Shaker):
        raise InputError(f"shaker = {shaker!r}: expected a Shaker")
    if isinstance(excitation, LevelControl):
        return excitation.sine, excitation
    if not isinstance(excitation, Sine):
        kinds = "expected a SweptSine, a SteppedSine or a LevelControl"
        raise InputError(f"excitation = {excitation!r} on a shaker: {kinds}")
    limit = shaker.current_limit if shaker.current_control else shaker.voltage_limit
    level, begin = float(excitation.level(0.0)), float(excitation.frequency(0.0))
    need = shaker.command_for(level, begin, structure.m1 + structure.m2)
    start = min(0.1 * need, limit or math.inf)
    return excitation, LevelControl(sine=excitation, start=start, limit=limit or math.inf)


def shake_on_shaker(
    structure: Structure,
    excitation: object,
    shaker: Shaker,
    sample_rate: float | None,
    start: ArrayLike | None,
    running: Mapping[str, Any],
) -> xr.Dataset:
    """Shake a structure on a shaker with a controlled table; return a result as `shake` does."""
    sine, control = sine_and_control(structure, excitation, shaker)
    rate = checked_positive("sample_rate", sample_rate or sine.usual_rate)
    own = math.sqrt(max(structure.k1 / structure.m1, structure.k2 / structure.m2)) / TURN
    every = math.ceil(32.0 * max(own, 0.05 * sine.usual_rate) / rate)
    count = math.floor(sine.duration * rate * (1.0 + 1e-14))
    run = cosimulate(
        structure,
        shaker,
        inputs={"command": control},
        duration=count / rate,
        step=1.0 / (every * rate),
        record=RECORDED,
        start=start,
        estimate=False,
        **running,
    )
    run = run.isel(time=np.s_[::every])
    contact = run.in_contact.values
    felt = absolute_accelerations_unforced(states_over_time(run), structure, contact)
    for number, values in enumerate(felt.T, 1):
        text = f"acceleration of mass {number} in space, between impacts"
        run[f"a{number}_abs"] = variable("time", values, "m/s2", text)
    title = f"Shaken by {sine.description} on a shaker: {structure.label()}"
    return run.assign_attrs(title=title, excitation=sine.label)
