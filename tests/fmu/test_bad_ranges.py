"""Ranges of ``modelDescription.xml`` hold in the FMU, and a refused call changes nothing."""

import math
import re

import pytest

from .driver import MODELS, path_of
from .programs.driver import DISCARD, Refused, harmonic, open_fmu

LIMITED = {"coil_inductance": 0.02, "current_limit": 1.0}
EVALUATION_RUNS = {  # settings and a time that takes more evaluations than the limits below
    "TwoMassImpactOscillator": (harmonic(0.3), 40.0),
    "MotorShaker": ({"voltage": 6.0, "speed_start": 40.0}, 0.4),
    "ElectrodynamicShaker": ({**LIMITED, "command": 9.0, "command_1": -4.0}, 4.0),
}
models = pytest.mark.parametrize("model", MODELS)


def beside(variable):
    """Numbers that are none, and those just outside a variable's range."""
    low, high = float(variable.min), float(variable.max)
    just = (math.nextafter(low, -math.inf), math.nextafter(high, math.inf))
    return [math.nan, math.inf, -math.inf, *just]


def try_range(f, variable):
    """Problems with a variable's range: values outside it, then its ends, which belong to it."""
    name, low, high, before = variable.name, variable.min, variable.max, f.get(variable.name)
    for value in beside(variable):
        try:
            f.set(**{name: value})
            yield f"{name} = {value} was accepted"
        except Refused as refused:
            (text,) = refused.messages
            told = re.search(rf"\b{name} = (\S+?):? ", text)
            if not told or float(told[1]).hex() != value.hex():
                yield f"{name} = {value}: {text}"
            for end in (low, high):
                if repr(float(end)) not in text:
                    yield f"{name}: {end} is not in {text}"
    if f.get(name) != before:
        yield f"{name} is no longer {before}"
    for value in (low, high):
        f.set(**{name: float(value)})
    f.set(**{name: before[0]})


@models
def test_every_range_holds(model, form):
    """NaN, infinities and numbers next to the ends are refused, the ends are not; at any time."""
    path = path_of(model, form)
    f, problems = open_fmu(path), []
    settable = [v for v in f.variables.values() if v.causality in ("parameter", "input")]
    settable = [v for v in settable if v.type in ("Real", "Float64")]
    assert len(settable) >= 18
    f.enter()
    for variable in settable:
        problems += try_range(f, variable)
    f.leave()
    f.step(1.0)
    for variable in settable:
        if variable.variability != "fixed":
            problems += try_range(f, variable)
    assert problems == []
    assert f.step(50.0).motion() == open_fmu(path).start().at(1.0, 50.0).motion()


def test_a_refused_set_sets_nothing(fmu):
    """One bad value in a list: the good ones before and after it are not taken over either."""
    f = open_fmu(fmu)
    f.enter()
    references = [f.reference(name) for name in ("m1", "k1", "m2")]
    f.refused("set" + f.variables["m1"].type, references, [2.0, math.nan, 3.0])
    assert f.get("m1", "k1", "m2") == [1.0, 1.0, 1.0]


def test_a_refused_step_leaves_the_instance_where_it_was(fmu):
    """After a step that cannot be done the run goes on with the bits it would have had."""
    values = {"d1": 0.0, "x2_start": 0.25, "box_frequency": 1.13}
    f, plain = (open_fmu(fmu).start(**values).step(30.0) for _ in range(2))
    before = f.outputs()
    limit, words = 10_000, "is discarded: evaluation_limit = 10000"
    if fmu.parent.name == "fmi3":  # by default a step may walk for a second
        limit, words = 10_000_000, "cannot finish: "
    f.set(box_frequency=1e9, evaluation_limit=limit)  # more radians than a step may walk
    assert words in f.refused("doStep", 30.0, 1.0)
    for point, size in ((30.0, -1.0), (30.0, math.nan), (12.0, 1.0)):
        f.refused("doStep", point, size)
    f.set(box_frequency=1.13, evaluation_limit=10_000_000)
    plain.set(box_frequency=1.13)
    assert f.outputs() == before
    assert f.step(90.0).outputs() == plain.step(90.0).outputs()


@models
def test_a_run_of_divided_steps_comes_to_the_same_end(model, form):
    """Through chattering, or limits. A motor's sub-step has 12 evaluations, and begins anew."""
    limit, least, most_allowed = (40, 1, 48) if model == "MotorShaker" else (9, 11, 8)
    (values, end), path = EVALUATION_RUNS[model], path_of(model, form)
    free = open_fmu(path).start(**values).step(end).motion()
    f = open_fmu(path).start(**values, evaluation_limit=limit)
    waiting, discarded, most = [end], 0, 0
    while waiting:
        try:
            f.step(waiting[-1])
        except Refused as refused:
            assert refused.status == DISCARD
            (message,) = refused.messages
            assert f"is discarded: evaluation_limit = {limit}, " in message
            assert "expected a shorter step, or a larger limit" in message
            discarded += 1
            waiting.append((f.time + waiting[-1]) / 2)
        else:
            waiting.pop()
            most = max(most, *f.get("evaluations"))
    assert discarded >= least and 0 < most <= most_allowed
    if model == "MotorShaker":
        assert f.motion() == pytest.approx(free, rel=1e-8, abs=1e-12)
    else:
        assert f.motion() == free


STARTS = [  # with what the message names
    *(({"wall": True, **more}, "wall = true") for more in ({"x2_start": 0.1}, {"v2_start": -1.0})),
    ({"wall": True, "bonded": True}, "bonded"),
    ({"stroke": 0.1, "clearance": 0.25}, "stroke = 0.1 m"),
    *(({"sample_count": n}, f"sample_count = {n}:") for n in (-1, 201)),
    *(({"evaluation_limit": n}, f"evaluation_limit = {n}: ") for n in (0, -1, 10_000_001)),
    ({"clearance": -0.5, "k2": 1.0, "x1_start": 0.125, "x2_start": 0.12}, "x2_start >= x1_start ="),
    ({"clearance": 0.5, "x1_start": 0.75, "x2_start": 0.2}, "clearance = 0.25 m"),
    ({"clearance": math.nan}, "-1e+100 <= clearance <= 1e+100"),
    ({"e_slope": -1e-300}, "0.0 <= e_slope <= 1e+100"),
    ({"e_slope": 1e101}, "0.0 <= e_slope <= 1e+100"),
    ({"e": 1.5}, "0.0 <= e <= 1.0"),
]


@pytest.mark.parametrize(("values", "words"), STARTS)
def test_starts_that_cannot_be_are_refused(fmu, values, words):
    with pytest.raises(Refused) as refused:
        open_fmu(fmu).start(**values)
    assert words in refused.value.messages[-1]


@pytest.mark.parametrize("steps", [7, 10, 49, 1000])
def test_no_step_goes_past_the_stop_time(fmu, steps):
    """An error, by FMI 2.0.5 and 3.0.2; the importer's rounding is no step past the end."""
    f = open_fmu(fmu)
    f.enter(0.0, stopTime=3.0)
    f.leave()
    for _ in range(steps):
        f.step(f.time + 3.0 / steps)
    assert "stopTime = 3.0 s" in f.refused("doStep", f.time, 0.5)
    with pytest.raises(Refused, match="startTime = 2.0 s with stopTime = 1.0 s"):
        f.reset().enter(2.0, stopTime=1.0)
