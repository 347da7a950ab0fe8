"""The six guarantees of TwoMassImpactOscillator.fmu, checked in your own pipeline.

Needs FMPy and pytest, nothing else, and takes less than a minute::

    pip install fmpy pytest
    FMU=path/to/TwoMassImpactOscillator.fmu pytest test_fmu.py

FMI 2.0 and 3.0, whatever made the binary. Nothing here knows how the FMU computes.
"""

import ctypes
import json
import math
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import fmpy
import pytest
from fmpy import fmi2, fmi3

FMU = os.environ.get("FMU", "")
CHAOS = {"box_amplitude": 1.0 / 1.13**2, "box_frequency": 1.13}
STATE = ("x1", "x2", "v1", "v2", "x_rel", "phase", "impact_count", "impact_time", "impact_energy")
messages: list[str] = []
if not Path(FMU).is_file():
    state = f"names no file, {FMU!r}" if FMU else "is not set"
    expected = "expected the path of TwoMassImpactOscillator.fmu"
    raise pytest.Collector.CollectError(f"environment variable FMU {state}: {expected}")
model = fmpy.read_model_description(FMU)
if model.modelName != "TwoMassImpactOscillator":
    expected = "expected a TwoMassImpactOscillator"
    raise pytest.Collector.CollectError(f"FMU={FMU}: a {model.modelName}, {expected}")
folder = tempfile.TemporaryDirectory()
fmpy.extract(FMU, folder.name)


class Run:
    """One initialised instance."""

    def __init__(self, initialize=True, **values):
        self.variables = {variable.name: variable for variable in model.modelVariables}
        self.third = model.fmiVersion.startswith("3")
        make = fmi3.FMU3Slave if self.third else fmi2.FMU2Slave
        name = model.coSimulation.modelIdentifier
        identity = {"guid": model.guid, "modelIdentifier": name, "instanceName": "instance"}
        self.fmu = make(unzipDirectory=folder.name, **identity)
        self.instantiate_with_log()
        self.set(**values)
        self.time = 0.0
        if initialize:
            self.initialize()

    def instantiate_with_log(self):
        if self.third:
            keep = lambda _e, _s, _c, text: messages.append(text.decode())  # noqa: E731
            self.fmu.instantiate(loggingOn=True, logMessage=keep)
            return
        calls = self.callbacks = fmi2.fmi2CallbackFunctions()
        calls.logger = fmi2.fmi2CallbackLoggerTYPE(lambda *all: messages.append(all[-1].decode()))
        calls.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        calls.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        fmpy.logging.addLoggerProxy(ctypes.byref(calls))
        self.fmu.instantiate(callbacks=calls, loggingOn=True)

    def initialize(self):
        if not self.third:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, **values):
        for name, value in values.items():
            variable = self.variables[name]
            getattr(self.fmu, f"set{variable.type}")([variable.valueReference], [value])

    def get(self, *names):
        found = []
        for variable in map(self.variables.__getitem__, names):
            found += getattr(self.fmu, f"get{variable.type}")([variable.valueReference])
        return found

    def step_to(self, *times):
        for time in times:
            self.fmu.doStep(self.time, time - self.time)
            self.time = time
        return self

    def mechanical_energy(self):
        """Of a structure with the default parameters, at rest in its box."""
        x1, x2, v1, v2 = self.get("x1", "x2", "v1", "v2")
        return 0.5 * (v1 * v1 + v2 * v2 + x1 * x1 + 1.2 * x2 * x2)

    def message_of_refusal(self, call):
        """The message of a call that has to fail."""
        messages.clear()
        with pytest.raises(Exception):  # noqa: B017  FMPy's differs with its version
            call()
        return " ".join(messages)

    def __del__(self):
        self.fmu.freeInstance()


def test_1_no_impact_is_missed():
    """One step of 500 s counts what 50,000 steps of 0.01 s count, and what their samples show."""
    fine, seen, before = Run(**CHAOS), 0, 0.0
    for k in range(50_000):
        (speed,) = fine.step_to(0.01 * (k + 1)).get("v_rel")
        seen += before < -0.05 and speed > 0.0 and speed - before > 0.1  # a jump, not a turn
        before = speed
    counts = [run.get("impact_count")[0] for run in (Run(**CHAOS).step_to(500.0), fine)]
    assert counts[0] == counts[1] >= seen > 20


