"""The paper's datasets through the FMU: small ones, each of a call of the public functions."""

import contextlib
import inspect
from dataclasses import replace
from unittest.mock import MagicMock

import numpy as np
import pytest

import orchestrate
from orchestrate.paper.cases import CASES
from orchestrate.paper.datasets import Datasets
from orchestrate.paper.resolution import QUICK
from orchestrate.running.options import Running

pytestmark = pytest.mark.usefixtures("exported")
RUNNING = {"jobs": 1, "progress": False}


@pytest.fixture
def data(tmp_path):
    """Datasets of few periods, the damped case in place of all sweeps."""
    stages = {"stages": (0, 4500), "skip": 5, "keep": 2, "transient": 500, "samples": 39}
    return Datasets(tmp_path, replace(QUICK, **stages), RUNNING)


def test_questions_are_such_as_their_functions_take(data):
    """A keyword that a function has no more is seen when it is called: in a run, after minutes."""
    asked, wrong = set(), []

    def get(name, function, *what, **keywords):
        known = {*inspect.signature(function).parameters, *Running.__annotations__}
        asked.add(function.__name__)
        wrong.extend((name, keyword) for keyword in keywords.keys() - known)
        return MagicMock()  # an answer of which anything can be asked

    data.get_or_compute = get
    for name, method in inspect.getmembers(data, inspect.ismethod):
        if name != "get_or_compute" and not inspect.signature(method).parameters:
            with contextlib.suppress(Exception):  # of what is no number
                method()
    assert not wrong and {"sweep", "attractors"} <= asked, (wrong, asked)


def test_a_response_is_run_on_until_it_repeats(data):
    """At D = 0.05 T/1 is unstable at 1.116, which 500 periods from 1.115 do not see."""
    etas = np.round(np.arange(1.101, 1.1165, 0.0015), 4)
    asked = {"eta": etas, "transient": 500, "samples": 40, **RUNNING}
    data.sweep = lambda *_: orchestrate.sweep(CASES["damped"], **asked)
    found, before = data.settled_responses("damped"), data.up_sweep("damped")
    assert before.multiplicity.values[-1] == 1
    assert found.eta.values.tolist() == [1.101, 1.1085, 1.116]
    assert found.multiplicity.values.tolist() == [1, 1, 2]
    assert found.impacts_per_period.values.tolist() == [1.0, 1.0, 1.5]
    assert found.periods.values.tolist()[::2] == [48, 4596]
    stored = {path.name for path in data.folder.glob("*.nc")}
    assert stored == {f"settled_e0.7_D0.05_up_{stage}.nc" for stage in (0, 1)}
    exponents = data.lyapunov_exponents("damped")
    assert (exponents.verdict < 0).all() and exponents.eta.equals(found.eta)


def test_chattering_shrinks_by_the_restitution_and_has_no_end(data, monkeypatch):
    """Each factor of gamma gives as many impacts more as its logarithm over that of e says."""
    monkeypatch.setattr("orchestrate.paper.cases.RESTITUTIONS", (0.05, 0.8, 1.0))
    monkeypatch.setattr("orchestrate.paper.cases.STICKING_GAMMAS", (1e-4, 1e-6))
    found = data.chattering_by_restitution()
    assert found.sticks.values.tolist() == [[1.0, 1.0], [1.0, 1.0], [0.0, 0.0]]
    assert found.ratio_error.sel(e=[0.05, 0.8], gamma=1e-6).max() < 1e-6
    for e in (0.05, 0.8):
        more = np.diff(found.impacts.sel(e=e).values)[0]
        assert more == pytest.approx(np.log(1e-2) / np.log(e), abs=1.0)
