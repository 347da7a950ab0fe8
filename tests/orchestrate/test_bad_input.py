"""What is asked wrongly in Python: one line, with the name, the value and what is expected."""

import functools
import inspect
import math

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate import Drive, Excitation, InputError, Structure
from orchestrate.diagnosis.fit import checked_delaminated_guess
from orchestrate.diagnosis.signs import choose_sound_structure
from orchestrate.fmu import MOTOR_SHAKER
from orchestrate.weak_drive.drive_spectra import drive_spectra
from orchestrate.weak_drive.ssp import write_ssp

from .laboratory.analysis.records import ANALYSES

UNIT, QUICK = Structure.nondimensional(), Structure.from_file("quick")
WALL = Structure.one_mass(m=0.8, k=5.0, d=0.3)
STROKE = Structure(stroke=1.0)
OVERLAPPING = (1.0, 0.0, 0.0, 0.0)
SIDES = {"x": ("x_rel", -0.4, 1.2, 5), "y": ("v_rel", -1.0, 1.0, 4)}
LABELS = xr.Dataset({"attractor_of": (("v_rel", "x_rel"), np.zeros((12, 40), np.int16))})
TWO = [1.0, 2.0]
OVER = {"eta": 1.0, "over": "e"}
AXES = {"eta": TWO, "e": [0.3, 0.7]}


@functools.cache
def window():
    return orchestrate.branch(UNIT, eta=2.6, limits=(2.5, 2.7))


