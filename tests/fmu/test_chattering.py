"""The end of chattering: which half is number 1 does not matter."""

import math
import random

import pytest

from .programs.driver import open_fmu

SWAPPED = {"1": "2", "2": "1"}


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
