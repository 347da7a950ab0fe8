"""What is asked wrongly in Python: one line, with the name, the value and what is expected."""

import functools
import math

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate import Drive, Excitation, InputError, Structure
from orchestrate.diagnosis.fit import delaminated_guess
from orchestrate.diagnosis.signs import sound_structure

UNIT = Structure.nondimensional()
WALL = Structure.one_mass(m=0.8, k=5.0, d=0.3)
STROKE = Structure(stroke=1.0)
OVERLAPPING = (1.0, 0.0, 0.0, 0.0)
SIDES = {"x": ("x_rel", -0.4, 1.2, 5), "y": ("v_rel", -1.0, 1.0, 4)}
LABELS = xr.Dataset({"attractor_of": (("v_rel", "x_rel"), np.zeros((12, 40), np.int16))})
TWO = [1.0, 2.0]
OVER = {"eta": 1.0, "over": "e"}
AXES = {"eta": TWO, "e": [0.3, 0.7]}
ASKED = {  # by function: what is asked well, and each time one thing wrongly
    "sweep": (
        {},
        [
            ({}, "nothing given; expected eta="),
            ({"eta": 1.0, "frequency": 1.0}, "eta= and frequency= given"),
            ({"amplitude": 1.0}, "amplitude= given"),
            ({"eta": 0.0}, r"eta = 0\.0"),
            ({"eta": math.inf}, "eta = inf"),
            ({"eta": 1e7}, "expected 1e-06 <= eta <= 1e"),
            ({"eta": "many"}, "eta = 'many'"),
            ({"eta": []}, "eta: 0 values"),
            ({"eta": np.ones((2, 2))}, "eta: 2x2 values"),
            ({"eta": [True]}, "eta"),
            ({"frequency": [1.0], "amplitude": 0.0}, r"amplitude = 0\.0.*force"),
            ({"frequency": TWO, "amplitude": [1.0, 2.0, 3.0]}, "3 values for 2 of frequency"),
            ({"eta": 1.0, "values": [1.0]}, "values: expected with over="),
            (OVER, "expected values="),
            ({"eta": 1.0, "over": "eta", "values": [1.0]}, "eta= too"),
            ({"eta": TWO, "over": "e", "values": [0.5]}, "eta: is a list"),
            ({"eta": 1.0, "over": "kapa", "values": [1.0]}, "kappa"),
            ({**OVER, "values": [0.5, 1.5]}, r"e = 1\.5: expected 0 <= e <= 1"),
            ({**OVER, "values": [math.nan]}, "values = nan"),
            ({"eta": 1.0, "start": (0.0, -1e-9, 0.0, 0.0)}, "start"),
            ({"eta": 1.0, "start": (0.0, math.nan, 0.0, 0.0)}, "start"),
            ({"eta": 1.0, "start": (0.0, 0.0, 0.0)}, "start"),
            ({"eta": 1.0, "start": "rest"}, "start"),
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
        [
            ({"direction": "given"}, "up, down, both"),
            ({"jump": 0}, "jump = 0"),
            ({"structure": WALL}, "wall"),
        ],
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
            ({"scale": -1.0}, r"scale = -1\.0"),
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
            ({"period": 0}, "period = 0"),
            ({"guess": {"time": [1.0]}}, "guess"),
            ({"guess": {"impact_time": [0.1, 2.0]}}, "impact_time"),
            ({"guess": OVERLAPPING}, "guess"),
            ({"eta": 1.0, "structure": UNIT.replace(D=0.0)}, "natural frequency of mass 1"),
            ({"structure": UNIT.as_bonded()}, "bonded"),
            ({"structure": 7}, "structure = 7"),
        ],
    ),
    "branch": (
        {"limits": TWO},
        [
            ({"over": "ata"}, "over = 'ata'"),
            ({"over": "wall", "eta": 1.3}, "over = 'wall'"),
            ({"over": "level", "eta": 2.0}, "over = 'level'"),
            ({"limits": (2.0, 1.0)}, "limits"),
            ({"limits": 3.0}, "limits"),
            ({"over": "e", "limits": (0.1, 0.9)}, "excitation"),
            ({"over": "e", "limits": (0.1, 1.9), "eta": 1.5}, "e = 1.9"),
            ({"eta": 4.0}, "eta = 4.0"),
            ({"eta": 2.5, "period": 2, "limits": (2.4, 2.8)}, "a guess to orbit"),
            ({"start": 1.5}, "start = 1.5"),
            ({"start": xr.Dataset()}, "start: a dataset over nothing"),
        ],
    ),
    "manifold": (
        {"eta": 3.0},
        [
            ({"eta": 2.0}, "0 multipliers outside the unit circle"),
            ({"distance": 0.1}, "distance = 0.1"),
            ({"distance": 0.01}, "expected a distance below 0.003"),
            ({"start": 1.0}, "start = 1.0"),
        ],
    ),
    "basin_entropy": (
        {},
        [
            ({"data": xr.Dataset()}, "basin"),
            ({"data": LABELS, "box": 5}, "at most 3"),
            ({"data": LABELS - 1, "box": 2}, "overlap"),
            ({"data": LABELS, "box": 1}, "box = 1"),
        ],
    ),
}
CASES = [(name, wrong, words) for name, (_, cases) in ASKED.items() for wrong, words in cases]


def refusal(call, words):
    """The line in which a call is refused."""
    with pytest.raises(InputError, match=words) as told:
        call()
    assert "\n" not in str(told.value) and "expected" in str(told.value)


@pytest.mark.parametrize(("name", "wrong", "words"), CASES)
def test_a_question_asked_wrongly(exported, name, wrong, words):
    asked = {**ASKED[name][0], **wrong}
    first = asked.pop("data") if "data" in asked else asked.pop("structure", UNIT)
    refusal(lambda: getattr(orchestrate, name)(first, **asked), words)


@functools.cache
def window():
    return orchestrate.branch(UNIT, eta=2.6, limits=(2.5, 2.7))


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"over": ("e", "eta")}, "over"),
        ({"over": ("eta", "ee")}, "over = 'ee'"),
        ({"limits": [(2.0, 4.0)]}, "limits"),
        ({"limits": [(1.0, 1.1), (0.5, 0.9)]}, "limits = .*: eta = .* at the start"),
        ({"limits": [(2.0, 4.0), (0.8, 0.9)]}, "limits = .*: e = 0.7 at the start"),
        ({"bifurcation": 99}, "bifurcation = 99"),
        ({"start": 1.5}, "start = 1.5"),
    ],
)
def test_a_border_asked_wrongly(exported, wrong, words):
    good = {"bifurcation": 0, "limits": [(2.0, 4.0), (0.5, 0.9)], "over": ("eta", "e")}
    refusal(lambda: orchestrate.border(UNIT, **{"start": window(), **good, **wrong}), words)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [({"switch": 0}, "switch: Neimark-Sacker"), ({"switch": 99}, "switch = 99"), ({}, "several")],
)
def test_what_cannot_be_switched_to(exported, wrong, words):
    given = {"start": window(), "limits": (2.0, 4.0), **wrong}
    refusal(lambda: orchestrate.branch(UNIT, **given), words)


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
    "fit": delaminated_guess,
    "detect": lambda s: sound_structure(s, None, None),
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