FROM = {"start": window, "limits": (2.0, 4.0)}
ASKED = {  # by function: what is asked well, and each time one thing wrongly
    "sweep": (
        {},
        [
            ({}, "nothing given; expected eta="),
            ({"eta": 1.0, "frequency": 1.0}, "eta= and frequency= given"),
            ({"amplitude": 1.0}, "amplitude= given"),
            ({"eta": 0.0}, r"eta = 0\.0"),
            ({"eta": 1e7}, "expected 1e-06 <= eta <= 1e"),
            ({"eta": []}, "eta: 0 values"),
            ({"eta": np.ones((2, 2))}, "eta: 2x2 values"),
            ({"frequency": [1.0], "amplitude": 0.0}, r"amplitude = 0\.0.*force"),
            ({"frequency": TWO, "amplitude": [1.0, 2.0, 3.0]}, "3 values for 2 of frequency"),
            ({"eta": 1.0, "values": [1.0]}, "values: expected with over="),
            (OVER, "expected values="),
            ({"eta": 1.0, "over": "eta", "values": [1.0]}, "eta= too"),
            ({"eta": TWO, "over": "e", "values": [0.5]}, "eta: is a list"),
            ({"eta": 1.0, "over": "kapa", "values": [1.0]}, "kappa"),
            ({**OVER, "values": [0.5, 1.5]}, r"e = 1\.5: expected 0 <= e <= 1"),
            ({"eta": 1.0, "start": (0.0, -1e-9, 0.0, 0.0)}, "start"),
            ({"eta": 1.0, "start": (0.0, 0.0, 0.0)}, "start"),
            ({"eta": 1.0, "start": xr.Dataset({"x1": 0.0})}, "start = a dataset"),
            ({"eta": 1.0, "start": (0.0, 1e-9, 0.0, 0.0), "structure": UNIT.as_bonded()}, "start"),
            ({"eta": 1.0, "start": (0.0, 0.1, 0.0, 0.0), "structure": WALL}, "x2 = 0 and v2 = 0"),
            ({"eta": 1.0, "start": (0.0, 1.1, 0.0, 0.0), "structure": STROKE}, "stroke = 1"),
        ],
    ),
    "simulate": (
        {"eta": 1.0},
        [
            ({"eta": TWO}, "eta: 2 values; expected one number"),
            ({"structure": None}, "structure = None: expected a Structure"),
            ({"structure": WALL, "force2": 1.0}, "force2: mass 2 is a wall"),
        ],
    ),
    "resonance": (
        {"eta": TWO},
        [({"direction": "given"}, "up, down, both"), ({"structure": WALL}, "wall")],
    ),
    "spectra": (
        {"eta": 1.0, "points": 32},
        [({"structure": WALL}, "wall"), ({}, "highest = 40: expected at most points/2 = 16")],
    ),
    "map": (
        {},
        [
            ({"eta": TWO}, "lists of values: eta; expected two"),
            ({"eta": 1.0, "e": 0.5}, "lists of values: none; expected two"),
            ({**AXES, "D": [0.1, 0.2]}, "lists of values: eta, e, D; expected two"),
            ({"e": [0.3, 0.7], "D": [0.1, 0.2]}, "nothing given"),
            ({"eta": TWO, "colour": TWO}, "colour"),
            ({**AXES, "e": [0.5, 1.5]}, r"e = 1\.5: expected 0 <= e <= 1"),
            ({**AXES, "e": [0.5, 0.5]}, "e: a value twice"),
            ({"eta": TWO, "over": "e"}, "over and values"),
            ({"eta": TWO, "over": "e", "values": TWO, "e": 0.5}, "over="),
        ],
    ),
    "attractors": (
        {"eta": 1.3},
        [
            ({"structure": UNIT.as_bonded()}, "bonded = True"),
            ({"scale": TWO}, "scale: 2 values for 1 of eta"),
        ],
    ),
    "basin": (
        {"eta": 1.3, **SIDES},
        [
            ({"x": ("z", 0.0, 1.0, 3)}, "'z'"),
            ({"x": ("v_rel", 0.0, 1.0, 3)}, "v_rel twice"),
            ({"x": ("x_rel", 1.0, 0.0, 3)}, "low < high"),
            ({"x": ("x_rel", 0.0, 1.0)}, "count"),
            ({"x": ("x_rel", -2.0, -1.0, 3)}, "overlap"),
            ({"at": OVERLAPPING}, "x2 >= x1"),
            ({"at": xr.Dataset({"x": ("sample", [1.0])})}, "dataset over sample"),
            ({"eta": TWO}, "one number"),
            ({"structure": UNIT.as_bonded()}, "bonded = True"),
        ],
    ),
    "orbit": (
        {"eta": 4.0},
        [
            ({"eta": TWO}, "eta: 2 values"),
            ({"eta": None}, "excitation"),
            ({"guess": {"time": [1.0]}}, "guess"),
            ({"guess": {"impact_time": [0.1, 2.0]}}, "impact_time"),
            ({"guess": OVERLAPPING}, "guess"),
            ({"eta": 1.0, "structure": UNIT.replace(D=0.0)}, "natural frequency of mass 1"),
            ({"structure": UNIT.as_bonded()}, "bonded"),
        ],
    ),
    "branch": (
        {"limits": TWO},
        [
            ({"over": "ata"}, "over = 'ata'"),
            ({"over": "wall", "eta": 1.3}, "over = 'wall'"),
            ({"over": "level", "eta": 2.0}, "over = 'level'"),
            ({"limits": (2.0, 1.0)}, "limits"),
            ({"over": "e", "limits": (0.1, 0.9)}, "excitation"),
            ({"over": "e", "limits": (0.1, 1.9), "eta": 1.5}, "e = 1.9"),
            ({"eta": 4.0}, "eta = 4.0"),
            ({"eta": 2.5, "period": 2, "limits": (2.4, 2.8)}, "a guess to orbit"),
            ({"start": xr.Dataset()}, "start: a dataset over nothing"),
            ({**FROM, "switch": 0}, "switch: Neimark-Sacker"),
            ({**FROM, "switch": 99}, "switch = 99"),
            (FROM, "several"),
        ],
    ),
    "border": (
        {"start": window, "bifurcation": 0, "limits": [(2.0, 4.0), (0.5, 0.9)]},
        [
            ({"over": ("e", "eta")}, "over"),
            ({"over": ("eta", "ee")}, "over = 'ee'"),
            ({"limits": [(2.0, 4.0)]}, "limits"),
            ({"limits": [(1.0, 1.1), (0.5, 0.9)]}, "limits = .*: eta = .* at the start"),
            ({"limits": [(2.0, 4.0), (0.8, 0.9)]}, "limits = .*: e = 0.7 at the start"),
            ({"bifurcation": 99}, "bifurcation = 99"),
            ({"start": 1.5}, "start = 1.5"),
        ],
    ),
    "manifold": (
        {"eta": 3.0},
        [
            ({"eta": 2.0}, "0 multipliers outside the unit circle"),
            ({"distance": 0.1}, "distance = 0.1"),
            ({"distance": 0.01}, "expected a distance below 0.003"),
        ],
    ),
    "basin_entropy": (
        {},
        [
            ({"data": xr.Dataset()}, "basin"),
            ({"data": LABELS, "box": 5}, "at most 3"),
            ({"data": LABELS - 1, "box": 2}, "overlap"),
        ],
    ),
}
CASES = [(name, wrong, words) for name, (_, cases) in ASKED.items() for wrong, words in cases]


