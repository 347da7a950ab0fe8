"""The tracer on a circle, whose folds, ends and points are known."""

import numpy as np
import pytest

from orchestrate.dynamics.bifurcation_kinds import KINDS, Kind
from orchestrate.dynamics.continuation import ArclengthStepper, NoConvergenceError, Root
from orchestrate.dynamics.tracer import LIMIT, MAX_POINTS, NO_CONVERGENCE, BranchTracer


class Circle:
    """x^2 + y^2 = 1."""

    scale, accuracy = np.ones(2), 1e-12

    def residual(self, unknowns):
        return np.array([unknowns @ unknowns - 1.0])

    def jacobian(self, unknowns, at_root=False):
        return 2.0 * unknowns[np.newaxis]


class CircleTracer(BranchTracer):
    """Folds are where x turns; other kinds are where a function of a point is zero."""

    kinds = (Kind.FOLD,)

    def __init__(self, angle=-0.5, longest=0.2, limits=(-2.0, 2.0), most=100, **functions):
        self.range, self.functions = limits, {KINDS[Kind.FOLD]: lambda root: root.tangent[0]}
        self.functions |= functions
        point, tangent = [np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]
        self.start = Root(np.array(point), np.array(tangent), 0.0, 0)
        super().__init__(ArclengthStepper(Circle(), self.start, 0.1, longest), most)

    def point(self, root):
        return root

    def limits(self):
        return 0, [self.range]

    def test_function(self, point, kind):
        return float(self.functions[KINDS[kind]](point))

    def go_on_from(self, point):
        self.stepper.root = point
        return point


def test_folds_are_located_on_the_curve():
    segment = (tracer := CircleTracer(most=40)).trace(tracer.start)
    assert segment.end == MAX_POINTS and len(segment.points) == 41
    folds = segment.bifurcations
    assert [each.kind for each in folds[:2]] == [Kind.FOLD, Kind.FOLD]
    found = np.array([each.point.unknowns for each in folds[:2]])
    assert found == pytest.approx(np.array([[1.0, 0.0], [-1.0, 0.0]]), abs=1e-12)
    before, after = (segment.points[int(folds[0].position) + i].unknowns[1] for i in (0, 1))
    assert before < 0.0 < after


def test_a_branch_stops_on_a_limit():
    segment = (tracer := CircleTracer(limits=(0.25, 2.0))).trace(tracer.start)
    assert segment.end == LIMIT
    assert segment.points[-1].unknowns[0] == 0.25


def test_a_branch_ends_at_an_ending_kind():
    class Ending(CircleTracer):
        kinds, ending_kinds = (Kind.FOLD, Kind.GRAZING), (Kind.GRAZING,)

    grazing = {KINDS[Kind.GRAZING]: lambda root: 0.5 - root.unknowns[1]}
    segment = (tracer := Ending(**grazing)).trace(tracer.start)
    assert segment.end == KINDS[Kind.GRAZING]
    assert [each.kind for each in segment.bifurcations] == [Kind.FOLD, Kind.GRAZING]
    assert segment.points[-1].unknowns[1] == pytest.approx(0.5, abs=1e-12)
    assert segment.bifurcations[-1].position == len(segment.points) - 1


@pytest.mark.parametrize("both", [True, False])
def test_two_bifurcations_in_one_step_are_found_where_they_are_sought(both):
    class Pairs(CircleTracer):
        kinds, finds_pairs = (Kind.FLIP,), both

    dip = {KINDS[Kind.FLIP]: lambda root: (root.unknowns[1] - 0.3) ** 2 - 1e-4}
    segment = (tracer := Pairs(-0.3, limits=(0.8, 2.0), **dip)).trace(tracer.start)
    places = [each.point.unknowns[1] for each in segment.bifurcations]
    assert places == pytest.approx([0.29, 0.31] if both else [], abs=1e-12)


def test_a_step_is_shortened_where_a_bifurcation_cannot_be_located():
    """It is not passed over in silence."""
    tracer = CircleTracer()
    located, lengths = tracer.locate, []

    def fail_in_long_steps(step):
        lengths.append(step.length)
        if step.length > 0.01 and step.brackets(Kind.FOLD):
            raise NoConvergenceError("too long")
        return located(step)

    tracer.locate = fail_in_long_steps
    segment = tracer.trace(tracer.start)
    assert segment.bifurcations[0].point.unknowns == pytest.approx([1.0, 0.0], abs=1e-12)
    assert min(lengths) <= 0.01
    tracer = CircleTracer()
    tracer.locate = lambda step: (_ for _ in ()).throw(NoConvergenceError("never"))
    assert tracer.trace(tracer.start).end == NO_CONVERGENCE


@pytest.mark.parametrize("method", ["fit_impacts_to_step", "go_on_from", "point"])
@pytest.mark.parametrize("error", [NoConvergenceError, np.linalg.LinAlgError])
def test_what_was_followed_is_kept_where_an_inner_iteration_fails(method, error):
    """Whatever part of a step it belongs to."""
    tracer = CircleTracer()
    whole, calls = getattr(tracer, method), []

    def fail_from_the_fifth_call_on(*arguments):
        calls.append(method)
        if len(calls) >= 5:
            raise error("no root")
        return whole(*arguments)

    setattr(tracer, method, fail_from_the_fifth_call_on)
    segment = tracer.trace(tracer.start)
    assert segment.end == NO_CONVERGENCE and len(segment.points) >= 3
