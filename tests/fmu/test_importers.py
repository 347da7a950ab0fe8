"""Importers with readers and loops of their own run the FMU and agree: FMPy's function and command
line, and libcosim.
"""

import csv
import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from ..fresh import run_fresh
from .driver import FMUS, run

NAMES = [
    "x1",
    "x2",
    "v1",
    "v2",
    "x_rel",
    "x_rel_max",
    "box_force",
    "box_impulse",
    "phase",
    "impact_time",
    "impact_energy",
]
EXACT_STEP, STOP = 0.125, 200.0  # dyadic: every importer's clock shows the same bits
VALUES = {"box_frequency": 1.13, "m2": 1.5, "x2_start": 0.25}


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """Rows of time and ``NAMES`` from the driver."""
    script = r"""
    names, values, step, count = json.loads(sys.argv[2]), json.loads(sys.argv[3]), float(sys.argv[4]), int(sys.argv[5])
    f = open_fmu(PATH).start(**values)
    answer([[0.0, *f.get(*names)], *[[k * step, *f.step(k * step).get(*names)] for k in range(1, count + 1)]])
    """
    arguments = (json.dumps(NAMES), json.dumps(VALUES), EXACT_STEP, int(STOP / EXACT_STEP))
    return np.array(
        run(script, FMUS["fmi2-python"], *arguments, cwd=tmp_path_factory.mktemp("reference"))
    )


def test_simulate_fmu(fmu, tmp_path, reference):
    """FMPy's function: the same bits, all along a chaotic motion."""
    script = r"""
    arguments = dict(stop_time=200.0, output_interval=0.125, start_values=json.loads(sys.argv[2]), output=json.loads(sys.argv[3]))
    result = fmpy.simulate_fmu(PATH, **arguments)
    answer([result[name].astype(float).tolist() for name in ["time", *arguments["output"]]])
    """
    rows = np.array(run(script, fmu, json.dumps(VALUES), json.dumps(NAMES), cwd=tmp_path)).T
    assert np.array_equal(rows, reference)
    assert reference[-1, -1] > 0.0


def test_second_simulation_is_as_fast_as_the_first(tmp_path):
    """FMPy extracts anew each time and deletes the folder afterwards, while Python keeps the
    modules: the kernel stays the compiled one.
    """
    script = r"""
    def compiled():
        return sum("/kernel-" in line for line in Path("/proc/self/maps").read_text().splitlines()) > 0

    import time
    values, seconds, ends = {"box_frequency": 1.13, "x_rel_max_on": False}, [], []
    for _ in range(4):
        begin = time.perf_counter()
        result = fmpy.simulate_fmu(PATH, stop_time=2e4, output_interval=1e4, start_values=values, output=["x1"])
        seconds.append(time.perf_counter() - begin)
        ends.append(float(result["x1"][-1]))
    answer([seconds, ends, compiled()])
    """
    seconds, ends, compiled = run(script, FMUS["fmi2-python"], cwd=tmp_path)
    assert compiled
    assert len(set(ends)) == 1
    assert min(seconds[1:]) < 4 * seconds[0] + 0.1  # the source takes some fifty times as long


def test_steps_that_differ_in_the_last_bits(fmu, tmp_path):
    """A tenth of a second is no binary number, so the loop's steps differ from each other; no step
    is refused and nothing adds up.
    """
    script = r"""
    values, names = {"box_frequency": 2.0, "box_amplitude": 0.25}, ["x1", "v1", "x2", "v2", "phase"]
    rows = fmpy.simulate_fmu(PATH, output_interval=0.1, stop_time=1000.0, start_values=values, output=names)
    f = open_fmu(PATH).start(**values).step(float(rows["time"][-1]))
    steps = {b - a for a, b in zip(rows["time"], rows["time"][1:])}
    answer([len(steps), len(rows), [float(rows[name][-1]) for name in names], f.get(*names)])
    """
    kinds, count, small, one = run(script, fmu, cwd=tmp_path)
    assert kinds > 5
    assert count == 10001
    assert small == pytest.approx(one, abs=1e-11)


