"""Importers with readers and loops of their own run the FMU and agree: FMPy's function and command
line, libcosim, fmuloader and ecos; and another checker reads it.
"""

import subprocess
import sys
from importlib.util import find_spec

import fmpy
import numpy as np
import pytest

from ..sparing import ordinary
from .driver import FMUS, FORMS, run, run_with_output
from .programs.driver import open_fmu

NAMES = [
    *("x1", "x2", "v1", "v2", "x_rel", "x_rel_max", "box_force", "box_impulse", "phase"),
    *("impact_time", "impact_energy"),
]
STEP, COUNT = 0.125, 1600  # dyadic: every importer's clock shows the same bits
VALUES = {"box_frequency": 1.13, "m2": 1.5, "x2_start": 0.25}


@pytest.fixture(scope="module")
def reference(forms):
    """Rows of time and ``NAMES``."""
    f = open_fmu(FMUS["fmi2"]).start(**VALUES)
    rows = [[0.0, *f.get(*NAMES)]]
    return np.array(rows + [[k * STEP, *f.step(k * STEP).get(*NAMES)] for k in range(1, COUNT + 1)])


def test_simulate_fmu(fmu, reference):
    """FMPy's function: the same bits, all along a chaotic motion."""
    options = {"stop_time": STEP * COUNT, "output_interval": STEP, "start_values": VALUES}
    found = fmpy.simulate_fmu(str(fmu), output=NAMES, **options)
    rows = np.array([found[name].astype(float) for name in ("time", *NAMES)]).T
    assert np.array_equal(rows, reference)
    assert reference[-1, -1] > 0.0


@pytest.mark.parametrize("form", ["fmi2-python", "fmi2"])
def test_libcosim(form, tmp_path, reference):
    """Another reader of the XML and another loop, with nanoseconds for a clock: bits again. It
    knows no FMI 3.0.
    """
    pytest.importorskip("libcosimpy")
    arguments = (FMUS[form], VALUES, [*NAMES, "impact_count"], STEP, COUNT)
    (rows, known), done = run_with_output("libcosim.simulate", *arguments, cwd=tmp_path)
    rows = np.array(rows)
    assert rows[:, 0] == pytest.approx(reference[1:, 0], abs=1e-9)
    assert np.array_equal(rows[:, 1:-1], reference[1:, 1:])
    assert rows[-1, -1] > 20
    assert known > 40
    assert "error" not in done.stderr.lower()


@pytest.mark.parametrize("form", ["fmi2", "fmi3"])
def test_fmuloader(form, tmp_path, reference):
    """Another way to the binary, with the stop time told: bits again."""
    pytest.importorskip("fmuloader")
    rows = run("loader.simulate", FMUS[form], VALUES, NAMES, STEP, COUNT, cwd=tmp_path)
    assert np.array_equal(np.array(rows), reference)


def test_ecos(tmp_path, reference):
    """A master that adds up its steps: bits again, where their sum is exact. FMI 3.0 it can, but it
    then frees its own memory twice.
    """
    if not find_spec("ecospy"):
        pytest.skip("ecospy is not installed")
    arguments = (FMUS["fmi2"], VALUES, NAMES, STEP, COUNT)
    rows = np.array(run("ecos.simulate", *arguments, cwd=tmp_path))
    assert np.array_equal(rows[:, :-1], reference[1:])
    assert rows[-1, -1] > 20


@pytest.mark.parametrize("form", ordinary(FORMS, ["fmi3"]))
def test_fmutool_finds_nothing_to_say(form):
    """The checks of the FMU manipulation toolbox: the XSD, and what the standard says besides."""
    pytest.importorskip("fmu_manipulation_toolbox")
    program = "from fmu_manipulation_toolbox.cli.fmutool import fmutool; fmutool()"
    command = [sys.executable, "-c", program, "-input", str(FMUS[form]), "-check"]
    done = subprocess.run(command, capture_output=True, text=True)
    version = 3 if form == "fmi3" else 2
    assert f"No semantic error against the FMI-{version} standard" in done.stdout + done.stderr
