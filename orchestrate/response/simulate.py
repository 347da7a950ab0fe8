"""One motion in time with its impacts, by the FMU's event mode: ``orchestrate.simulate``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..fmu import NO_INPUT, OSCILLATOR, EventInstance, Impacts, start_motion
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import Count, Transient
from ..running.job import FAMILY, Table
from ..running.options import Running
from .equations import absolute_accelerations_at, acceleration_of_box
from .labels import Variable, make_dataset, variable, yes_or_no
from .questions import OneMotionQuestion, Point, checked_point, checked_state
from .signatures import as_given, question

OUTPUTS = ("x1", "x2", "v1", "v2", "x_rel", "v_rel", "contact_force", "phase")
AS_MEASURED = "between impacts, as an accelerometer on it reads it"
IN_TIME = {  # units, long name
    "x1": ("m", "displacement of mass 1 relative to the box"),
    "x2": ("m", "displacement of mass 2 relative to the box"),
    "v1": ("m/s", "velocity of mass 1 relative to the box"),
    "v2": ("m/s", "velocity of mass 2 relative to the box"),
    "a1": ("m/s2", "acceleration of mass 1 relative to the box between impacts"),
    "a2": ("m/s2", "acceleration of mass 2 relative to the box between impacts"),
    "a1_abs": ("m/s2", f"absolute acceleration of mass 1 {AS_MEASURED}"),
    "a2_abs": ("m/s2", f"absolute acceleration of mass 2 {AS_MEASURED}"),
    "box_acceleration": ("m/s2", "acceleration of the box"),
    "x_rel": ("m", "gap x2 - x1 + clearance"),
    "v_rel": ("m/s", "velocity of the gap"),
    "contact_force": ("N", "compressive force between the masses in permanent contact (18)"),
}


class SimulateJob(OneMotionQuestion):
    """Job of :func:`orchestrate.simulate`: one motion in time."""

    result: ClassVar[str] = "motion"
    replaced: ClassVar[tuple[str, ...]] = (*OneMotionQuestion.replaced, "phase")
    family: ClassVar[tuple[str, ...]] = FAMILY

    def communication_times(self) -> NDArray[np.float64]:
        """Return the times, s, of all points kept, from the end of the transient on."""
        numbers = np.arange(self.periods * self.points + 1)
        return (self.transient + numbers / self.points) * self.excitation.period

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[Point], previous: Table | None
    ) -> Table:
        times = self.communication_times()
        with EventInstance(fmus[OSCILLATOR]) as instance:
            start_motion(instance, *items[0], self.start)
            instance.record_impacts(0.0, float(times[0]))
            loop = instance.event_loop((), OUTPUTS)
            rows, touching, impacts = loop.run(times[[0, -1]], NO_INPUT, times)
        columns = dict(zip(OUTPUTS, rows.T, strict=True))
        phase = columns["phase"]
        box = acceleration_of_box(self.excitation, phase)
        first, second = absolute_accelerations_at(rows[:, :4], items[0], phase, touching).T
        return {
            **columns,
            "in_contact": touching,
            **impact_columns(impacts, self.structure),
            "box_acceleration": box,
            **{"a1_abs": first, "a2_abs": second},
            **{"a1": first - box, "a2": second - box},
        }

    def dataset(self, table: Table) -> xr.Dataset:
        contact = "whether the masses are in permanent contact"
        variables = {
            **{name: variable("time", table[name], *IN_TIME[name]) for name in IN_TIME},
            "in_contact": yes_or_no("time", table["in_contact"], contact),
            **impact_variables(table),
        }
        time = self.communication_times()
        tau, turns = self.structure.omega * time, time / self.excitation.period
        coordinates = {
            "time": variable("time", time, "s", "time from the start"),
            "tau": variable("time", tau, "1", "time in units of 1/omega (4)"),
            "periods_done": variable("time", turns, "1", "time in excitation periods"),
        }
        title = f"Motion in time: {self.structure.label()}"
        return make_dataset(variables, coordinates, title)


def impact_variables(table: Table) -> dict[str, Variable]:
    closing, impulse = table["impact_velocity"], table["impulse"]
    text = "whether permanent contact follows the impact (17)"
    return {
        "impact_time": variable("impact", table["impact_time"], "s", "time of the impact"),
        "impact_velocity": variable("impact", closing, "m/s", "closing speed before it"),
        "impulse": variable("impact", impulse, "N.s", "impulse on each mass (15)"),
        "sticks": yes_or_no("impact", table["sticks"], text),
    }


def impact_columns(impacts: Impacts, structure: Structure) -> Table:
    names = "impact_time", "impact_velocity", "impulse", "sticks"
    columns = impacts.time, impacts.closing, impacts.impulse(structure), impacts.sticks
    return dict(zip(names, columns, strict=True))


@question(SimulateJob)
def simulate(
    structure: Structure,
    *,
    eta: float | None = None,
    frequency: float | None = None,
    amplitude: float | None = None,
    box_acceleration: float = 0.0,
    force1: float = 0.0,
    force2: float = 0.0,
    periods: Count = 20,
    transient: Transient = 0,
    points: Count = 200,
    start: ArrayLike | None = None,
    phase: float = 0.0,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Simulate a motion in time; return displacements to accelerations, and its impacts.

    Parameters
    ----------
    structure : Structure
        Delaminated or bonded.
    eta : float, optional
        Frequency ratio Omega/omega; the box's amplitude is 1/eta^2 m, so that xi of (3) is x in m.
    frequency, amplitude : float, optional
        The physical form instead: rad/s and m.
    box_acceleration, force1, force2 : float
        Constant acceleration of the box, m/s2, and amplitudes of forces on the masses, N, as in
        :func:`orchestrate.sweep`.
    periods : int
        Excitation periods kept.
    transient : int
        Periods dropped before them.
    points : int
        Communication points a period.
    start : array_like of 4 floats, optional
        x1, x2 in m, v1, v2 in m/s at time 0, relative to the box; at rest by default.
    phase : float
        Phase of the box's motion ``a sin(Omega t + phase)`` at time 0, rad.
    **running
        ``store``, ``progress`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over ``time`` in s, ``periods*points + 1`` points from the first kept one on: ``x1``,
        ``x2``, ``v1``, ``v2``, ``x_rel``, ``v_rel`` relative to the box; ``a1``, ``a2``, the
        velocities' derivatives between impacts; ``a1_abs``, ``a2_abs``, absolute accelerations;
        ``box_acceleration``; ``contact_force`` in N and ``in_contact``. Over ``impact``:
        ``impact_time`` in s, ``impact_velocity``, the closing speed in m/s, ``impulse`` in N s,
        and ``sticks``.

    Raises
    ------
    InputError
        Where a required argument is missing, arguments contradict each other, or a number is
        out of its range.

    Notes
    -----
    States, impacts and the contact force come from the FMU; accelerations follow from the states by
    (6), in permanent contact with the contact force (18). An impulse (15) is no part of them. Where
    an impact begins permanent contact, its impulse is that of a plastic one.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.response.simulate import simulate
    >>> motion = simulate(Structure.nondimensional(), eta=0.4, transient=50, periods=2)
    >>> motion.sizes["time"], motion.sizes["impact"], int(motion.sticks.sum())
    (401, 60, 2)
    """
    pushes = {"box_acceleration": box_acceleration, "force1": force1, "force2": force2}
    _, excitation = checked_point(structure, eta, frequency, amplitude, **pushes)
    start = checked_state("start", start, structure)
    return as_given(excitation=excitation.replace(phase=phase), start=start)
