"""Maps: each point is a response from the same start, in whatever unit and order."""

import itertools

import numpy as np
import pytest

from orchestrate.dynamics.orbits import orbit
from orchestrate.dynamics.parameter_map import MapJob, map
from orchestrate.model import Structure
from orchestrate.model.outcomes import REPEATED, UNDECIDED
from orchestrate.response.simulate import simulate
from orchestrate.response.sweep import sweep

PAPER = Structure.nondimensional()
SLOWER = PAPER.replace(e_slope=0.05)  # a restitution that decreases
ETAS, ES = [0.4, 1.13, 1.6], [0.3, 0.7]

pytestmark = pytest.mark.usefixtures("exported")


@pytest.fixture(scope="module")
def found(exported):
    return map(SLOWER, eta=ETAS, e=ES, exponent=True, periods=100)


@pytest.mark.parametrize(("count", "chunks"), [(50, 16), (2, 12), (330, 17)])
def test_a_map_of_few_points_is_stored_in_many_parts(count, chunks):
    given = (("eta", tuple(np.linspace(1.0, 2.0, count))), ("e", (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)))
    job = MapJob(name="map", structure=PAPER, start=(0.0,) * 4, given=given)
    assert len(job.chunks()) == chunks and job.chunks()[-1].stop == 6 * count


def test_each_point_is_a_response_from_rest(found):
    assert found.multiplicity.dims == ("eta", "e")
    for eta, e in itertools.product(ETAS, ES):
        dropped = max(300, round(300 * eta))
        swept = sweep(SLOWER.replace(e=e), eta=eta, transient=dropped, samples=60).isel(eta=0)
        for name in ("impacts_per_period", "multiplicity", "xi_rel_max"):
            assert float(found.sel(eta=eta, e=e)[name]) == float(swept[name]), name


def test_responses_next_to_each_other_are_alike_where_a_mass_passes_zero_at_phase_zero():
    # the arc on which x2 is 0 at phase 0: T was called 2, 9, 11 and 0 along it
    arc = map(PAPER, eta=np.linspace(1.90, 1.95, 11), e=np.linspace(0.33, 0.37, 5))
    assert (arc.multiplicity == 1).all()
    assert (arc.multiplicity_decided == REPEATED).all()


def test_what_is_undecided_is_run_on():
    given = {"eta": [0.827, 0.894], "e": [0.74, 0.86], "transient": 200}
    stopped, run_on = (map(PAPER, **given, longest=most) for most in (0, 20_000))
    places = [{"eta": 0.827, "e": 0.86}, {"eta": 0.894, "e": 0.74}]
    for where, n in zip(places, (8, 2), strict=True):  # by Newton's method
        assert int(stopped.multiplicity_decided.sel(where)) == UNDECIDED
        assert int(run_on.multiplicity_decided.sel(where)) == REPEATED
        assert int(run_on.multiplicity.sel(where)) == n
        structure, eta = PAPER.replace(e=where["e"]), where["eta"]  # the response from rest
        end = sweep(structure, eta=eta, transient=20_000, samples=4).end_state.values[0]
        found = orbit(structure, eta=eta, period=n, guess=end)
        assert found.stable and found.fmu_return < 1e-9


def test_the_largest_impulse_is_that_of_the_motion(found):
    motion = simulate(SLOWER, eta=1.6, transient=480 + 60, periods=30)
    speed = float(motion.impact_velocity.max())
    expected = 0.5 * (1.0 + SLOWER.restitution(speed)) * speed
    assert float(found.impulse_max.sel(eta=1.6, e=0.7)) == pytest.approx(expected, rel=1e-9)


def test_any_two_parameters_in_any_unit():
    own = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=0.9, e=0.6)
    short = {"transient": 50, "settle": 1.0, "samples": 10, "longest": 0}
    found = map(own, k2=[6000.0, 8000.0], D=[0.01, 0.02, 0.03], eta=1.4, m2=1.0, **short)
    assert found.xi_rel_max.dims == ("k2", "D")
    assert found.k2.attrs["units"] == "N/m"
    one = own.replace(m2=1.0, k2=8000.0, D=0.02)
    swept = sweep(one, eta=1.4, transient=50, samples=10)
    assert float(found.xi_rel_max.sel(k2=8000.0, D=0.02)) == float(swept.xi_rel_max[0])
    same = map(own, k2=[6000.0, 8000.0], over="D", values=found.D, eta=1.4, m2=1.0, **short)
    assert same.equals(found) and same.attrs["identity"] == found.attrs["identity"]
    box = map(own, frequency=[90.0, 110.0], amplitude=[1e-3, 2e-3], **short)
    np.testing.assert_allclose(box.xi_rel_max[:, 0], box.xi_rel_max[:, 1], rtol=1e-6)
