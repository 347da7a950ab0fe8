"""Equations of a bifurcation followed over two parameters: orbit and bifurcation condition.

How nearly singular the orbit's matrix with a multiplier on the unit circle is, the bordered system
says (Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, 2000, chapter 4).
Grazings and earlier releases have equations of their own: with a preload and no impacts the latter
is the level at which the structure first opens.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .bifurcation_kinds import KINDS, Kind
from .closed_form import Floats
from .continuation import ArclengthStepper, NoConvergenceError, Root, leading_index
from .families import Family, central_difference
from .orbit_tracer import OrbitPoint
from .periodic_orbit import CLOSING, PeriodicOrbit
from .tracer import BranchStep, BranchTracer, ContinuationSettings
from .turning_points import (
    GAP,
    contact_pressure_and_derivatives,
    nearest_miss,
    rate_curvature_and_value,
    turning_points,
    weakest_force,
)

REAL_MULTIPLIERS: dict[int, float] = {Kind.FOLD: 1.0, Kind.FLIP: -1.0}
SMOOTH_KINDS = (Kind.FOLD, Kind.FLIP, Kind.TORUS)
FOLLOWED = (*SMOOTH_KINDS, Kind.GRAZING, Kind.TOUCHING, Kind.EARLIER_RELEASE)
OVERLAP = 1e-9  # over a eta^2: a gap, or a force, smaller by this than zero is no rounding


@dataclass
class BifurcationCurve:
    """Equations of an orbit at a bifurcation, as a curve over two parameters."""

    family: Family  # of two parameters
    kind: int
    node: int  # that grazes, or the segment that touches or is released: its index, else -1
    # what the kind adds, at the start: the multiplier's angle, or the phase of touching or of the
    # release
    extra: Floats
    scale: Floats = field(init=False)
    columns: NDArray[np.complex128] = field(init=False)
    rows: NDArray[np.complex128] = field(init=False)

    def __post_init__(self) -> None:
        self.scale = np.append(self.family.scale, np.ones(len(self.extra)))

    @classmethod
    def from_orbit(cls, family: Family, point: OrbitPoint, kind: int) -> BifurcationCurve:
        node, extra = -1, np.zeros(0)
        if kind == Kind.TORUS:
            which = np.abs(np.abs(point.upper_multipliers) - 1.0).argmin()
            extra = np.array([np.angle(point.upper_multipliers[which])])
        elif kind == Kind.GRAZING:
            released = point.orbit.sequence.releases
            node = int(np.where(released, np.inf, point.orbit.nodes[:, CLOSING]).argmin())
        elif kind == Kind.TOUCHING:
            _, node, phase = nearest_miss(point.orbit, turning_points(point.orbit))
            extra = np.array([phase])
        elif kind == Kind.EARLIER_RELEASE:
            _, node, phase = weakest_force(point.orbit)
            extra = np.array([phase])
        elif kind not in SMOOTH_KINDS:
            expected = ", ".join(KINDS[known] for known in FOLLOWED)
            raise InputError(f"bifurcation: {KINDS[kind]}; expected one of {expected}")
        return cls(family, kind, node, extra)

    @property
    def accuracy(self) -> float:
        return self.family.accuracy

    @property
    def first_parameter_index(self) -> int:
        return self.family.node_unknowns

    def critical_multiplier(self, unknowns: Floats) -> complex:
        """Return the Floquet multiplier on the unit circle at this bifurcation."""
        if self.kind == Kind.TORUS:
            return complex(np.exp(1j * unknowns[-1]))
        return REAL_MULTIPLIERS[self.kind]

    def orbit(self, unknowns: Floats) -> PeriodicOrbit:
        return self.family.orbit(unknowns[: self.family.node_unknowns + 2])

    def update_bordering_vectors(self, unknowns: Floats) -> None:
        """Reset the bordering vectors to the singular vectors of the matrix at these unknowns."""
        if self.kind in SMOOTH_KINDS:
            left, _, right = np.linalg.svd(self.scaled_orbit_jacobian(unknowns))
            self.columns = rotate_leading_component_to_real(left[:, -1])
            self.rows = rotate_leading_component_to_real(right[-1].conj())

    def scaled_orbit_jacobian(self, unknowns: Floats) -> NDArray[np.complex128]:
        """Return the orbit's scaled Jacobian at the multiplier: singular at the bifurcation."""
        matrix = self.orbit(unknowns).jacobian(self.critical_multiplier(unknowns))
        return np.asarray(matrix * self.scale[: self.family.node_unknowns], dtype=complex)

    def bifurcation_condition(self, unknowns: Floats) -> Floats:
        """Return what is zero at the bifurcation: one number, two if the kind adds an unknown."""
        if self.kind == Kind.GRAZING:
            return self.orbit(unknowns).nodes[self.node, CLOSING : CLOSING + 1]
        if self.kind == Kind.TOUCHING:
            which = np.array([self.node]), np.array([GAP])
            orbit = self.orbit(unknowns)
            rate, _, gap = rate_curvature_and_value(orbit, *which, unknowns[-1:])
            return np.append(np.minimum(gap, orbit.form.limit - gap), rate)
        if self.kind == Kind.EARLIER_RELEASE:
            force, rate, _ = contact_pressure_and_derivatives(
                self.orbit(unknowns), np.array([self.node]), unknowns[-1:]
            )
            return np.append(force, rate)
        size = self.family.node_unknowns
        bordered = np.zeros((size + 1, size + 1), dtype=complex)
        bordered[:size, :size] = self.scaled_orbit_jacobian(unknowns)
        bordered[:size, size], bordered[size, :size] = self.columns, self.rows.conj()
        defect = np.linalg.solve(bordered, np.eye(size + 1)[-1])[-1]
        return np.array([defect.real, defect.imag] if self.kind == Kind.TORUS else [defect.real])

    def residual(self, unknowns: Floats) -> Floats:
        orbit = self.family.residual(unknowns[: self.family.node_unknowns + 2])
        return np.append(orbit, self.bifurcation_condition(unknowns))

    def jacobian(self, unknowns: Floats, at_root: bool = False) -> Floats:
        """Return the residual's Jacobian, the bifurcation condition's rows by differences."""
        orbit = self.family.jacobian(unknowns[: self.family.node_unknowns + 2])
        blank = np.zeros((len(orbit), len(self.extra)))
        spans = [(-np.inf, np.inf)] * self.family.node_unknowns
        limits = [*spans, *self.family.setting.limits, *[(-np.inf, np.inf)] * len(self.extra)]
        columns = [
            central_difference(self.bifurcation_condition, unknowns, i, *limit, step=1e-6 * scale)
            for i, (limit, scale) in enumerate(zip(limits, self.scale, strict=True))
        ]
        return np.vstack([np.hstack([orbit, blank]), np.array(columns).T])

    def why_no_motion(self, unknowns: Floats) -> str:
        """Return why the orbit is no possible motion, or no longer at this bifurcation; or ""."""
        orbit = self.orbit(unknowns)
        closing = np.where(orbit.sequence.releases, np.inf, orbit.nodes[:, CLOSING])
        if self.kind == Kind.GRAZING:
            closing[self.node] = np.inf
        if (closing <= 0.0).any():
            return "another impact grazes"
        if (orbit.durations <= 0.0).any():
            return "impacts change their order"
        if nearest_miss(orbit, turning_points(orbit))[0] < -OVERLAP:
            return "a flight grazes" if self.kind != Kind.TOUCHING else "another flight grazes"
        if weakest_force(orbit)[0] < -OVERLAP:
            earlier = self.kind == Kind.EARLIER_RELEASE
            return "a still earlier release" if earlier else "an earlier release"
        if self.kind == Kind.TORUS and not 0.0 < unknowns[-1] < np.pi:
            return "a resonance 1:1 or 1:2"
        return ""


