"""Couple the oscillator to any drive that is an FMU for co-simulation, ``orchestrate.cosimulate``.

The drive steps once: most cannot go back. The oscillator goes back instead. It first steps under an
extrapolated acceleration, which gives the force on the box; the drive steps with the mean of that
force, exact through impacts; then the oscillator does the step again under the acceleration between
both ends. So the coupling is of second order, of a drive of which nothing is asked but a step.

Once the accelerations over all steps are known, the motion is computed again by the FMU with
events: its impacts are exact, and it does not depend on communication points.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..access.begin import REST, begin
from ..access.channel import Channel
from ..access.description import Description, describe
from ..access.exported import finder
from ..access.instance import REAL_TYPES, Instance
from ..access.models import ELECTRODYNAMIC_SHAKER, OSCILLATOR, SHAKER
from ..access.play import CUBIC, PLAYED, Player
from ..checks import checked_integer
from ..errors import InputError
from ..response.labels import variable, yes_or_no
from ..response.questions import Question, checked_state, checked_structure
from ..response.simulate import IN_TIME, impact_columns, impact_variables
from ..running.job import Inputs, Table, brief, plain
from ..running.runner import answer
from ..structures import Excitation
from ..structures.drive import Drive
from ..structures.shaker import Shaker
from ..structures.structure import Structure
from .connection import FORCE, MOTION, OURS, BoxMotion, checked_links, checked_variable
from .polynomials import Cubic, integrate_work, matched_cubic
from .schedule import Course, check

if TYPE_CHECKING:
    import xarray as xr
    from typing_extensions import Unpack

    from ..running.options import Running

OUTPUTS = (*PLAYED, "box_force", "impact_energy")
EXCHANGED = ("box_force", "box_impulse", "box_impulse_moment")
IN_TIME_TOO = {
    "box_force": ("N", "force of springs and dampers on the box"),
    "impact_energy": ("J", "energy lost in impacts since the start"),
    "box_acceleration": ("m/s2", "acceleration of the box, as the oscillator has it"),
    "box_work": ("J", "work of that force on the drive since the start"),
    "coupling_error": ("m", "estimated error of x1 and x2 by the coupling, the larger one"),
}
BEGINNING = (1, 1, 2, 4, 8, 16, 32)  # parts of the first step where velocities are not known
MAX_STEPS = 10_000_000
Floats = NDArray[np.float64]
Values = tuple[tuple[str, float | bool], ...]


class Force(NamedTuple):
    """The force on the box over a step: at both ends, its mean, and its first moment over h^2."""

    first: float
    last: float
    mean: float
    moment: float


class DriveSide:
    """The drive's FMU: what is set, what is read, by our names and in SI."""

    def __init__(self, job: CosimulateJob, description: Description) -> None:
        self.job, self.links = job, checked_links(dict(job.connect), description)
        self.inputs = dict(job.inputs)
        self.instance = Instance(description.path, "drive")
        self.theirs = {name: self.links[name].theirs for name in MOTION if name in self.links}
        self.instance.initialize(
            **dict(job.start_values), **self.inputs_at(0.0), **self.force_inputs()
        )

    def inputs_at(self, time: float) -> dict[str, float]:
        """Return the drive's other inputs at a time."""
        return {name: course.voltage(time) for name, course in self.inputs.items()}

    def force_inputs(self, *derivatives: float) -> dict[str, float]:
        """Return the force, and those of its derivatives that are connected, by their names."""
        values = dict(zip(FORCE, (*derivatives, 0.0, 0.0, 0.0, 0.0), strict=False))
        links = {name: self.links[name] for name in FORCE if name in self.links}
        return {link.theirs: values[name] / link.scale for name, link in links.items()}

    def step(self, time: float, ahead: float, force: Force) -> None:
        """Step the drive once under a force: its cubic where it takes one, else its mean."""
        derivatives: Sequence[float] = (force.mean,)
        if FORCE[-1] in self.links:
            derivatives = matched_cubic(*force, ahead - time)
        inputs = self.inputs_at(0.5 * (time + ahead))
        self.instance.set(**inputs, **self.force_inputs(*derivatives))
        self.instance.step(time, ahead)

    def motion(self, time: float, force: float) -> dict[str, float]:
        """Return the motion of the box at a time, under the force there."""
        self.instance.set(**self.inputs_at(time), **self.force_inputs(force))
        values = self.instance.get(*self.theirs.values())
        return {
            name: self.links[name].scale * value
            for name, value in zip(self.theirs, values, strict=True)
        }

    def recorded(self) -> list[float]:
        """Return what is recorded of the drive, in its own units."""
        return [float(value) for value in self.instance.get(*self.job.record)]