def refusal(call, words):
    with pytest.raises(InputError, match=words) as told:
        call()
    assert "expected" in str(told.value)


def function_and_arguments(name, wrong):
    """A function, what it is asked about, and its keywords, but for what is wrong."""
    asked = {**ASKED[name][0], **wrong}
    asked = {key: window() if value is window else value for key, value in asked.items()}
    first = asked.pop("data") if "data" in asked else asked.pop("structure", UNIT)
    return getattr(orchestrate, name), first, asked


@pytest.mark.parametrize(("name", "wrong", "words"), CASES)
def test_a_question_asked_wrongly(exported, name, wrong, words):
    function, first, asked = function_and_arguments(name, wrong)
    refusal(lambda: function(first, **asked), words)


@pytest.mark.parametrize("name", ASKED)
def test_each_keyword_of_a_question_is_refused_by_its_name(exported, name):
    function, first, good = function_and_arguments(name, {})
    keys = [*inspect.signature(function).parameters][1:]
    good = {key: value for key, value in ({"eta": 1.3} | good).items() if key in keys}
    for key in (key for key in keys if key not in ("running", "parameters")):
        for wrong in (object(), {"a": 1}, [[1.0], [2.0, 3.0]]):
            refusal(lambda asked={**good, key: wrong}: function(first, **asked), key)


@pytest.mark.parametrize(
    ("asked", "meant"), [({"hz": 12.0}, r"frequency=2\*pi\*Hz"), ({"frequencey": 1.0}, "frequency")]
)
def test_an_unknown_keyword_is_named_with_the_one_that_is_meant(asked, meant):
    with pytest.raises(TypeError, match=f"'{next(iter(asked))}'.*{meant}"):
        orchestrate.simulate(UNIT, **asked)


SINE = orchestrate.SweptSine(first=0.05, last=0.5, duration=20.0, acceleration=1.0)
KNOCK = orchestrate.Hammer(peak=1.0, width=0.1, half=2)
SENSOR = orchestrate.Sensor(bandwidth=1.0)
SHAKER = orchestrate.Shaker.from_file("shaker_1kN")
DRIVE = Drive.from_file("quick")
VOLTS = {"voltage": (1.0, 2.0)}
UNKNOWING = {  # what does not know a wall or a stroke
    "manifold": lambda s: orchestrate.manifold(s, start=None, eta=1.3),
    "measure": lambda s: orchestrate.measure(orchestrate.simulate(s, eta=1.3), SENSOR),
    "shaker": lambda s: orchestrate.shake(s, SINE, shaker=SHAKER),
    "contact_threshold": lambda s: orchestrate.contact_threshold(s, eta=1.0),
    "cosimulate": lambda s: orchestrate.cosimulate(s, DRIVE, duration=1.0, step=0.1),
    "couple": lambda s: orchestrate.couple(s, DRIVE, **VOLTS, rate=0.1),
    "passage": lambda s: orchestrate.passage(s, DRIVE, **VOLTS),
    "capture": lambda s: orchestrate.capture(s, DRIVE, **VOLTS),
    "jump_voltages": lambda s: orchestrate.jump_voltages(s, DRIVE, **VOLTS),
    "drive_spectra": lambda s: orchestrate.drive_spectra(s, DRIVE),
    "drive_branch": lambda s: orchestrate.drive_branch(s, DRIVE),
    "plan_test": lambda s: orchestrate.plan_test(s),
    "fit": checked_delaminated_guess,
    "detect": lambda s: choose_sound_structure(s, None, None),
}
KNOWING_STROKE = ("shaker", "cosimulate", "fit", "detect")


