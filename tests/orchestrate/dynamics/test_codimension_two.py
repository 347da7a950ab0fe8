"""Points of codimension two: against closed forms, normal forms, and from both of their curves."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest

import orchestrate
from orchestrate import Structure
from orchestrate.dynamics import codimension_two
from orchestrate.dynamics.bifurcation_kinds import Kind
from orchestrate.dynamics.codimension_two import (
    CharacteristicPolynomial,
    PointKind,
    locate_points_between,
)
from orchestrate.dynamics.continuation import newton_correct, unit_vector
from orchestrate.flags import flag_words

from .single_impact import SingleImpact

PAPER = Structure.nondimensional()
QUIET = {"progress": False}
WINDOWS = {1: (2.5, (2.4, 2.8)), 2: (3.55, (3.25, 3.7))}


@functools.cache
def window(period):
    eta, limits = WINDOWS[period]
    return orchestrate.branch(PAPER, eta=eta, period=period, limits=limits, **QUIET)


@functools.cache
def points(period, kind, over, limits):
    """The points on a curve of a kind, by their names: both parameters, and the point itself."""
    start = window(period)
    names = flag_words(start.bifurcation_kind.attrs)
    numbers = [i for i, k in enumerate(start.bifurcation_kind.values) if names[int(k)] == kind]
    asked = {"over": ("eta", over), "limits": [(1.0, 7.0), limits], "longest": 0.5}
    found = orchestrate.border(PAPER, start=start, bifurcation=numbers[0], **asked, **QUIET)
    words = flag_words(found.codimension_two_kind.attrs)
    table = {}
    for number, at in enumerate(found.codimension_two_kind.values):
        each = found.isel(codimension_two=number)
        values = float(each.codimension_two_eta), float(each[f"codimension_two_{over}"])
        table[words[int(at)]] = values, each
    return table


@pytest.mark.slow
def test_points_are_where_the_closed_form_has_them_and_on_both_of_their_curves():
    resonance, at = points(1, "Neimark-Sacker", "kappa", (1.05, 2.2))["resonance 1:3"]
    truth = SingleImpact(resonance[0], 1, kappa=resonance[1]).multipliers
    assert np.abs(truth - np.exp(2j * np.pi / 3.0)).min() < 1e-8
    assert float(at.codimension_two_residual) < 1e-12
    kinds, name = ("Neimark-Sacker", "period doubling"), "flip-Neimark-Sacker"
    both = [points(1, kind, "kappa", (1.05, 2.2))[name][0] for kind in kinds]
    assert both[0] == pytest.approx(both[1], abs=1e-9)
    truth = SingleImpact(both[0][0], 1, kappa=both[0][1]).multipliers
    pair = truth[truth.imag > 0.0]
    assert np.abs(truth + 1.0).min() < 1e-8 and abs(np.abs(pair) - 1.0).min() < 1e-8
    kinds, name = ("period doubling", "grazing of a flight"), "grazing period doubling"
    both = [points(2, kind, "e", (0.29, 0.71))[name][0] for kind in kinds]
    assert both[0] == pytest.approx(both[1], abs=1e-9)
    truth = SingleImpact(both[0][0], 2, e=both[0][1])
    assert np.abs(truth.multipliers + 1.0).min() < 1e-8
    assert abs(truth.gap(np.linspace(0.01, 0.99, 20_001) * truth.time).min()) < 1e-7


class Normal:
    """A fold curve of a normal form: p1 + p2 x - x^3 = 0, with multipliers of its own."""

    kind, accuracy, scale = Kind.FOLD, 1e-12, np.ones(3)

    def __init__(self):
        self.family = SimpleNamespace(node_unknowns=1, jacobian=self.first, setting=None)
        self.columns = self.rows = np.ones(1)

    def update_bordering_vectors(self, unknowns):
        pass

    def first(self, unknowns):
        x, _, p2 = unknowns
        return np.array([[p2 - 3.0 * x * x, 1.0, x]])

    def scaled_orbit_jacobian(self, unknowns):
        return self.first(unknowns)[:, :1].astype(complex)

    def residual(self, unknowns):
        x, p1, p2 = unknowns
        return np.array([p1 + p2 * x - x**3, p2 - 3.0 * x * x])

    def jacobian(self, unknowns, at_root=False):
        return np.vstack([self.first(unknowns), [-6.0 * unknowns[0], 0.0, 1.0]])


class Known(CharacteristicPolynomial):
    log_size = 0.0

    def __init__(self, *multipliers):
        self.coefficients = np.poly(multipliers)[::-1].real


def between(curve, first, last):
    roots = []
    for x in (first, last):
        guess = np.array([x, -2.0 * x**3, 3.0 * x * x])
        roots.append(newton_correct(curve, guess, unit_vector(3, 0)))
    return {each.kind: each for each in locate_points_between(curve, *roots, 0.0)}


@pytest.mark.parametrize("first", [-0.05, -0.15])
def test_a_cusp_is_where_the_normal_form_has_it(monkeypatch, first):
    known = Known(1.0, 0.5, 0.3, 0.2)
    monkeypatch.setattr(codimension_two, "characteristic_polynomial", lambda *_: known)
    found = between(Normal(), first, 0.1)
    assert set(found) == {PointKind.CUSP}
    assert found[PointKind.CUSP].unknowns == pytest.approx(np.zeros(3), abs=1e-12)
    assert between(Normal(), 0.05, 0.3) == {}


def test_what_the_multipliers_beside_1_say_on_a_fold(monkeypatch):
    """One is -1, one more is 1, a pair is on the unit circle; two real ones of product 1 are
    nothing.
    """
    cases = {
        PointKind.FOLD_FLIP: lambda x: (-1.0 - (x - 0.2), 0.3, 0.2),
        PointKind.RESONANCE_1: lambda x: (1.0 + (x - 0.2), 0.3, 0.2),
        PointKind.FOLD_TORUS: lambda x: (*((0.8 + x) * np.exp([1.1j, -1.1j])), 0.2),
        None: lambda x: (2.0, 0.3 + x, 0.2),
    }
    for kind, others in cases.items():

        def known(curve, unknowns, _=0.0, others=others):
            return Known(1.0, *others(unknowns[0]))

        monkeypatch.setattr(codimension_two, "characteristic_polynomial", known)
        found = between(Normal(), 0.1, 0.35)
        assert set(found) == ({kind} if kind is not None else set())
        if kind is not None:
            assert found[kind].unknowns[0] == pytest.approx(0.2, abs=1e-9)
            assert found[kind].residual < 1e-9
