"""Importers with readers and loops of their own run the FMU and agree; another checker reads it."""

import subprocess
import sys
from importlib.util import find_spec

import fmpy
import numpy as np
import pytest

from ..sparing import ordinary
from .driver import FMUS, FORMS, run
from .programs.driver import open_fmu

NAMES = [
    *("x1", "x2", "v1", "v2", "x_rel", "x_rel_max", "box_force", "box_impulse", "phase"),
    *("impact_time", "impact_energy", "impact_count"),
]
STEP, COUNT = 0.125, 800  # dyadic: every importer's clock shows the same bits
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
    assert reference[-1, -1] > 10


@pytest.mark.parametrize(
    ("importer", "form"),
    [
        *(("libcosimpy", "fmi2-python"), ("libcosimpy", "fmi2")),  # it knows no FMI 3.0
        *(("fmuloader", "fmi2"), ("fmuloader", "fmi3")),
        ("ecospy", "fmi2"),  # FMI 3.0 it can, but it then frees its own memory twice
    ],
)
def test_another_importer_gets_the_same_bits(importer, form, tmp_path, reference):
    """Their clocks count nanoseconds, or add up steps; one is told the stop time."""
    if not find_spec(importer):
        pytest.skip(f"{importer} is not installed")
    arguments = FMUS[form], VALUES, NAMES[:-1], STEP, COUNT
    rows = np.array(run(f"importers.{importer}", *arguments, cwd=tmp_path))
    assert rows[:, 0] == pytest.approx(reference[1:, 0], abs=1e-9)
    assert np.array_equal(rows[:, 1:], reference[1:, 1:])


@pytest.mark.parametrize("form", ordinary(FORMS, ["fmi3"]))
def test_fmutool_finds_nothing_to_say(form):
    """The checks of the FMU manipulation toolbox: the XSD, and what the standard says besides."""
    pytest.importorskip("fmu_manipulation_toolbox")
    program = "from fmu_manipulation_toolbox.cli.fmutool import fmutool; fmutool()"
    command = [sys.executable, "-c", program, "-input", str(FMUS[form]), "-check"]
    done = subprocess.run(command, capture_output=True, text=True)
    version = 3 if form == "fmi3" else 2
    assert f"No semantic error against the FMI-{version} standard" in done.stdout + done.stderr
