"""Couple the oscillator to any drive that is an FMU for co-simulation, ``orchestrate.cosimulate``.

The drive steps once: most cannot go back (:mod:`.master`). Once the accelerations over all steps
are known, the motion is computed again by the FMU with events: its impacts are exact, and it does
not depend on communication points.
"""

from __future__ import annotations

import hashlib
import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from ..errors import FmuError, InputError
from ..fmu.begin import REST, begin
from ..fmu.description import Description, describe, describe_runnable
from ..fmu.exported import finder
from ..fmu.instance import REAL_TYPES, Instance
from ..fmu.models import ELECTRODYNAMIC_SHAKER, OSCILLATOR, SHAKER
from ..fmu.play import PLAYED, Player
from ..lazy import Unpack, xr
from ..model import Excitation
from ..model.arguments import Count, Positive, checked_integer
from ..model.drive import Drive
from ..model.shaker import Shaker
from ..model.structure import Structure
from ..response.labels import Variable, variable, yes_or_no
from ..response.questions import Question, checked_state, checked_structure
from ..response.simulate import IN_TIME, impact_columns, impact_variables
from ..running.job import Chunk, Table, brief, plain
from ..running.options import Running
from ..running.runner import answer
from .connection import (
    FORCE,
    MOTION,
    OURS,
    Connection,
    Link,
    checked_links,
    checked_units,
    checked_variable,
)
from .controllers import InputControl
from .energy_balance import given_work
from .inputs import Input, Inputs, check_inputs
from .master import DriveSide, Master, Scheme
from .polynomials import end_value
from .record import Floats, Record, joined
from .schedule import Course, check

OUTPUTS = (*PLAYED, "box_force", "impact_energy")
IN_TIME_TOO = {
    "box_force": ("N", "force of springs and dampers on the box"),
    "impact_energy": ("J", "energy lost in impacts since the start"),
    "box_acceleration": ("m/s2", "acceleration of the box, as the oscillator has it"),
    "box_work": ("J", "work of that force on the drive since the start"),
    "coupling_error": ("m", "estimated error of x1 and x2 by the coupling, the larger one"),
}
BEGINNING = (1, 1, 2, 4, 8, 16, 32)  # parts of the first step where no acceleration is known
# in place of the structure where there is none: the drive does not feel it
BALLAST = Structure(m1=1.0, m2=1.0, k1=1.0, k2=1.0, bonded=True)
MAX_STEPS = 10_000_000
IN_STEPS = ("nodes", "cubics", "work")  # arrays with a row for each step
AT_THE_DURATION = "at the duration"  # attribute `ended` of a run that the drive did not end
NOTHING = np.empty((0, 0))
DIVERGED = 1e12  # m: springs that a force on the box would stretch so far are none
NOTICED = 0.01  # of the largest displacement: a larger coupling error gives a warning
RESOLVED = 0.5  # of a drive's response to a force at once, its mean over a step, else a warning
SHORT = 1.0 / 64.0  # of a step: in it a drive responds to a force as at once
TO_HALF = 8.0 / 7.0  # error over its difference to half the step, which errors of third order have
Values = tuple[tuple[str, float | bool], ...]


