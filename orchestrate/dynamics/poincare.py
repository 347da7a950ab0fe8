"""Poincaré sections of a motion at a phase, at impacts or releases: ``orchestrate.poincare``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..constants import TURN
from ..fmu import OSCILLATOR, EventInstance, Impacts, Instance, gaps_of_states, start_motion
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import Count, Transient, checked_number
from ..response.labels import make_dataset, variable, yes_or_no
from ..response.questions import OneMotionQuestion, Point, checked_point, checked_state
from ..response.signatures import as_given, question
from ..response.simulate import IN_TIME
from ..running.job import FAMILY, Fmus, Table
from ..running.options import Running
from .impacts_after_transient import state_after_transient
from .variational import deviation_matrices_and_contacts, nondimensional_impacts

COLUMNS = ("x1", "x2", "v1", "v2", "x_rel", "v_rel")
SECTIONS = {  # what a section is, by its name
    "phase": "states at one phase of the box, once a period",
    "impacts": "states just after impacts",
    "releases": "states where permanent contact ends",
}
Floats = NDArray[np.float64]


class PoincareJob(OneMotionQuestion):
    """Job of :func:`orchestrate.poincare`: the Poincaré section of one motion."""

    family: ClassVar[tuple[str, ...]] = FAMILY

    def work(self, fmus: Fmus, items: Sequence[Point], previous: Table | None) -> Table:
        point, period = items[0], self.excitation.period
        with Instance(fmus[OSCILLATOR]) as plain:
            start = state_after_transient(plain, point, self.start, self.transient)
            if self.at == "phase":
                first = self.phase / self.excitation.frequency
                times = first + period * np.arange(float(self.periods))
            else:
                with EventInstance(fmus[OSCILLATOR]) as eventful:
                    start_motion(eventful, *point, start)
                    impacts = eventful.record_impacts(0.0, self.periods * period)
                if self.at == "impacts":
                    return states_after_impacts(impacts, self.structure)
                times = release_times(impacts, point, self.periods * period)
            start_motion(plain, *point, start)
            rows, now = np.empty((len(times), len(COLUMNS))), 0.0
            for row, time in zip(rows, times.tolist(), strict=True):
                if time > now:
                    plain.step(now, time)
                row[:], now = plain.get(*COLUMNS), time
        return {"time": times, "rows": rows}

    def dataset(self, table: Table) -> xr.Dataset:
        time, columns = table["time"], dict(zip(COLUMNS, table["rows"].T, strict=True))
        phase = np.mod(time * self.excitation.frequency, TURN)
        if self.at == "phase":
            phase = np.full(len(time), self.phase)
        variables = {
            **{name: variable("point", columns[name], *IN_TIME[name]) for name in COLUMNS},
            "phase": variable("point", phase, "rad", "phase of the box"),
        }
        if self.at == "impacts":
            closing, text = table["impact_velocity"], "whether permanent contact follows (17)"
            variables |= {
                "impact_velocity": variable("point", closing, "m/s", "closing speed before it"),
                "sticks": yes_or_no("point", table["sticks"], text),
            }
        since = self.transient * self.excitation.period
        coordinates = {"time": variable("point", since + time, "s", "time from the start")}
        title = f"Poincaré section, {SECTIONS[self.at]}: {self.structure.label()}"
        return make_dataset(variables, coordinates, title)


def states_after_impacts(impacts: Impacts, structure: Structure) -> Table:
    gap, stroke = gaps_of_states(impacts.state, structure.gap_offset), structure.stroke
    gap = np.where(gap > 0.5 * stroke, stroke, 0.0)  # 0 without a stroke
    rate = np.where(impacts.sticks, 0.0, impacts.state[:, 3] - impacts.state[:, 2])
    rows = np.column_stack([impacts.state, gap, rate])
    more = {"impact_velocity": impacts.closing, "sticks": impacts.sticks}
    return {"time": impacts.time, "rows": rows, **more}


def release_times(impacts: Impacts, point: Point, end: float) -> Floats:
    """Return the times, s, at which permanent contacts begun by given impacts are released."""
    omega = point.structure.omega
    scaled = nondimensional_impacts(impacts, point)
    ends = np.append(scaled.time[1:], omega * end)
    _, lasting = deviation_matrices_and_contacts(scaled, omega * end, point)
    released = scaled.sticks & (lasting < ends - scaled.time)
    return np.asarray((scaled.time + lasting)[released] / omega)


@question(PoincareJob)
def poincare(
    structure: Structure,
    *,
    eta: float | None = None,
    frequency: float | None = None,
    amplitude: float | None = None,
    box_acceleration: float = 0.0,
    force1: float = 0.0,
    force2: float = 0.0,
    at: Literal["phase", "impacts", "releases"] = "phase",
    phase: float = 0.0,
    transient: Transient = 500,
    periods: Count = 1000,
    start: ArrayLike | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Compute a Poincaré section of a motion: at a phase of the box, at impacts, or at releases.

    Parameters
    ----------
    structure : Structure
    eta : float, optional
        Frequency ratio Omega/omega; the box's amplitude is 1/eta^2 m.
    frequency, amplitude : float, optional
        The physical form instead: rad/s and m.
    box_acceleration, force1, force2
        As in :func:`orchestrate.simulate`.
    at : {"phase", "impacts", "releases"}
        Where states are taken. At one phase of the box, once an excitation period; just after each
        impact; or where each permanent contact that an impact began ends.
    phase : float
        Phase of the box, rad, where ``at`` is ``"phase"``.
    transient : int
        Excitation periods dropped.
    periods : int
        Excitation periods followed after them.
    start : array_like of 4 floats, optional
        x1, x2 in m, v1, v2 in m/s at phase 0; at rest by default.
    **running
        ``store``, ``progress`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over ``point``: ``x1``, ``x2``, ``v1``, ``v2``, ``x_rel``, ``v_rel`` relative to the box,
        ``phase`` of the box, ``time``; at impacts also ``impact_velocity``, the closing speed
        before them, and ``sticks``. There may be none: a motion without impacts has no section at
        impacts.

    Raises
    ------
    InputError
        Where an argument is missing, contradicts another one, or is out of its range.

    Notes
    -----
    All states are read from the FMU, at exact times: those of impacts are its events, those of
    releases are the zeros (19) of the contact force.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.dynamics.poincare import poincare
    >>> section = poincare(Structure.nondimensional(), eta=0.4, at="releases", periods=3)
    >>> section.sizes["point"], float(abs(section.v_rel).max() < 1e-12)
    (3, 1.0)
    """
    pushes = {"box_acceleration": box_acceleration, "force1": force1, "force2": force2}
    _, excitation = checked_point(structure, eta, frequency, amplitude, **pushes)
    phase = math.fmod(checked_number("phase", phase, "a number, rad"), TURN) % TURN
    start = checked_state("start", start, structure)
    return as_given(excitation=excitation, phase=phase, start=start)
