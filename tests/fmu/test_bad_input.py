"""Every mistake gives a status and a message, and no instance suffers, nor the process."""

import math
from functools import partial

import pytest

from ..sparing import ordinary
from .driver import FMUS
from .programs.driver import OK, Refused, harmonic, open_fmu

nan, inf = math.nan, math.inf
forms = pytest.mark.parametrize("form", ["fmi2-python", "fmi2"])


PHASES = {  # how an instance comes there
    "new": lambda f: None,
    "begun": lambda f: f.enter(),
    "running": lambda f: f.start().step(2.0),
    "ended": lambda f: f.start().step(2.0).call("terminate"),
}
OVERLAP = "x2_start = 0.0 m; x2_start >= x1_start = 1.0 m"
STEP_SIZE = "expected every finite number >= 0"
ONCE = "python: expected one call"
STATE = "python: FMU state; expected a state saved by this FMU"
SLOW = {"m1": 1e24, "m2": 1e24, "k1": 1e-24, "k2": 1e-24, "box_frequency": 0.0}
SET = [  # phase, values, and parts of the message; those of pythonfmu's form alone are marked
    ("new", {"m1": nan}, "m1 = nan kg; 1e-24 <= m1 <= 1e+24"),
    ("running", {"box_amplitude": nan}, "box_amplitude = nan m; -1e+100 <= box_amplitude <= "),
    ("running", {"m1": 2.0}, "m1 = 2.0; fixed parameter; before the end of initialisation"),
    ("ended", {"e": 0.5}, "python: e = 0.5; python: fixed parameter"),
    ("new", {"x1": 1.0}, "x1 = 1.0; output; expected a parameter or an input"),
    ("running", {"impact_count": 3}, "impact_count = 3; output; expected"),
]
CALL = [  # phase, function, arguments of which names are references, and parts of the message
    ("new", "setReal", (["m1", "k2", "m2"], [2.0, nan, 3.0]), "k2 = nan N/m; 1e-24 <= k2 <= 1e+24"),
    ("running", "getReal", ([999],), "valueReference = 999; python: Real; expected"),
    ("new", "setReal", ([999], [1.0]), "valueReference = 999; python: Real; expected"),
    ("running", "getInteger", (["m1"],), "valueReference = 0; python: Integer; expected"),
    ("running", "getString", (["m1"],), "python: valueReference = 0; String"),
    ("new", "setInteger", (["m1"], [2]), "valueReference = 0; python: Integer; expected"),
    ("new", "setReal", (["bonded"], [1.0]), "valueReference = ; python: Real; expected"),
    ("running", "doStep", (2.0, -0.5), f"communicationStepSize = -0.5 s; {STEP_SIZE}"),
    ("running", "doStep", (2.5, 0.5), "currentCommunicationPoint = 2.5 s; expected 2.0 s"),
    ("running", "doStep", (inf, 0.5), "currentCommunicationPoint = inf s; expected 2.0 s"),
    ("new", "doStep", (0.0, 1.0), "fmi2DoStep; python: expected after initialisation"),
    ("begun", "doStep", (0.0, 1.0), "fmi2DoStep; python: expected after initialisation"),
    ("ended", "doStep", (2.0, 1.0), "fmi2DoStep; python: before fmi2Terminate"),
    ("new", "exitInitializationMode", (), f"fmi2ExitInitializationMode; {ONCE} in initialisation"),
    ("running", "enterInitializationMode", (), f"fmi2EnterInitializationMode; {ONCE}"),
    ("running", "setupExperiment", (), f"fmi2SetupExperiment; {ONCE}"),
]
OTHER = {  # what has more steps: a function, and parts of the message
    "start time nan": (lambda f: f.enter(nan), "startTime = nan s; every finite number"),
    "start time infinite": (lambda f: f.enter(-inf), "startTime = -inf s; every finite number"),
    "overlap at the start": (lambda f: f.start(x1_start=1.0), OVERLAP),
    "overlap seen when an output is read": (lambda f: overlapping(f).get("v1"), OVERLAP),
    "bonded apart": (lambda f: f.start(bonded=True, x2_start=0.5), "bonded = true; x2_start = 0.5"),
    "bonded at two speeds": (lambda f: f.start(bonded=True, v2_start=0.5), "v2_start = 0.5 m/s"),
    "oscillations beyond counting": (
        lambda f: f.start(bonded=True).step(2.0).step(1e80),
        "the number of oscillations; time = 1e+80 s; expected",
    ),
    "motion beyond floating point": (
        lambda f: f.start(bonded=True, box_crackle=1e100, **SLOW).step(1e38),
        "the motion leaves the range of floating-point numbers; time = 1e+38 s; expected",
    ),
    "state of something else": (lambda f: f.restore(b"no state of this FMU" * 90, 2.0), STATE),
    "state of another version": (lambda f: f.restore(of_another_version(f), 2.0), STATE),
}