@pytest.mark.parametrize("structure", [WALL, STROKE])
def test_a_wall_and_a_stroke_are_refused_where_they_are_not_known(exported, structure):
    for name, ask in UNKNOWING.items():
        if structure.wall or name not in KNOWING_STROKE:
            refusal(lambda ask=ask: ask(structure), "wall" if structure.wall else "stroke")


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: orchestrate.shake(UNIT, SINE, shaker=SHAKER, force1=0.1, frequency=1.0), "0.1"),
        (lambda: orchestrate.shake(UNIT, SINE, shaker=SHAKER, box_acceleration=0.1), "= 0.1"),
        (lambda: orchestrate.measure(orchestrate.simulate(UNIT, eta=1, force1=0.1), SENSOR), "0.1"),
        (lambda: orchestrate.shake(UNIT, SINE, force1=1.0), "force1 = 1.0.*frequency"),
        (lambda: orchestrate.shake(WALL, SINE, force2=1.0, frequency=1.0), "force2: .* wall"),
        (lambda: orchestrate.shake(WALL, KNOCK), "force2: .* wall"),
        (lambda: WALL.as_bonded(), "bonded = True with wall = True"),
        (lambda: Excitation(frequency=math.nan, amplitude=1.0), "frequency = nan"),
    ],
)
def test_what_pushes_where_it_is_not_known(exported, call, words):
    refusal(call, words)


def test_a_wall_has_no_second_mass():
    for name in ("mu", "kappa", "D2", "D3", "f2", "zeta2", "omega_2", "alike"):
        refusal(lambda name=name: getattr(WALL, name), "mass 2 is a wall")
    for name in ("m2", "k2", "d2", "mu", "kappa", "D2", "f2", "zeta2"):
        refusal(lambda name=name: WALL.replace(**{name: 1.0}), f"^{name}: mass 2 is a wall")
        refusal(lambda name=name: WALL.get(name), f"^{name}: mass 2 is a wall")


PROFILE = ((20.0, 0.5), (200.0, 0.1))
SWEEP = {"first": 20.0, "last": 90.0, "duration": 2.0, "acceleration": 4.9}
HALVES = Structure.from_halves(m1=1.5, m2=1.2, f1=42.0, f2=52.0, zeta1=0.06, zeta2=0.04, e=0.5)
NOISY = orchestrate.Sensor(bandwidth=600.0, noise=0.01, range=300.0)
PLAN = {"sensor": NOISY, "levels": [1.0], "frequencies": [40.0, 50.0]}
LINKS = {"box_velocity": "box_velocity", "box_force": "box_force"}
CURVE = {"frequency": np.arange(40.0, 60.0), "level": 4.0, "amplitude1": np.ones(20)}
RECORDED = np.arange(200) / 100.0
MADE = {  # what is made of numbers, each of which is refused by its name where it is none
    "SweptSine": SWEEP,
    "SteppedSine": {"acceleration": 1.0, "frequencies": (8.0, 40.0), "settle_cycles": 5},
    "Random": {"duration": 2.0, "seed": 1, "psd": PROFILE, "rms": 1.0},
    "Shock": {"peak": 1.0, "length": 0.01, "delay": 0.1, "duration": 0.2},
    "Sampled": {"acceleration": [0.0, 1.0, 0.0, 1.0], "sample_rate": 100.0},
    "Hammer": {"peak": 1.0, "width": 0.1, "at": 0.1, "duration": 1.0, "half": 1},
    "Sensor": {"bandwidth": 9.0, "noise": 1.0, "range": 9.0, "resolution": 0.1, "order": 4}
    | {"sample_rate": 30.0, "seed": 1},
    "SpeedControl": {"speed": 1.0, "gain": 1.0, "reset_time": 1.0, "rise": 1.0},
    "SpeedGradient": {"filter_time": 1.0, "passed": 1.0, "low": 0.5},
    "Excitation": {"frequency": 1.0, "amplitude": 1.0, "phase": 0.0},
    "Structure": QUICK.parameters(),
    "Drive": DRIVE.parameters(),
}