class Coupling:
    """Both FMUs, stepped together: the accelerations of the box over all steps come of it."""

    def __init__(self, job: CosimulateJob, oscillator: Instance, drive: DriveSide) -> None:
        self.drive, self.time = drive, 0.0
        still = Excitation(frequency=job.structure.omega, amplitude=0.0)
        begin(oscillator, job.structure, still, job.start)
        self.channel = Channel(oscillator, CUBIC, EXCHANGED)
        self.force = self.channel.get()[0]
        self.box = BoxMotion([], {})
        self.box.add(0.0, drive.motion(0.0, self.force))
        self.work = 0.0

    def step(self, ahead: float) -> Cubic:
        """Do one communication step to a time; return the box acceleration over it."""
        h = ahead - self.time
        self.channel.save()
        force = self.try_step(self.box.ahead(), h)
        self.drive.step(self.time, ahead, force)
        acceleration = self.box.over_step(ahead, self.drive.motion(ahead, force.last))
        self.channel.restore()
        force = self.try_step(acceleration, h)
        outputs = self.drive.motion(ahead, force.last)
        if "box_velocity" in outputs:
            velocity = self.box.values["box_velocity"][-1]
            self.work += integrate_work(matched_cubic(*force, h), velocity, acceleration, h)
        self.box.add(ahead, outputs)
        self.time, self.force = ahead, force.last
        return acceleration

    def try_step(self, acceleration: Sequence[float], h: float) -> Force:
        """Step the oscillator under an acceleration of the box; return the force over the step."""
        self.channel.put(*acceleration)
        self.channel.step(self.time, h)
        last, impulse, moment = self.channel.get()
        return Force(self.force, last, impulse / h, moment / (h * h))


