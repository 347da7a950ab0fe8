"""The end of chattering: nothing sticks out of motion at e = 1, it does not matter which half is
number 1, and what it takes stands in the energy balance.
"""

import math
import random

import pytest

from .programs.driver import harmonic, open_fmu

PUSHED = {"box_amplitude": 0.0, "box_frequency": 0.0, "box_acceleration": -9.81}
# mass 1 is all but free, and falls on mass 2
FALLING = {"m1": 1.0, "k1": 1e-6, "d1": 0.0, "m2": 2.0, "k2": 50.0, "d2": 0.0, "x1_start": -1.0}
FALLING |= PUSHED
STATE = ("x1", "x2", "v1", "v2")
SWAPPED = {"1": "2", "2": "1"}


def energy(values, x1, x2, v1, v2):
    """Energy relative to the box, in its constant field."""
    kinetic = values["m1"] * v1**2 + values["m2"] * v2**2
    elastic = values["k1"] * x1**2 + values["k2"] * x2**2
    pushed = values["box_acceleration"] * (values["m1"] * x1 + values["m2"] * x2)
    return 0.5 * (kinetic + elastic) + pushed


def mirrored(values):
    """The same structure seen from the other side: mass 2 is number 1, x is -x."""
    other = {}
    for name, value in values.items():
        swapped = "".join(SWAPPED.get(letter, letter) for letter in name)
        turned = name.endswith("_start") or name in ("box_amplitude", "box_acceleration")
        other[swapped if name[0] in "mkdxv" else name] = -value if turned else value
    return other


def random_structure(seed):
    """A damped structure whose halves differ by decades, with a gap or a preload or neither."""
    rng = random.Random(seed)
    values = {n: 10.0 ** rng.uniform(-1.0, 1.0) for n in ("m1", "m2", "k1", "k2")}
    for i in "12":
        values["d" + i] = rng.uniform(0.02, 0.2) * math.sqrt(values["m" + i] * values["k" + i])
        values[f"v{i}_start"] = rng.uniform(-1.0, 1.0)
    values |= {"e": rng.uniform(0.1, 0.8), "gamma": 10.0 ** rng.uniform(-5.0, -1.0)}
    values["e_slope"] = rng.choice((0.0, 0.3))
    values["clearance"] = rng.choice((0.0, 0.1, -0.1))
    values["box_acceleration"] = rng.uniform(-1.0, 1.0)
    return values | {"box_amplitude": 0.5, "box_frequency": rng.uniform(0.2, 1.5)}


def test_elastic_impacts_lose_nothing_for_a_thousand_seconds(fmu):
    f = open_fmu(fmu).start(**FALLING, e=1.0)
    total = energy(FALLING, *f.get(*STATE))
    count, lost, left_out = f.step(1000.0).get("impact_count", "impact_energy", "sticking_energy")
    assert (count > 200, lost, left_out) == (True, 0.0, 0.0)
    # of terms of 5e7 J: the soft spring's rest is 9.81e6 m away
    assert energy(FALLING, *f.get(*STATE)) == pytest.approx(total, rel=1e-5)


@pytest.mark.parametrize(("e", "end"), [(1.0, 10.0), (0.9, 1000.0), (0.5, 1000.0)])
def test_the_falling_mass_may_be_either_number(fmu, e, end):
    """In a time that rounding leaves alone: elastic bouncing is chaotic."""
    names = ("impact_count", "contact_count", "impact_time")
    one, other = (
        open_fmu(fmu).start(**values, e=e).step(end).get(*names)
        for values in (FALLING, mirrored(FALLING))
    )
    assert one[:2] == other[:2]
    assert one[2] == pytest.approx(other[2], rel=1e-6)
    assert one[0] > 5