@pytest.mark.parametrize("name", MADE)
def test_what_is_no_number_is_refused_by_its_name(name):
    for key, value in MADE[name].items():
        large = [10**400] * (key not in ("seed", "range"))
        for wrong in (math.nan, "x\ny", [object()], -math.inf, *large):
            with pytest.raises(InputError, match=rf"^[^\n]*\b{key}\b[^\n]*expected[^\n]*$"):
                getattr(orchestrate, name)(**{**MADE[name], key: wrong})
        assert getattr(orchestrate, name)(**{**MADE[name], key: value})


def recorded(**changes):
    made = xr.Dataset({"box_acceleration": ("time", np.sin(RECORDED))}, {"time": RECORDED})
    made = made.assign(acceleration1=("time", np.cos(RECORDED))).assign_attrs(sample_rate=100.0)
    return made.assign({name: ("time", value) for name, value in changes.items()})


@pytest.mark.parametrize("name", ANALYSES)
def test_each_keyword_of_an_analysis_is_refused_by_its_name(name):
    function = getattr(orchestrate, name)
    keys = [key for key in inspect.signature(function).parameters if key not in ("record", "phase")]
    assert keys
    for key in keys:
        for wrong in ("round", -1.0, math.nan, [object()]):
            with pytest.raises(InputError, match=rf"^[^\n]*\b{key}\b[^\n]*expected[^\n]*$"):
                function(recorded(), **{key: wrong})


def made(name, **changes):
    """Something of a kind, but for some of its numbers; None leaves one out."""
    own = {**MADE[name], **changes}
    return lambda: getattr(orchestrate, name)(**{k: v for k, v in own.items() if v is not None})


def asked(name, *given, **question):
    """A public function that is asked; a motor drives the quick structure unless told otherwise."""
    return lambda: getattr(orchestrate, name)(*given or (QUICK, DRIVE), **question)


def curve(**changes):
    return lambda: orchestrate.resonance_curve(**{**CURVE, **changes})


def plan(structure=HALVES, **changes):
    return lambda: orchestrate.plan_test(structure, **{**PLAN, **changes})


@functools.cache
def shaken():
    sampled = orchestrate.Sampled(acceleration=np.ones(30).tolist(), sample_rate=100.0)
    return orchestrate.shake(QUICK.as_bonded(), sampled, sample_rate=100.0, progress=False)


