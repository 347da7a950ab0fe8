"""Sweeps: order, directions, any parameter; chunks and scales change nothing."""

from unittest.mock import patch

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from orchestrate.fmu import OSCILLATOR, Instance, find_or_export, sample_evenly, start_motion
from orchestrate.model import Excitation, Structure
from orchestrate.model.outcomes import IRREGULAR, REPEATED, UNDECIDED
from orchestrate.response.multiplicity import DECIDED
from orchestrate.response.simulate import simulate
from orchestrate.response.sweep import SweepJob, sweep

PAPER = Structure.nondimensional()
SHORT = {"transient": 30, "samples": 20}
ETAS = (1.13, 0.4, 1.10, 1.2)  # chaotic ones among them: a wrong start is seen
EXACT = ("xi_rel", "xi_rel_max", "impacts_per_period", "end_state", "multiplicity")
NUMBERS = (*EXACT, "a1_max", "x2_max")

pytestmark = pytest.mark.usefixtures("exported")


def same(one, other, names=NUMBERS):
    for name in names:
        np.testing.assert_array_equal(one[name].values, other[name].values, err_msg=name)


def test_responses_of_a_sweep_are_run_on_each_from_its_own_state(exported):
    """T/1 at D = 0.05 is unstable from 1.1154 on, which 500 periods from 1.115 do not see."""
    structure = Structure.nondimensional(D=0.05)
    up = sweep(structure, eta=[1.09, 1.115, 1.116], transient=500, samples=40, progress=False)
    settings = {"transient": 3000, "samples": 48, "tolerance": 1e-6, "progress": False}
    later = sweep(structure, eta=[1.116, 1.09], start=up, **settings)
    assert up.multiplicity.values.tolist() == [1, 1, 1]
    assert later.multiplicity.values.tolist() == [2, 1]
    for n, eta in enumerate((1.116, 1.09)):
        alone = sweep(structure, eta=[eta], start=up.sel(eta=[eta]), **settings)
        xr.testing.assert_equal(later.isel(eta=[n]), alone)


def test_a_response_is_what_the_fmu_says_step_by_step():
    excitation = Excitation.nondimensional(1.13, PAPER)
    period = excitation.period
    with Instance(find_or_export(OSCILLATOR).path) as instance:
        start_motion(instance, PAPER, excitation, x_rel_max_on=True)
        states = sample_evenly(instance, 0.0, 20 * period, 20)
        before = instance.get("impact_count")[0]
        states = np.concatenate([states, sample_evenly(instance, 20 * period, 50 * period, 30)])
        impacts = instance.get("impact_count")[0]
    found = sweep(PAPER, eta=1.13, transient=20, samples=30).isel(eta=0)
    np.testing.assert_allclose(found.xi_rel, states[20:, 1] - states[20:, 0], atol=1e-12)
    size = abs(states[-1]).max()
    np.testing.assert_allclose(found.end_state, states[-1], rtol=0.0, atol=1e-13 * size)
    assert float(found.impacts_per_period) == (impacts - before) / 30
    whole = sweep(PAPER, eta=1.13, transient=0, samples=50).isel(eta=0)
    assert float(whole.impacts_per_period) == impacts / 50
    assert found.sample.values.tolist() == list(range(21, 51))


@pytest.mark.parametrize("direction", ["up", "down", "given", "both"])
def test_directions_chunks_and_peaks_change_no_bit(direction):
    """Both directions are each alone; each is the one given in its order, whatever the chunks."""
    found = sweep(PAPER, eta=ETAS, direction=direction, **SHORT)
    assert tuple(found.eta.values) == ETAS
    with patch.object(SweepJob, "chunk_size", 3):
        same(found, sweep(PAPER, eta=ETAS, direction=direction, peak_periods=1, **SHORT), EXACT)
    for one in ("up", "down") if direction == "both" else (direction,):
        part = found.sel(direction=one) if direction == "both" else found
        order = {"up": sorted(ETAS), "down": sorted(ETAS)[::-1], "given": ETAS}[one]
        same(part.sel(eta=list(order)), sweep(PAPER, eta=order, direction="given", **SHORT))


@pytest.mark.parametrize(
    ("name", "values"), [("e", [0.3, 0.7]), ("k2", [1.1, 1.4]), ("D", [0.01, 0.05]), ("mu", [0.5])]
)
def test_over_a_parameter_of_the_structure(name, values):
    found = sweep(PAPER, over=name, values=values, eta=0.9, **SHORT)
    start = None
    for value in values:
        one = sweep(PAPER.replace(**{name: value}), eta=0.9, start=start, **SHORT).isel(eta=0)
        same(found.sel({name: value}), one)
        start = one.end_state.values
    assert found[name].attrs["units"]


@given(st.integers(-8, 8), st.integers(-4, 4), st.floats(0.3, 3.0), st.floats(0.7, 2.0))
@settings(max_examples=8, deadline=None)
def test_the_unit_of_mass_and_time_does_not_matter(mass, time, eta, kappa):
    numbers, omega = {"kappa": kappa, "e": 0.4, "mu": 1.5}, 2.0**time
    other = Structure.nondimensional(**numbers, m1=2.0**mass, omega=omega)
    both = Structure.nondimensional(**numbers), other
    one, two = (sweep(s, eta=eta, transient=20, samples=5) for s in both)
    same(one, two, ("xi_rel", "xi_rel_max", "end_state", "xi1_max"))
    np.testing.assert_allclose(two.a1_max, omega**2 * one.a1_max, rtol=1e-12)


def test_it_is_told_how_the_multiplicity_was_decided():
    found = sweep(PAPER, eta=[1.047, 1.13])
    assert found.multiplicity_decided.values.tolist() == [REPEATED, IRREGULAR]
    words = found.multiplicity_decided.attrs["flag_meanings"].split()
    numbers = found.multiplicity_decided.attrs["flag_values"].tolist()
    assert dict(zip(numbers, words, strict=True)) == DECIDED
    converging = sweep(PAPER.replace(e=0.86), eta=0.827, transient=240, samples=60)
    assert converging.multiplicity_decided.values.tolist() == [UNDECIDED]


def test_impacts_of_a_response_are_counted_over_its_own_period():
    structure = Structure.nondimensional(mu=2.325, kappa=1.113, D=0.0413, e=0.374)
    for peaks in (1, 8):
        found = sweep(structure, eta=2.615, peak_periods=peaks)
        assert (int(found.multiplicity[0]), float(found.impacts_per_period[0])) == (22, 24 / 22)
    motion = simulate(structure, eta=2.615, transient=700, periods=22, points=1)
    assert motion.sizes["impact"] == 24


PEAKS = [(0.7, 0.005, 21.558, 1.047), (0.7, 0.05, 2.6347, 1.057), (0.3, 0.005, 16.410, 1.048)]


@pytest.mark.parametrize(("e", "D", "highest", "eta"), PEAKS)
def test_resonance_peak(exported, e, D, highest, eta):
    etas = np.arange(1030, 1066) / 1000
    structure = Structure.nondimensional(e=e, D=D)
    gaps = sweep(structure, eta=etas, transient=200, samples=40).xi_rel_max
    assert gaps.max() == pytest.approx(highest, rel=1e-3)
    assert gaps.idxmax() == pytest.approx(eta, abs=1e-9)