def overlapping(f):
    f.set(x1_start=1.0).enter()
    return f


def of_another_version(f):
    data, _ = f.start().save()
    return data[:30] + b"0000" + data[34:]


def call(f, function, given):
    if function[1:3] == "et" and function != "setupExperiment":
        names, *values = given
        given = [f.reference(x) if x in f.variables else x for x in names], *values
    f.call(function, *given)


CASES = {  # by name: phase, the call that must fail, and parts of its message
    **{f"{phase}: {v}": (phase, lambda f, v=v: f.set(**v), parts) for phase, v, parts in SET},
    **{
        f"{phase}: {function}{given}": (phase, partial(call, function=function, given=given), parts)
        for phase, function, given, parts in CALL
    },
    **{name: ("new", *case) for name, case in OTHER.items()},
}


def refusal(f, fail):
    with pytest.raises(Refused) as refused:
        fail(f)
    assert refused.value.status != OK
    return "\n".join(refused.value.messages)


def good(f):
    """Outputs of a run with parameters of its own: what a reset has to bring back."""
    return f.start(m2=1.5, x2_start=0.25, **harmonic(1.13)).step(40.0).outputs()


@forms
@pytest.mark.parametrize("key", CASES)
def test_a_mistake_is_refused_with_a_message_and_nothing_else_suffers(form, key, capfd):
    """A message that names the thing, its value and what is expected.

    Where the importer does not hear what is logged, pythonfmu's message is one line on stderr, and
    only there: nothing is told twice.
    """
    phase, fail, parts = CASES[key]
    parts = [part for part in parts.split("; ") if form != "fmi2" or part[:8] != "python: "]
    path = FMUS[form]
    witness, expected = open_fmu(path, name="witness"), good(open_fmu(path))
    witness.start(m2=1.5, x2_start=0.25, **harmonic(1.13)).step(20.0)
    for logging in (True, False):
        f = open_fmu(path, name="free", logging=logging or form == "fmi2")
        PHASES[phase](f)
        message, told = refusal(f, fail), capfd.readouterr().err.splitlines()
        assert told == [] if logging or form == "fmi2" else message == ""
        if not message:
            (message,) = told
            assert "'free'" in message  # whose mistake it was
        wanted = [part.removeprefix("python: ") for part in parts]
        assert [part for part in wanted if part not in message] == [], message
        if logging:
            assert good(f.reset()) == expected
        f.free()  # the second time right after the failure
    assert witness.step(40.0).outputs()["x1"] == expected["x1"]


@pytest.mark.parametrize("key", ordinary(CASES, [*CASES][::5]))
def test_hundreds_of_mistakes_do_no_harm(key):
    """pythonfmu releases references at each call, which shows only after some hundred."""
    phase, fail, _ = CASES[key]
    f = open_fmu(FMUS["fmi2-python"])
    PHASES[phase](f)
    for _ in range(250):
        refusal(f, fail)
        if key in OTHER:
            f.reset()
    assert good(f.reset()) == good(open_fmu(FMUS["fmi2-python"]))
