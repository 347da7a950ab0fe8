"""Runs with states saved and restored keep their bits."""

from __future__ import annotations

import functools
import random
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from orchestrate.access import OSCILLATOR, SHAKER, Instance, find
from orchestrate.access.events import EventInstance
from orchestrate.errors import FmuError, InputError

from . import parameter_sets
from .findings import expect_none
from .test_bits import STATE, STEP, Bits, to_hexadecimal

STEPS = 40  # of a course
LONGEST = 60.0  # rad of the slower mass that a course lasts at most
MANY = 500.0  # impacts of a course, from which on no importer stops at each of them
PYTHON_EVERY, SHAKER_EVERY = 12, 5  # courses
CUBIC = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
FORCE = ("box_force", "box_force_1", "box_force_2", "box_force_3")
POINT = {  # outputs of a point of time, and of the step before it
    OSCILLATOR: STATE,
    SHAKER: (
        *("box_position", "box_velocity", "box_acceleration", "box_jerk", "angle", "speed"),
        *("motor_current", "motor_torque", "motor_energy", "box_force_work", "stored_energy"),
    ),
}
OF_STEP = {OSCILLATOR: STEP, SHAKER: ()}
Values = dict[str, float]
Kinds = Sequence[tuple[type, str]]  # of instances among which states are moved
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")


@dataclass(frozen=True)
class InputCourse:
    """A run to be compared: start values, then inputs to set and times to step to."""

    model: str
    values: Values
    start_time: float
    steps: tuple[tuple[Values, float], ...]

    @property
    def output_names(self) -> tuple[str, ...]:
        """Return the names of the compared outputs; those at a point of time first."""
        return (*POINT[self.model], *OF_STEP[self.model])


@functools.cache
def fmu_path(model: str, form: str) -> Path:
    """Return the path of a model's FMU in a form, of the present sources."""
    return find(model, form).path


def draw_course(seed: int, number: int) -> InputCourse:
    """Draw the course of a number under a seed."""
    rng = random.Random(f"{seed} {number}")
    if number % SHAKER_EVERY == 0:
        values = {"voltage": rng.uniform(2.0, 12.0), "armature_inductance": rng.choice((0.0, 0.05))}
        values |= draw_force(rng)
        return InputCourse(
            SHAKER, values, 0.0, draw_steps(rng, 0.0, rng.uniform(0.1, 4.0), draw_motor_inputs(rng))
        )
    drawn = parameter_sets.draw_parameter_set(seed, number)
    values = {**drawn.values, "x_rel_max_on": float(rng.random() < 0.7)}
    slower = min(parameter_sets.natural_frequencies(drawn.values))
    duration = min(drawn.duration, LONGEST * rng.uniform(0.1, 1.0) / slower)
    scale = values["box_amplitude"] * values["box_frequency"] ** 2 or 1.0
    size = [scale * slower**i for i in range(4)]
    inputs = [
        {name: rng.uniform(-0.2, 0.2) * size[i] * rng.choice((0.0, 1.0, 1.0))}
        for i, name in enumerate(CUBIC)
    ]
    for name in ("box_amplitude", "box_frequency"):
        inputs += [{name: values[name] * rng.uniform(0.5, 1.5)}, {name: values[name]}]
    if rng.random() < 0.7:
        values |= inputs[rng.randrange(4)]
    return InputCourse(
        OSCILLATOR, values, drawn.start_time, draw_steps(rng, drawn.start_time, duration, inputs)
    )


def draw_force(rng: random.Random) -> Values:
    """Draw a force on the shaker's box, as a cubic."""
    return {name: rng.uniform(-2.0, 2.0) * 5.0**i for i, name in enumerate(FORCE)}


def draw_motor_inputs(rng: random.Random) -> list[Values]:
    """Draw inputs of the shaker that may be set during a run."""
    single = [{name: value} for name, value in draw_force(rng).items()]
    return [*single, draw_force(rng), {"voltage": rng.uniform(2.0, 12.0)}]


def draw_steps(
    rng: random.Random, start: float, duration: float, inputs: Sequence[Values]
) -> tuple[tuple[Values, float], ...]:
    """Draw ``STEPS`` pairs by time: inputs to set, often ``{}``, and the end time, s."""
    parts = sorted(rng.random() for _ in range(STEPS))
    return tuple(
        (rng.choice(inputs) if rng.random() < 0.35 else {}, start + duration * part)
        for part in parts
    )


