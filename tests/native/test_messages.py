"""What the native FMUs say when they are asked for what they are not, or for what is not there."""

import ctypes
import shutil

import fmpy
import pytest
from fmpy import fmi2, fmi3

from .slave import harmonic, slave

VERSIONS = ("fmi2", "fmi3")
OTHER = "{00000000-0000-0000-0000-000000000000}"


@pytest.fixture(scope="module", params=VERSIONS)
def unpacked(request, fmus, tmp_path_factory):
    """An FMU's version, its folder, its GUID or instantiation token, and its name."""
    folder = tmp_path_factory.mktemp(request.param)
    path = str(fmus[request.param])
    fmpy.extract(path, str(folder))
    known = fmpy.read_model_description(path)
    yield request.param, folder, known.guid or known.instantiationToken, known.modelName
    shutil.rmtree(folder, ignore_errors=True)


def refusal(unpacked, token, kind):
    """What is logged where an instance of a kind is not made."""
    version, folder, _, name = unpacked
    messages = []
    identity = {
        "guid": token,
        "unzipDirectory": str(folder),
        "modelIdentifier": name,
        "instanceName": "one",
    }
    if version == "fmi3":
        made = (fmi3.FMU3Slave if kind == "co-simulation" else fmi3.FMU3Model)(**identity)

        def hear(_environment, _status, _category, text):
            messages.append(text.decode())

        with pytest.raises(Exception, match="instantiate"):
            made.instantiate(logMessage=hear)
    else:
        made = (fmi2.FMU2Slave if kind == "co-simulation" else fmi2.FMU2Model)(**identity)
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
            lambda _e, _i, _s, _c, text: messages.append(text.decode())
        )
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        fmpy.logging.addLoggerProxy(ctypes.byref(callbacks))
        with pytest.raises(Exception, match="instantiate"):
            made.instantiate(callbacks=callbacks)
    (message,) = messages
    return message


def test_another_token_is_shown_beside_the_fmus_own(unpacked):
    version, _, token, _ = unpacked
    message = refusal(unpacked, OTHER, "co-simulation")
    assert token in message and OTHER in message
    assert ("instantiation token" in message) == (version == "fmi3")
    assert ("GUID" in message) == (version == "fmi2")


def test_model_exchange_is_refused_as_such(unpacked):
    _, _, token, _ = unpacked
    message = refusal(unpacked, token, "model exchange")
    assert "co-simulation only" in message
    assert "GUID" not in message and "token" not in message


@pytest.mark.parametrize("version", VERSIONS)
def test_integers_and_booleans_are_printed_as_such(fmus, version):
    with slave(fmus[version]) as fmu:
        sample_count, bonded, impact_count = (
            fmu.variables[name].valueReference
            for name in ("sample_count", "bonded", "impact_count")
        )
        set_integer = "setInt32" if version == "fmi3" else "setInteger"
        fmu.start()
        said = fmu.refused(set_integer, [sample_count], [300])
        assert "sample_count = 300: expected 0 <= sample_count <= 200" in said
        assert "impact_count = 7: an output" in fmu.refused(set_integer, [impact_count], [7])
        assert "bonded = true: a fixed parameter" in fmu.refused("setBoolean", [bonded], [True])
        assert "box_frequency = -1.0 rad/s" in fmu.refused(
            "setFloat64" if version == "fmi3" else "setReal",
            [fmu.variables["box_frequency"].valueReference],
            [-1.0],
        )


@pytest.mark.parametrize("version", VERSIONS)
def test_a_wrong_type_is_named_with_its_variable(fmus, version):
    real, whole = ("Float64", "Int32") if version == "fmi3" else ("Real", "Integer")
    with slave(fmus[version]) as fmu:
        fmu.start()
        reference = fmu.variables["in_contact"].valueReference
        said = fmu.refused(f"get{real}", [reference])
        assert f"valueReference = {reference}: in_contact is one of the Boolean variables" in said
        assert f"expected one of the {real} variables in modelDescription.xml" in said
        said = fmu.refused(f"get{whole}", [99999])
        assert f"valueReference = 99999: expected one of the {whole} variables" in said


@pytest.mark.parametrize("version", VERSIONS)
def test_counts_in_messages_are_whole_numbers(fmus, version):
    """Of a step that cannot finish: chattering without an end."""
    with slave(fmus[version]) as fmu:
        fmu.start(box_amplitude=0.0, box_acceleration=-1.0, x2_start=1.0, e=1.0, gamma=1e-9)
        fmu.fmu.doStep(0.0, 1.0)
        said = fmu.refused("doStep", 1.0, 1e12)
    assert "evaluations (at most 10000000)" in said
    counted = said.split("after ")[1].split(" impacts")[0]
    assert counted.isdigit() and int(counted) > 0


@pytest.mark.parametrize("version", VERSIONS)
def test_unknown_log_categories_are_refused(fmus, version):
    with slave(fmus[version]) as fmu:
        known = fmpy.read_model_description(str(fmus[version])).logCategories
        assert known
        fmu.fmu.setDebugLogging(True, [category.name for category in known])
        fmu.fmu.setDebugLogging(False, [])
        said = fmu.refused("setDebugLogging", True, [known[0].name, "logNonsense"])
        assert "logNonsense" in said and known[0].name in said


@pytest.mark.parametrize("early", [False, True])
def test_a_state_saved_in_event_mode_is_stepped_on_without_it(fmus, early):
    with (
        slave(fmus["fmi3"], event_mode=True, early_return=early) as fmu,
        slave(fmus["fmi3"]) as other,
    ):
        fmu.start(**harmonic(1.13))
        while not fmu.step(fmu.time + 4.0)[0]:
            pass
        fmu.fmu.enterEventMode()
        state = fmu.fmu.getFMUState()
        data = fmu.fmu.serializeFMUState(state)
        fmu.fmu.freeFMUState(state)
        fmu.update()
        fmu.fmu.enterStepMode()
        read = other.fmu.deserializeFMUState(data)
        other.fmu.setFMUState(read)
        other.time = fmu.time
        end = fmu.time + 20.0
        while fmu.time < end:
            if fmu.step(end)[0]:
                fmu.fmu.enterEventMode()
                fmu.update()
                fmu.fmu.enterStepMode()
        other.step(end)
        assert other.get("x1", "v2", "impact_count") == fmu.get("x1", "v2", "impact_count")
        fmu.fmu.setFMUState(read)  # where there is event mode, the state is still in it
        fmu.update()
        other.fmu.freeFMUState(read)


@pytest.mark.parametrize("version", VERSIONS)
def test_a_state_freed_by_its_handle_frees_nothing(fmus, version):
    """What fmusim 0.0.39 does: the handle where the standard has a pointer to it."""
    with slave(fmus[version]) as fmu:
        fmu.start(**harmonic(1.13))
        fmu.step(20.0)
        before = fmu.get("x1", "x2", "impact_count")
        state = fmu.fmu.getFMUState()
        name = "fmi3FreeFMUState" if version == "fmi3" else "fmi2FreeFMUstate"
        handle = ctypes.cast(state, ctypes.POINTER(ctypes.c_void_p))
        assert getattr(fmu.fmu.dll, name)(fmu.fmu.component, handle) == 0
        fmu.step(30.0)
        fmu.fmu.setFMUState(state)
        assert fmu.get("x1", "x2", "impact_count") == before
        fmu.fmu.freeFMUState(state)