FAST = orchestrate.Sensor(bandwidth=30.0, sample_rate=90.0)
NAN = math.nan
RAMP = {"voltage": (1.2, 1.6)}
STEPS = orchestrate.SteppedSine(frequencies=(40.0, 46.0), acceleration=4.0)
LEVEL = {"command": orchestrate.LevelControl(sine=STEPS, start=0.1)}
RELATED = [  # numbers that do not fit each other, words, and what else has a rule of its own
    (made("SweptSine", last=20.0), "last = 20.0 Hz | another frequency than first"),
    (made("SweptSine", spacing="lin"), "spacing = 'lin' | linear, log"),
    (made("SweptSine", rate=1.0), "duration = 2.0 and rate = 1.0 given"),
    (made("SweptSine", duration=None), "duration= and rate="),
    (made("SweptSine", acceleration=[(30, 1), (90, 1)]), "30 to 90 Hz; expected 20 to 90"),
    (made("SweptSine", acceleration=[(30, 1), (10, 1)]), "ascending frequencies"),
    (made("SteppedSine", frequencies=()), "frequencies: 0 of them; expected 1 to 100000"),
    (made("SteppedSine", settle_cycles=1.5), "settle_cycles = 1.5: expected a whole number"),
    (made("SteppedSine", acceleration=[(9, 1), (20, 1)]), "9 to 20 Hz; expected 8 to 40"),
    (made("Random", psd=[(20, 0.0), (30, 1.0)]), "psd at 20 Hz = 0.0: expected a number > 0"),
    (made("Random", duration=1e-3), "no multiple of 1/duration"),
    (made("Random", duration=1e7), "duration = 10000000.0 s: expected at most"),
    (made("Shock", shape="sine"), "shape = 'sine': expected one of half-sine"),
    (made("Shock", duration=0.001), "duration = 0.001 s: expected at least delay + length"),
    (made("Sampled", acceleration=[1.0, NAN, 2.0, 3.0]), "acceleration, row 1: nan"),
    (made("Sampled", acceleration=[1.0, 2.0]), "2 values; expected a list of 4"),
    (made("Sampled", acceleration="a"), "expected a list of numbers, in m/s2, at most 50000000"),
    (asked("shake", UNIT, SINE, frequency="a"), "a number, 1e-24 <= frequency <= 1e+24 rad/s"),
    (asked("shake", UNIT, SINE, frequency=np.ones(2)), "frequency <= 1e+24 rad/s"),
    (made("Hammer", half=3), "half = 3"),
    (made("Hammer", duration=0.05), "duration = 0.05"),
    (made("Sensor", order=11), "order = 11: expected a whole number from 1 to 10"),
    (made("Sensor", kind="chebyshev"), "kind = 'chebyshev': expected one of butterworth"),
    (made("Sensor", antialiasing="yes"), "antialiasing = 'yes': expected true or false"),
    (lambda: orchestrate.SweptSine(**{**SWEEP, "first": 1e6, "last": 1e9}).pieces(), "less than"),
    (lambda: orchestrate.LevelControl(sine=3, start=0.1), "sine = 3: expected"),
    (lambda: orchestrate.LevelControl(sine=STEPS, start=0.0), "start = 0.0"),
    (lambda: orchestrate.LevelControl(sine=STEPS, start=0.1, limit=0.05), "limit = 0.05"),
    (lambda: orchestrate.LevelControl(sine=STEPS, start=0.1, fastest=1.0), "fastest = 1.0"),
    (lambda: orchestrate.LevelControl(sine=STEPS, start=0.1, patience=-1.0), "patience = -1"),
    (asked("shake", QUICK, 3.0), "excitation = 3.0: expected a SweptSine, SteppedSine"),
    (asked("shake", 3.0, STEPS), "structure = 3.0: expected a Structure"),
    (asked("shake", QUICK, STEPS, sample_rate=1e12), "sample_rate = 1000000000000.0 Hz"),
    (asked("shake", QUICK, STEPS, start=(1.0, 0.0, 0.0, 0.0)), "start = "),
    (asked("shake", QUICK, made("Shock")(), shaker=SHAKER), "expected a SweptSine"),
    (asked("shake", QUICK, STEPS, shaker=3), "shaker = 3: expected a Shaker"),
    (asked("measure", 3.0, SENSOR), "history: expected an answer of shake or simulate"),
    (lambda: orchestrate.measure(shaken(), 3.0), "sensor = 3.0: expected a Sensor"),
    (lambda: orchestrate.measure(shaken(), {"mass1": FAST}), "one for each of box_acceleration"),
    (
        lambda: orchestrate.measure(shaken(), {"box_acceleration": FAST, "acceleration1": SENSOR}),
        "sensor: 2.56 and 90 Hz; expected one sample rate",
    ),
    (lambda: orchestrate.measure(shaken(), FAST, excitation=SINE), "expected 30 samples at 100"),
    (curve(amplitude1=-np.ones(20)), "row 0: -1 | >= 0"),
    (curve(frequency=np.arange(20) // 2 + 1), "1 Hz after 1 Hz"),
    (curve(level=0.0), "level, row 0: 0; expected a number > 0"),
    (curve(unit="V"), "unit = 'V'; expected one such as m/s2"),
    (curve(direction="left"), "direction = 'left'"),
    (curve(amplitude1=None), "no amplitude; expected"),
    (curve(amplitude1=np.ones(9)), "9 values; expected 20"),
    (asked("psd", 3.0), "record: float, without time"),
    (asked("psd", recorded().isel(time=slice(5))), "5 samples; expected at least 16"),
    (asked("psd", recorded(acceleration1=np.nan * RECORDED)), "acceleration1[0] = nan at 0 s"),
    (asked("psd", recorded(time=RECORDED + 0.004 * (RECORDED == 0.7))), "time[69] = 0.69 s"),
    (asked("psd", recorded(time=RECORDED % 1.0)), "expected ascending numbers"),
    (asked("psd", recorded().assign_attrs(sample_rate=50.0)), "sample_rate = 50.0 Hz: the time"),
    (asked("psd", recorded().assign_attrs(sample_rate="fast")), "sample_rate = 'fast' Hz"),
    (asked("frf", recorded(), resolution=0.5), "expected at least 2"),
    (asked("frf", recorded().drop_vars("box_acceleration")), "no box_acceleration; expected"),
    (asked("frf", recorded().drop_vars("acceleration1")), "no acceleration1, m/s2; frf needs"),
    (asked("shock_spectrum", recorded(), frequencies=[60.0]), "<= 50 Hz, half the sampling"),
    (asked("shock_spectrum", recorded(), frequencies="a"), "> 0 and <= 50 Hz, half"),
    (asked("shock_spectrum", recorded(), damping=1.0), "0 <= damping < 1"),
    (asked("track_orders", recorded(), orders=(2, 3)), "with 1 among them"),
    (asked("track_orders", recorded(), periods=5000.0), "periods = 5000.0: the record has"),
    (asked("track_orders", recorded(), phase=[1.0, 2.0]), "phase: expected a SweptSine or 200"),
    (asked("track_orders", recorded(), phase=np.zeros(200)), "expected a phase that grows"),
    (asked("couple", voltage=(1.2, 1.2)), "(1.2, 1.2) | different"),
    (asked("couple", voltage=1.2), "voltage = 1.2 | duration"),
    (asked("couple", **RAMP, duration=3.0), "duration = 3.0 | rate"),
    (asked("couple", voltage=(1.0, 1.2, 1.4)), "(1.0, 1.2, 1.4) | (first, last)"),
    (asked("couple", voltage="high", duration=1.0), "'high' | a number"),
    (asked("couple", **RAMP, rate=1e-12), "steps | at most 1e+09"),
    (asked("couple", **RAMP, step=-0.1), "step = -0.1 | 0.0001 <= step <= 1"),
    (asked("couple", **RAMP, tolerance=-1.0), "tolerance = -1.0 | 0 <= tolerance"),
    (asked("couple", **RAMP, increment=2.0), "increment = 2.0 | 0 <= increment <= 0.4"),
    (asked("couple", **RAMP, speed_start=math.inf), "speed_start = inf | finite"),
    (asked("couple", voltage=1.5, duration=1e-10), "1e-10 s | one communication step"),
    (asked("couple", voltage=0.001, duration=10.0), "no revolution in 10 s | raise the voltage"),
    (asked("couple", **RAMP, fmu={MOTOR_SHAKER: "nowhere.fmu"}), "nowhere.fmu: no such file"),
    (asked("couple", **RAMP, control="pi"), "control = 'pi' | SpeedControl(...)"),
    (asked("couple", QUICK, DRIVE.replace(motor_constant=0.0), **RAMP), "motor_constant = 0.0"),
    (asked("passage", **RAMP, around=0.0), "around = 0.0 s | 0 < around"),
    (asked("capture", voltage=1.5), "voltage = 1.5 | (lowest, highest)"),
    (asked("capture", voltage=(1.6, 1.5)), "(1.6, 1.5) | (lowest, highest)"),
    (asked("capture", **RAMP, over="D"), "over = 'D' | both"),
    (asked("capture", **RAMP, over="colour", values=[1.0]), "colour | no parameter"),
    (asked("capture", **RAMP, over="rotor_inertia", values=[-1.0]), "rotor_inertia = -1.0 | <="),
    (asked("capture", **RAMP, over="D", values=[0.1, 0.1]), "values = [0.1, 0.1] | each once"),
    (asked("capture", **RAMP, time=1e-300), "1e-300 | one communication step"),
    (asked("drive_branch", speed=(1.4, 1.2)), "speed = (1.4, 1.2) rad/s"),
    (asked("jump_voltages", **RAMP, rates=[]), "rates: 0 values | a list of 1"),
    (asked("jump_voltages", **RAMP, rates=[1e-4, -1e-4]), "rate = -0.0001 | 0 < rate"),
    (asked("jump_voltages", **RAMP, over="m1", values=[1.0]), "over = 'm1' | expected clearance"),
    (asked("jump_voltages", **RAMP, over="e"), "over = 'e' and values = None | both"),
    (lambda: drive_spectra(QUICK, DRIVE, points=64, highest=99), "points/2 = 32"),
    (lambda: drive_spectra(QUICK, DRIVE, voltage=0.001, begin=0.0009, hold=1.0), "no two revol"),
    (asked("waterfall", xr.Dataset({"x1": ("time", [0.0])})), "no angle in the dataset"),
    (asked("waterfall", xr.Dataset(), mass=3), "mass = 3 | from 1 to 2"),
    (asked("couple_all", {"one": (QUICK, DRIVE)}, rates=[]), "expected one of each"),
    (asked("couple_all", {"one": (QUICK, DRIVE)}, kinds=["glued"]), "kinds = 'glued' | bonded"),
    (
        lambda: write_ssp("nowhere/x.ssp", QUICK, DRIVE, voltage=1.0, version="3.0"),
        "'1.0' or '2.0'",
    ),
    (lambda: write_ssp("nowhere/x.ssp", QUICK, DRIVE), "voltage: expected with a motor"),
    (
        asked("cosimulate", QUICK, SHAKER, connect=LINKS, inputs=LEVEL, duration=0.4, step=1e-3),
        "command is controlled; connect box_acceleration",
    ),
    (asked("record_of_run", None), "run: no box_acceleration and angle over the time"),
    (asked("signs", recorded(), seeds=0), "seeds = 0"),
    (asked("signs", recorded(), noise=-1.0), "noise = -1.0"),
    (asked("signs", recorded(), periods=1.0), "periods = 1.0"),
    (asked("signs", recorded(), high_band=48.0), "high_band = 48.0"),
    (asked("signs", recorded(), other=recorded().drop_vars("acceleration1")), "other[0]: none"),
    (asked("signs", recorded().drop_vars("acceleration1")), "no acceleration1"),
    (asked("fit", recorded(), HALVES, free=("f1", "f3")), "free = 'f3': expected some of f1, f2"),
    (asked("fit", recorded(), HALVES, free=()), "each once"),
    (asked("fit", recorded(), HALVES, hypothesis="cracked"), "'cracked': expected one of delamin"),
    (plan(levels=[0.0]), "levels"),
    (plan(frequencies=[50.0, 40.0]), "frequencies"),
    (plan(frequencies=50.0), "two at least"),
    (plan(sensor=orchestrate.Sensor(bandwidth=400.0)), "noise = 0.0"),
    (plan(sensor={"box_acceleration": NOISY}), "only on the box"),
    (plan(HALVES.as_bonded()), "bonded"),
    (plan(reserve=0.5), "reserve"),
    (plan(g=0.1), "levels and g: expected one"),
    (plan(levels=None, g=[-1.0]), "g = "),
]


@pytest.mark.parametrize("number", range(len(RELATED)))
def test_what_does_not_fit_together_is_refused(exported, number):
    call, words = RELATED[number]
    with pytest.raises(InputError) as told:
        call()
    assert all(word.strip() in str(told.value) for word in words.split("|")), str(told.value)
