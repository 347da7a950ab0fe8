"""Bifurcations over two parameters against closed forms."""

import functools
from dataclasses import replace

import numpy as np
import pytest

import orchestrate
from orchestrate.dynamics import borders
from orchestrate.dynamics.bifurcation_kinds import Kind
from orchestrate.dynamics.borders import border
from orchestrate.dynamics.branches import branch
from orchestrate.dynamics.closed_form import ClosedForm
from orchestrate.model import Excitation, Structure
from orchestrate.response import signatures
from orchestrate.response.questions import Point

from ...sparing import ordinary
from .single_impact import SingleImpact

PAPER = Structure.nondimensional(e=0.7, D=0.005)
LIMITS = {"e": (0.6, 0.8), "D": (0.003, 0.01), "kappa": (1.15, 1.3)}
KINDS = Kind.TORUS, Kind.FLIP, Kind.TOUCHING
CURVES = [(kind, list(LIMITS)[(i + k) % 3]) for k in range(3) for i, kind in enumerate(KINDS)]


@functools.cache
def window():
    return branch(PAPER, eta=4.0, period=2, limits=(3.2, 4.0))


@pytest.mark.parametrize(("kind", "over"), ordinary(CURVES, several_names=True))
def test_curves_are_where_the_closed_form_has_the_bifurcation(kind, over):
    limits = [(2.5, 5.0), LIMITS[over]]
    at = np.flatnonzero(window().bifurcation_kind.values == kind)[-1]  # that is highest in eta
    asked = {"over": ("eta", over), "limits": limits, "longest": 0.4}
    found = border(PAPER, start=window(), bifurcation=at, **asked)
    assert found.sizes["point"] > 5
    for i, end in ((0, "first_end"), (-1, "last_end")):
        assert found.attrs[end] != "limit" or found[over].values[i] in LIMITS[over]
    for i in range(0, found.sizes["point"], 4):
        value = float(found[over].values[i])
        truth = SingleImpact(float(found.eta.values[i]), 2, **{over: value})
        assert found.node_closing.values[i, 0] == pytest.approx(truth.closing, abs=1e-10)
        if kind == Kind.TORUS:
            assert np.abs(np.abs(truth.multipliers) - 1.0).min() < 1e-9
            assert np.abs(truth.multipliers - np.exp(1j * found.angle.values[i])).min() < 1e-9
        elif kind == Kind.FLIP:
            assert np.abs(truth.multipliers + 1.0).min() < 1e-9
        else:
            assert abs(found.nearest_miss.values[i]) < 1e-12
            times = np.linspace(0.01, 0.99, 20_001) * truth.time
            assert abs(truth.gap(times).min()) < 1e-7


def test_a_fold_is_found_from_either_side_of_it(monkeypatch):
    """Beyond there is no orbit, and what is known of a fold is known to its accuracy."""
    folded = Structure.nondimensional(D=0.02, clearance=3.0)
    box = {"over": "frequency", "frequency": 1.12, "amplitude": 1.12**-2}
    start = branch(folded, **box, limits=(1.1, 1.36), longest=0.3)
    monkeypatch.setattr(signatures, "compute_dataset", lambda job, *rest: job)
    (at,) = np.flatnonzero(start.bifurcation_kind.values == Kind.FOLD)
    value = float(start.bifurcation_value[at])
    question = {"over": ("frequency", "e"), "limits": [(1.2, 1.4), (0.6, 0.8)]}
    job = border(folded, start=start, bifurcation=at, **question)
    for beyond in (-1e-7, 0.0, 1e-7):
        near = replace(job, values=(value + beyond, 0.7))
        curve, root = borders.solve_start_on_curve(near)
        assert root.unknowns[curve.family.node_unknowns :] == pytest.approx([value, 0.7], abs=1e-11)


DAMPED = Structure(d1=0.1, d2=0.12, e=0.5)
BOX = {"frequency": 1.2, "amplitude": 1.0}


def test_a_border_begins_where_an_open_structure_touches():
    """Grazing of the linear orbit over the clearance is the threshold of contact, and its curve
    over clearance and amplitude is the straight line that scaling says.
    """
    open_structure = DAMPED.replace(clearance=2.0)
    level = orchestrate.contact_threshold(open_structure, frequency=1.2)
    touching = 2.0 / float(level.threshold_amplitude[0])  # clearance at amplitude 1
    wide = open_structure.replace(clearance=1.2 * touching)
    form = ClosedForm.from_structure(wide, Excitation(**BOX))
    steady = Point(wide, Excitation(**BOX)).states_from_faces(form.steady_response(np.zeros(1)))
    apart = orchestrate.orbit(wide, **BOX, guess=steady[0])  # from rest it impacts: another branch
    assert float(apart.impacts_per_period) == 0.0
    along = {"over": "clearance", "limits": (0.9 * touching, 1.4 * touching), "longest": 0.3}
    found = orchestrate.branch(wide, start=apart, **along)
    assert found.bifurcation_value.values == pytest.approx([touching], rel=1e-9)
    limits = [(0.5 * touching, 1.4 * touching), (0.6, 1.3)]
    asked = {"over": ("clearance", "amplitude"), "limits": limits, "longest": 0.1}
    curve = orchestrate.border(wide, start=found, bifurcation=0, **asked)
    assert curve.sizes["point"] > 3
    assert curve.clearance.values / curve.amplitude.values == pytest.approx(touching, rel=1e-8)
