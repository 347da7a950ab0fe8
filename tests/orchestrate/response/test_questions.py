"""At what a question is asked: both forms of an excitation, one parameter, and what is refused."""

import pytest

from orchestrate.model import Structure
from orchestrate.response.sweep import SweepJob

OWN = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=0.9, e=0.6)


def along(structure=OWN, **asked):
    rest = {"direction": "given", "transient": 0, "samples": 1, "tolerance": 0.1, "peak_periods": 1}
    return SweepJob(name="", structure=structure, **rest, **asked).series


@pytest.mark.parametrize(
    ("asked", "name", "count"),
    [
        ({"eta": 1.2}, "eta", 1),
        ({"frequency": 90.0, "amplitude": 1e-3}, "frequency", 1),
        ({"frequency": [80.0, 90.0], "amplitude": 1e-3}, "frequency", 2),
        ({"frequency": [80.0, 90.0], "amplitude": [1e-3, 2e-3]}, "frequency", 2),
        ({"frequency": 80.0, "amplitude": [1e-3, 2e-3, 3e-3]}, "amplitude", 3),
        ({"eta": 1.2, "over": "k2", "values": [6000.0, 8000.0]}, "k2", 2),
        ({"over": "eta", "values": [0.5, 0.6]}, "eta", 2),
        ({"frequency": 80.0, "over": "amplitude", "values": [1e-3]}, "amplitude", 1),
    ],
)
def test_what_is_a_list_is_the_dimension(asked, name, count):
    found = along(**asked)
    assert (found.name, len(found.values), len(found.points)) == (name, count, count)
    coordinates = found.coordinates()
    assert {"eta", "frequency", "amplitude", "period", name} == set(coordinates)
    for dims, values, attributes in coordinates.values():
        assert dims == name
        assert len(values) == count
        assert attributes["units"] and attributes["long_name"]


def test_the_call_is_one_that_can_be_made_again(exported):
    import orchestrate

    names = {"Structure": Structure, "__builtins__": {}}
    for ask, asked in (
        (orchestrate.sweep, {"eta": [0.4, 1.1], "transient": 3, "samples": 4}),
        (orchestrate.simulate, {"eta": 1.1, "periods": 2, "points": 3, "phase": 1.0}),
        (orchestrate.map, {"eta": [0.4, 1.1], "e": [0.3, 0.6], "transient": 3, "settle": 1.0}),
    ):
        found = ask(OWN, **asked)
        again = eval(found.attrs["call"], {**names, ask.__name__: ask})
        assert again.identical(found.assign_attrs(history=again.attrs["history"]))