def as_keywords(values: Values) -> dict[str, Any]:
    """Return start values as keywords for an instance."""
    flags = {name: bool(values[name]) for name in ("bonded", "x_rel_max_on") if name in values}
    return {**values, **flags}


def advance(instance: Instance, time: float, target: float) -> None:
    """Step to a time through early returns; a step of length 0 counts too."""
    if isinstance(instance, EventInstance) and target > time:
        instance.advance(time, target)
    else:
        instance.step(time, target)


def run_undisturbed(course: InputCourse, path: Path) -> list[Bits]:
    """Return the outputs after each step of a course, up to the first that fails."""
    rows: list[Bits] = []
    with Instance(path) as instance:
        try:
            instance.initialize(course.start_time, **as_keywords(course.values))
            time = course.start_time
            for inputs, target in course.steps:
                instance.set(**inputs)
                instance.step(time, target)
                time = target
                rows.append(read_outputs(instance, course.output_names))
        except (FmuError, InputError):
            pass
    return rows


def read_outputs(instance: Instance, names: Sequence[str]) -> Bits:
    """Return the instance's outputs as texts with all bits."""
    return to_hexadecimal([float(value) for value in instance.get(*names)])


def wander(rng: random.Random, instance: Instance, course: InputCourse, time: float) -> None:
    """Change an instance's inputs, step it or start another run: what a restore must undo."""
    try:
        if rng.random() < 0.1:
            instance.reset()
            instance.initialize(course.start_time)
            time = course.start_time
        for _ in range(rng.randrange(3)):
            inputs, target = rng.choice(course.steps)
            instance.set(**inputs)
            if target >= time:
                advance(instance, time, time + (target - time) * rng.random() ** 4)
                return
    except (FmuError, InputError):
        pass


def restore_in_event_mode(rng: random.Random, instance: EventInstance, course: InputCourse) -> None:
    """Save and restore a state in event mode, where the instance is."""
    data = instance.save_state()
    instance.call("updateDiscreteStates")
    instance.call("enterStepMode")
    wander(rng, instance, course, float("inf"))
    instance.restore_state(data)


def advance_disturbed(
    rng: random.Random, instance: EventInstance, course: InputCourse, time: float, end: float
) -> int:
    """Step to ``end`` with restores in event mode; return their number.

    -1 where no step size of 53 bits leads from an impact to ``end``: another time is not compared.
    Where the clock's last digit puts an impact at ``end``, a step of no length follows: an early
    return shows the state at the impact.
    """
    restored, event = 0, True
    while event or time < end:
        if time + (end - time) != end:
            return -1
        event, _, _, time = instance.call("doStep", time, end - time)
        if event:
            instance.call("enterEventMode")
            if not restored or rng.random() < 0.02:
                restore_in_event_mode(rng, instance, course)
                restored += 1
            instance.call("updateDiscreteStates")
            instance.call("enterStepMode")
    return restored


def restore_in_memory(
    rng: random.Random, instance: Instance, course: InputCourse, time: float
) -> None:
    """Save a state in memory, change the instance's motion at random, and restore the state."""
    get, _, _, put, free = instance.state_calls()
    state = instance.call(get)
    try:
        wander(rng, instance, course, time)
        instance.call(put, state)
    finally:
        instance.call(free, state)


def restore_elsewhere(
    rng: random.Random,
    instance: Instance,
    others: Sequence[Instance],
    course: InputCourse,
    time: float,
) -> Instance:
    """Save a state, change the motion, and restore: here, or serialised in another instance."""
    if rng.random() < 0.4:
        restore_in_memory(rng, instance, course, time)
        return instance
    data = instance.save_state()
    wander(rng, instance, course, time)
    taken = rng.choice(others)
    taken.restore_state(data)
    return taken