def test_2_the_communication_grid_does_not_matter():
    """To the last bit, through chaos."""
    draw = random.Random(1)
    uneven = sorted(draw.uniform(0.0, 400.0) for _ in range(500))
    expected = Run(**CHAOS).step_to(400.0).get(*STATE)
    assert Run(**CHAOS).step_to(*uneven, 400.0).get(*STATE) == expected
    assert Run(**CHAOS).step_to(*(0.4 * k for k in range(1, 1000)), 400.0).get(*STATE) == expected


@pytest.mark.parametrize("power", [-40, -1, 1, 30])
def test_3_twice_the_amplitude_is_twice_the_motion(power):
    """To the last bit."""
    scale = 2.0**power
    one = Run(**CHAOS, x2_start=0.25).step_to(200.0)
    amplitude = {"box_amplitude": CHAOS["box_amplitude"] * scale, "x2_start": 0.25 * scale}
    other = Run(**{**CHAOS, **amplitude}).step_to(200.0)
    names = ("x1", "x2", "v1", "v2")
    assert other.get(*names) == [scale * value for value in one.get(*names)]


def test_4_never_through_each_other_and_nothing_is_lost():
    run = Run(**CHAOS)
    for k in range(4000):
        assert run.step_to(0.1 * (k + 1)).get("x_rel")[0] >= 0.0


def test_4_energy_and_momentum():
    """Undriven and undamped: what the masses lose is what the impacts took, and the box's."""
    run = Run(box_amplitude=0.0, d1=0.0, d2=0.0, x2_start=1.0, v1_start=0.5)
    start, momentum = run.mechanical_energy(), sum(run.get("v1", "v2"))
    for k in range(1000):
        lost, impulse = run.step_to(0.25 * (k + 1)).get("impact_energy", "box_impulse")
        assert run.mechanical_energy() + lost == pytest.approx(start, rel=1e-11)
        after = sum(run.get("v1", "v2"))
        assert after - momentum == pytest.approx(-impulse, abs=1e-12)
        momentum = after
    assert lost > 0.01


def states_as_text():
    """Numbers of a run, as text."""
    return [float(value).hex() for value in Run(**CHAOS).step_to(100.0, 300.0).get(*STATE)]


def test_5_two_instances_and_two_processes():
    assert states_as_text() == states_as_text()
    program = "import json, test_fmu; print('ANSWER', json.dumps(test_fmu.states_as_text()))"
    where = {"cwd": Path(__file__).parent, "env": {**os.environ, "FMU": str(Path(FMU).resolve())}}
    said = subprocess.check_output([sys.executable, "-c", program], text=True, **where)
    (answer,) = [line[7:] for line in said.splitlines() if line.startswith("ANSWER ")]
    assert json.loads(answer) == states_as_text()


def test_5_a_run_resumed_from_a_saved_state():
    """Through bytes, in another instance."""
    run = Run(**CHAOS).step_to(150.0)
    state = run.fmu.getFMUState()
    data = run.fmu.serializeFMUState(state)
    run.fmu.freeFMUState(state)
    other = Run()
    state = other.fmu.deserializeFMUState(data)
    other.fmu.setFMUState(state)
    other.fmu.freeFMUState(state)
    other.time = 150.0
    assert other.step_to(300.0).get(*STATE) == run.step_to(300.0).get(*STATE)


def settable_ranges():
    """Names and ranges of parameters and inputs."""
    kinds, types = ("parameter", "input"), ("Real", "Float64")
    found = [v for v in model.modelVariables if v.causality in kinds and v.type in types]
    return [(v.name, float(v.min), float(v.max)) for v in found]


@pytest.mark.parametrize(("name", "low", "high"), settable_ranges())
def test_6_bad_values_are_refused_by_name(name, low, high):
    run, twin = Run(initialize=False), Run(**CHAOS).step_to(10.0)
    for value in (math.nan, math.inf, -math.inf, low - 1e90 - abs(low), high + 1e90 + abs(high)):
        message = run.message_of_refusal(lambda value=value: run.set(**{name: value}))
        assert name in message and "expected" in message
    run.initialize()
    assert run.step_to(10.0).get("x_rel")[0] >= 0.0  # the instance is usable, others live on
    assert twin.step_to(20.0).get(*STATE) == Run(**CHAOS).step_to(10.0, 20.0).get(*STATE)


@pytest.mark.parametrize("step", [-1.0, math.nan, math.inf])
def test_6_bad_steps_are_refused(step):
    run = Run(**CHAOS).step_to(10.0)
    assert "communicationStepSize" in run.message_of_refusal(lambda: run.fmu.doStep(10.0, step))
    assert run.step_to(20.0).get(*STATE) == Run(**CHAOS).step_to(10.0, 20.0).get(*STATE)