class Coupling:
    """Both FMUs of a job, stepped together at its step or a part of it."""

    def __init__(
        self,
        job: CosimulateJob,
        oscillator: Instance,
        drive: Instance,
        parts: int,
        inverse_mass: float,
    ) -> None:
        self.job, self.parts, self.oscillator, self.drive = job, parts, oscillator, drive
        self.inputs = Inputs(job.inputs, drive.description)
        still = Excitation(frequency=job.structure.omega, amplitude=0.0)
        begin(oscillator, job.structure, still, job.start)
        connection = job.begin_drive(drive, self.inputs)
        connection = replace(connection, recorded=job.record)
        self.h = job.step / parts
        fixed = drive.description.has_fixed_step or drive.description.internal_step
        goes_back = drive.description.has_states and not fixed
        scheme = Scheme(self.h, halves_discarded=goes_back)
        self.master = Master(oscillator, drive, scheme, connection, inverse_mass=inverse_mass)
        knows = "box_acceleration" in connection.links
        self.divides_first = not knows and not fixed

    def advance(self, items: Sequence[int]) -> Table:
        """Do the steps of some items; return nodes, cubics, work, and what is recorded."""
        steps = range(items[0] * self.parts, (items[-1] + 1) * self.parts)
        recorded = []
        if self.master.connection.recorded and not steps.start:
            start = [*self.inputs.start_values().values()]
            recorded = [np.array([self.master.recorded(start)])]
        try:
            record = self.run(steps)
        except FmuError:
            self.check_forces([self.master.time], [self.master.motion.box_force])
            raise
        self.check_forces(record["time"], record["box_force"])
        nodes = record["time"].copy()
        nodes[record.ends] = self.job.times(self.parts)[steps.start + 1 :][: len(record.ends)]
        after = record.after
        table = {"nodes": nodes[1:], "cubics": np.transpose(after.acceleration())}
        table |= {"work": given_work(record), "ended": np.array([self.master.ended])}
        if self.inputs.control:
            table["control"] = np.array([self.inputs.state])
        table = {f"{name} {self.parts}": values for name, values in table.items()}
        if self.master.connection.recorded:
            rows = record.recorded[self.parts - 1 :: self.parts]
            table[f"recorded {self.parts}"] = np.concatenate([*recorded, rows])
        return table

    def check_forces(self, times: ArrayLike, forces: ArrayLike) -> None:
        """Raise ``FmuError`` with what to look at where the coupling diverges."""
        limit = DIVERGED * (self.job.structure.k1 + self.job.structure.k2)
        rows = np.column_stack([times, forces])[: 0 if self.job.alone else None]
        for time, force in rows[np.abs(rows[:, 1]) > limit][:1]:
            links = self.master.connection.links
            motion = " and ".join(links[name].theirs for name in MOTION if name in links)
            text = f"the coupling diverges at t = {time:.3g} s (box_force = {force:.2g} N)"
            text += f": look at the unit of {motion} and the sign of box_force"
            raise FmuError(f"{text}, connect {turned(links)}; or reduce the step") from None

    def run(self, steps: range) -> Record:
        """Run both FMUs over some steps."""
        if steps.start or not self.divides_first:
            return self.inputs.run(self.master, steps, self.h, int(self.divides_first))
        parts = (
            np.array(BEGINNING) / sum(BEGINNING) * self.h
        )  # nothing is known of the acceleration
        rows = self.inputs.rows(np.append(0.0, np.cumsum(parts)), self.master.width)
        runs = (self.master.run(rows[i : i + 1], h) for i, h in enumerate(parts.tolist()))
        pieces = joined([*runs])
        if self.master.ended:
            raise FmuError(self.master.ended)
        begun = replace(pieces, ends=pieces.ends[-1:], recorded=pieces.recorded[-1:])
        return joined([begun, self.inputs.run(self.master, steps[1:], self.h, 1)])

    def get_state(self) -> Table:
        """Return the state of both FMUs and of the master, a row of each."""
        states = (self.oscillator.save_state().hex(), self.drive.save_state().hex())
        memory = {"states": np.array([states]), "memory": np.array([self.master.get_state()])}
        return {f"{name} {self.parts}": values for name, values in memory.items()}

    def set_state(self, table: Table) -> None:
        """Set both FMUs and the master back to the last state of a table."""
        oscillator, drive = (bytes.fromhex(text) for text in table[f"states {self.parts}"][-1])
        self.oscillator.restore_state(oscillator)
        self.drive.restore_state(drive)
        self.master.set_state(table[f"memory {self.parts}"][-1].tolist())
        if self.inputs.control:
            self.inputs.state = tuple(table[f"control {self.parts}"][-1].tolist())


