"""Step two FMU instances together, in chunks of steps that go on with the same bits.

A run is a master with what gives the drive's inputs, step by step. All that it goes on from is one
row of a table: the states of both FMUs, the numbers of the master, of the inputs' control, and of
what is counted on the way.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..errors import FmuError
from ..fmu.instance import Instance
from ..fmu.models import MOTOR_SHAKER, OSCILLATOR
from ..model.drive import Drive
from ..model.structure import Structure
from ..running.job import Fmus, Job, Table
from .controllers import Controller
from .inputs import Input, Inputs, Supply
from .master import Master, Scheme
from .revolutions import Revolutions
from .schedule import Schedule
from .step_record import Record

STATE, MEMORY = "_state", "_memory"  # ends of the columns of a run's state
END = b"."  # of an FMU's state in an array, which loses zeros at its end


def oscillator_start_values(structure: Structure) -> dict[str, float | bool]:
    """Return the structure FMU's start values, its own box excitation turned off."""
    off = {"box_amplitude": 0.0, "box_frequency": 0.0, "x_rel_max_on": False}
    return {**structure.parameters(), **off}


def select_state(table: Table, rows: slice) -> Table:
    return {name: table[name][rows] for name in table if name.endswith((STATE, MEMORY))}


class Run:
    """Step both FMU instances of a master; save and restore all that goes on."""

    def __init__(self, master: Master, inputs: Inputs, **counted: Any) -> None:
        self.master, self.inputs = master, inputs
        self.oscillator, self.drive = master.oscillator.instance, master.drive.instance
        self._memories: dict[str, Any] = {"master": master, **counted}
        self._saved = {"oscillator": self.oscillator, "drive": self.drive}
        if not self.drive.description.saves_states:
            self._saved = {}

    def run_steps(self, steps: range) -> Record:
        return self.inputs.run_master(self.master, steps, self.master.scheme.h)

    def close(self) -> None:
        self.master.close()

    def get_state(self) -> Table:
        table: dict[str, Any] = {
            n + STATE: one.save_state() + END for n, one in self._saved.items()
        }
        table |= {name + MEMORY: one.numbers_to_resume() for name, one in self._memories.items()}
        table["control" + MEMORY] = self.inputs.state
        return {name: np.array([value]) for name, value in table.items()}

    def set_state(self, table: Table) -> None:
        for name, instance in self._saved.items():
            instance.restore_state(bytes(table[name + STATE][-1]).removesuffix(END))
        for name, one in self._memories.items():
            one.resume_from(table[name + MEMORY][-1].tolist())
        self.inputs.state = tuple(table["control" + MEMORY][-1].tolist())


class CoupledJob(Job, ABC):
    """Base of a run of two FMUs in chunks of steps; the last item is what concludes from all."""

    chunk_size: ClassVar[int] = 10_000
    sequential: ClassVar[bool] = True
    last_item_uses_all: ClassVar[bool] = True
    item_columns: ClassVar[tuple[str, ...]] = ()  # nodes or revolutions, and a state
    item: ClassVar[str] = "step"

    @abstractmethod
    def step_count(self) -> int:
        """Return the number of communication steps of the run."""

    @abstractmethod
    def advance(self, fmus: Fmus, steps: range, previous: Table | None) -> Table:
        """Do some steps from the end of the chunk before; return what they leave, and a state."""

    @abstractmethod
    def compute_from_all_steps(self, fmus: Fmus, table: Table) -> Table:
        """Compute what follows from all steps."""

    def count(self) -> int:
        return self.step_count() + 1

    def items(self) -> Sequence[int]:
        return range(self.count())

    def work(self, fmus: Fmus, items: Sequence[Any], previous: Table | None) -> Table:
        if items[0] < self.step_count():
            return self.advance(fmus, range(items[0], items[-1] + 1), previous)
        assert previous is not None
        return self.compute_from_all_steps(fmus, previous)


@dataclass(frozen=True)
class DriveJob(Job):
    """Base of what is computed of a structure with our own motor, by default bonded and not."""

    structure: Structure
    drive: Drive

    models: ClassVar[tuple[str, ...]] = (OSCILLATOR, MOTOR_SHAKER)

    def items(self) -> Sequence[Any]:
        return self.structure.as_bonded(), self.structure.as_delaminated()


@dataclass(frozen=True)
class MotorJob(CoupledJob, DriveJob):
    """Define what determines a run of our own motor: system, schedule, scheme and control."""

    schedule: Schedule
    scheme: Scheme
    speed_start: float  # of the motor, rad/s
    # time for which a voltage is held at most until the speed settles, s
    hold: float
    # what takes the voltage from the schedule; the motor gets all of it if there is no such part
    control: Controller | None = None

    def step_count(self) -> int:
        return math.ceil(self.schedule.duration / self.scheme.h - 1e-9)

    def advance(self, fmus: Fmus, steps: range, previous: Table | None) -> Table:
        with open_motor_run(self, fmus) as run:
            if previous is not None:
                run.set_state(previous)
            return {**self.run_and_keep(run, steps), **run.get_state()}

    def run_and_keep(self, run: MotorRun, steps: range) -> Table:
        """Run some communication steps; return what is kept of them: the revolutions."""
        return run.run_steps_by_revolution(steps)


class MotorRun(Run):
    """A run of our own motor, with its revolutions."""

    def __init__(self, job: MotorJob, oscillator: Instance, shaker: Instance) -> None:
        self.job, self.revolutions = job, Revolutions(job.structure)
        oscillator.initialize(**oscillator_start_values(job.structure))
        voltage: Input = job.schedule.course
        if job.control:
            voltage = Supply(job.schedule.course, job.control, job.speed_start)
        inputs = Inputs([("voltage", voltage)], shaker.description)
        own = {"speed_start": job.speed_start, "voltage": job.schedule.voltage(0.0)}
        shaker.initialize(**job.drive.parameters(), **own)
        master, balance = Master(oscillator, shaker, job.scheme), self.revolutions.balance
        super().__init__(master, inputs, balance=balance, revolution=self.revolutions)

    def run_steps(self, steps: range) -> Record:
        record = super().run_steps(steps)
        if self.master.end_reason:  # our own drives do not
            raise FmuError(self.master.end_reason)
        return record

    def run_steps_by_revolution(self, steps: range) -> Table:
        return self.revolutions.add_record(self.run_steps(steps))[0]

    def run_steps_for_speeds(self, steps: range) -> np.ndarray:
        """Run some steps; return only the mean speeds of completed revolutions, rad/s."""
        return self.revolutions.complete_revolutions(self.run_steps(steps))[:, 2]


@contextmanager
def motor_run_starter(fmus: Fmus) -> Iterator[Callable[[MotorJob], MotorRun]]:
    """Create both FMU instances; give what resets them and starts a run, one after the other."""
    with (
        Instance(fmus[OSCILLATOR], "oscillator") as oscillator,
        Instance(fmus[MOTOR_SHAKER], "shaker") as shaker,
    ):

        def start(job: MotorJob) -> MotorRun:
            oscillator.reset()
            shaker.reset()
            return MotorRun(job, oscillator, shaker)

        yield start


@contextmanager
def open_motor_run(job: MotorJob, fmus: Fmus) -> Iterator[MotorRun]:
    with motor_run_starter(fmus) as start, closing(start(job)) as run:
        yield run