def rotate_leading_component_to_real(vector: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Rotate a complex vector so that its leading component is real and positive."""
    first = vector[leading_index(vector)]
    return np.asarray(vector * (first.conjugate() / abs(first)), dtype=complex)


class BifurcationTracer(BranchTracer[BifurcationCurve, Root]):
    """Traces a bifurcation over two parameters by pseudo-arclength continuation."""

    def __init__(
        self, curve: BifurcationCurve, start: Root, settings: ContinuationSettings
    ) -> None:
        # short, as the curve is not known yet
        first, longest = min(1e-3, settings.max_step), settings.max_step
        super().__init__(ArclengthStepper(curve, start, first, longest), settings.max_points)

    def make_point(self, root: Root) -> Root:
        return root

    def first_limited_unknown_and_limits(self) -> tuple[int, Sequence[tuple[float, float]]]:
        curve = self.stepper.curve
        return curve.first_parameter_index, curve.family.setting.limits

    def move_stepper_to(self, point: Root) -> Root:
        self.stepper.root = point
        self.stepper.curve.update_bordering_vectors(point.unknowns)
        return point

    def end_reason_and_last_points(self, step: BranchStep[Root]) -> tuple[str, Iterable[Root]]:
        reason = self.stepper.curve.why_no_motion(step.after.unknowns)
        return reason, self.bisect_for_last_motion(step) if reason else ()

    def bisect_for_last_motion(self, step: BranchStep[Root]) -> list[Root]:
        """Bisect a step for its last root that is a possible motion; return [root], or []."""
        low, high = 0.0, step.length
        last: list[Root] = []
        for _ in range(24):  # its end is known to 1e-7 of the step then
            middle = 0.5 * (low + high)
            try:
                root = self.stepper.root_after(middle)
            except NoConvergenceError:
                return last
            if self.stepper.curve.why_no_motion(root.unknowns):
                high = middle
            else:
                low, last = middle, [root]
        return last
