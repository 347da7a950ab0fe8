"""Every script of ``examples/`` runs as it stands, and the one in C says what its twin says."""

import runpy
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest

from tests import ROOT

from ..sparing import ordinary

EXAMPLES = ROOT / "examples"
SCRIPTS = sorted(EXAMPLES.glob("*.py"))
SAID = {  # something of what each prints
    "basin": "2 attractors",
    "event_mode": "impact at 9.584866 s, closing at 1.198201 m/s",
    "fmpy_sweep": "eta = 1.045: largest gap 20.5801",
    "lyapunov_sweep": "chaotic at",
    "own_drive": "acceleration of the box -1.28",
    "own_motor": "delaminated: the speed jumps at 6.19 V on the way up",
    "parameter_map": "of the map repeats after one period",
    "resonance_curve": "bonded, up       : 3.18 mm at 12.7 Hz",
    "through_the_resonance": "swung by 8.73 V: 144 rad/s",
    "time_history": "largest gap: 7.80 mm",
}
QUICK = ("event_mode", "fmpy_sweep", "own_drive", "time_history")


@pytest.mark.parametrize(
    "script",
    ordinary(SCRIPTS, [one for one in SCRIPTS if one.stem in QUICK]),
    ids=lambda script: script.stem,
)
def test_script_runs(script, folder, coarse, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", [str(script)])
    runpy.run_path(str(script), run_name="__main__")
    assert SAID[script.stem] in capsys.readouterr().out


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")
def test_c_example(folder, monkeypatch, capsys):
    headers = Path(fmpy.__file__).parent / "c-code"
    program, source = folder / "event_mode", EXAMPLES / "event_mode.c"
    warnings = ("-Wall", "-Wextra", "-Werror")
    command = ("cc", *warnings, "-I", headers, source, "-ldl", "-lm", "-o", program)
    subprocess.run(command, check=True)
    with zipfile.ZipFile(folder / "build" / "fmi3" / "TwoMassImpactOscillator.fmu") as archive:
        archive.extractall(folder / "fmu")
    said = subprocess.run([program, "fmu"], cwd=folder, capture_output=True, text=True, check=True)
    monkeypatch.setattr(sys, "argv", ["event_mode.py"])
    runpy.run_path(str(EXAMPLES / "event_mode.py"), run_name="__main__")
    assert said.stdout == capsys.readouterr().out
