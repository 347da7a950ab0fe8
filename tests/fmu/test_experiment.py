"""Start, stop and messages of an experiment, as the standards have them."""

import fmpy
import numpy as np
import pytest
from fmpy import fmi2

from fmu_src.export import forms

from .driver import run


def test_no_step_goes_past_the_stop_time(fmu, tmp_path):
    """FMI 2.0.5 (fmi2SetupExperiment) and 3.0.2 (fmi3EnterInitializationMode): an error."""
    reached, message = run("experiment.past_the_stop_time", fmu, cwd=tmp_path)
    assert reached == 1.0
    assert "stopTime = 1.0 s" in message and "1.25" in message


def test_stop_time_before_the_start_is_refused(fmu, tmp_path):
    message = run("experiment.stop_before_start", fmu, cwd=tmp_path)
    assert "startTime = 2.0 s with stopTime = 1.0 s: expected stopTime >= startTime" in message


@pytest.mark.parametrize("steps", [7, 10, 49, 1000])
def test_steps_whose_sum_rounds_past_the_stop_time_are_taken(fmu, tmp_path, steps):
    """A tenth, ten times, is not one: the importer's rounding is no step past the end."""
    assert run("experiment.sum_of_steps", fmu, steps, cwd=tmp_path) == pytest.approx(3.0)


@pytest.mark.parametrize("form", ["fmi2", "fmi3"])
def test_the_motor_turns_in_a_default_run(exported, form):
    """What a checker runs with nothing set shows a motion."""
    path = str(exported / form / "MotorShaker.fmu")
    result = fmpy.simulate_fmu(path, stop_time=2.0, output_interval=0.01)
    assert result["speed"][-1] > 10.0
    assert np.ptp(result["box_position"]) > 1e-5


@pytest.mark.parametrize("name", forms.MODELS)
def test_a_message_needs_no_arguments(exported, tmp_path, name):
    """Importers that show the format as it is, and those that fill it in, show the same text."""
    path = exported / "fmi2" / f"{name}.fmu"
    found = fmpy.read_model_description(str(path))
    folder = fmpy.extract(str(path), str(tmp_path))
    texts = []
    callbacks = fmi2.fmi2CallbackFunctions()  # no proxy: the format itself arrives
    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(lambda *given: texts.append(given[-1].decode()))
    callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
    callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
    identifier = found.coSimulation.modelIdentifier
    fmu = fmi2.FMU2Slave(
        guid=found.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="a"
    )
    fmu.instantiate(callbacks=callbacks)
    with pytest.raises(Exception, match="fmi2SetReal"):
        fmu.setReal([0], [float("nan")])
    fmu.freeInstance()
    (text,) = texts
    variable = found.modelVariables[0]
    assert f"{variable.name} = nan {variable.unit}: expected " in text
    assert text.count("%") % 2 == 0
