"""Compute and write reference runs of the models, in the format of FMI's cross-check."""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from orchestrate.fmu import Instance

MODELS = Path(__file__).resolve().parents[1] / "fmu_src" / "models"


@dataclass(frozen=True)
class Reference:
    """A model's reference run: inputs, outputs and times."""

    # model name, and its folder below `fmu_src/models`
    model: str
    folder: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    input_at: Callable[[float], tuple[float, ...]]  # inputs from a time on
    jumps: tuple[float, ...]  # communication points at which they change, s
    # s
    step: float
    stop: float

    def times(self) -> list[float]:
        """Communication points, with exact halves of tenths."""
        return [round(i * self.step, 10) for i in range(round(self.stop / self.step) + 1)]


OSCILLATOR = Reference(
    model="TwoMassImpactOscillator",
    folder="oscillator",
    inputs=("box_amplitude", "box_frequency", "box_acceleration"),
    outputs=(
        *("x1", "x2", "v1", "v2", "x_rel"),
        *("box_force", "contact_force", "phase", "impact_energy"),
    ),
    input_at=lambda t: (1.0, 0.4 if t < 30.0 else 0.8, 0.0 if t < 45.0 else 0.05),
    jumps=(30.0, 45.0),
    step=0.05,
    stop=60.0,
)
MOTOR_SHAKER = Reference(
    model="MotorShaker",
    folder="motor_shaker",
    inputs=("voltage", "box_force"),
    outputs=(
        *("box_position", "box_velocity", "angle", "speed", "motor_torque"),
        *("motor_energy", "box_damper_energy", "stored_energy"),
    ),
    input_at=lambda t: (3.0 if t < 3.0 else 8.0, 0.0 if t < 4.0 else 20.0),
    jumps=(3.0, 4.0),
    step=0.005,
    stop=5.0,
)
COIL = Reference(
    model="ElectrodynamicShaker",
    folder="electrodynamic_shaker",
    inputs=("command", "box_force"),
    outputs=(
        *("box_position", "box_velocity", "box_acceleration", "current", "voltage", "power"),
        *("energy", "coil_heat", "suspension_loss", "box_force_work", "stored_energy"),
    ),
    input_at=lambda t: (5.0 if t < 1.0 else -5.0 if t < 2.0 else 0.0, 0.0 if t < 2.0 else 50.0),
    jumps=(1.0, 2.0),
    step=0.005,
    stop=3.0,
)
REFERENCES = (OSCILLATOR, MOTOR_SHAKER, COIL)


def run_and_record(
    fmu: str | PathLike[str],
    times: Sequence[float],
    outputs: Sequence[str],
    inputs: Callable[[float], dict[str, float]],
    **start: float,
) -> list[list[float]]:
    """Run an FMU under inputs set before each step; return rows of time and outputs."""
    with Instance(fmu) as instance:
        instance.initialize(times[0], **start, **inputs(times[0]))
        rows = [[times[0], *instance.get(*outputs)]]
        for time, target in itertools.pairwise(times):
            instance.set(**inputs(time))
            instance.step(time, target)
            rows.append([target, *instance.get(*outputs)])
    return rows


def compute_reference_rows(reference: Reference, fmu: str | PathLike[str]) -> list[list[float]]:
    def inputs(time: float) -> dict[str, float]:
        return dict(zip(reference.inputs, reference.input_at(time), strict=True))

    return run_and_record(fmu, reference.times(), reference.outputs, inputs)


def write_reference_files(reference: Reference, rows: Sequence[Sequence[float]]) -> None:
    folder = MODELS / reference.folder / "reference"
    folder.mkdir(exist_ok=True)
    write_csv(folder / f"{reference.model}_ref.csv", ["time", *reference.outputs], rows)
    times = sorted([0.0, *reference.jumps, *reference.jumps, reference.stop])
    before = [time if i % 2 == 0 else math.nextafter(time, 0.0) for i, time in enumerate(times)]
    pairs = zip(times, before, strict=True)
    inputs = [[time, *reference.input_at(value)] for time, value in pairs]
    write_csv(folder / f"{reference.model}_in.csv", ["time", *reference.inputs], inputs)
    options = {
        **{"StartTime": 0.0, "StopTime": reference.stop, "StepSize": reference.step},
        **{"RelTol": 0.0, "OutputIntervalLength": reference.step},
    }
    lines = "".join(f"{key}, {value}\n" for key, value in options.items())
    (folder / f"{reference.model}_ref.opt").write_text(lines)


def write_csv(path: Path, header: Sequence[str], rows: Iterable[Sequence[float]]) -> None:
    with path.open("w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header)
        writer.writerows([[repr(float(value)) for value in row] for row in rows])
