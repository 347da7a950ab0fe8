"""What is kept of the excitation of a stored orbit or branch where a continuation begins."""

import pytest
import xarray as xr

from orchestrate.dynamics import manifolds
from orchestrate.dynamics.branches import branch, complete_excitation
from orchestrate.dynamics.orbits import orbit
from orchestrate.model import Structure
from orchestrate.response import questions

PAPER = Structure.nondimensional(e=0.7, D=0.005)
BEAM = Structure.from_file("beam")
BY_FREQUENCY = "[['frequency', 97.4], ['amplitude', 0.0001]]"


def asked(excitation):
    """Return a stored orbit as far as its excitation goes."""
    at = {"eta": 1.3, "frequency": 97.4, "amplitude": 1e-4}
    return xr.Dataset(coords=at, attrs={"excitation": excitation})


@pytest.mark.parametrize("over", ["k1", "m1", "omega", "f1"])
def test_where_omega_varies_the_frequency_is_kept_that_was_asked_for(over):
    for varied in ((over,), ("e", over)):
        kept = complete_excitation(asked(BY_FREQUENCY), varied, (), (0.0, 1.0), BEAM, {})
        assert kept == (("frequency", 97.4), ("amplitude", 1e-4))
        kept = complete_excitation(asked("[['eta', 1.3]]"), varied, (), (0.0, 1.0), BEAM, {})
        assert kept == (("eta", 1.3),)
    kept = complete_excitation(asked(BY_FREQUENCY), ("e",), (), (0.0, 1.0), BEAM, {})
    assert kept == (("eta", 1.3),)


def test_what_pushes_at_the_start_is_kept(monkeypatch):
    """Of an orbit that is stable, whose manifold is refused after that."""
    pushes = {"box_acceleration": 0.05, "force1": 0.02}
    start = orbit(PAPER, eta=1.7, **pushes)
    monkeypatch.setattr(questions, "answer", lambda job, *rest: job)
    kept = branch(PAPER, start=start, limits=(1.6, 1.8))
    assert dict(kept.setting.excitation) == pushes
    given = branch(PAPER, start=start, limits=(1.6, 1.8), box_acceleration=0.0)
    assert dict(given.setting.excitation) == {"force1": 0.02}
    along = branch(PAPER, start=start, over="box_acceleration", limits=(0.0, 0.1))
    assert along.value == 0.05 and dict(along.setting.excitation)["force1"] == 0.02
    monkeypatch.setattr(manifolds.ManifoldJob, "saddle", lambda job: None)
    kept = manifolds.manifold(PAPER, start=start)
    assert {name: getattr(kept, name) for name in pushes} == pushes
