"""Step the oscillator and any drive that is an FMU for co-simulation: the job of ``cosimulate``.

The drive steps once: most cannot go back (:mod:`.master`). Once the accelerations over all steps
are known, the motion is computed again by the FMU with events: its impacts are exact, and it does
not depend on communication points.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ..errors import FmuError, InputError
from ..fmu.description import Description, describe
from ..fmu.events import BOX as BOX_ACCELERATION
from ..fmu.events import PLAYED, Player
from ..fmu.instance import Instance
from ..fmu.models import OSCILLATOR
from ..fmu.oscillator import REST, start_motion
from ..lazy import xr
from ..model import Excitation
from ..model.arguments import Count, Positive
from ..response.labels import Variable, variable, yes_or_no
from ..response.questions import Question
from ..response.simulate import IN_TIME, impact_columns, impact_variables
from ..running.job import Chunk, Fmus, Table, format_brief, to_json_data
from .connection import MOTION, PUSHES, Connection, Link, checked_links
from .controllers import InputControl
from .inputs import Input, Inputs
from .master import DriveSide, Master, Scheme
from .polynomials import end_derivatives
from .run import CoupledJob, Run
from .step_record import Floats, Record, join_records

OUTPUTS = (*PLAYED, "box_force", "impact_energy")
IN_TIME_TOO = {
    "box_force": ("N", "force of springs and dampers on the box"),
    "impact_energy": ("J", "energy lost in impacts since the start"),
    "box_acceleration": ("m/s2", "acceleration of the box, as the oscillator has it"),
    **{name: ("N", f"force of the drive on half {name[-1]}") for name in PUSHES},
    "box_work": ("J", "work of that force on the drive since the start"),
    "coupling_error": ("m", "estimated error of x1 and x2 by the coupling, the larger one"),
}
FIRST_STEP_PARTS = (1, 1, 2, 4, 8, 16, 32)  # parts of the first step where no acceleration is known
IN_STEPS = ("nodes", "cubics", "work")  # arrays with a row for each step
AT_THE_DURATION = "at the duration"  # attribute `ended` of a run that the drive did not end
NOTHING = np.empty((0, 0))
DIVERGED = 1e12  # m, stretch of a spring by the force on the box: the coupling has diverged
SHORT = 1.0 / 64.0  # of a step: in it a drive responds to a force as at once
TO_HALF = 8.0 / 7.0  # error over its difference to half the step, which errors of third order have
Values = tuple[tuple[str, float | bool], ...]


class CosimulationRun(Run):
    """Both FMUs of a job, stepped together at its step or a part of it."""

    def __init__(
        self, job: CosimulateJob, fmus: tuple[Instance, Instance], parts: int, inverse_mass: float
    ) -> None:
        (oscillator, drive), self.job, self.parts = fmus, job, parts
        still = Excitation(frequency=job.structure.omega, amplitude=0.0)
        start_motion(oscillator, job.structure, still, job.start)
        inputs = Inputs(job.inputs, drive.description)
        connection = replace(job.initialize_and_connect(drive, inputs), recorded=job.record)
        fixed = drive.description.has_fixed_step or drive.description.internal_step
        goes_back = drive.description.has_states and not fixed
        scheme = Scheme(job.step / parts, halves_discarded=goes_back)
        master = Master(oscillator, drive, scheme, connection, inverse_mass=inverse_mass)
        self.divides_first = "box_acceleration" not in connection.links and not fixed
        super().__init__(master, inputs)

    def run_communication_steps(self, communication_steps: range) -> Table:
        """Do communication steps, each in `parts`; return nodes, cubics, work, what is recorded."""
        steps = range(communication_steps.start * self.parts, communication_steps.stop * self.parts)
        recorded = []
        if self.master.connection.recorded and not steps.start:
            start = [*self.inputs.start_values().values()]
            recorded = [np.array([self.master.read_recorded(start)])]
        try:
            record = self.run_steps(steps)
        except FmuError:
            self.require_bounded_forces([self.master.time], [self.master.motion.box_force])
            raise
        self.require_bounded_forces(record["time"], record["box_force"])
        nodes = record["time"].copy()
        times = self.job.communication_times(self.parts)[steps.start + 1 :]
        nodes[record.ends] = times[: len(record.ends)]
        table = {"nodes": nodes[1:], "cubics": np.transpose(record.after.input_cubics())}
        table |= {"work": record.after["given"], "ended": np.array([self.master.end_reason])}
        if self.master.connection.recorded:
            rows = record.recorded[self.parts - 1 :: self.parts]
            table["recorded"] = np.concatenate([*recorded, rows])
        return table

    def require_bounded_forces(self, times: ArrayLike, forces: ArrayLike) -> None:
        limit = DIVERGED * (self.job.structure.k1 + self.job.structure.k2)
        rows = np.column_stack([times, forces])[: 0 if self.job.is_drive_alone else None]
        for time, force in rows[np.abs(rows[:, 1]) > limit][:1]:
            links = self.master.connection.links
            motion = " and ".join(links[name].theirs for name in MOTION if name in links)
            text = f"the coupling diverges at t = {time:.3g} s (box_force = {force:.2g} N)"
            if "box_force" not in links:
                raise FmuError(text) from None
            text += f": look at the unit of {motion} and the sign of box_force"
            text += f", connect {format_reversed_force(links)}; or reduce the step"
            raise FmuError(text) from None

    def run_steps(self, steps: range) -> Record:
        """Run both FMUs over some steps, the first one in parts where no acceleration is known."""
        h, divides = self.master.scheme.h, self.divides_first
        if steps.start or not divides:
            return self.inputs.run_master(self.master, steps, h, int(divides))
        parts = np.array(FIRST_STEP_PARTS) / sum(FIRST_STEP_PARTS) * h
        edges = np.append(0.0, np.cumsum(parts))
        rows = self.inputs.rows_over_steps(edges, self.master.input_width)
        runs = (self.master.run(rows[i : i + 1], h) for i, h in enumerate(parts.tolist()))
        pieces = join_records([*runs])
        if self.master.end_reason:
            raise FmuError(self.master.end_reason)
        begun = replace(pieces, ends=pieces.ends[-1:], recorded=pieces.recorded[-1:])
        return join_records([begun, self.inputs.run_master(self.master, steps[1:], h, 1)])


@dataclass(frozen=True, kw_only=True)
class CosimulateJob(CoupledJob, Question):
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
    family: ClassVar[tuple[str, ...]] = ("stroke",)  # at a wall the box's velocity jumps

    @property
    def is_drive_alone(self) -> bool:
        return not {"box_force", *PUSHES} & set(dict(self.connect))

    def parameters(self) -> dict[str, Any]:
        known = super().parameters()
        return {**known, "structure": None} if self.is_drive_alone else known

    def format_call(self) -> str:
        values: dict[str, Any] = {"connect": dict(self.connect), "units": dict(self.units)}
        values |= {"parameters": dict(self.start_values)}
        values |= {name: getattr(self, name) for name in ("duration", "step", "record", "start")}
        texts = (f"{name}={value!r}" for name, value in values.items() if value)
        described = format_brief(to_json_data(self.structure))
        structure = "None" if self.is_drive_alone else f"Structure{described}"
        return f"{self.asked}({structure}, {self.drive!r}, {', '.join(texts)})"

    def step_count(self) -> int:
        return round(self.duration / self.step)

    def communication_times(self, parts: int = 1) -> Floats:
        return np.linspace(0.0, self.duration, parts * self.step_count() + 1)

    def chunks(self) -> list[Chunk]:
        """Split the steps into chunks if the drive can give its state, to go on from."""
        if describe(self.drive).saves_states:
            return super().chunks()
        last = self.step_count()
        return [Chunk(0, 0, last, None), Chunk(1, last, last + 1, 0)]

    def progress_note(self, first: int) -> str:
        return "" if first or describe(self.drive).saves_states else "run (not resumable)"

    def advance(self, fmus: Fmus, steps: range, previous: Table | None) -> Table:
        response = previous["response"][-1] if previous else self.measure_response_to_force()
        table: Table = {"response": response[np.newaxis]}
        warned: dict[str, None] = {}
        for parts in self.step_divisions():
            before = previous and columns_of_division(previous, parts)
            if before and before["ended"][-1]:
                columns = {name: values[:0] for name, values in before.items()}  # nothing more
                columns["ended"] = before["ended"]
            else:
                with Instance(fmus[OSCILLATOR]) as one, Instance(self.drive, "drive") as drive:
                    coupling = CosimulationRun(self, (one, drive), parts, float(response[0]))
                    if before:
                        coupling.set_state(before)
                    columns = {**coupling.run_communication_steps(steps), **coupling.get_state()}
                    coupling.close()
                    warned |= drive.warnings
            table |= {f"{name} {parts}": values for name, values in columns.items()}
        table["warned"] = np.array(["\n".join(warned)])
        return table

    def initialize_and_connect(self, drive: Instance, inputs: Inputs) -> Connection:
        drive.initialize(**dict(self.start_values), **inputs.start_values())
        links = self.links_to(drive.description)
        return Connection(links, tuple(inputs.names), first_cubic=inputs.first_cubic)

    def links_to(self, drive: Description) -> dict[str, Link]:
        return checked_links(dict(self.connect), drive, dict(self.units), self.is_drive_alone)

    def measure_response_to_force(self) -> Floats:
        """Return the box's acceleration by 1 N at once, m/s2, and which part of it in a step.

        Raise ``InputError`` if it moves against the force.
        """
        seen: list[Any] = []
        if "box_force" not in dict(self.connect):
            return np.array([0.0, math.nan])
        for force in (0.0, 1.0):
            with suppress(FmuError), Instance(self.drive, "drive") as drive:
                inputs = Inputs(self.inputs, drive.description)
                connection = self.initialize_and_connect(drive, inputs)
                side = DriveSide(drive, replace(connection, inputs=()))  # they stay as they began
                side.set_inputs((force, 0.0, 0.0, 0.0), ())
                motion, about = [side.read_outputs()[:3]], drive.description
                short = 0.0 if about.has_fixed_step or about.internal_step else SHORT * self.step
                if short:
                    drive.step(0.0, short)
                    motion.append(side.read_outputs()[:3])
                drive.step(short, self.step)
                seen.append([*motion, side.read_outputs()[:3]])
        if len(seen) < 2:  # the run itself says what the drive does
            return np.array([0.0, math.nan])
        begin, *early, late = np.diff(seen, axis=0)[0]
        means = np.array([2.0 / self.step**2, 1.0 / self.step, 1.0]) * late
        soon = np.array([2.0 / short**2, 1.0 / short]) * early[0][:2] if early else means[:2]
        at_once = next((x for x in (begin[2], *soon[::-1]) if math.isfinite(x)), math.nan)
        moved = next((x for x in (at_once, *means) if math.isfinite(x) and x), 0.0)
        if moved < 0.0 and self.force_sign == "tested":
            text = f"1 N of box_force accelerates the box by {moved:.2g} m/s2, against the force; "
            text += f"connect {format_reversed_force(connection.links)}, or say "
            raise InputError(f"{text}force_sign='given' if that is meant")
        mean = next(x for x in means[[1, 0, 2]] if math.isfinite(x))
        return np.array([at_once, mean / at_once if at_once else math.nan])

    def inputs_left_at_start(self, drive: Description) -> Iterator[str]:
        """Yield ``name = start unit`` of each of the drive's inputs that nothing is given for."""
        links = self.links_to(drive).values()
        given = {*(link.theirs for link in links), *Inputs(self.inputs, drive).names}
        for name, one in drive.variables.items():
            if one.causality == "input" and name not in given:
                yield f"{name} = {one.start} {one.unit or ''}".rstrip()

    def step_divisions(self) -> tuple[int, ...]:
        """Return into how many parts steps are divided: 1, and 2 in a second run for the error."""
        return (1, 2) if self.estimate else (1,)

    def compute_from_all_steps(self, fmus: Fmus, table: Table) -> Table:
        runs = {parts: columns_of_division(table, parts) for parts in self.step_divisions()}
        times, ended = self.times_and_end_reason(runs)
        times = self.communication_times(self.points)[: self.points * (len(times) - 1) + 1]
        motions, run = [], runs[1]
        with Player(fmus[OSCILLATOR]) as player:
            for one in runs.values():
                done = one["nodes"] <= times[-1] if ended else slice(None)
                one |= {name: one[name][done] for name in IN_STEPS}
                player.start(self.structure, self.start)
                nodes = np.append(0.0, one["nodes"])
                pushes = (name for name in PUSHES if name in dict(self.connect))
                drives = (BOX_ACCELERATION, *pushes)
                motions.append(player.play(nodes, one["cubics"], times, OUTPUTS, drives))
        rows, touching, impacts = motions[0]
        columns = dict(zip(OUTPUTS, rows.T, strict=True)) | {"time": times, "in_contact": touching}
        if self.estimate:
            away = np.abs(rows - motions[1][0])[:, [OUTPUTS.index(name) for name in ("x1", "x2")]]
            columns["coupling_error"] = TO_HALF * away.max(axis=1)
        nodes, cubics = np.append(0.0, run["nodes"]), run["cubics"]
        inside = (nodes.searchsorted(times, side="right") - 1).clip(max=len(cubics) - 1)
        for i, name in enumerate(drives):
            cubic = tuple(cubics[inside, 4 * i : 4 * i + 4].T)
            columns[name] = end_derivatives(cubic, times - nodes[inside])[0]
        columns["step_time"] = times[:: self.points]
        work = np.append(0.0, np.cumsum(run["work"]))
        columns["box_work"] = work[nodes.searchsorted(columns["step_time"])]
        for _, control in self.inputs:
            if isinstance(control, InputControl):
                end = control.abort_time(tuple(run["control_memory"][-1].tolist()))
                columns["control_aborted"] = np.array([end])
        columns["response"], columns["ended"] = table["response"][:1], np.array([ended])
        return {**columns, **impact_columns(impacts, self.structure)}

    def times_and_end_reason(self, runs: Mapping[int, Table]) -> tuple[Floats, str]:
        ends = [np.max(run["nodes"], initial=0.0) for run in runs.values()]
        last, times = min(ends), self.communication_times()
        both = zip(runs.values(), ends, strict=True)
        texts = [text for run, end in both if end == last for text in run["ended"].tolist()]
        ended = next(filter(None, texts), "")
        if last < times[1]:
            raise FmuError(f"{ended}, in its first step; expected at least one of them")
        return times[times <= last], ended

    def dataset(self, table: Table) -> xr.Dataset:
        description = describe(self.drive)
        at_steps = "time" if self.points == 1 else "step_time"
        times = {"time": "time"} | {at_steps: "communication points"}
        structure = "no structure" if self.is_drive_alone else self.structure.label()
        resumable = "yes" if description.saves_states else "no: the drive cannot save its state"
        return xr.Dataset(
            self.motion_variables(table, at_steps) | self.drive_variables(table, at_steps),
            {name: variable(name, table[name], "s", text) for name, text in times.items()},
            {
                "title": f"{structure} on {description.name}",
                "drive": description.name,
                "recorded": ",".join(self.record),
                "inputs_at_start": ", ".join(self.inputs_left_at_start(description)),
                "response_in_a_step": float(table["response"][0][1]),
                "ended": str(table["ended"][-1]) or AT_THE_DURATION,
                "drive_warnings": "\n".join(dict.fromkeys(filter(None, table["warned"].tolist()))),
                "resumable": resumable,
            },
        )

    def motion_variables(self, table: Table, at_steps: str) -> dict[str, Variable]:
        shown = {**IN_TIME, **IN_TIME_TOO}
        work = shown.pop("box_work")
        acceleration = variable("time", table["box_acceleration"], *shown["box_acceleration"])
        if self.is_drive_alone:
            return {"box_acceleration": acceleration}
        variables = {
            n: variable("time", table[n], *about) for n, about in shown.items() if n in table
        }
        if "box_velocity" in dict(self.connect):
            variables["box_work"] = variable(at_steps, table["box_work"], *work)
        text = "whether the masses are in permanent contact"
        variables["in_contact"] = yes_or_no("time", table["in_contact"], text)
        return variables | impact_variables(table)

    def drive_variables(self, table: Table, at_steps: str) -> dict[str, Variable]:
        count, variables = len(table["step_time"]), {}
        recorded, finer = (table.get(f"recorded {i}", NOTHING)[:count].T for i in (1, 2))
        for i, name in enumerate(self.record):
            about = describe(self.drive).variable(name)
            text, unit = about.description or f"{name} of the drive", about.unit or "1"
            variables[name] = variable(at_steps, recorded[i], unit, text)
            if self.estimate:
                error = TO_HALF * np.abs(recorded[i] - finer[i])
                variables[f"{name}_error"] = variable(at_steps, error, unit, f"error of {text}")
        if "control_aborted" in table:
            text = "time at which the control gave up, NaN if it did not"
            variables["control_aborted"] = variable((), table["control_aborted"][-1], "s", text)
        return variables


def columns_of_division(table: Table, parts: int) -> Table:
    end = f" {parts}"
    return {name.removesuffix(end): table[name] for name in table if name.endswith(end)}


def format_reversed_force(links: Mapping[str, Link]) -> str:
    force = links["box_force"]
    return f"box_force={'-' if force.scale > 0.0 else ''}{force.theirs}"
