"""The tracer on a circle: where an inner iteration fails, it says so and keeps what it had."""

import numpy as np
import pytest

from orchestrate.dynamics.bifurcation_kinds import Kind
from orchestrate.dynamics.continuation import ArclengthStepper, NoConvergenceError, Root
from orchestrate.dynamics.tracer import NO_CONVERGENCE, BranchTracer


class Circle:
    scale, accuracy = np.ones(2), 1e-12

    def residual(self, unknowns):
        return np.array([unknowns @ unknowns - 1.0])

    def jacobian(self, unknowns, at_root=False):
        return 2.0 * unknowns[np.newaxis]


class CircleTracer(BranchTracer):
    """Folds are where x turns."""

    kinds = (Kind.FOLD,)

    def __init__(self):
        point, tangent = [np.cos(-0.5), np.sin(-0.5)], [-np.sin(-0.5), np.cos(-0.5)]
        self.start = Root(np.array(point), np.array(tangent), 0.0, 0)
        super().__init__(ArclengthStepper(Circle(), self.start, 0.1, 0.2), 100)

    def make_point(self, root):
        return root

    def first_limited_unknown_and_limits(self):
        return 0, [(-2.0, 2.0)]

    def test_function(self, point, kind):
        return float(point.tangent[0])

    def move_stepper_to(self, point):
        self.stepper.root = point
        return point


def test_a_step_is_shortened_where_a_bifurcation_cannot_be_located():
    """It is not passed over in silence."""
    tracer = CircleTracer()
    located, lengths = tracer.locate_bifurcations, []

    def fail_in_long_steps(step):
        lengths.append(step.length)
        if step.length > 0.01 and step.sign_change_brackets(Kind.FOLD):
            raise NoConvergenceError("too long")
        return located(step)

    tracer.locate_bifurcations = fail_in_long_steps
    segment = tracer.trace(tracer.start)
    assert segment.bifurcations[0].point.unknowns == pytest.approx([1.0, 0.0], abs=1e-12)
    assert min(lengths) <= 0.01
    tracer = CircleTracer()
    tracer.locate_bifurcations = lambda step: (_ for _ in ()).throw(NoConvergenceError("never"))
    assert tracer.trace(tracer.start).end == NO_CONVERGENCE


@pytest.mark.parametrize("method", ["fit_impacts_to_step", "move_stepper_to", "make_point"])
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
