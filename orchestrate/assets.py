"""What the FMU carries beside its code, made through the FMU itself: ``python -m orchestrate.assets``.

Pictures of the documentation, ``model.png``, and the reference result; also the README's variable table. They are kept in the repository, so that
an export does not depend on the version of a plotting library; a test compares the reference result with what the FMU gives.
"""

import csv
import itertools
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .build import default_fmu
from .fmu import Instance, describe

SOURCES = Path(__file__).resolve().parents[1] / "fmu_src" / "models"


@dataclass(frozen=True)
class Reference:
    """A model's reference run: inputs that jump at the communication points ``jumps``.

    Attributes
    ----------
    model, folder : str
        Model name, and its folder below ``fmu_src/models``.
    inputs, outputs : tuple of str
    input_at : callable
        Inputs from a time on.
    jumps : tuple of float
    step, stop : float
    """

    model: str
    folder: str
    inputs: tuple
    outputs: tuple
    input_at: Callable
    jumps: tuple
    step: float
    stop: float

    def times(self):
        """Communication points, with exact halves of tenths."""
        return [round(i * self.step, 10) for i in range(round(self.stop / self.step) + 1)]


def oscillator_inputs(time):
    """The frequency jumps at 30 s, a constant acceleration sets in at 45 s."""
    return 1.0, 0.4 if time < 30.0 else 0.8, 0.0 if time < 45.0 else 0.05


def shaker_inputs(time):
    """The voltage jumps at 3 s, a force sets in at 4 s."""
    return 3.0 if time < 3.0 else 8.0, 0.0 if time < 4.0 else 20.0


OSCILLATOR = Reference(
    "TwoMassImpactOscillator",
    "oscillator",
    ("box_amplitude", "box_frequency", "box_acceleration"),
    ("x1", "x2", "v1", "v2", "x_rel", "box_force", "contact_force", "phase", "impact_energy"),
    oscillator_inputs,
    (30.0, 45.0),
    0.05,
    60.0,
)
SHAKER = Reference(
    "MotorShaker",
    "motor_shaker",
    ("voltage", "box_force"),
    ("box_position", "box_velocity", "angle", "speed", "motor_torque", "motor_energy", "box_damper_energy", "stored_energy"),
    shaker_inputs,
    (3.0, 4.0),
    0.005,
    5.0,
)
REFERENCES = (OSCILLATOR, SHAKER)


def marks(reference):
    """The lines of the README between which a model's variable table stands."""
    begin = f"<!-- variables: generated from fmu_src/models/{reference.folder}/variables.py, kept so by a test -->"
    return begin, "<!-- end of variables -->"


def reference_rows(reference, fmu):
    """Time and outputs of the reference run through an FMU, one row a communication point."""
    times = reference.times()

    def inputs(time):
        return dict(zip(reference.inputs, reference.input_at(time), strict=True))

    with Instance(fmu) as instance:
        instance.initialize(0.0, **inputs(0.0))
        rows = [[times[0], *instance.get(*reference.outputs)]]
        for time, target in itertools.pairwise(times):
            instance.set(**inputs(time))
            instance.step(time, target)
            rows.append([target, *instance.get(*reference.outputs)])
    return rows


def write_csv(path, header, rows):
    """A CSV file with numbers to the last bit."""
    with Path(path).open("w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header)
        writer.writerows([[repr(float(value)) for value in row] for row in rows])


def write_reference(reference, rows):
    """The three files of an FMI cross-check reference."""
    folder = SOURCES / reference.folder / "reference"
    folder.mkdir(exist_ok=True)
    write_csv(folder / f"{reference.model}_ref.csv", ["time", *reference.outputs], rows)
    times = sorted([0.0, *reference.jumps, *reference.jumps, reference.stop])
    before = [time if i % 2 == 0 else math.nextafter(time, 0.0) for i, time in enumerate(times)]
    inputs = [[time, *reference.input_at(value)] for time, value in zip(times, before, strict=True)]
    write_csv(folder / f"{reference.model}_in.csv", ["time", *reference.inputs], inputs)
    options = {"StartTime": 0.0, "StopTime": reference.stop, "StepSize": reference.step, "RelTol": 0.0, "OutputIntervalLength": reference.step}
    (folder / f"{reference.model}_ref.opt").write_text("".join(f"{key}, {value}\n" for key, value in options.items()))


def example(fmu, eta=0.4, transient=500, periods=2, points=600):
    """Two settled periods of the paper's Figure 5, as times and values."""
    names = ("x1", "x2", "x_rel", "in_contact")
    period = 2.0 * math.pi / eta
    times = [0.0, *(transient * period + np.linspace(0.0, periods * period, points))]
    with Instance(fmu) as instance:
        instance.initialize(0.0, box_amplitude=1.0 / eta**2, box_frequency=eta)
        rows = []
        for time, target in itertools.pairwise(times):
            instance.step(time, target)
            rows.append([float(value) for value in instance.get(*names)])
    return np.array(times[1:]), dict(zip(names, np.array(rows).T, strict=True))


def variable_table(path):
    """The README's variable table, from the FMU's own description."""
    lines = ["| name | causality | unit | start | meaning |", "|---|---|---|---|---|"]
    for variable in describe(path).variables.values():
        if re.search(r"\[(?!1\])\d+\]$", variable.name):  # of a series, the first stands for all
            continue
        kind = variable.causality if variable.causality != "parameter" else f"parameter, {variable.variability}"
        unit = variable.unit or variable.type
        lines.append(f"| `{variable.name}` | {kind} | {unit} | {'' if variable.start is None else variable.start} | {variable.description} |")
    return "\n".join(lines) + "\n"


def with_table(readme, reference, table):
    """The README with a model's variable table replaced."""
    begin, end = marks(reference)
    head, rest = readme.split(begin + "\n")
    _, tail = rest.split(end, 1)
    return f"{head}{begin}\n{table}{end}{tail}"


def draw(reference, fmu, rows):
    """The pictures of a model."""
    from .figures.fmu_pictures import draw_example, draw_scheme
    from .figures.shaker_pictures import draw_run_up, draw_shaker

    folder = SOURCES / reference.folder
    scheme = draw_shaker if reference is SHAKER else draw_scheme
    scheme(folder / "documentation" / "scheme.png")
    scheme(folder / "model.png", width=2.4)
    if reference is SHAKER:
        values = dict(zip(("time", *reference.outputs), np.array(rows).T, strict=True))
        draw_run_up(values["time"], values["speed"], values["box_position"], folder / "documentation" / "plot.svg")
    else:
        times, values = example(fmu)
        draw_example(times, values, folder / "documentation" / "plot.svg")


def main():
    """Write all of it."""
    readme = Path("README.md")
    for reference in REFERENCES:
        fmu = default_fmu(reference.model, Path("build"))
        rows = reference_rows(reference, fmu)
        write_reference(reference, rows)
        draw(reference, fmu, rows)
        readme.write_text(with_table(readme.read_text(encoding="utf-8"), reference, variable_table(fmu)), encoding="utf-8")


if __name__ == "__main__":
    main()
