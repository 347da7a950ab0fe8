"""The mistakes of test_bad_input: how to get there, the call that must fail, and what its message
must name.
"""

# A text that begins with "python: " is looked for in the messages of the pythonfmu form alone.
# The two pieces of code run in the fresh process with an instance ``f``; ``data`` there is a good
# serialised state of another run.
NAN_STEP = "f.call('doStep', currentCommunicationPoint=f.time, communicationStepSize={})"
AT = "f.call('doStep', currentCommunicationPoint={}, communicationStepSize=0.5)"
REFERENCE = "f.variables['{}'].valueReference"
IN_MODE = "f.call('setupExperiment', startTime=0.0); f.set({}); f.call('enterInitializationMode')"
EXIT = "f.call('exitInitializationMode')"
ENTER = "f.call('enterInitializationMode')"
RUNNING = "f.start({}).step(2.0)"
ROOT_1_2, ROOT_1_1 = 1.2**0.5, 1.1**0.5

CASES = {
    # values
    "nan parameter": ("", "f.set(m1=math.nan)", ["m1 = nan kg", "1e-30 <= m1 <= 1e+30"]),
    "negative mass": ("", "f.set(m2=-1.0)", ["m2 = -1.0 kg", "1e-30 <= m2 <= 1e+30"]),
    "negative damping": ("", "f.set(d1=-0.01)", ["d1 = -0.01 N.s/m", "0.0 <= d1 <= 1e+30"]),
    "restitution above 1": ("", "f.set(e=1.5)", ["e = 1.5", "0.0 <= e <= 1.0"]),
    "infinite start": (
        "",
        "f.set(x2_start=-math.inf)",
        ["x2_start = -inf m", "-1e+100 <= x2_start <= 1e+100"],
    ),
    "nan in initialisation mode": (
        IN_MODE.format(""),
        "f.set(gamma=math.nan)",
        ["gamma = nan", "1e-09 <= gamma <= 1.0"],
    ),
    "nan input": (
        RUNNING.format(""),
        "f.set(box_amplitude=math.nan)",
        ["box_amplitude = nan m", "-1e+100 <= box_amplitude <= 1e+100"],
    ),
    "infinite input": (
        RUNNING.format(""),
        "f.set(box_jerk=math.inf)",
        ["box_jerk = inf m/s3", "-1e+100 <= box_jerk <= 1e+100"],
    ),
    "negative frequency": (
        RUNNING.format(""),
        "f.set(box_frequency=-1.0)",
        ["box_frequency = -1.0 rad/s", "0.0 <= box_frequency <= 1e+30"],
    ),
    "one bad value among good ones": (
        "",
        f"f.call('setReal', [{REFERENCE.format('m1')}, {REFERENCE.format('k2')}, {REFERENCE.format('m2')}], [2.0, math.nan, 3.0])",
        ["k2 = nan N/m", "1e-30 <= k2 <= 1e+30"],
    ),
    # combinations
    "masses overlap at the start": (
        IN_MODE.format("x1_start=1.0"),
        EXIT,
        ["x2_start = 0.0 m", "x2_start >= x1_start = 1.0 m"],
    ),
    "overlap seen when an output is read": (
        IN_MODE.format("x1_start=1.0"),
        "f.get('v1')",
        ["x2_start = 0.0 m", "x2_start >= x1_start = 1.0 m"],
    ),
    "bonded apart": (
        IN_MODE.format("bonded=True, x2_start=0.5"),
        EXIT,
        ["bonded = true", "x2_start = 0.5 m", "x2_start = x1_start = 0.0 m"],
    ),
    "bonded at two speeds": (
        IN_MODE.format("bonded=True, v2_start=0.5"),
        EXIT,
        ["bonded = true", "v2_start = 0.5 m/s", "v2_start = v1_start = 0.0 m/s"],
    ),
    "resonance of undamped mass 1": (
        IN_MODE.format("d1=0.0, box_frequency=1.0"),
        EXIT,
        ["box_frequency = 1.0 rad/s", "mass 1", "d1 > 0"],
    ),
    "resonance of undamped mass 2": (
        IN_MODE.format(f"d2=0.0, box_frequency={ROOT_1_2!r}"),
        EXIT,
        [f"box_frequency = {ROOT_1_2!r} rad/s", "mass 2", "d2 > 0"],
    ),
    "resonance of both": (
        IN_MODE.format(f"d1=0.0, d2=0.0, bonded=True, box_frequency={ROOT_1_1!r}"),
        EXIT,
        [f"box_frequency = {ROOT_1_1!r} rad/s", "both masses", "d1 + d2 > 0"],
    ),
    "resonance of both apart": (
        IN_MODE.format(f"d1=0.0, d2=0.0, box_frequency={ROOT_1_1!r}"),
        EXIT,
        [f"box_frequency = {ROOT_1_1!r} rad/s", "d1 + d2 > 0"],
    ),
    "resonance by a later input": (
        RUNNING.format("d1=0.0") + "; f.set(box_frequency=1.0)",
        "f.step(3.0)",
        ["box_frequency = 1.0 rad/s", "mass 1", "d1 > 0"],
    ),
    "motion beyond floating point": (
        RUNNING.format("bonded=True") + "; f.set(box_crackle=1e100)",
        "f.step(1e80)",
        ["range of floating-point numbers", "time = 1e+80 s", "expected"],
    ),
    # who may set what, when
    "fixed parameter after initialisation": (
        RUNNING.format(""),
        "f.set(m1=2.0)",
        ["m1 = 2.0", "fixed parameter", "before the end of initialisation"],
    ),
    "fixed Boolean after initialisation": (
        RUNNING.format(""),
        "f.set(bonded=True)",
        ["bonded = 1.0", "fixed parameter"],
    ),
    "fixed parameter after the end": (
        RUNNING.format("") + "; f.call('terminate')",
        "f.set(e=0.5)",
        ["python: e = 0.5", "python: fixed parameter"],
    ),
    "output set": (
        "",
        "f.set(x1=1.0)",
        ["x1 = 1.0", "output", "expected a parameter or an input"],
    ),
    "Integer output set": (
        RUNNING.format(""),
        "f.set(impact_count=3)",
        ["impact_count = 3", "output", "expected"],
    ),
    "Boolean output set": (
        RUNNING.format(""),
        "f.set(in_contact=True)",
        ["in_contact", "output", "expected"],
    ),
    # value references and types
    "unknown reference read": (
        RUNNING.format(""),
        "f.call('getReal', [999])",
        ["valueReference = 999", "python: Real", "expected"],
    ),
    "hidden state read": (
        RUNNING.format(""),
        "f.call('getReal', [len(f.variables)])",
        ["valueReference = ", "python: Real", "expected"],
    ),
    "unknown reference set": (
        "",
        "f.call('setReal', [999], [1.0])",
        ["valueReference = 999", "python: Real", "expected"],
    ),
    "Real read as Integer": (
        RUNNING.format(""),
        f"f.call('getInteger', [{REFERENCE.format('m1')}])",
        ["valueReference = 0", "python: Integer", "expected"],
    ),
    "Real read as Boolean": (
        RUNNING.format(""),
        f"f.call('getBoolean', [{REFERENCE.format('m1')}])",
        ["valueReference = 0", "python: Boolean", "expected"],
    ),
    "Real read as String": (
        RUNNING.format(""),
        f"f.call('getString', [{REFERENCE.format('m1')}])",
        ["python: valueReference = 0", "String"],
    ),
    "Integer read as Real": (
        RUNNING.format(""),
        f"f.call('getReal', [{REFERENCE.format('impact_count')}])",
        ["valueReference = ", "python: Real", "expected"],
    ),
    "Real set as Integer": (
        "",
        f"f.call('setInteger', [{REFERENCE.format('m1')}], [2])",
        ["valueReference = 0", "python: Integer", "expected"],
    ),
    "Real set as Boolean": (
        "",
        f"f.call('setBoolean', [{REFERENCE.format('m1')}], [True])",
        ["valueReference = 0", "python: Boolean", "expected"],
    ),
    "Real set as String": (
        "",
        f"f.call('setString', [{REFERENCE.format('m1')}], ['%s%n'])",
        ["python: valueReference = 0", "String"],
    ),
    "Boolean set as Real": (
        "",
        f"f.call('setReal', [{REFERENCE.format('bonded')}], [1.0])",
        ["valueReference = ", "python: Real", "expected"],
    ),
    # steps
    "negative step": (
        RUNNING.format(""),
        NAN_STEP.format("-0.5"),
        ["communicationStepSize = -0.5 s", "expected every finite number >= 0"],
    ),
    "nan step": (
        RUNNING.format(""),
        NAN_STEP.format("math.nan"),
        ["communicationStepSize = nan s", "expected every finite number >= 0"],
    ),
    "infinite step": (
        RUNNING.format(""),
        NAN_STEP.format("math.inf"),
        ["communicationStepSize = inf s", "expected every finite number >= 0"],
    ),
    "point of time ahead": (
        RUNNING.format(""),
        AT.format("2.5"),
        ["currentCommunicationPoint = 2.5 s", "expected 2.0 s"],
    ),
    "point of time gone by": (
        RUNNING.format(""),
        AT.format("1.5"),
        ["currentCommunicationPoint = 1.5 s", "expected 2.0 s"],
    ),
    "point of time nan": (
        RUNNING.format(""),
        AT.format("math.nan"),
        ["currentCommunicationPoint = nan s", "expected 2.0 s"],
    ),
    "point of time infinite": (
        RUNNING.format(""),
        AT.format("math.inf"),
        ["currentCommunicationPoint = inf s", "expected 2.0 s"],
    ),
    # order of calls
    "step before initialisation": (
        "",
        "f.step(1.0)",
        ["fmi2DoStep", "python: expected after initialisation"],
    ),
    "step in initialisation mode": (
        IN_MODE.format(""),
        "f.step(1.0)",
        ["fmi2DoStep", "python: expected after initialisation"],
    ),
    "step after the end": (
        RUNNING.format("") + "; f.call('terminate')",
        "f.step(3.0)",
        ["fmi2DoStep", "python: before fmi2Terminate"],
    ),
    "mode left before it is entered": (
        "",
        EXIT,
        ["fmi2ExitInitializationMode", "python: expected one call in initialisation mode"],
    ),
    "mode left twice": (
        RUNNING.format(""),
        EXIT,
        ["fmi2ExitInitializationMode", "python: expected one call in initialisation mode"],
    ),
    "mode entered twice": (
        IN_MODE.format(""),
        ENTER,
        ["fmi2EnterInitializationMode", "python: expected one call"],
    ),
    "mode entered while running": (
        RUNNING.format(""),
        ENTER,
        ["fmi2EnterInitializationMode", "python: expected one call"],
    ),
    "mode entered after the end": (
        RUNNING.format("") + "; f.call('terminate')",
        ENTER,
        ["fmi2EnterInitializationMode", "python: expected one call"],
    ),
    "experiment set up while running": (
        RUNNING.format(""),
        "f.call('setupExperiment')",
        ["fmi2SetupExperiment", "python: expected one call"],
    ),
    "start time nan": (
        "",
        "f.call('setupExperiment', startTime=math.nan)",
        ["startTime = nan s", "every finite number"],
    ),
    "start time infinite": (
        "",
        "f.call('setupExperiment', startTime=-math.inf)",
        ["startTime = -inf s", "every finite number"],
    ),
    # saved states
    "state of something else": (
        RUNNING.format(""),
        "f.restore(b'no state of this FMU' * 90, 2.0)",
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
    "empty state": (
        "",
        "f.restore(b'', 2.0)",
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
    "state cut short": (
        RUNNING.format(""),
        "f.restore(data[:-1], 2.0)",
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
    "state cut to its header": (
        RUNNING.format(""),
        "f.restore(data[:64], 2.0)",
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
    "state too long": (
        RUNNING.format(""),
        "f.restore(data + bytes(8), 2.0)",
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
    "state of another version": (
        RUNNING.format(""),
        "f.restore(data[:30] + b'0000' + data[34:], 2.0)",
        ["python: FMU state", "expected a state saved by this FMU"],
    ),
}
