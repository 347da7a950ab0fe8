"""Parameters that the variable table has beside the paper's: what follows from the row of each."""

import dataclasses

import numpy as np
import pytest

import orchestrate
from orchestrate import InputError, Structure
from orchestrate.cli.grammar import parse_changes
from orchestrate.model import structure as module
from orchestrate.model.ranges import ADDED, OF_LENGTH, STRUCTURE

HALVES = {"m1": 1.5, "m2": 1.2, "f1": 42.0, "f2": 55.0}
BONDED = {"mass": 2.0, "f": 50.0, "thicknesses": (3.0, 2.0)}
FORMS = [
    "m1 = 1.0\nm2 = 1.0\nk1 = 1.0\nk2 = 1.2\nd1 = 0.01\nd2 = 0.01",
    "mu = 1.0\nkappa = 1.2\nD = 0.005",
    "m1 = 1.0\nm2 = 1.0\nf1_hz = 1.0\nf2_hz = 1.1\nzeta1 = 0.01\nzeta2 = 0.01",
]


@pytest.mark.parametrize("name", ADDED)
def test_every_constructor_takes_it(name):
    value = {name: 0.02}
    changed = Structure().replace(**value), Structure().replace(**parse_changes([f"{name}=0.02"]))
    made = [Structure(**value), Structure.nondimensional(**value), *changed]
    made += [Structure.from_halves(**HALVES, **value), Structure.from_bonded(**BONDED, **value)]
    made += [Structure.from_attributes(Structure(**value).parameters())]
    for structure in made:
        assert structure.get(name) == structure.parameters()[name] == 0.02
        assert f"{name}0.02" in structure.label()
    assert name not in Structure().label()
    assert Structure().get(name) == STRUCTURE[name].default
    with pytest.raises(InputError, match="nothing_of_the_kind"):
        Structure.nondimensional(nothing_of_the_kind=1.0)


@pytest.mark.parametrize("name", ADDED)
@pytest.mark.parametrize("keys", FORMS)
def test_files_have_it_with_all_keys_and_may_leave_it_out(tmp_path, keys, name):
    path = tmp_path / "beam.toml"
    path.write_text(f"[structure]\n{keys}\n{name} = 2e-5\n")
    assert Structure.from_file(path).get(name) == 2e-5
    path.write_text(f"[structure]\n{keys}\n")
    assert Structure.from_file(path).get(name) == STRUCTURE[name].default
    path.write_text(f"[structure]\n{keys}\n{name} = nan\n")
    unit = STRUCTURE[name].unit
    with pytest.raises(InputError, match=f"structure.{name} = nan {unit}: expected"):
        Structure.from_file(path)


@pytest.mark.parametrize("name", sorted({*ADDED} & {*OF_LENGTH}))
def test_with_a_length_in_it_the_level_counts_and_scaling_it_too_does_not(name):
    """At twice the amplitude the motion is another one, unless the parameter goes along."""
    structure = Structure(**{name: 0.05}, e=0.9)
    power = STRUCTURE[name].dimension["m"]
    assert structure.has_scale and not Structure().has_scale
    asked = {"frequency": 1.2, "periods": 3}
    one, other, same = (
        orchestrate.simulate(structure.replace(**{name: value}), amplitude=size, **asked).x_rel
        for value, size in ((0.05, 1.0), (0.05, 2.0), (0.05 * 2.0**power, 2.0))
    )
    assert np.array_equal(same, 2.0 * one) and not np.allclose(other, 2.0 * one, rtol=1e-6)


def test_a_row_of_the_table_makes_a_field(monkeypatch):
    """What a class does not write out, between its numbers and its flags, documented."""

    class Kind:
        """Of a kind.

        m1 : float
        bonded : bool
        """

        m1: float = 1.0
        bonded: bool = False

    monkeypatch.setattr(module, "STRUCTURE", {name: STRUCTURE[name] for name in ("m1", *ADDED)})
    made = dataclasses.dataclass(module.with_tabulated_fields(Kind))
    assert [field.name for field in dataclasses.fields(made)] == ["m1", *ADDED, "bonded"]
    assert all(getattr(made(), name) == STRUCTURE[name].default for name in ADDED)
    assert all(
        f"{name} : float\n        {STRUCTURE[name].description}" in made.__doc__ for name in ADDED
    )
