"""Run both FMUs step by step from a schedule; save and restore their states."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..errors import FmuError
from ..fmu.instance import Instance
from ..fmu.models import OSCILLATOR, SHAKER
from ..model.drive import Drive
from ..model.structure import Structure
from ..running.job import Fmus, Job, Table
from .controllers import Controller, Measurement
from .master import Master, Scheme
from .record import Record
from .revolutions import Revolutions
from .schedule import Schedule


def oscillator_start(structure: Structure) -> dict[str, float | bool]:
    """Return the structure FMU's start values, its own box excitation turned off."""
    off = {"box_amplitude": 0.0, "box_frequency": 0.0, "x_rel_max_on": False}
    return {**structure.parameters(), **off}


@dataclass(frozen=True)
class CoupledRun(Job):
    """Define what determines a coupled run: system, schedule, scheme and control."""

    structure: Structure
    drive: Drive
    schedule: Schedule
    scheme: Scheme
    speed_start: float  # of the motor, rad/s
    # time for which a voltage is held at most until the speed settles, s
    hold: float
    # what takes the voltage from the schedule; the motor gets all of it where there is none
    control: Controller | None = None

    models: ClassVar[tuple[str, ...]] = (OSCILLATOR, SHAKER)

    def steps(self) -> int:
        """Return the number of communication steps of the run."""
        return math.ceil(self.schedule.duration / self.scheme.h - 1e-9)


class Run:
    """Step both FMU instances of a coupled run and collect its revolutions."""

    def __init__(self, job: CoupledRun, oscillator: Instance, shaker: Instance) -> None:
        self.job, self.oscillator, self.shaker = job, oscillator, shaker
        oscillator.initialize(**oscillator_start(job.structure))
        voltage = job.schedule.voltage(0.0)
        shaker.initialize(**job.drive.parameters(), speed_start=job.speed_start, voltage=voltage)
        self.master = Master(oscillator, shaker, job.scheme)
        self.revolutions = Revolutions(job.structure)
        self.control_memory = job.control.begin(job.speed_start) if job.control else ()

    def step_voltage(self, i: int) -> float:
        """Return the motor's voltage in a step, from the schedule or the controller, V."""
        h, control = self.job.scheme.h, self.job.control
        available = self.job.schedule.voltage((i + 0.5) * h)
        if control is None:
            return available
        seen = Measurement(self.master.time, self.master["speed"], available, h)
        voltage, self.control_memory = control.update(seen, self.control_memory)
        return voltage

    def record(self, steps: Sequence[int]) -> Record:
        """Run some communication steps; return their record."""
        if self.job.control is None:
            record = self.master.run([self.step_voltage(i) for i in steps])
        else:
            voltages = ([self.step_voltage(i)] for i in steps)
            record = self.master.run_controlled(voltages, len(steps))
        if self.master.ended:  # our own drives do not
            raise FmuError(self.master.ended)
        return record

    def revolve(self, steps: Sequence[int]) -> Table:
        """Run some communication steps; return the table of completed revolutions."""
        return self.revolutions.add(self.record(steps))[0]

    def speeds(self, steps: Sequence[int]) -> np.ndarray:
        """Run some steps; return the mean speeds of completed revolutions alone, rad/s."""
        return np.array(
            [speed for _, _, speed, _ in self.revolutions.completed(self.record(steps))]
        )

    def get_state(self) -> Table:
        """Return the complete state of the run as a table of one row."""
        states = {
            "oscillator_state": np.frombuffer(self.oscillator.save_state(), dtype=np.uint8),
            "shaker_state": np.frombuffer(self.shaker.save_state(), dtype=np.uint8),
            "master_memory": np.array(self.master.get_state()),
            "balance_memory": np.array(self.revolutions.balance.get_state()),
            "revolution_memory": np.array(self.revolutions.get_state()),
            "control_memory": np.array(self.control_memory),
        }
        return {name: state[np.newaxis] for name, state in states.items()}

    def set_state(self, table: Table) -> None:
        """Restore the state in the last row of a table."""
        self.oscillator.restore_state(table["oscillator_state"][-1].tobytes())
        self.shaker.restore_state(table["shaker_state"][-1].tobytes())
        self.master.set_state(table["master_memory"][-1].tolist())
        self.revolutions.balance.set_state(table["balance_memory"][-1].tolist())
        self.revolutions.set_state(table["revolution_memory"][-1].tolist())
        self.control_memory = tuple(table["control_memory"][-1].tolist())


@contextmanager
def begin_run(job: CoupledRun, fmus: Fmus) -> Iterator[Run]:
    """Create both FMU instances, start a run on them and free them at the end."""
    with (
        Instance(fmus[OSCILLATOR], "oscillator") as oscillator,
        Instance(fmus[SHAKER], "shaker") as shaker,
    ):
        run = Run(job, oscillator, shaker)
        try:
            yield run
        finally:
            run.master.close()
