"""Jobs behind single claims, through the FMU: chattering, responses later, a map's best point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from orchestrate.access import finder
from orchestrate.dynamics.lyapunov import CHAOTIC, PERIODIC
from orchestrate.dynamics.parameter_map import MapJob
from orchestrate.paper.cases import CASES
from orchestrate.paper.chattering import ChatteringJob
from orchestrate.paper.later_responses import LaterJob, classify_changes
from orchestrate.paper.map_peaks import MapPeakJob
from orchestrate.response.sweep import SweepJob
from orchestrate.running.runner import gather

PAPER, DAMPED = CASES["elastic"], CASES["damped"]


def ask(*jobs):
    """The last job's result."""
    return gather(jobs, {"progress": False, "jobs": 1}, finder({}))[-1]


def test_chattering_shrinks_by_the_restitution_and_has_no_end(exported):
    """Each factor of gamma gives as many impacts more as its logarithm over that of e says."""
    gammas = (1e-4, 1e-6)
    job = ChatteringJob(name="chattering", restitutions=(0.05, 0.8, 1.0), gammas=gammas)
    found = ask(job)
    assert found.sticks.values.tolist() == [[1.0, 1.0], [1.0, 1.0], [0.0, 0.0]]
    assert found.ratio_error.sel(e=[0.05, 0.8], gamma=1e-6).max() < 1e-6
    for e in (0.05, 0.8):
        more = np.diff(found.impacts.sel(e=e).values)[0]
        assert more == pytest.approx(np.log(1e-2) / np.log(e), abs=1.0)
    assert found.shortest.sel(e=0.8, gamma=1e-6) < 1e-5 < found.shortest.sel(e=1.0, gamma=1e-6)


def test_a_sweep_s_responses_later(exported):
    """T/1 at D = 0.05 is unstable from 1.1154 on, which 500 periods from 1.115 do not see."""
    sweep = SweepJob(
        name="sweep", structure=DAMPED, eta=(1.09, 1.115, 1.116), transient=500, samples=40
    )
    later = LaterJob(
        name="later",
        structure=DAMPED,
        eta=(1.09, 1.116),
        follows="sweep",
        transient=4000,
        samples=40,
    )
    found = ask(sweep, later)
    assert found.multiplicity.values.tolist() == [1.0, 2.0]
    parts = classify_changes(ask(sweep), found, 0.01)
    which = "periodic, later with another period or other impacts"
    assert {name: part.tolist() for name, part in parts.items() if part.any()} == {
        which: [False, True]
    }


def test_the_largest_impulse_of_a_map_is_followed_longer(exported):
    given = (("e", (0.7, 0.95)), ("eta", (1.04, 1.05)))
    chart = MapJob(name="map_e", structure=PAPER, given=given, transient=50, settle=0.0, samples=20)
    peak = MapPeakJob(
        name="peak", map="map_e", parameter="e", structure=PAPER, transient=100, periods=600
    )
    found = ask(chart, peak)
    assert found.eta.values.tolist() == [1.05]
    assert found.verdict.values.tolist() == [CHAOTIC]
    assert float(found.impulse_max[0]) > 50.0  # chaos, at e = 0.95
    assert found.attrs["periods"] == 600
    steady = MapJob(
        name="map_D",
        structure=PAPER,
        given=(("D", (0.005, 0.05)), ("eta", (1.05,))),
        transient=300,
        samples=20,
    )
    low = ask(steady, replace(peak, map="map_D", parameter="D", transient=600))
    assert low.verdict.values.tolist() == [PERIODIC]
    assert float(low.impulse_max[0]) == pytest.approx(22.033, abs=0.01)
