"""Couple the oscillator to any drive that is an FMU for co-simulation, ``orchestrate.cosimulate``.

The job is in :mod:`.cosimulation_job`.
"""

from __future__ import annotations

import hashlib
import math
import warnings
from collections.abc import Container, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from ..errors import NOT_NUMBERS, InputError
from ..fmu.description import Description, describe_runnable
from ..fmu.exported import make_fmu_finder
from ..fmu.instance import REAL_TYPES
from ..fmu.models import ELECTRODYNAMIC_SHAKER, MOTOR_SHAKER
from ..lazy import Unpack, xr
from ..model.arguments import Count, checked_mapping, checked_path, checked_texts, checked_word
from ..model.drive import Drive
from ..model.ranges import checked_range
from ..model.shaker import Shaker
from ..model.structure import Structure
from ..response.questions import checked_state, checked_structure
from ..response.simulate import IN_TIME
from ..running.options import Running
from ..running.runner import compute_dataset
from .connection import FORCE, MOTION, OURS, checked_links, checked_units, checked_variable
from .controllers import InputControl
from .cosimulation_job import AT_THE_DURATION, IN_TIME_TOO, CosimulateJob, Values
from .inputs import Input, check_input_connections
from .master import MAX_STEPS_KEPT
from .schedule import Course

# in place of the structure where there is none: the drive does not feel it
BALLAST = Structure(m1=1.0, m2=1.0, k1=1.0, k2=1.0, bonded=True)
ForceSign = Literal["tested", "given"]
NOTICED = 0.01  # of the largest displacement: a larger coupling error gives a warning
RESOLVED = 0.5  # of a drive's response to a force at once, its mean over a step, else a warning


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
    force_sign: ForceSign = "tested",
    points: Count = 1,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Couple the oscillator to a drive that is an FMU, and simulate both.

    Parameters
    ----------
    structure : Structure or None
        Delaminated or bonded; ``None`` for only the drive, which has no ``box_force`` then.
    drive : path, Drive or Shaker
        An FMU of FMI 2.0 or 3.0 for co-simulation that moves the box, of any tool; or one of the
        package's own: a motor with an unbalance, an electrodynamic shaker.
    connect : mapping of str to str
        The drive's variables by the names here. Of ``box_acceleration`` (m/s2), ``box_velocity``
        and ``box_position`` at least one is an output of the drive; ``box_force`` (N) is its input,
        the force of springs and dampers on the box, positive as the box's motion. A name with a
        minus before it, as ``"-force"``, counts with the other sign; other units of the same kind
        are converted, and ``"pos[mm]"`` states one as ``units`` does. A drive that takes
        derivatives of the force has them as ``box_force_1`` to ``box_force_3``. Outputs ``force1``
        and ``force2`` (N) act on the halves, with or without a box that moves. By default the names
        of the package's own drives.
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
        ``box_acceleration``, ``force1`` and ``force2`` where connected, what is recorded of the
        drive by its names, with its estimated error as ``NAME_error``, ``box_work`` where a
        velocity is connected, ``coupling_error``, the larger error of ``x1`` and ``x2`` in m, and
        of a control the time ``control_aborted``. Attributes: ``ended``, when and why the drive
        ended the simulation before the duration, with what was reached until then, and
        ``drive_warnings``, what it warned of; both are given as warnings too. Over ``impact``:
        ``impact_time``, ``impact_velocity``, ``impulse`` and ``sticks``.

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
    otherwise, of second order if it is only the acceleration and inputs change or the force acts
    late, as long as the acceleration is that under the present force when it is read. Of a drive
    whose outputs change only in steps they are of first order, unless its velocity is connected.
    After impacts that one of the two runs has and the other not, or in chaos, the estimated error
    is as large as the motion.

    An interrupted run resumes where the drive can save its state (``canSerializeFMUstate``); else
    it restarts, as ``resumable`` in the attributes says.

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
    mappings = {"connect": connect, "units": units, "parameters": parameters, "inputs": inputs}
    connect, units, parameters, inputs = (checked_mapping(*one) for one in mappings.items())
    foreign = not isinstance(drive, (Drive, Shaker))
    if isinstance(drive, (Drive, Shaker)):
        parameters = {**drive.parameters(), **parameters}
        model = MOTOR_SHAKER if isinstance(drive, Drive) else ELECTRODYNAMIC_SHAKER
        ours = {name: name for name in OURS if structure is not None or name not in FORCE}
        connect, drive = connect or ours, make_fmu_finder(running)(model).path
    path = checked_path("drive", drive).resolve()
    description = describe_runnable(path)
    units = checked_units(units, description)
    links = checked_links(connect, description, units, structure is None)
    for name, value in (("duration", duration), ("step", step)):
        checked_range(name, value, "s", low=0.0, open_low=True)
    checked_range("duration/step", duration / step, high=MAX_STEPS_KEPT)
    step = checked_step(duration, step, description, estimate)
    estimate = estimate and structure is not None
    checked = checked_structure(BALLAST if structure is None else structure)
    job = CosimulateJob(
        name=f"cosimulate_{checked.label() if structure else 'alone'}_{path.stem}",
        structure=checked,
        duration=duration,
        estimate=estimate,
        drive=str(path),
        drive_sha256=hashlib.sha256(path.read_bytes()).hexdigest(),
        connect=tuple(connect.items()),
        units=tuple(units.items()),
        start_values=checked_parameters(parameters, description),
        inputs=checked_inputs(inputs, description, duration),
        step=step,
        record=checked_recorded_names(record, description),
        start=checked_state("start", start, checked),
        force_sign=checked_word("force_sign", force_sign, get_args(ForceSign)),
        points=points,
    )
    check_input_connections(job.inputs, links)
    digest = job.drive_sha256 if foreign else ""
    run = compute_dataset(job, running, make_fmu_finder(running), digest)
    warn_of_run(run, links, estimate)
    return run


