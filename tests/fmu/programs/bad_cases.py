"""Mistakes: how to get there, the call that must fail, and what its message must name.

Read by the test and by the fresh process. A text that begins with "python: " is looked for in the
messages of the pythonfmu form alone. ``f.saved`` is a good serialised state of another run.
"""

import math


def in_mode(**values):
    """A new instance in initialisation mode, with values set."""

    def prepare(f):
        f.call("setupExperiment", startTime=0.0)
        f.set(**values)
        f.call("enterInitializationMode")

    return prepare


def running(then=None, **values):
    """An instance at 2 s; ``then`` is set there."""

    def prepare(f):
        f.start(**values).step(2.0)
        f.set(**(then or {}))

    return prepare


def ended(f):
    """A terminated instance."""
    f.start().step(2.0)
    f.call("terminate")


def new(f):
    """A new instance."""


def step_at(f, time):
    """A step from a point of time of the caller's own."""
    f.call("doStep", currentCommunicationPoint=time, communicationStepSize=0.5)


def step_by(f, size):
    """A step of any size."""
    f.call("doStep", currentCommunicationPoint=f.time, communicationStepSize=size)


CASES = {
    "nan parameter": (new, lambda f: f.set(m1=math.nan), ["m1 = nan kg", "1e-30 <= m1 <= 1e+30"]),
    "negative mass": (new, lambda f: f.set(m2=-1.0), ["m2 = -1.0 kg", "1e-30 <= m2 <= 1e+30"]),
    "negative damping": (
        new,
        lambda f: f.set(d1=-0.01),
        ["d1 = -0.01 N.s/m", "0.0 <= d1 <= 1e+30"],
    ),
    "restitution above 1": (new, lambda f: f.set(e=1.5), ["e = 1.5", "0.0 <= e <= 1.0"]),
    "infinite start": (
        new,
        lambda f: f.set(x2_start=-math.inf),
        ["x2_start = -inf m", "-1e+100 <= x2_start <= 1e+100"],
    ),
    "nan in initialisation mode": (
        in_mode(),
        lambda f: f.set(gamma=math.nan),
        ["gamma = nan", "1e-09 <= gamma <= 1.0"],
    ),
    "nan input": (
        running(),
        lambda f: f.set(box_amplitude=math.nan),
        ["box_amplitude = nan m", "-1e+100 <= box_amplitude <= 1e+100"],
    ),
    "infinite input": (
        running(),
        lambda f: f.set(box_jerk=math.inf),
        ["box_jerk = inf m/s3", "-1e+100 <= box_jerk <= 1e+100"],
    ),
    "negative frequency": (
        running(),
        lambda f: f.set(box_frequency=-1.0),
        ["box_frequency = -1.0 rad/s", "0.0 <= box_frequency <= 1e+30"],
    ),
    "one bad value among good ones": (
        new,
        lambda f: f.call(
            "setReal",
            [f.reference("m1"), f.reference("k2"), f.reference("m2")],
            [2.0, math.nan, 3.0],
        ),
        ["k2 = nan N/m", "1e-30 <= k2 <= 1e+30"],
    ),
    "masses overlap at the start": (
        in_mode(x1_start=1.0),
        lambda f: f.call("exitInitializationMode"),
        ["x2_start = 0.0 m", "x2_start >= x1_start = 1.0 m"],
    ),
    "overlap seen when an output is read": (
        in_mode(x1_start=1.0),
        lambda f: f.get("v1"),
        ["x2_start = 0.0 m", "x2_start >= x1_start = 1.0 m"],
    ),
    "bonded apart": (
        in_mode(bonded=True, x2_start=0.5),
        lambda f: f.call("exitInitializationMode"),
        ["bonded = true", "x2_start = 0.5 m", "x2_start = x1_start = 0.0 m"],
    ),
    "bonded at two speeds": (
        in_mode(bonded=True, v2_start=0.5),
        lambda f: f.call("exitInitializationMode"),
        ["bonded = true", "v2_start = 0.5 m/s", "v2_start = v1_start = 0.0 m/s"],
    ),
    "motion beyond floating point": (
        running(bonded=True, then={"box_crackle": 1e100}),
        lambda f: f.step(1e80),
        ["range of floating-point numbers", "time = 1e+80 s", "expected"],
    ),
    "fixed parameter after initialisation": (
        running(),
        lambda f: f.set(m1=2.0),
        ["m1 = 2.0", "fixed parameter", "before the end of initialisation"],
    ),
    "fixed Boolean after initialisation": (
        running(),
        lambda f: f.set(bonded=True),
        ["bonded = true", "fixed parameter"],
    ),
    "fixed parameter after the end": (
        ended,
        lambda f: f.set(e=0.5),
        ["python: e = 0.5", "python: fixed parameter"],
    ),
    "output set": (
        new,
        lambda f: f.set(x1=1.0),
        ["x1 = 1.0", "output", "expected a parameter or an input"],
    ),
    "Integer output set": (
        running(),
        lambda f: f.set(impact_count=3),
        ["impact_count = 3", "output", "expected"],
    ),
    "Boolean output set": (
        running(),
        lambda f: f.set(in_contact=True),
        ["in_contact", "output", "expected"],
    ),
    "unknown reference read": (
        running(),
        lambda f: f.call("getReal", [999]),
        ["valueReference = 999", "python: Real", "expected"],
    ),
    "hidden state read": (
        running(),
        lambda f: f.call("getReal", [len(f.variables)]),
        ["valueReference = ", "python: Real", "expected"],
    ),
    "unknown reference set": (
        new,
        lambda f: f.call("setReal", [999], [1.0]),
        ["valueReference = 999", "python: Real", "expected"],
    ),
    "Real read as Integer": (
        running(),
        lambda f: f.call("getInteger", [f.reference("m1")]),
        ["valueReference = 0", "python: Integer", "expected"],
    ),
    "Real read as Boolean": (
        running(),
        lambda f: f.call("getBoolean", [f.reference("m1")]),
        ["valueReference = 0", "python: Boolean", "expected"],
    ),
    "Real read as String": (
        running(),
        lambda f: f.call("getString", [f.reference("m1")]),
        ["python: valueReference = 0", "String"],
    ),
    "Integer read as Real": (
        running(),
        lambda f: f.call("getReal", [f.reference("impact_count")]),
        ["valueReference = ", "python: Real", "expected"],
    ),
    "Real set as Integer": (
        new,
        lambda f: f.call("setInteger", [f.reference("m1")], [2]),
        ["valueReference = 0", "python: Integer", "expected"],
    ),
    "Real set as Boolean": (
        new,
        lambda f: f.call("setBoolean", [f.reference("m1")], [True]),
        ["valueReference = 0", "python: Boolean", "expected"],
    ),
    "Real set as String": (
        new,
        lambda f: f.call("setString", [f.reference("m1")], ["%s%n"]),
        ["python: valueReference = 0", "String"],
    ),
    "Boolean set as Real": (
        new,
        lambda f: f.call("setReal", [f.reference("bonded")], [1.0]),
        ["valueReference = ", "python: Real", "expected"],
    ),
    "negative step": (
        running(),
        lambda f: step_by(f, -0.5),
        ["communicationStepSize = -0.5 s", "expected every finite number >= 0"],
    ),
    "nan step": (
        running(),
        lambda f: step_by(f, math.nan),
        ["communicationStepSize = nan s", "expected every finite number >= 0"],
    ),
    "infinite step": (
        running(),
        lambda f: step_by(f, math.inf),
        ["communicationStepSize = inf s", "expected every finite number >= 0"],
    ),
    "point of time ahead": (
        running(),
        lambda f: step_at(f, 2.5),
        ["currentCommunicationPoint = 2.5 s", "expected 2.0 s"],
    ),
    "point of time gone by": (
        running(),
        lambda f: step_at(f, 1.5),
        ["currentCommunicationPoint = 1.5 s", "expected 2.0 s"],
    ),
    "point of time nan": (
        running(),
        lambda f: step_at(f, math.nan),
        ["currentCommunicationPoint = nan s", "expected 2.0 s"],
    ),
    "point of time infinite": (
        running(),
        lambda f: step_at(f, math.inf),
        ["currentCommunicationPoint = inf s", "expected 2.0 s"],
    ),
    "step before initialisation": (
        new,
        lambda f: f.step(1.0),
        ["fmi2DoStep", "python: expected after initialisation"],
    ),
    "step in initialisation mode": (
        in_mode(),
        lambda f: f.step(1.0),
        ["fmi2DoStep", "python: expected after initialisation"],
    ),
    "step after the end": (
        ended,
        lambda f: f.step(3.0),
        ["fmi2DoStep", "python: before fmi2Terminate"],
    ),
    "mode left before it is entered": (
        new,
        lambda f: f.call("exitInitializationMode"),
        ["fmi2ExitInitializationMode", "python: expected one call in initialisation mode"],
    ),
    "mode left twice": (
        running(),
        lambda f: f.call("exitInitializationMode"),
        ["fmi2ExitInitializationMode", "python: expected one call in initialisation mode"],
    ),
    "mode entered twice": (
        in_mode(),
        lambda f: f.call("enterInitializationMode"),
        ["fmi2EnterInitializationMode", "python: expected one call"],
    ),
    "mode entered while running": (
        running(),
        lambda f: f.call("enterInitializationMode"),
        ["fmi2EnterInitializationMode", "python: expected one call"],
    ),
    "mode entered after the end": (
        ended,
        lambda f: f.call("enterInitializationMode"),
        ["fmi2EnterInitializationMode", "python: expected one call"],
    ),
    "experiment set up while running": (
        running(),
        lambda f: f.call("setupExperiment"),
        ["fmi2SetupExperiment", "python: expected one call"],
    ),
    "start time nan": (
        new,
        lambda f: f.call("setupExperiment", startTime=math.nan),
        ["startTime = nan s", "every finite number"],
    ),
    "start time infinite": (
        new,
        lambda f: f.call("setupExperiment", startTime=-math.inf),
        ["startTime = -inf s", "every finite number"],
    ),
    "state of something else": (
        running(),
        lambda f: f.restore(b"no state of this FMU" * 90, 2.0),
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
    "empty state": (
        new,
        lambda f: f.restore(b"", 2.0),
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
    "state cut short": (
        running(),
        lambda f: f.restore(f.saved[:-1], 2.0),
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
    "state cut to its header": (
        running(),
        lambda f: f.restore(f.saved[:64], 2.0),
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
    "state too long": (
        running(),
        lambda f: f.restore(f.saved + bytes(8), 2.0),
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
    "state of another version": (
        running(),
        lambda f: f.restore(f.saved[:30] + b"0000" + f.saved[34:], 2.0),
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
}
