"""Runs with states saved and restored keep their bits."""

import random
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from typing import Any

import pytest

from orchestrate.errors import FmuError, InputError
from orchestrate.fmu import MOTOR_SHAKER, OSCILLATOR, Instance, find
from orchestrate.fmu.events import EventInstance

from .findings import expect_none
from .parameter_sets import draw_parameter_set, natural_frequencies
from .test_bits import STATE, STEP, Bits, to_hexadecimal

STEPS = 40  # of a course
LONGEST = 60.0  # rad of the slower mass that a course lasts at most
MANY = 500.0  # impacts of a course, from which on no importer stops at each of them
PYTHON_EVERY, SHAKER_EVERY = 12, 5  # courses
CUBIC = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
FORCE = ("box_force", "box_force_1", "box_force_2", "box_force_3")
POINT = {  # outputs of a point of time; the oscillator has those of the step before it too
    OSCILLATOR: STATE,
    MOTOR_SHAKER: (
        *("box_position", "box_velocity", "box_acceleration", "box_jerk", "angle", "speed"),
        *("motor_current", "motor_torque", "motor_energy", "box_force_work", "stored_energy"),
    ),
}
REFUSALS = (FmuError, InputError)
Values = dict[str, float]
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")


@dataclass(frozen=True)
class Course:
    """A run to be compared: start values, then inputs to set and times to step to."""

    model: str
    values: dict[str, Any]
    start: float  # s
    steps: tuple[tuple[Values, float], ...]

    def begin(self, instance: Instance) -> float:
        """Initialize an instance; return the time."""
        instance.initialize(self.start, **self.values)
        return self.start

    def read(self, instance: Instance, of_step: bool = True) -> Bits:
        """Return the outputs with all bits."""
        more = STEP if of_step and self.model == OSCILLATOR else ()
        return to_hexadecimal(instance.get(*POINT[self.model], *more))


def draw_course(seed: int, number: int) -> Course:
    """Draw a course; each fifth is MotorShaker's."""
    rng = random.Random(f"{seed} {number}")
    if number % SHAKER_EVERY == 0:
        force = {name: rng.uniform(-2.0, 2.0) * 5.0**i for i, name in enumerate(FORCE)}
        inputs = [{name: value} for name, value in force.items()]
        inputs += [force, {"voltage": rng.uniform(2.0, 12.0)}]
        values = {"voltage": rng.uniform(2.0, 12.0), "armature_inductance": rng.choice((0.0, 0.05))}
        values, start, duration = values | force, 0.0, rng.uniform(0.1, 4.0)
    else:
        drawn = draw_parameter_set(seed, number)
        values, start = {**drawn.values, "x_rel_max_on": rng.random() < 0.7}, drawn.start_time
        values["bonded"] = bool(values.get("bonded"))
        slower = min(natural_frequencies(drawn.values))
        duration = min(drawn.duration, LONGEST * rng.uniform(0.1, 1.0) / slower)
        scale = values["box_amplitude"] * values["box_frequency"] ** 2 or 1.0
        inputs = [
            {name: rng.uniform(-0.2, 0.2) * scale * slower**i * rng.choice((0.0, 1.0, 1.0))}
            for i, name in enumerate(CUBIC)
        ]
        for name in ("box_amplitude", "box_frequency"):
            inputs += [{name: values[name] * rng.uniform(0.5, 1.5)}, {name: values[name]}]
        if rng.random() < 0.7:
            values |= inputs[rng.randrange(4)]
    times = sorted(start + duration * rng.random() for _ in range(STEPS))
    steps = tuple((rng.choice(inputs) if rng.random() < 0.35 else {}, time) for time in times)
    return Course(OSCILLATOR if number % SHAKER_EVERY else MOTOR_SHAKER, values, start, steps)


def undisturbed(course: Course) -> list[Bits]:
    """Return the outputs after each step of a course, up to the first that fails."""
    rows: list[Bits] = []
    with Instance(find(course.model, "fmi3").path) as instance, suppress(*REFUSALS):
        time = course.begin(instance)
        for inputs, target in course.steps:
            instance.set(**inputs)
            instance.step(time, target)
            time = target
            rows.append(course.read(instance))
    return rows


