"""Units by their names, against the exponents and factors that define them."""

import pytest

from orchestrate.fmu.unit_names import unit_by_name

METRE, ACCELERATION, FORCE = {"m": 1}, {"m": 1, "s": -2}, {"kg": 1, "m": 1, "s": -2}
KNOWN = {
    **dict.fromkeys(("m/s2", "m/s^2", "m/s²", "m.s-2", "m*s^(-2)", "m/s/s"), (ACCELERATION, 1.0)),
    **{"mm/s2": (ACCELERATION, 1e-3), "mm": (METRE, 1e-3), "\u00b5m": (METRE, 1e-6)},
    **{"N": (FORCE, 1.0), "kN": (FORCE, 1e3), "kg.m/s2": (FORCE, 1.0), "g mm/s2": (FORCE, 1e-6)},
    **{"N/s": ({**FORCE, "s": -3}, 1.0), "m/min": ({"m": 1, "s": -1}, 1 / 60), "m/m": ({}, 1.0)},
}


@pytest.mark.parametrize("name", KNOWN)
def test_a_unit_is_what_its_name_says(name):
    exponents, factor = KNOWN[name]
    unit = unit_by_name(name)
    assert unit is not None and unit.exponents == exponents
    assert unit.factor == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize("name", ["", "g", "fathom", "1", "m/", "m//s", "%", "m2x"])
def test_what_is_not_sure_is_not_guessed(name):
    assert unit_by_name(name) is None
