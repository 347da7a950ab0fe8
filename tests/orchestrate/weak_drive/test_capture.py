"""Capture from rest: the border against simulations of the whole system."""

import numpy as np
import pytest

from orchestrate import capture
from orchestrate.weak_drive.averaged import bonded_dividing_speed
from orchestrate.weak_drive.capture import bracket_threshold
from orchestrate.weak_drive.capture_rule import CONVERGED, UNDECIDED, CaptureOutcome

from ...sparing import ordinary
from .coupled import QUICK, rest, system_of
from .monolithic import Monolith

SHORT = {"step": 0.2, "progress": False}
COARSE = {"method": "DOP853", "rtol": 1e-8, "atol": 1e-10}
OPEN = QUICK.with_structure(clearance=3.0)
# a quick motor: it is beyond the resonance for 80 revolutions, and returns
SWINGING = system_of(
    *(0.86903, 1.077872, 0.006998, 0.01166, 0.730714),
    **{"beta": 0.202611, "epsilon": 0.000919, "b": 0.227602, "Omega_b": 0.214632, "D_b": 0.012328},
)
BORDERS = {  # ends and the outcome of each voltage between
    "quick": (QUICK.as_bonded(), (1.5442, 1.5446), 2),
    "swinging": (SWINGING.as_bonded(), (1.2773, 1.2793), 3),
    "impacts": (QUICK, (1.53, 1.55), 3),
    "swinging with impacts": (SWINGING, (1.275, 1.279), 3),
    "open": (OPEN, (1.51, 1.55), 3),
}


@pytest.mark.parametrize("name", ordinary(BORDERS, ["quick"]))
def test_the_border_is_that_of_the_whole_system(name):
    """A motor ends below the resonance a tolerance under the border, and beyond it above."""
    system, ends, count = BORDERS[name]
    found = capture(*system, voltage=ends, count=count, **SHORT)
    low, high = float(found.border_low), float(found.border_high)
    assert found.passes.values.tolist()[::2] == [0, 1][: len(found.passes[::2])]
    assert high - low <= 1e-4 and float(found.border) == 0.5 * (low + high)
    times = np.arange(0.0, 1000.0 if name == "quick" else 1500.0, 0.5)
    solvers = (Monolith(*system, v, COARSE) for v in (low - 1e-4, high + 1e-4))
    sides = [solver.solve(rest(), times)[0][:, 7] for solver in solvers]
    assert sides[0][-100:].mean() < bonded_dividing_speed(*system) < sides[1][-100:].mean()
    if name == "swinging":
        assert (sides[0] > bonded_dividing_speed(*system)).sum() * 0.5 > 20 * 2 * np.pi / 1.25
    if name == "quick":
        assert found.decision.values.tolist() == ["converged", "converged"]
        assert float(found.border) == pytest.approx(1.54443, abs=1e-4)
        assert float(found.fold) == pytest.approx(1.58306, abs=1e-4) and not found.above_fold
        below, beyond = float(found.speed_low), float(found.speed_high)
        assert below < 1.3 and beyond > 1.5 and found.speed[1] == pytest.approx(beyond, abs=1e-3)
        reached = times[np.flatnonzero(sides[1] < bonded_dividing_speed(*system))[-1]]
        assert np.isnan(found.passage_time[0]) and 0.5 < found.passage_time[1] / reached < 2.0


def test_a_start_that_has_not_settled_is_undecided():
    """Too little time: no outcome, and no border, by default there are both."""
    asked = {"voltage": (1.5, 1.6), "count": 2, "tolerance": 0.05, **SHORT}
    found = capture(*QUICK.as_bonded(), time=200.0, **asked)
    assert found.decision.values.tolist() == ["undecided"] * 2 and not found.passes.any()
    for name in ("passage_time", "border", "border_low", "border_high"):
        assert np.isnan(found[name]).all()


@pytest.mark.parametrize("known", [(1.0, 1.8), (1.0, 1.3, 1.4, 1.8), (1.0, 1.2, 1.6, 1.8)])
def test_undecided_starts_widen_the_border(known):
    """Made-up: captured below 1.28, undecided to 1.47, passes above."""
    asked = []

    def start(voltage):
        asked.append(voltage)
        if voltage < 1.28:
            return CaptureOutcome(CONVERGED)
        return CaptureOutcome(CONVERGED, True, 1.0) if voltage > 1.47 else CaptureOutcome(UNDECIDED)

    ends = bracket_threshold(known, [start(voltage) for voltage in known], start, 0.01)
    low, high = (end.voltage for end in ends)
    assert 1.27 <= low < 1.28 and 1.47 < high <= 1.48
    assert len(asked) < 30


def test_over_a_second_parameter():
    """A heavier rotor takes more voltage; it is the one of the drive that varies."""
    asked = {"voltage": (1.5, 1.6), "count": 2, "tolerance": 0.02, **SHORT}
    found = capture(*QUICK.as_bonded(), over="rotor_inertia", values=[800.0, 1400.0], **asked)
    assert found.passes.dims == ("rotor_inertia", "voltage")
    assert found.rotor_inertia.attrs["units"] == "kg.m2"
    assert 1.52 < found.border[0] < found.border[1] < 1.57
    alone = QUICK.drive.replace(rotor_inertia=1400.0)
    other = capture(QUICK.structure.as_bonded(), alone, **asked)
    for name in ("border", "fold", "passage_time"):
        assert np.array_equal(other[name], found[name][1], equal_nan=True)


def test_voltages_on_one_side_have_no_border():
    """Of no more than the speed beyond takes nothing is simulated: a motor at rest, too."""
    low = capture(*QUICK.as_bonded(), voltage=(0.0, 1.3), count=2, **SHORT)
    high = capture(*QUICK.as_bonded(), voltage=(1.7, 1.8), count=2, **SHORT)
    assert not low.passes.any() and high.passes.all()
    assert low.decision.values.tolist() == ["no-load speed"] * 2
    assert np.isnan(low.border) and np.isnan(high.border)