@dataclass(frozen=True, kw_only=True)
class CosimulateJob(Question):
    """Job of :func:`orchestrate.cosimulate`: the oscillator and a drive, over time."""

    drive: str  # path of its FMU
    drive_sha256: str
    connect: tuple[tuple[str, str], ...]
    units: tuple[tuple[str, str], ...] = ()
    start_values: Values = ()
    inputs: tuple[tuple[str, Input], ...] = ()
    duration: Positive
    step: float
    record: tuple[str, ...] = ()
    start: tuple[float, ...] = REST
    estimate: bool = True
    force_sign: str = "tested"
    points: Count = 1
    asked: ClassVar[str] = "cosimulate"
    chunk_size: ClassVar[int] = 10_000
    sequential: ClassVar[bool] = True
    gathers: ClassVar[bool] = True
    item_columns: ClassVar[tuple[str, ...]] = ()  # nodes, and a state
    item: ClassVar[str] = "step"

    @property
    def alone(self) -> bool:
        """Return whether the drive runs without a structure."""
        return "box_force" not in dict(self.connect)

    def call_text(self) -> str:
        values: dict[str, Any] = {"connect": dict(self.connect), "units": dict(self.units)}
        values |= {"parameters": dict(self.start_values)}
        values |= {name: getattr(self, name) for name in ("duration", "step", "record", "start")}
        texts = (f"{name}={value!r}" for name, value in values.items() if value)
        structure = "None" if self.alone else f"Structure{brief(plain(self.structure))}"
        return f"{self.asked}({structure}, {self.drive!r}, {', '.join(texts)})"

    def count(self) -> int:
        return round(self.duration / self.step) + 1

    def times(self, parts: int = 1) -> Floats:
        """Return the communication points, s, of steps divided into equal parts."""
        return np.linspace(0.0, self.duration, parts * (self.count() - 1) + 1)

    def items(self) -> Sequence[int]:
        return range(self.count())

    def chunks(self) -> list[Chunk]:
        """Split the steps into chunks if the drive can give its state, to go on from."""
        if describe(self.drive).saves_states:
            return super().chunks()
        last = self.count() - 1
        return [Chunk(0, 0, last, None), Chunk(1, last, last + 1, 0)]

    def progress_note(self, first: int) -> str:
        """Return the progress bar's note where a run cannot be resumed."""
        if first or describe(self.drive).saves_states:
            return ""
        return "run (not resumable)"

    def work(self, fmus: Mapping[str, Path], items: Sequence[int], previous: Table | None) -> Table:
        """Do some steps, of half the length too; or compute the motion at the end."""
        if items[0] == self.count() - 1:
            assert previous is not None
            return self.motion(fmus[OSCILLATOR], previous)
        response = self.response_to_force() if previous is None else previous["response"][-1]
        table: Table = {"response": response[np.newaxis]}
        warned: dict[str, None] = {}
        for parts in self.finenesses():
            if previous is not None and previous[f"ended {parts}"][-1]:
                table |= nothing_more(previous, parts)
                continue
            with Instance(fmus[OSCILLATOR]) as oscillator, Instance(self.drive, "drive") as drive:
                coupling = Coupling(self, oscillator, drive, parts, float(response[0]))
                if previous is not None:
                    coupling.set_state(previous)
                table |= coupling.advance(items)
                if drive.description.saves_states:
                    table |= coupling.get_state()
                coupling.master.close()
                warned |= drive.warnings
        table["warned"] = np.array(["\n".join(warned)])
        return table

    def begin_drive(self, drive: Instance, inputs: Inputs) -> Connection:
        """Initialise the drive with its inputs at the start; return how it is connected."""
        drive.initialize(**dict(self.start_values), **inputs.start_values())
        links = self.links(drive.description)
        return Connection(links, tuple(inputs.names), cubic=inputs.cubic)

    def links(self, drive: Description) -> dict[str, Link]:
        """Return the connections by our names."""
        return checked_links(dict(self.connect), drive, dict(self.units), self.alone)

    def response_to_force(self) -> Floats:
        """Return by how much 1 N accelerates the box at once, m/s2, and which part of it in a step.

        At once is what a connected acceleration says, else the motion in a short step.
        """
        seen: list[Any] = []
        if self.alone:
            return np.array([0.0, math.nan])
        for force in (0.0, 1.0):
            with suppress(FmuError), Instance(self.drive, "drive") as drive:
                connection = self.begin_drive(drive, Inputs(self.inputs, drive.description))
                side = DriveSide(drive, replace(connection, inputs=()))  # they stay as they began
                side.put((force, 0.0, 0.0, 0.0), ())
                motion, about = [side.get()[:3]], drive.description
                short = 0.0 if about.has_fixed_step or about.internal_step else SHORT * self.step
                if short:
                    drive.step(0.0, short)
                    motion.append(side.get()[:3])
                drive.step(short, self.step)
                seen.append([*motion, side.get()[:3]])
        if len(seen) < 2:  # the run itself says what the drive does
            return np.array([0.0, math.nan])
        begin, *early, late = np.diff(seen, axis=0)[0]
        means = np.array([2.0 / self.step**2, 1.0 / self.step, 1.0]) * late
        soon = np.array([2.0 / short**2, 1.0 / short]) * early[0][:2] if early else means[:2]
        at_once = next((x for x in (begin[2], *soon[::-1]) if math.isfinite(x)), math.nan)
        self.check_sign([at_once, *means], connection.links)
        mean = next(x for x in means[[1, 0, 2]] if math.isfinite(x))
        return np.array([at_once, mean / at_once if at_once else math.nan])

    def check_sign(self, responses: Sequence[float], links: Mapping[str, Link]) -> None:
        """Raise ``InputError`` if the first response to the force that is one goes against it."""
        moved = next((x for x in responses if math.isfinite(x) and x), 0.0)
        if moved < 0.0 and self.force_sign == "tested":
            text = f"1 N of box_force accelerates the box by {moved:.2g} m/s2, against the force; "
            text += f"connect {turned(links)}, or say force_sign='given' if that is meant"
            raise InputError(text)

    def inputs_at_start(self, drive: Description) -> Iterator[str]:
        """Yield ``name = start unit`` of each of the drive's inputs that nothing is given for."""
        links = self.links(drive).values()
        given = {*(link.theirs for link in links), *Inputs(self.inputs, drive).names}
        for name, one in drive.variables.items():
            if one.causality == "input" and name not in given:
                yield f"{name} = {one.start} {one.unit or ''}".rstrip()

    def finenesses(self) -> tuple[int, ...]:
        """Return into how many parts steps are divided: 1, and 2 in a second run for the error."""
        return (1, 2) if self.estimate else (1,)

    def motion(self, oscillator: Path, steps: Table) -> Table:
        """Return the motion under the accelerations of all steps, over time, and its impacts."""
        times, ended = self.reached(steps)
        times = self.times(self.points)[: self.points * (len(times) - 1) + 1]
        for parts in self.finenesses() if ended else ():
            done = steps[f"nodes {parts}"] <= times[-1]
            steps |= {name: steps[name][done] for name in (f"{one} {parts}" for one in IN_STEPS)}
        motions = []
        with Player(oscillator) as player:
            for parts in self.finenesses():
                nodes = np.append(0.0, steps[f"nodes {parts}"])
                player.start(self.structure, self.start)
                motions.append(player.play(nodes, steps[f"cubics {parts}"], times, OUTPUTS))
        rows, touching, impacts = motions[0]
        columns = dict(zip(OUTPUTS, rows.T, strict=True)) | {"time": times, "in_contact": touching}
        if self.estimate:
            away = np.abs(rows - motions[1][0])[:, [OUTPUTS.index(name) for name in ("x1", "x2")]]
            columns["coupling_error"] = TO_HALF * away.max(axis=1)
        nodes, cubics = np.append(0.0, steps["nodes 1"]), steps["cubics 1"]
        inside = (nodes.searchsorted(times, side="right") - 1).clip(max=len(cubics) - 1)
        columns["box_acceleration"] = end_value(tuple(cubics[inside].T), times - nodes[inside])
        columns["step_time"] = times[:: self.points]
        work = np.append(0.0, np.cumsum(steps["work 1"]))
        columns["box_work"] = work[nodes.searchsorted(columns["step_time"])]
        for _, one in self.inputs:
            if isinstance(one, InputControl):
                end = one.aborted(tuple(steps["control 1"][-1].tolist()))
                columns["control_aborted"] = np.array([end])
        columns["response"] = steps["response"][:1]
        columns["ended"] = np.array([ended])
        return {**columns, **impact_columns(impacts, self.structure)}

    def reached(self, steps: Table) -> tuple[Floats, str]:
        """Return the communication points that all runs reached, and by what they ended earlier."""
        ends = {i: np.max(steps[f"nodes {i}"], initial=0.0) for i in self.finenesses()}
        last, times = min(ends.values()), self.times()
        texts = [text for i in ends if ends[i] == last for text in steps[f"ended {i}"].tolist()]
        ended = next(filter(None, texts), "")
        if last < times[1]:
            raise FmuError(f"{ended}, in its first step; expected at least one of them")
        return times[times <= last], ended

    def dataset(self, table: Table) -> xr.Dataset:
        description = describe(self.drive)
        at_steps = "time" if self.points == 1 else "step_time"
        times = {"time": "time"} | {at_steps: "communication points"}
        structure = "no structure" if self.alone else self.structure.label()
        resumable = "yes" if description.saves_states else "no: the drive cannot save its state"
        return xr.Dataset(
            self.motion_variables(table, at_steps) | self.drive_variables(table, at_steps),
            {name: variable(name, table[name], "s", text) for name, text in times.items()},
            {
                "title": f"{structure} on {description.name}",
                "drive": description.name,
                "recorded": ",".join(self.record),
                "inputs_at_start": ", ".join(self.inputs_at_start(description)),
                "response_in_a_step": float(table["response"][0][1]),
                "ended": str(table["ended"][-1]) or AT_THE_DURATION,
                "drive_warnings": "\n".join(dict.fromkeys(filter(None, table["warned"].tolist()))),
                "resumable": resumable,
            },
        )

    def motion_variables(self, table: Table, at_steps: str) -> dict[str, Variable]:
        """Return the variables of the box, and of the structure if there is one."""
        shown = {**IN_TIME, **IN_TIME_TOO}
        work = shown.pop("box_work")
        acceleration = variable("time", table["box_acceleration"], *shown["box_acceleration"])
        if self.alone:
            return {"box_acceleration": acceleration}
        found = {n: variable("time", table[n], *about) for n, about in shown.items() if n in table}
        if "box_velocity" in dict(self.connect):
            found["box_work"] = variable(at_steps, table["box_work"], *work)
        text = "whether the masses are in permanent contact"
        found["in_contact"] = yes_or_no("time", table["in_contact"], text)
        return found | impact_variables(table)

    def drive_variables(self, table: Table, at_steps: str) -> dict[str, Variable]:
        """Return what is recorded of the drive, with its estimated error, and of a control."""
        count, found = len(table["step_time"]), {}
        recorded, finer = (table.get(f"recorded {i}", NOTHING)[:count].T for i in (1, 2))
        for i, name in enumerate(self.record):
            about = describe(self.drive).variable(name)
            text, unit = about.description or f"{name} of the drive", about.unit or "1"
            found[name] = variable(at_steps, recorded[i], unit, text)
            if self.estimate:
                error = TO_HALF * np.abs(recorded[i] - finer[i])
                found[f"{name}_error"] = variable(at_steps, error, unit, f"error of {text}")
        if "control_aborted" in table:
            text = "time at which the control gave up, NaN if it did not"
            found["control_aborted"] = variable((), table["control_aborted"][-1], "s", text)
        return found