def wander(rng: random.Random, instance: Instance, course: Course, time: float) -> None:
    """Change an instance's inputs, step it or start another run: what a restore must undo."""
    with suppress(*REFUSALS):
        if rng.random() < 0.1:
            instance.reset()
            instance.initialize(course.start)
            time = course.start
        for _ in range(rng.randrange(3)):
            inputs, target = rng.choice(course.steps)
            instance.set(**inputs)
            if target >= time:
                end = time + (target - time) * rng.random() ** 4
                is_event = isinstance(instance, EventInstance) and end > time
                (instance.impacts if is_event else instance.step)(time, end)
                return


def restore(
    rng: random.Random, here: Instance, pool: Sequence[Instance], course: Course, time: float
) -> Instance:
    """Save a state, change the motion, and restore: in memory, or its bytes in any instance."""
    if rng.random() < 0.4:
        get, _, _, put, free = here.state_calls()
        state = here.call(get)
        wander(rng, here, course, time)
        here.call(put, state)
        here.call(free, state)
        return here
    data = here.save_state()
    wander(rng, here, course, time)
    taken = rng.choice(pool)
    taken.restore_state(data)
    return taken


def advance_in_events(
    rng: random.Random, here: EventInstance, course: Course, time: float, end: float
) -> int:
    """Step to `end` with restores in event mode; return their number.

    -1 where no step size of 53 bits leads from an impact to `end`: another time is not compared.
    Where the clock's last digit puts an impact at `end`, a step of no length follows: an early
    return shows the state at the impact.
    """
    restored, event = 0, True
    while event or time < end:
        if time + (end - time) != end:
            return -1
        event, _, _, time = here.call("doStep", time, end - time)
        if not event:
            continue
        here.call("enterEventMode")
        if not restored or rng.random() < 0.02:
            data = here.save_state()
            here.call("updateDiscreteStates")
            here.call("enterStepMode")
            wander(rng, here, course, float("inf"))
            here.restore_state(data)
            restored += 1
        here.call("updateDiscreteStates")
        here.call("enterStepMode")
    return restored


def run_disturbed(
    rng: random.Random, course: Course, rows: Sequence[Bits], pool: Sequence[Instance]
) -> tuple[int, str]:
    """Run with a restore before each step; return the restores' number, what is wrong ("")."""
    here, restored = pool[0], 0
    time = course.begin(here)
    for number, ((inputs, target), row) in enumerate(zip(course.steps, rows, strict=False)):
        pending = rng.random() < 0.5
        here.set(**inputs if pending else {})  # a state whose inputs no step has seen yet
        here = restore(rng, here, pool, course, time)
        here.set(**{} if pending else inputs)
        end, stops = time + (target - time), 0  # where a step ends, to the last bit
        if isinstance(here, EventInstance) and end > time:
            data = here.save_state()
            stops = 1 + advance_in_events(rng, here, course, time, end)
            if not stops:
                here = pool[0]
                here.restore_state(data)
        if not stops:
            here.step(time, target)
        restored, time = restored + 1 + stops, target
        bits = course.read(here, of_step=not stops)
        if bits != row[: len(bits)]:
            wrong = [i for i, pair in enumerate(zip(bits, row, strict=False)) if len({*pair}) > 1]
            return restored, f"step {number}: {[(*POINT[course.model], *STEP)[i] for i in wrong]}"
    return restored, ""


def attack(seed: int, budget: int, counts: Counter[str]) -> Iterator[str]:
    """Yield what is wrong in courses with ``budget`` restores or more."""
    number = 0
    while counts["restores"] < budget:
        course = draw_course(seed, number)
        rows = undisturbed(course)
        pools = {"native": [(Instance, form) for form in ("fmi3", "fmi2", "fmi3")]}
        if rows and course.model == OSCILLATOR:
            impacts = float.fromhex(rows[-1][STATE.index("impact_count")])
            pools["native"] += [(EventInstance, "fmi3")] * (impacts < MANY)
        if number % PYTHON_EVERY == 1:
            pools["Python"] = [(Instance, "fmi2-python")] * 2
        for name, kinds in pools.items() if rows else ():
            rng = random.Random(f"{seed} {number} {name}")
            with ExitStack() as stack:
                paths = [(kind, find(course.model, form).path) for kind, form in kinds]
                pool = [stack.enter_context(kind(path)) for kind, path in paths]
                try:
                    restored, wrong = run_disturbed(rng, course, rows, pool)
                except REFUSALS as error:
                    restored, wrong = 1, f"refused: {error}"
            counts += {"restores": restored, name: restored, course.model: restored}
            if wrong:
                yield f"course {number}, {name}: {wrong}"
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
    assert {OSCILLATOR, MOTOR_SHAKER, "native", "Python"} <= set(counts)
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
