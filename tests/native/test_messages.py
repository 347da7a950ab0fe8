"""What the native FMUs say when they are asked for what they are not, or for what is not there."""

import ctypes
import tempfile

import fmpy
import pytest
from fmpy import fmi2, fmi3

from ..fmu.programs import driver
from ..fmu.programs.driver import Fmu2, callbacks, describe, harmonic, hear, messages, open_fmu

OTHER = "{00000000-0000-0000-0000-000000000000}"
KINDS = {  # classes of FMPy by FMI version
    "fmi2": {"co-simulation": fmi2.FMU2Slave, "model exchange": fmi2.FMU2Model},
    "fmi3": {"co-simulation": fmi3.FMU3Slave, "model exchange": fmi3.FMU3Model},
}


def bare(path, version, token, kind="co-simulation"):
    found = describe(path)
    return KINDS[version][kind](
        guid=token,
        unzipDirectory=fmpy.extract(str(path), tempfile.mkdtemp(dir=Fmu2.home)),
        modelIdentifier=found.coSimulation.modelIdentifier,
        instanceName="one",
    )


def refusal(path, version, token, kind):
    """What is logged where an instance of a kind is not made."""
    messages.clear()
    told = {"logMessage": hear} if version == "fmi3" else {"callbacks": callbacks()}
    with pytest.raises(Exception, match="instantiate"):
        bare(path, version, token, kind).instantiate(**told)
    (message,) = messages
    return message


def test_another_token_is_shown_beside_the_fmus_own(fmus, version):
    message = refusal(fmus[version], version, OTHER, "co-simulation")
    assert describe(fmus[version]).guid in message and OTHER in message
    assert ("instantiation token" in message) == (version == "fmi3")
    assert ("GUID" in message) == (version == "fmi2")


def test_a_message_needs_no_arguments(fmus):
    """Importers that show the format as it is, and those that fill it in, show the same text."""
    path = fmus["fmi2"]
    raw = fmi2.fmi2CallbackFunctions()  # no proxy: the format itself arrives
    raw.logger, raw.allocateMemory, raw.freeMemory = driver.LOGGER, *driver.allocation()
    fmu = bare(path, "fmi2", describe(path).guid)
    fmu.instantiate(callbacks=raw)
    messages.clear()
    with pytest.raises(Exception, match="fmi2SetReal"):
        fmu.setReal([0], [float("nan")])
    fmu.freeInstance()
    (text,) = messages
    assert "m1 = nan kg: expected " in text
    assert text.count("%") % 2 == 0


def test_a_state_freed_by_its_handle_frees_nothing(fmus, version):
    """What fmusim 0.0.39 does: the handle where the standard has a pointer to it."""
    with open_fmu(fmus[version]) as fmu:
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
