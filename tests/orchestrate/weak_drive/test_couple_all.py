"""Many runs at once: the same numbers as one by one, shared out, each kept."""

import numpy as np
import pytest

from orchestrate import InputError, couple, couple_all

from .coupled import BEAM, QUICK

SETS = {"one": tuple(QUICK), "other": tuple(BEAM)}
FEW = {"eta0": (1.1, 1.11), "rates": [4e-4, 8e-4], "back": False, "progress": False}
FEW |= {"kinds": ["delaminated"]}


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    return couple_all(SETS, **FEW, jobs=2, store=folder), folder


def test_each_run_is_that_of_couple(found):
    """Two sets, two rates; the shorter runs end in NaN."""
    whole, _ = found
    assert whole.sizes["run"] == 4 and sorted(set(whole.system.values)) == ["one", "other"]
    chosen = (whole.system == "other") & (whole.structure == "delaminated") & (whole.rate == 8e-4)
    (row,) = np.flatnonzero(chosen.values)
    volts, omega = BEAM.drive.volts(BEAM.structure), BEAM.structure.omega
    ends, rate = (1.1 * volts, 1.11 * volts), 8e-4 * volts * omega
    single = couple(*BEAM, voltage=ends, rate=rate, back=False, progress=False)
    count = single.sizes["revolution"]
    for name in ("speed", "amplitude", "missing", "eta0"):
        assert np.array_equal(whole[name][row, :count], single[name]), name
    assert np.isnan(whole.speed[row, count:]).all()
    assert whole.speed.units == "rad/s" and whole.rate.units == "1"


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"systems": {}}, "systems = .*: expected"),
        ({"rates": [0.0]}, "rate = 0.0: expected a number > 0"),
        ({"kinds": ["glued"]}, "kinds = 'glued': expected bonded or delaminated"),
        ({"rates": []}, "expected one of each"),
    ],
)
def test_mistakes(arguments, text):
    with pytest.raises(InputError, match=text):
        couple_all(**{"systems": SETS, **FEW, **arguments})
