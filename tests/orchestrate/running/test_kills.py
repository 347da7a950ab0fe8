"""Each kind of question, killed after each chunk: the same bytes, no chunk computed twice."""

from __future__ import annotations

import inspect
import pkgutil
import shutil
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate import Drive, Structure
from orchestrate.running.job import Job
from orchestrate.running.journal import Journal, journal_path
from orchestrate.weak_drive.drive_spectra import drive_spectra
from tests.sparing import ordinary

UNIT, QUICK, QUICK_DRIVE = Structure.nondimensional(), Structure.from_file("quick"), "quick"
MOTOR = QUICK, Drive.from_file(QUICK_DRIVE)
SHORT = {"transient": 20, "samples": 8}
BEAM = Structure.from_halves(m1=1.5, m2=1.2, f1=42.0, f2=52.0, zeta1=0.01)
PRESSED = Structure.from_halves(m1=1.0, m2=1.0, f1=42.0, f2=55.0, clearance=-20e-6)
SWEPT = orchestrate.SweptSine(first=40.0, last=56.0, duration=4.0, acceleration=4.0)
SHAKER = orchestrate.Shaker.from_file("shaker_100N").replace(table_mass=5.0)
SINE = orchestrate.SweptSine(first=8.0, last=9.0, duration=1.0, acceleration=0.2)
CONTROL = orchestrate.LevelControl(sine=SINE, start=0.1, limit=30.0)
SPEED_CONTROL = orchestrate.SpeedControl(speed=1.4, gain=3.0, reset_time=20.0)
Ask = Callable[..., xr.Dataset]


def fit(**running: Any) -> xr.Dataset:
    hertz = np.linspace(42.0, 52.0, 21)
    ratio = abs((1 + 0.02j * hertz / 47) / (1 - (hertz / 47) ** 2 + 0.02j * hertz / 47))
    curve = orchestrate.resonance_curve(frequency=hertz, level=4.0, amplitude1=ratio, unit="1")
    return orchestrate.fit(curve, BEAM, hypothesis="bonded", **running)


def detect(**running: Any) -> xr.Dataset:
    history = orchestrate.shake(BEAM.as_bonded(), SWEPT, sample_rate=600.0, progress=False)
    return orchestrate.detect(history, BEAM.replace(f1=44.0), **running)


def border(**running: Any) -> xr.Dataset:
    window = orchestrate.branch(UNIT, eta=2.6, limits=(2.5, 2.7), progress=False)
    asked = {"limits": [(2.5, 2.7), (0.69, 0.71)], "longest": 0.5}
    return orchestrate.border(UNIT, start=window, bifurcation=0, **asked, **running)


def asked(function: Any, *structures: Any, **call: Any) -> Ask:
    return lambda **running: function(*structures, **call, **running)