def run_disturbed(
    rng: random.Random, course: InputCourse, rows: Sequence[Bits], pool: Sequence[Instance]
) -> tuple[int, str]:
    """Run with a restore before each step; return the restores' number, what is wrong ("")."""
    here, time, restored = pool[0], course.start_time, 0
    here.initialize(course.start_time, **as_keywords(course.values))
    for number, ((inputs, target), row) in enumerate(zip(course.steps, rows, strict=False)):
        pending = rng.random() < 0.5
        if pending:  # a state in which inputs are set that no step has seen yet
            here.set(**inputs)
        here = restore_elsewhere(rng, here, pool, course, time)
        restored += 1
        if not pending:
            here.set(**inputs)
        end, stops = time + (target - time), 0  # where a step ends, to the last bit
        if isinstance(here, EventInstance) and end > time:
            data = here.save_state()
            stops = 1 + advance_disturbed(rng, here, course, time, end)
            restored += stops
            if not stops:
                here = pool[0]
                here.restore_state(data)
        if not stops:
            here.step(time, target)
        names = POINT[course.model] if stops else course.output_names
        row_here = read_outputs(here, names)
        if row_here != row[: len(names)]:
            wrong = [name for name, a, b in zip(names, row_here, row, strict=False) if a != b]
            return restored, f"step {number}: {', '.join(wrong)}"
        time = target
    return restored, ""


def instance_pools(course: InputCourse, number: int, rows: Sequence[Bits]) -> list[Kinds]:
    """Return the kinds of instances among which states may be moved."""
    native: list[tuple[type, str]] = [(Instance, "fmi3"), (Instance, "fmi2"), (Instance, "fmi3")]
    if course.model == OSCILLATOR:
        impacts = float.fromhex(rows[-1][STATE.index("impact_count")])
        native += [(EventInstance, "fmi3")] * (impacts < MANY)
    forms: list[Kinds] = [native]
    if number % PYTHON_EVERY == 1:
        forms.append([(Instance, "fmi2-python")] * 2)
    return forms


def compare(
    seed: int, number: int, course: InputCourse, rows: Sequence[Bits], kinds: Kinds
) -> tuple[int, str]:
    """Run a course with restores; return their number, and what is wrong ("")."""
    rng = random.Random(f"{seed} {number} {kinds[0][1]}")
    with ExitStack() as stack:
        pool = [stack.enter_context(k(fmu_path(course.model, form))) for k, form in kinds]
        try:
            return run_disturbed(rng, course, rows, pool)
        except (FmuError, InputError) as error:
            return 1, f"refused: {error}"


def attack(seed: int, budget: int, counts: Counter[str]) -> Iterator[str]:
    """Yield what is wrong in courses with ``budget`` restores or more."""
    number = 0
    while counts["restores"] < budget:
        course = draw_course(seed, number)
        rows = run_undisturbed(course, fmu_path(course.model, "fmi3"))
        for kinds in instance_pools(course, number, rows) if rows else ():
            restored, wrong = compare(seed, number, course, rows, kinds)
            counts += {"restores": restored, kinds[0][1]: restored, course.model: restored}
            if wrong:
                yield f"course {number}, {kinds[0][1]}: {wrong}"
        number += 1


@pytest.mark.slow
@pytest.mark.budget(20_000)  # restores
def test_saved_states_restore_a_run_to_the_last_bit(exported, seed, budget):
    """Before each step a state is saved, the instance led astray, and the state restored.

    From memory or bytes, in the same instance or another, of FMI 2.0, of FMI 3.0 or in event mode;
    at half of them after inputs were set. Each fifth course is MotorShaker's.
    """
    counts: Counter[str] = Counter()
    findings = list(attack(seed, budget, counts))
    assert {OSCILLATOR, SHAKER, "fmi3", "fmi2-python"} <= set(counts)
    expect_none(findings, counts)


RESTORE = Instance.restore_state


def forget_all(instance, data):
    """As if nothing had been restored."""


def forget_when_inputs_were_set(instance, data):
    """As if the time of setting were no part of the state: a cubic begins again."""
    RESTORE(instance, data)
    if "box_snap" in instance.description.variables:
        instance.set(**dict(zip(CUBIC, instance.get(*CUBIC), strict=True)))


@pytest.mark.slow
@pytest.mark.parametrize("fault", [forget_all, forget_when_inputs_were_set])
def test_a_state_that_lacks_something_is_found(exported, monkeypatch, fault):
    monkeypatch.setattr(Instance, "restore_state", fault)
    assert list(attack(3, 100, Counter()))