def test_fmpy_command_line(fmu, tmp_path, reference):
    """``fmpy simulate`` writes the same numbers into its table."""
    command = [
        sys.executable,
        "-m",
        "fmpy",
        "simulate",
        str(fmu),
        "--stop-time",
        str(STOP),
        "--output-interval",
        str(EXACT_STEP),
    ]
    command += [
        "--start-values",
        *[text for name, value in VALUES.items() for text in (name, str(value))],
    ]
    command += ["--output-variables", *NAMES, "--output-file", "out.csv"]
    done = subprocess.run(
        command,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={**os.environ, "VIBROIMPACT_MESSAGES": ""},
    )
    # pythonfmu's library writes into freed memory when a process ends, which now and then aborts
    # it: see test_limits
    assert done.returncode == 0 or ("python" in fmu.parent.name and done.returncode == -6), (
        done.stderr
    )
    assert done.stderr.replace("corrupted double-linked list", "").strip() == ""
    with (tmp_path / "out.csv").open(newline="") as file:
        head, *rows = list(csv.reader(file))
    columns = [[name.strip('"') for name in head].index(name) for name in ["time", *NAMES]]
    assert np.array(rows, dtype=float)[:, columns] == pytest.approx(reference, rel=1e-12, abs=1e-12)


COSIM = r"""
import json, os
from libcosimpy.CosimEnums import CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

log_output_level(CosimLogLevel.WARNING)
path, values, names, step, count = sys.argv[1], json.loads(sys.argv[2]), json.loads(sys.argv[3]), float(sys.argv[4]), int(sys.argv[5])
execution = CosimExecution.from_step_size(int(step * 1e9))
slave = CosimLocalSlave(path, "oscillator")
index = execution.add_local_slave(slave)
variables = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
for name, value in values.items():
    assert execution.real_initial_value(index, variables[name], value)
observer = CosimObserver.create_last_value()
assert execution.add_observer(observer)
wanted = [variables[name] for name in names]
rows = []
for k in range(1, count + 1):
    assert execution.step(), k
    rows.append([execution.status().current_time * 1e-9, *observer.last_real_values(index, wanted)])
impacts = observer.last_integer_values(index, [variables["impact_count"]])
answer([rows, impacts, len(variables)])
sys.stdout.flush()
os._exit(0)  # libcosim's own threads outlive it, and pythonfmu's library the FMU
"""


@pytest.mark.parametrize("form", ["fmi2-python", "fmi2"])
def test_libcosim(form, tmp_path, reference):
    """Another reader of the XML and another loop, with nanoseconds for a clock: bits again. It
    knows no FMI 3.0.
    """
    pytest.importorskip("libcosimpy")
    count = int(STOP / EXACT_STEP)
    arguments = (FMUS[form], json.dumps(VALUES), json.dumps(NAMES), EXACT_STEP, count)
    (rows, (impacts,), known), done = run_fresh(
        COSIM, *arguments, cwd=tmp_path, env={"VIBROIMPACT_MESSAGES": ""}
    )
    rows = np.array(rows)
    assert rows[:, 0] == pytest.approx(reference[1:, 0], abs=1e-9)
    assert np.array_equal(rows[:, 1:], reference[1:, 1:])
    assert impacts > 20
    assert known > 40
    assert "error" not in done.stderr.lower()


def test_two_importers_at_once(tmp_path):
    """Two processes share nothing but the file."""
    script = "answer(open_fmu(PATH).start(**harmonic(1.13)).step(300.0).outputs())"
    folders = [tmp_path / str(k) for k in range(3)]
    for folder in folders:
        Path(folder).mkdir()
    with ThreadPoolExecutor(3) as pool:
        found = list(pool.map(lambda folder: run(script, FMUS["fmi2-python"], cwd=folder), folders))
    assert found[0] == found[1] == found[2]