def test_it_does_not_matter_which_half_is_number_one(fmu):
    f, contacts, ratios = open_fmu(fmu), 0, []
    names = ("impact_count", "contact_count", "impact_energy", "sticking_energy")
    for seed in range(60):
        values = random_structure(seed)
        one, other = (
            f.reset().start(**v).step(20.0).get(*names) for v in (values, mirrored(values))
        )
        assert one[:2] == other[:2], values
        assert one[2:] == pytest.approx(other[2:], rel=1e-6, abs=1e-12), values
        contacts += one[1]
        ratios.append(values["k1"] * values["m2"] / (values["m1"] * values["k2"]))
    assert contacts > 60
    assert min(ratios) < 0.1 < 10.0 < max(ratios)


@pytest.mark.parametrize("e_slope", [0.0, 0.05])
def test_nothing_sticks_out_of_motion_at_e_1(fmu, e_slope):
    """Whatever gamma is; the same structures stick with a smaller coefficient."""
    f, counts = open_fmu(fmu), {1.0: [0, 0.0], 0.5: [0, 0.0]}
    for seed in range(20):
        for e, found in counts.items():
            values = {**random_structure(seed), "e": e, "e_slope": e_slope, "gamma": 0.5}
            f.reset().start(**values).step(20.0)
            found[0] += f.one("contact_count")
            found[1] += f.one("sticking_energy") + (f.one("impact_energy") if not e_slope else 0.0)
    assert counts[1.0] == [0, 0.0]
    assert counts[0.5][0] > 10
    assert counts[0.5][1] > 0.0


@pytest.mark.parametrize(
    "more",
    [
        {"k2": 9.0},
        {"m2": 0.5, "e_slope": 0.4},
        {"m2": 0.5, "clearance": 0.2},
        {"k2": 7.0, "clearance": -0.2},
    ],
)
def test_the_energy_of_impacts_is_newtons_and_that_of_flights_left_out(fmu, more):
    """Both by the closing speeds of single impacts."""
    values = {"m2": 1.5, "k2": 1.4, "e": 0.7, "gamma": 0.3, **harmonic(0.4), **more}
    mass, steps = values["m2"] / (1.0 + values["m2"]), 0
    f, count, contacts, by_impacts, left_out = open_fmu(fmu).start(**values), 0, 0, 0.0, 0.0
    names = ("impact_count", "contact_count", "impact_velocity", "impact_energy", "sticking_energy")
    while f.time < 80.0:
        now, sticking, speed, lost, taken = f.step(f.time + 2.0**-7).get(*names)
        assert now <= count + 1, "steps short enough to see each impact"
        if now > count:
            e = values["e"] / (1.0 + values.get("e_slope", 0.0) * speed)
            parting = 0.5 * mass * (e * speed) ** 2
            by_impacts += 0.5 * mass * speed**2 - parting
            left_out += parting if sticking > contacts else 0.0
            steps += 1
        count, contacts = now, sticking
    assert taken == pytest.approx(left_out, rel=1e-12)
    assert lost - taken == pytest.approx(by_impacts, rel=1e-12)
    assert steps > contacts > 3
    assert left_out > 1e-6 * by_impacts


@pytest.mark.parametrize("stiffness", [0.04, 1.2, 40.0])
def test_flights_left_out_last_less_than_gamma_over_the_faster_half(fmu, stiffness):
    """A half pressed on the other bounces as a ball: chattering ends after as many impacts as the
    rule says, and not one earlier.
    """
    e, gamma, closing = 0.8, 1e-3, 1e-3
    values = {"k2": stiffness, "e": e, "gamma": gamma, "d1": 0.0, "d2": 0.0}
    x = 1.0 if stiffness > 1.0 else -1.0
    pressed = abs(stiffness - 1.0)
    starts = {"x1_start": x, "x2_start": x, "v1_start": 0.5 * closing, "v2_start": -0.5 * closing}
    left = 2.0 * e * closing / (pressed * (1.0 - e)) * max(1.0, math.sqrt(stiffness))
    impacts = 1 + math.ceil(math.log(gamma / left) / math.log(e))
    f = open_fmu(fmu).start(**values, **starts, box_amplitude=0.0).step(0.1)
    assert f.get("impact_count", "in_contact") == [pytest.approx(impacts, abs=1), True]
