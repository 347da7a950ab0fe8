"""What the FMU carries beside its code, made through the FMU itself: ``python -m orchestrate.assets``.

Pictures of the documentation, ``model.png``, and the reference result; also the README's variable table. They are kept in the repository, so that
an export does not depend on the version of a plotting library; a test compares the reference result with what the FMU gives.
"""

import csv
import itertools
import math
import re
from pathlib import Path

import numpy as np

from .build import default_fmu
from .fmu import Instance, describe

MODEL = "TwoMassImpactOscillator"
FOLDER = Path(__file__).resolve().parents[1] / "fmu_src" / "oscillator"
STEP, STOP = 0.05, 60.0
INPUTS = ("box_amplitude", "box_frequency", "box_acceleration")
TABLE_BEGIN = "<!-- variables: generated from fmu_src/oscillator/variables.py, kept so by a test -->"
TABLE_END = "<!-- end of variables -->"
OUTPUTS = ("x1", "x2", "v1", "v2", "x_rel", "box_force", "contact_force", "phase", "impact_energy")


def input_at(time):
    """Inputs of the reference run: the frequency jumps at 30 s, a constant acceleration sets in at 45 s."""
    return 1.0, 0.4 if time < 30.0 else 0.8, 0.0 if time < 45.0 else 0.05


def reference_times():
    """Communication points of the reference run, with exact halves of tenths."""
    return [round(i * STEP, 10) for i in range(round(STOP / STEP) + 1)]


def reference_rows(fmu):
    """Outputs of the reference run through an FMU, one row a communication point."""
    times = reference_times()
    with Instance(fmu) as instance:
        instance.initialize(0.0, **dict(zip(INPUTS, input_at(0.0), strict=True)))
        rows = [[times[0], *instance.get(*OUTPUTS)]]
        for time, target in itertools.pairwise(times):
            instance.set(**dict(zip(INPUTS, input_at(time), strict=True)))
            instance.step(time, target)
            rows.append([target, *instance.get(*OUTPUTS)])
    return rows


def write_csv(path, header, rows):
    """A CSV file with numbers to the last bit."""
    with Path(path).open("w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header)
        writer.writerows([[repr(float(value)) for value in row] for row in rows])


def write_reference(fmu, folder):
    """The three files of an FMI cross-check reference."""
    folder.mkdir(exist_ok=True)
    write_csv(folder / f"{MODEL}_ref.csv", ["time", *OUTPUTS], reference_rows(fmu))
    jumps = [0.0, 30.0, 30.0, 45.0, 45.0, STOP]
    before = [0.0, 29.0, 30.0, 44.0, 45.0, STOP]
    write_csv(folder / f"{MODEL}_in.csv", ["time", *INPUTS], [[t, *input_at(b)] for t, b in zip(jumps, before, strict=True)])
    options = {"StartTime": 0.0, "StopTime": STOP, "StepSize": STEP, "RelTol": 0.0, "OutputIntervalLength": STEP}
    (folder / f"{MODEL}_ref.opt").write_text("".join(f"{key}, {value}\n" for key, value in options.items()))


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


def with_table(readme, table):
    """The README with its variable table replaced."""
    head, rest = readme.split(TABLE_BEGIN + "\n")
    _, tail = rest.split(TABLE_END)
    return f"{head}{TABLE_BEGIN}\n{table}{TABLE_END}{tail}"


def main():
    """Write all of it."""
    from .figures.fmu_pictures import draw_example, draw_scheme

    fmu = default_fmu(MODEL, Path("build"))
    write_reference(fmu, FOLDER / "reference")
    draw_scheme(FOLDER / "documentation" / "scheme.png")
    draw_scheme(FOLDER / "model.png", width=2.4)
    times, values = example(fmu)
    draw_example(times, values, FOLDER / "documentation" / "plot.svg")
    readme = Path("README.md")
    readme.write_text(with_table(readme.read_text(encoding="utf-8"), variable_table(fmu)), encoding="utf-8")


if __name__ == "__main__":
    main()
