"""Which function may be called when, and what a call that may not be changes: nothing."""

import re

import pytest

from fmu_src.export import native_form

from ..fmu.driver import MODELS, VERSIONS, path_of
from ..fmu.programs.driver import open_fmu

NEW, INITIALIZING, STEPPING, TERMINATED, BETWEEN_EVENTS, AT_EVENT = range(6)
INPUTS = {
    "TwoMassImpactOscillator": ("box_amplitude", "e", "x1"),
    "MotorShaker": ("voltage", "motor_constant", "box_position"),
    "ElectrodynamicShaker": ("command", "force_factor", "box_position"),
}


def in_phase(path, phase):
    """An instance that has come to a phase; the last two are modes of FMI 3.0."""
    options = {"event_mode": phase >= BETWEEN_EVENTS} if phase >= BETWEEN_EVENTS else {}
    f = open_fmu(path, **options)
    if phase == NEW:
        return f
    if phase == INITIALIZING:
        f.enter()
        return f
    f.start().step(20.0)
    if phase == TERMINATED:
        f.call("terminate")
    if phase == AT_EVENT:
        f.call("enterEventMode")
    return f


def calls(f):
    """Function and arguments, and in which phases it is allowed."""
    names = INPUTS[f.fmu.modelIdentifier]
    an_input, fixed, output = ([f.reference(name)] for name in names)
    real = f.variables[names[2]].type
    yield "enterInitializationMode", (), {NEW}
    yield "exitInitializationMode", (), {INITIALIZING}
    yield "terminate", (), {STEPPING, BETWEEN_EVENTS, AT_EVENT}
    yield f"get{real}", (output,), {*range(6)} - {NEW}
    yield f"set{real}", (an_input, [0.5]), {*range(6)} - {TERMINATED}
    yield f"set{real}", (fixed, [0.5]), {NEW, INITIALIZING}
    yield f"set{real}", (output, [0.5]), set()
    yield "doStep", (20.0, 1.0), {STEPPING, BETWEEN_EVENTS}
    rates = "getOutputDerivatives" if f.third else "getRealOutputDerivatives"
    yield rates, (output, [1]), {*range(6)} - {NEW}
    if f.third:
        yield "updateDiscreteStates", (), {AT_EVENT}
        yield "enterStepMode", (), {AT_EVENT}
        yield "enterEventMode", (), {BETWEEN_EVENTS}
    else:
        yield "setupExperiment", (), {NEW}


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("version", VERSIONS)
def test_calls_out_of_order_are_refused_and_change_nothing(exported, version, model):
    """Not a byte of the state; and reset forgets everything."""
    path = path_of(model, version)
    fresh = in_phase(path, STEPPING).save()
    for phase in range(6 if version == "fmi3" else 4):
        f = in_phase(path, phase)
        before = f.save()
        for function, given, allowed in calls(f):
            if phase in allowed:
                f.call(function, *given)
                f.restore(*before)
                continue
            now = f.save()
            assert f.refused(function, *given)
            same = f.save() == now
            assert same, (phase, function)
        f.reset().start().step(20.0)
        if phase < BETWEEN_EVENTS:
            assert f.save() == fresh


def functions_of_header(version):
    """Every function the standard's header declares: some importers look for all of them."""
    text = native_form.fmi_headers(version)[f"{version}Functions.h"].decode()
    return sorted(set(re.findall(rf"_Export\s+{version}\w+TYPE\s+({version}\w+)\s*;", text)))