def cosimulate(
    structure: Structure | None,
    drive: str | PathLike[str] | Drive | Shaker,
    *,
    connect: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    parameters: Mapping[str, float | bool] | None = None,
    inputs: Mapping[str, float | Input | tuple[ArrayLike, ArrayLike]] | None = None,
    duration: float,
    step: float,
    record: Sequence[str] | None = None,
    start: ArrayLike | None = None,
    estimate: bool = True,
    force_sign: Literal["tested", "given"] = "tested",
    points: Count = 1,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Couple the oscillator to a drive that is an FMU, and simulate both.

    Parameters
    ----------
    structure : Structure or None
        Delaminated or bonded; ``None`` for the drive alone, which has no ``box_force`` then.
    drive : path, Drive or Shaker
        An FMU of FMI 2.0 or 3.0 for co-simulation that moves the box, of any tool; or one of the
        package's own: a motor with an unbalance, an electrodynamic shaker.
    connect : mapping of str to str
        The drive's variables by the names here. Of ``box_acceleration`` (m/s2), ``box_velocity``
        and ``box_position`` at least one is an output of the drive; ``box_force`` (N) is its input,
        the force of springs and dampers on the box, positive as the box's motion. A name with a
        minus before it, as ``"-force"``, counts with the other sign; other units of the same kind
        are converted, and ``"pos[mm]"`` states one as ``units`` does. A drive that takes
        derivatives of the force has them as ``box_force_1`` to ``box_force_3``. By default the
        names of the package's own drives.
    units : mapping of str to str, optional
        Units of connected variables, by the drive's names, in place of those that it states: m/s2,
        mm, kN and others. Units that it defines by no base units are taken by their names; none
        means SI.
    parameters : mapping of str to float, optional
        Start values of the drive, by its names.
    inputs : mapping, optional
        Its other inputs: a number, times in s with values, a :class:`orchestrate.Course`, or one
        :class:`orchestrate.LevelControl`, which holds the level of the box's acceleration.
    duration : float
        Length of the run, s.
    step : float
        Communication step, s: the longest one, where the duration is no multiple of it.
    record : sequence of str, optional
        Variables of the drive that are stored.
    start : array_like of 4 floats, optional
        x1, x2 in m, v1, v2 in m/s at time 0, relative to the box; at rest by default.
    estimate : bool
        Whether the coupling's error is estimated, by a second run with half the step.
    force_sign : {"tested", "given"}
        Whether a force that moves the box against it is an error, or meant so.
    points : int
        Points of time in each step: the motion between communication points is that of the FMU's
        closed form. What is of the drive stays over ``step_time`` if it is more than 1.
    **running
        ``store``, ``progress`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over ``time`` in s, the communication points: ``x1``, ``x2``, ``v1``, ``v2``, ``x_rel``,
        ``v_rel``, ``contact_force``, ``in_contact``, ``box_force``, ``impact_energy``,
        ``box_acceleration``, what is recorded of the drive by its names, with its estimated error
        as ``NAME_error``, ``box_work`` where a velocity is connected, ``coupling_error``, the
        larger error of ``x1`` and ``x2`` in m, and
        of a control the time ``control_aborted``. Attributes: ``ended``, when and why the drive
        ended the simulation before the duration, with what was reached until then, and
        ``drive_warnings``, what it warned of; both are given as warnings too.
        Over ``impact``: ``impact_time``, ``impact_velocity``, ``impulse`` and ``sticks``.

    Raises
    ------
    InputError
        Where a connection cannot be made, a name is not the drive's, or a number is out of its
        range.
    FmuError
        Where an FMU refuses a step, returns early from it, or discards it: at last, for a drive
        that can go back is tried with parts of the step, down to 1/64.

    Notes
    -----
    The drive does each step once, so it need not be able to go back; the oscillator does it two or
    three times, see :mod:`orchestrate.weak_drive.master`. A drive takes the force held, or with its
    derivatives. Errors are of fourth order in the step if a velocity is connected, of third order
    otherwise, of second order if it is the acceleration alone and inputs change or the force acts
    late, as long as the acceleration is that under the present force when it is read. Of a drive
    whose outputs change in steps alone they are of first order, unless its velocity is connected.
    After impacts that one of the two runs has and the other not, or in chaos, the estimated error
    is as large as the motion.

    An interrupted run resumes where the drive can save its state (``canSerializeFMUstate``); else
    it begins anew, as ``resumable`` in the attributes says.

    Examples
    --------
    >>> import orchestrate
    >>> beam, drive = orchestrate.Structure.from_file("beam"), orchestrate.Drive.from_file("beam")
    >>> at_speed = {"speed_start": 60.0}  # rad/s
    >>> run = orchestrate.cosimulate(
    ...     beam, drive, parameters=at_speed, inputs={"voltage": 4.0}, duration=0.5, step=0.002
    ... )
    >>> run.x1.dims, bool(run.coupling_error.max() < 1e-6)
    (('time',), True)
    """
    foreign = not isinstance(drive, (Drive, Shaker))
    if isinstance(drive, (Drive, Shaker)):
        parameters = {**drive.parameters(), **(parameters or {})}
        model = SHAKER if isinstance(drive, Drive) else ELECTRODYNAMIC_SHAKER
        ours = {name: name for name in OURS if structure is not None or name not in FORCE}
        connect, drive = connect or ours, finder(running)(model).path
    path = Path(drive).resolve()
    description = describe_runnable(path)
    units = checked_units(units, description)
    links = checked_links(connect or {}, description, units, structure is None)
    for name, value in (("duration", duration), ("step", step)):
        check(name, value, "s", low=0.0, exclusive=True)
    check_internal_step(duration, step, description, estimate)
    count = checked_step_count(duration, step, description)
    estimate = estimate and structure is not None
    checked = checked_structure(BALLAST if structure is None else structure)
    job = CosimulateJob(
        name=f"cosimulate_{checked.label() if structure else 'alone'}_{path.stem}",
        structure=checked,
        duration=duration,
        estimate=estimate,
        drive=str(path),
        drive_sha256=hashlib.sha256(path.read_bytes()).hexdigest(),
        connect=tuple((connect or {}).items()),
        units=tuple(units.items()),
        start_values=checked_parameters(parameters or {}, description),
        inputs=checked_inputs(inputs or {}, description, duration),
        step=float(duration) / count,
        record=checked_record(record or (), description),
        start=checked_state("start", start, checked),
        force_sign=force_sign,
        points=points,
    )
    check_inputs(job.inputs, links)
    found = answer(job, running, finder(running), job.drive_sha256 if foreign else "")
    warn_of_drive(found)
    missing = [name for name in MOTION if name not in links]
    if missing:
        warn_of_step(found, missing)
    if estimate:
        warn_of_error(found, missing)
    return found


def warn_of_drive(run: xr.Dataset) -> None:
    """Warn with what the drive warned of, each text once, and where it ended the simulation."""
    attributes = getattr(run, "attrs", {})
    for text in attributes.get("drive_warnings", "").splitlines():
        warnings.warn(text, stacklevel=3)
    if (ended := attributes.get("ended", AT_THE_DURATION)) != AT_THE_DURATION:
        warnings.warn(f"{ended}; the result ends there", stacklevel=3)


def nothing_more(previous: Table, parts: int) -> Table:
    """Return the table of a run that a drive ended in a chunk before: no rows, the same end."""
    table = {name: previous[name][:0] for name in previous if name.endswith(f" {parts}")}
    return {**table, f"ended {parts}": previous[f"ended {parts}"]}


def warn_of_step(run: xr.Dataset, missing: Sequence[str]) -> None:
    """Warn where the drive is not seen to follow a force as a mass does within a step."""
    share = getattr(run, "attrs", {}).get("response_in_a_step", math.nan)
    if share < RESOLVED:
        text = f"a force accelerates the box by {share:.2g} in a step, where it does by 1 at once: "
        text += "the step is too long for the drive's own motion"
        warnings.warn(f"{text}; reduce it or connect {', '.join(missing)}", stacklevel=3)


def turned(links: Mapping[str, Link]) -> str:
    """Return the connection of the force with the other sign."""
    force = links["box_force"]
    return f"box_force={'-' if force.scale > 0.0 else ''}{force.theirs}"


def warn_of_error(run: xr.Dataset, missing: Sequence[str]) -> None:
    """Warn where the coupling's error may hide or make impacts; ``missing`` could be connected."""
    if "coupling_error" not in getattr(run, "data_vars", ()):  # a job alone
        return
    size = max(float(abs(run[name]).max()) for name in ("x1", "x2"))
    error = float(run.coupling_error.max())
    if error > NOTICED * size:
        more = f" and connect {', '.join(missing)} if the drive has it" if missing else ""
        text = f"coupling error {error:.2g} m of displacements up to {size:.2g} m: "
        text += "it diverges: look at units" if error > size else "impacts may be missed or added"
        warnings.warn(f"{text}; reduce the step{more}", stacklevel=3)


def checked_step_count(duration: float, step: float, drive: Description) -> int:
    """Return the number of steps; raise ``InputError`` if a drive of equal steps has a rest."""
    count = max(1, math.ceil(duration / step - 1e-9))
    if drive.has_fixed_step and not math.isclose(count * step, duration, rel_tol=1e-9):
        raise InputError(
            f"duration = {duration} s, step = {step} s: the FMU {drive.name} takes steps of one "
            "length alone; expected a duration that is a whole number of steps"
        )
    return checked_integer("duration/step", count, 1, MAX_STEPS)


def check_internal_step(duration: float, step: float, drive: Description, estimate: bool) -> None:
    """Raise ``InputError`` unless all steps are multiples of the drive's internal one."""
    internal, parts = drive.internal_step, 2 if estimate else 1
    if not internal:
        return
    taken = duration / max(1, math.ceil(duration / step - 1e-9)) / parts
    if round(taken / internal) < 1 or not math.isclose(
        taken, round(taken / internal) * internal, rel_tol=1e-9
    ):
        why = ", half of which is for the error's estimate" if estimate else ""
        raise InputError(
            f"step = {step} s: the FMU {drive.name} calculates in steps of {internal:g} s "
            f"(fixedInternalStepSize); expected a multiple of {parts * internal:g} s{why}, and a "
            "duration that is a whole number of steps"
        )


def checked_parameters(parameters: Mapping[str, Any], drive: Description) -> Values:
    """Return start values of the drive by its names; raise ``InputError`` for what it has not."""
    checked: list[tuple[str, float | bool]] = []
    for name, value in parameters.items():
        if checked_variable(drive, name, "", any_type=True).initial == "calculated":
            raise InputError(f"parameters: {name} of the FMU {drive.name} has no start value")
        if isinstance(value, (bool, np.bool_)):
            checked.append((name, bool(value)))
            continue
        check(name, value, str(drive.variable(name).unit or ""))
        is_real = drive.variable(name).type in REAL_TYPES
        checked.append((name, float(value) if is_real else int(value)))
    return tuple(checked)


def checked_inputs(
    inputs: Mapping[str, Any], drive: Description, duration: float
) -> tuple[tuple[str, Input], ...]:
    """Return the drive's other inputs by name: a ``Course`` each, or the control as it is given."""
    courses: list[tuple[str, Input]] = []
    for name, value in inputs.items():
        checked_variable(drive, name, "input")
        if not isinstance(value, (Course, InputControl)):
            times, values = value if isinstance(value, tuple) else ((0.0, duration), (value, value))
            try:
                value = Course(tuple(np.ravel(times)), tuple(np.ravel(values)))
            except InputError as error:
                raise InputError(f"inputs: {name}: {error}") from None
            except (TypeError, ValueError):
                text = "expected a number, (times, values) or a Course"
                raise InputError(f"inputs: {name} = {value!r:.60}: {text}") from None
        courses.append((name, value))
    return tuple(courses)


def checked_record(record: Sequence[str], drive: Description) -> tuple[str, ...]:
    """Return the names of what is recorded of the drive; raise ``InputError`` if one is not its."""
    if isinstance(record, str):
        record = [record]
    for name in record:
        checked_variable(drive, name, "", any_type=True)
        if name in (*IN_TIME, *IN_TIME_TOO):
            raise InputError(f"record: {name} is a name of the oscillator's; leave it out")
    return tuple(dict.fromkeys(record))