ETAS = {"eta": [0.9, 1.0, 1.1]}
CONTROLLED = {"inputs": {"command": CONTROL}, "duration": 0.3, "step": 2e-3}
SETTLED = {"voltage": 1.3, "begin": 1.29, "hold": 50.0}
HELD = {"voltage": 1.5, "duration": 30.0}
PLANE = {"eta": 1.1, "x": ("x_rel", 0.0, 1.0, 3), "y": ("v_rel", -1.0, 1.0, 2)}
LEVELS = {"frequency": [250.0], "level": [0.1]}
CAPTURED = {"voltage": (1.5, 1.6), "count": 2, "tolerance": 0.05, "step": 0.4}
RAMP = {"rates": [8e-4, 4e-4], "back": False, "step": 0.4, "settle": 50.0}
QUESTIONS: Mapping[str, tuple[int, Ask]] = {  # with the items of a chunk
    "SimulateJob": (1, asked(orchestrate.simulate, UNIT, eta=1.1, periods=3)),
    "ResonanceJob": (2, asked(orchestrate.resonance, UNIT, **ETAS, **SHORT)),
    "ResonanceLevelsJob": (2, asked(orchestrate.resonance_levels, PRESSED, **LEVELS, **SHORT)),
    "SweepJob": (2, asked(orchestrate.sweep, UNIT, **ETAS, **SHORT, direction="both")),
    "IndependentStartsJob": (2, asked(orchestrate.sweep, UNIT, **ETAS, **SHORT, direction="given")),
    "MapJob": (2, asked(orchestrate.map, UNIT, eta=[1.0, 1.1], e=[0.3, 0.7], transient=20)),
    "LyapunovJob": (2, asked(orchestrate.lyapunov, UNIT, **ETAS, transient=20, periods=100)),
    "AttractorsJob": (3, asked(orchestrate.attractors, UNIT, eta=1.1, starts=4, transient=20)),
    "BasinJob": (4, asked(orchestrate.basin, UNIT, **PLANE, transient=20)),
    "SpectraJob": (1, asked(orchestrate.spectra, UNIT, eta=[1.0, 1.1], periods=4, points=128)),
    "PoincareJob": (1, asked(orchestrate.poincare, UNIT, eta=1.1, transient=20, periods=20)),
    "ImpactStatisticsJob": (2, asked(orchestrate.impact_statistics, UNIT, **ETAS, periods=20)),
    "OrbitJob": (1, asked(orchestrate.orbit, UNIT, eta=2.0)),
    "ManifoldJob": (1, asked(orchestrate.manifold, UNIT, eta=3.0, length=0.3)),
    "BranchJob": (1, asked(orchestrate.branch, UNIT, eta=2.0, limits=(1.95, 2.05))),
    "BorderJob": (1, border),
    "ShakeJob": (2500, asked(orchestrate.shake, BEAM, SWEPT, sample_rate=600.0)),
    "CosimulateJob": (80, asked(orchestrate.cosimulate, BEAM, SHAKER, **CONTROLLED)),
    "CoupleJob": (200, asked(orchestrate.couple, *MOTOR, **HELD, control=SPEED_CONTROL)),
    "PassageJob": (200, asked(orchestrate.passage, *MOTOR, **HELD)),
    "JumpVoltagesJob": (1, asked(orchestrate.jump_voltages, *MOTOR, voltage=(1.5, 1.6), **RAMP)),
    "DriveBranchJob": (1, asked(orchestrate.drive_branch, *MOTOR, speed=(1.29, 1.32), longest=0.2)),
    "DriveSpectraJob": (1, asked(drive_spectra, *MOTOR, **SETTLED, revolutions=8, points=64)),
    "CaptureJob": (1, asked(orchestrate.capture, QUICK.as_bonded(), MOTOR[1], **CAPTURED)),
    "PlanJob": (1, asked(orchestrate.plan_test, BEAM, levels=[0.5, 5.0], frequencies=[40.0, 56.0])),
    "FitJob": (1, fit),
    "DetectJob": (1, detect),
}
SLOW = {"JumpVoltagesJob", "CaptureJob", "DriveBranchJob", "DetectJob", "PlanJob", "BorderJob"}
SLOW |= {"FitJob", "BranchJob", "ManifoldJob"}


def kinds_of_questions() -> set[type[Job]]:
    for module in pkgutil.walk_packages(orchestrate.__path__, "orchestrate."):
        if not module.name.endswith("__main__"):
            import_module(module.name)
    waiting, kinds = [Job], set[type[Job]]()
    while waiting:
        kind = waiting.pop()
        waiting += kind.__subclasses__()
        if not inspect.isabstract(kind) and kind.__module__.startswith("orchestrate."):
            kinds.add(kind)
    return kinds


def test_every_kind_of_question_is_killed():
    assert {kind.__name__ for kind in kinds_of_questions()} == set(QUESTIONS)


class Killed(BaseException):
    """Stands for SIGKILL: what is on the disk at that moment is what is left."""


@pytest.mark.parametrize("name", ordinary(QUESTIONS, set(QUESTIONS) - SLOW))
def test_killed_after_each_chunk_it_goes_on(exported, tmp_path, monkeypatch, name):
    size, ask = QUESTIONS[name]
    (kind,) = (kind for kind in kinds_of_questions() if kind.__name__ == name)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    monkeypatch.setattr(kind, "chunk_size", size)
    answers: list[list[int]] = []  # numbers of the chunks that each call has computed
    put = Journal.put

    def store(journal: Journal, index: int, table: Any) -> None:
        put(journal, index, table)
        answers[-1].append(index)
        if kills:
            shutil.copytree(folder(len(answers) - 1), folder(len(answers)))
            raise Killed

    def folder(number: int) -> Path:
        return tmp_path / str(number)

    def call(number: int, **running: Any) -> bytes:
        answers.append([])
        path = folder(number) / "result.nc"
        ask(store=path, jobs=1, progress=False, **running)
        return path.read_bytes()

    monkeypatch.setattr(Journal, "put", store)
    kills = False
    expected, ((*chunks,), *_) = call(0), answers
    assert sorted(chunks) == list(range(len(chunks)))
    shutil.rmtree(folder(0))
    answers.clear()
    kills = True
    for number in range(len(chunks)):
        with pytest.raises(Killed):
            call(number)
    last = folder(len(chunks))
    assert journal_path(last / "result.nc").exists()
    assert call(len(chunks)) == expected
    assert answers == [*([index] for index in chunks), []], "chunks are computed twice"
    assert [path.name for path in last.iterdir()] == ["result.nc"]