@dataclass(frozen=True, kw_only=True)
class CosimulateJob(Question):
    """Job of :func:`orchestrate.cosimulate`: the oscillator and a drive, over time."""

    drive: str  # path of its FMU
    drive_sha256: str
    connect: tuple[tuple[str, str], ...]
    start_values: Values = ()
    inputs: tuple[tuple[str, Course], ...] = ()
    duration: float
    step: float
    record: tuple[str, ...] = ()
    start: tuple[float, ...] = REST
    estimate: bool = True
    asked: ClassVar[str] = "cosimulate"

    def call_text(self) -> str:
        """Return Python source of the call that repeats this job."""
        values = {"connect": dict(self.connect), "parameters": dict(self.start_values)}
        values |= {name: getattr(self, name) for name in ("duration", "step", "record", "start")}
        texts = (f"{name}={value!r}" for name, value in values.items() if value)
        structure = f"Structure{brief(plain(self.structure))}"
        return f"{self.asked}({structure}, {self.drive!r}, {', '.join(texts)})"

    def items(self, inputs: Inputs) -> Sequence[int]:
        """Return the one item: the whole run."""
        return [0]

    def times(self) -> Floats:
        """Return the communication points, s."""
        count = math.ceil(self.duration / self.step - 1e-9)
        return np.append(self.step * np.arange(count), self.duration)

    def work(self, fmus: Mapping[str, Path], items: Sequence[int], previous: Table | None) -> Table:
        """Run both FMUs; return the columns over time, and the impacts."""
        times, columns, impacts = self.times(), *self.run(fmus[OSCILLATOR])
        if self.estimate:
            finer, _ = replace(self, step=0.5 * self.step, record=()).run(fmus[OSCILLATOR])
            shared = finer["time"].searchsorted(times)
            away = [np.abs(columns[name] - finer[name][shared]) for name in ("x1", "x2")]
            columns["coupling_error"] = 4.0 / 3.0 * np.max(away, axis=0)
        return {**columns, **impact_columns(impacts, self.structure)}

    def run(self, oscillator: Path) -> tuple[dict[str, Floats], Any]:
        """Run both FMUs at the job's step; return columns over time, and the impacts."""
        drive = DriveSide(self, describe(self.drive))
        times = self.times()
        try:
            with Instance(oscillator) as plain:
                coupling = Coupling(self, plain, drive)
                nodes, cubics = [0.0], []
                recorded, work = [drive.recorded()], [0.0]
                for index, target in enumerate(times[1:].tolist()):
                    for end in self.ends(index, target, coupling):
                        cubics.append(coupling.step(end))
                        nodes.append(end)
                    recorded.append(drive.recorded())
                    work.append(coupling.work)
        finally:
            drive.instance.close()
        with Player(oscillator) as player:
            player.start(self.structure, self.start)
            rows, touching, impacts = player.play(np.array(nodes), np.array(cubics), times, OUTPUTS)
        accelerations = dict(zip(nodes, cubics, strict=False))
        box = [accelerations[time][0] for time in times[:-1].tolist()]
        columns = dict(zip(OUTPUTS, rows.T, strict=True))
        columns |= {"time": times, "in_contact": touching, "box_work": np.array(work)}
        box.append(acceleration_at(cubics[-1], nodes[-1] - nodes[-2]))
        columns["box_acceleration"] = np.array(box)
        names = (f"drive {name}" for name in self.record)
        columns |= dict(zip(names, np.array(recorded).T, strict=True))
        return columns, impacts

    def ends(self, index: int, target: float, coupling: Coupling) -> list[float]:
        """Return the ends of a step's parts: the first has some without an acceleration."""
        is_fixed = coupling.drive.instance.description.has_fixed_step
        if index or is_fixed or "box_acceleration" in coupling.box.values:
            return [target]
        return [target * part for part in np.cumsum(BEGINNING) / sum(BEGINNING)]

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return the dataset over communication points, and of the impacts."""
        import xarray as xr

        names = {**IN_TIME, **IN_TIME_TOO}
        description = describe(self.drive)
        theirs = {}
        for name in self.record:
            about = description.variable(name)
            text = about.description or f"{name} of the drive"
            theirs[name] = variable("time", table[f"drive {name}"], about.unit or "1", text)
        knows_velocity = any(ours == "box_velocity" for ours, _ in self.connect)
        shown = [n for n in names if n in table and (n != "box_work" or knows_velocity)]
        contact = "whether the masses are in permanent contact"
        return xr.Dataset(
            {
                **{name: variable("time", table[name], *names[name]) for name in shown},
                "in_contact": yes_or_no("time", table["in_contact"], contact),
                **theirs,
                **impact_variables(table),
            },
            {"time": variable("time", table["time"], "s", "communication points")},
            {
                "title": f"{self.structure.label()} on {description.name}",
                "drive": description.name,
                "recorded": ",".join(self.record),
            },
        )


def acceleration_at(cubic: Sequence[float], h: float) -> float:
    """Return a cubic of value and derivatives, a time later."""
    a0, a1, a2, a3 = cubic
    return a0 + h * (a1 + 0.5 * h * (a2 + h * a3 / 3.0))


def cosimulate(
    structure: Structure,
    drive: str | PathLike[str] | Drive | Shaker,
    *,
    connect: Mapping[str, str] | None = None,
    parameters: Mapping[str, float | bool] | None = None,
    inputs: Mapping[str, float | Course | tuple[ArrayLike, ArrayLike]] | None = None,
    duration: float,
    step: float,
    record: Sequence[str] | None = None,
    start: ArrayLike | None = None,
    estimate: bool = True,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Couple the oscillator to a drive that is an FMU, and simulate both.

    Parameters
    ----------
    structure : Structure
        Delaminated or bonded.
    drive : path, Drive or Shaker
        An FMU of FMI 2.0 or 3.0 for co-simulation that moves the box, of any tool; or one of the
        package's own: a motor with an unbalance, an electrodynamic shaker.
    connect : mapping of str to str
        The drive's variables by the names here. Of ``box_acceleration`` (m/s2), ``box_velocity``
        and ``box_position`` at least one is an output of the drive; ``box_force`` (N) is its input,
        the force of springs and dampers on the box, positive as the box's motion. A name with a
        minus before it, as ``"-force"``, counts with the other sign; other units of the same kind
        are converted. A drive that takes derivatives of the force has them as ``box_force_1`` to
        ``box_force_3``. By default the names of the package's own drives.
    parameters : mapping of str to float, optional
        Start values of the drive, by its names.
    inputs : mapping, optional
        Its other inputs: a number, times in s with values, or a :class:`orchestrate.Course`.
    duration, step : float
        Of the run, and the communication step, s.
    record : sequence of str, optional
        Variables of the drive that are stored.
    start : array_like of 4 floats, optional
        x1, x2 in m, v1, v2 in m/s at time 0, relative to the box; at rest by default.
    estimate : bool
        Whether the coupling's error is estimated, by a second run with half the step.
    **running
        ``store``, ``progress`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over ``time``, the communication points in s: ``x1``, ``x2``, ``v1``, ``v2``, ``x_rel``,
        ``v_rel``, ``contact_force``, ``in_contact``, ``box_force``, ``impact_energy``,
        ``box_acceleration``, what is recorded of the drive by its names, ``box_work`` where a
        velocity is connected, and ``coupling_error``, the larger error of ``x1`` and ``x2`` in m.
        Over ``impact``: ``impact_time``, ``impact_velocity``, ``impulse`` and ``sticks``.

    Raises
    ------
    InputError
        Where a connection cannot be made, a name is not the drive's, or a number is out of its
        range.
    FmuError
        Where an FMU refuses a step.

    Notes
    -----
    The drive does each step once, so it need not be able to go back; the oscillator does it twice.
    Its second step is under the acceleration between both ends of the step, a line (with a velocity
    a parabola of the same mean), and the drive is under the force's mean, which is exact through
    impacts. Errors are of second order in the step as long as the drive's acceleration follows its
    force at once when it is read; of a drive whose outputs change in steps alone they are of first
    order, unless its velocity is connected. After impacts that one of the two runs has and the
    other not, or in chaos, the estimated error is as large as the motion.

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
        connect, drive = connect or OURS, finder(running)(model).path
    path = Path(drive).resolve()
    description = describe(path)
    checked_links(connect or {}, description)
    for name, value in (("duration", duration), ("step", step)):
        check(name, value, "s", low=0.0, exclusive=True)
    count = checked_step_count(duration, step, description)
    job = CosimulateJob(
        name=f"cosimulate_{checked_structure(structure).label()}_{path.stem}",
        structure=structure,
        drive=str(path),
        drive_sha256=hashlib.sha256(path.read_bytes()).hexdigest(),
        connect=tuple((connect or {}).items()),
        start_values=checked_parameters(parameters or {}, description),
        inputs=checked_inputs(inputs or {}, description, duration),
        duration=float(duration),
        step=float(duration) / count if description.has_fixed_step else float(step),
        record=checked_record(record or (), description),
        start=checked_state("start", start, structure),
        estimate=bool(estimate),
    )
    return answer(job, running, finder(running), foreign)


def checked_step_count(duration: float, step: float, drive: Description) -> int:
    """Return the number of steps; raise ``InputError`` if a drive of equal steps has a rest."""
    count = round(duration / step)
    if drive.has_fixed_step and not math.isclose(count * step, duration, rel_tol=1e-9):
        raise InputError(
            f"duration = {duration} s, step = {step} s: the FMU {drive.name} takes steps of one "
            "length alone; expected a duration that is a whole number of steps"
        )
    return checked_integer("duration/step", max(count, 1), 1, MAX_STEPS)


def checked_parameters(parameters: Mapping[str, Any], drive: Description) -> Values:
    """Return start values of the drive by its names; raise ``InputError`` for what it has not."""
    checked: list[tuple[str, float | bool]] = []
    for name, value in parameters.items():
        checked_variable(drive, name, "", any_type=True)
        if isinstance(value, (bool, np.bool_)):
            checked.append((name, bool(value)))
            continue
        check(name, value, str(drive.variable(name).unit or ""))
        checked.append(
            (name, float(value) if drive.variable(name).type in REAL_TYPES else int(value))
        )
    return tuple(checked)


def checked_inputs(
    inputs: Mapping[str, Any], drive: Description, duration: float
) -> tuple[tuple[str, Course], ...]:
    """Return the drive's other inputs as courses over time."""
    courses = []
    for name, value in inputs.items():
        checked_variable(drive, name, "input")
        if not isinstance(value, Course):
            times, values = value if isinstance(value, tuple) else ((0.0, duration), (value, value))
            try:
                value = Course(tuple(np.ravel(times)), tuple(np.ravel(values)))
            except (TypeError, ValueError):
                raise InputError(
                    f"inputs: {name} = {value!r}: expected a number, (times, values) or a Course"
                ) from None
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