def checked_step(duration: float, step: float, drive: Description, estimate: bool) -> float:
    """Return the length of equal steps; raise ``InputError`` if the drive cannot take such ones."""
    count = max(1, math.ceil(duration / step - 1e-9))
    internal, parts = drive.internal_step, 2 if estimate else 1
    taken = duration / count / parts
    multiple = round(taken / internal) if internal else 0
    if internal and (multiple < 1 or not math.isclose(taken, multiple * internal, rel_tol=1e-9)):
        why = ", half of which is for the error's estimate" if estimate else ""
        raise InputError(
            f"step = {step} s: the FMU {drive.name} calculates in steps of {internal:g} s "
            f"(fixedInternalStepSize); expected a multiple of {parts * internal:g} s{why}, and a "
            "duration that is a whole number of steps"
        )
    if drive.has_fixed_step and not math.isclose(count * step, duration, rel_tol=1e-9):
        raise InputError(
            f"duration = {duration} s, step = {step} s: the FMU {drive.name} takes only steps "
            "of one length; expected a duration that is a whole number of steps"
        )
    return float(duration) / count


def checked_parameters(parameters: Mapping[str, Any], drive: Description) -> Values:
    checked: list[tuple[str, float | bool]] = []
    for name, value in parameters.items():
        if checked_variable(drive, name, "", any_type=True).initial == "calculated":
            raise InputError(f"parameters: {name} of the FMU {drive.name} has no start value")
        if isinstance(value, (bool, np.bool_)):
            checked.append((name, bool(value)))
            continue
        checked_range(name, value, str(drive.variable(name).unit or ""))
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
            except NOT_NUMBERS:
                text = "expected a number, (times, values) or a Course"
                raise InputError(f"inputs: {name} = {value!r:.60}: {text}") from None
        courses.append((name, value))
    return tuple(courses)


def checked_recorded_names(record: Any, drive: Description) -> tuple[str, ...]:
    record = checked_texts("record", record)
    for name in record:
        checked_variable(drive, name, "", any_type=True)
        if name in (*IN_TIME, *IN_TIME_TOO):
            raise InputError(f"record: {name} is a name of the oscillator's; leave it out")
    return tuple(dict.fromkeys(record))


def warn_of_run(run: xr.Dataset, links: Container[str], estimate: bool) -> None:
    """Warn with what the drive warned of, of an early end, a step that is too long, and errors."""
    attributes = getattr(run, "attrs", {})  # of a job alone none
    texts = attributes.get("drive_warnings", "").splitlines()
    if (ended := attributes.get("ended", AT_THE_DURATION)) != AT_THE_DURATION:
        texts.append(f"{ended}; the result ends there")
    unconnected = ", ".join(name for name in MOTION if name not in links)
    unconnected = "" if unconnected == ", ".join(MOTION) else unconnected
    share = attributes.get("response_in_a_step", math.nan)
    if unconnected and share < RESOLVED:
        text = f"a force accelerates the box by {share:.2g} in a step, where it does by 1 at once: "
        text += "the step is too long for the drive's own motion"
        texts.append(f"{text}; reduce it or connect {unconnected}")
    if estimate and "coupling_error" in getattr(run, "data_vars", ()):
        size = max(float(abs(run[name]).max()) for name in ("x1", "x2"))
        error = float(run.coupling_error.max())
        if error > NOTICED * size:  # it may hide impacts or make some
            more = f" and connect {unconnected} if the drive has it" if unconnected else ""
            text = f"coupling error {error:.2g} m of displacements up to {size:.2g} m: "
            diverges = "it diverges: look at units"
            text += diverges if error > size else "impacts may be missed or added"
            texts.append(f"{text}; reduce the step{more}")
    for text in texts:
        warnings.warn(text, stacklevel=3)
