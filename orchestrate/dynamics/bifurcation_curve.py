"""Equations of a bifurcation followed over two parameters: orbit and bifurcation condition.

How nearly singular the orbit's matrix with a multiplier on the unit circle is, the bordered system
says (Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, 2000, chapter 4).
Grazings and earlier releases have equations of their own: with a preload and no impacts the latter
is the level at which the structure first opens.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .bifurcation_kinds import KINDS, Kind
from .closed_form import Floats
from .continuation import NoConvergenceError, Root, leading_index
from .families import Family, central_difference
from .orbit_tracer import OrbitPoint
from .periodic_orbit import CLOSING, PeriodicOrbit
from .tracer import BranchStep, BranchTracer
from .turning_points import (
    GAP,
    contact_pressure_and_derivatives,
    nearest_miss,
    rate_curvature_and_value,
    weakest_force,
)

SMOOTH_KINDS = (Kind.FOLD, Kind.FLIP, Kind.TORUS)
FOLLOWED = (*SMOOTH_KINDS, Kind.GRAZING, Kind.TOUCHING, Kind.EARLIER_RELEASE)
OVERLAP = 1e-9  # over a eta^2: a gap, or a force, smaller by this than zero is no rounding
FREE = -np.inf, np.inf  # limits of an unknown that is no parameter


@dataclass
class BifurcationCurve:
    """Equations of an orbit at a bifurcation, as a curve over two parameters."""

    family: Family  # of two parameters
    kind: int
    node: int  # that grazes, or the segment that touches or is released: its index, else -1
    # the unknown that the kind adds, at the start: the multiplier's angle, or the phase of touching
    # or of the release
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
            _, node, phase = nearest_miss(point.orbit)
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

    def orbit(self, unknowns: Floats) -> PeriodicOrbit:
        return self.family.orbit(unknowns[: self.family.node_unknowns + 2])

    def update_bordering_vectors(self, unknowns: Floats) -> None:
        """Reset the bordering vectors to the singular vectors of the matrix at these unknowns."""
        if self.kind in SMOOTH_KINDS:
            left, _, right = np.linalg.svd(self.scaled_orbit_jacobian(unknowns))
            self.columns = rotate_leading_component_to_real(left[:, -1])
            self.rows = rotate_leading_component_to_real(right[-1].conj())

    def scaled_orbit_jacobian(self, unknowns: Floats) -> NDArray[np.complex128]:
        """Return the orbit's scaled Jacobian at the multiplier on the unit circle: singular."""
        multiplier: complex = 1.0 if self.kind == Kind.FOLD else -1.0
        if self.kind == Kind.TORUS:
            multiplier = complex(np.exp(1j * unknowns[-1]))
        matrix = self.orbit(unknowns).jacobian(multiplier)
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
        bordered = bordered_orbit_jacobian(self, unknowns)
        defect = np.linalg.solve(bordered, np.eye(len(bordered))[-1])[-1]
        return np.array([defect.real, defect.imag] if self.kind == Kind.TORUS else [defect.real])

    def residual(self, unknowns: Floats) -> Floats:
        orbit = self.family.residual(unknowns[: self.family.node_unknowns + 2])
        return np.append(orbit, self.bifurcation_condition(unknowns))

    def jacobian(self, unknowns: Floats, at_root: bool = False) -> Floats:
        """Return the residual's Jacobian, the bifurcation condition's rows by differences."""
        limits = enumerate(self.family.setting.limits, self.family.node_unknowns)
        return self.jacobian_with(self.bifurcation_condition, unknowns, dict(limits))

    def jacobian_with(
        self,
        conditions: Callable[[Floats], Floats],
        unknowns: Floats,
        limits: Mapping[int, tuple[float, float]],
    ) -> Floats:
        """Return the Jacobian of the orbit's equations and of conditions, these by differences."""
        orbit = self.family.jacobian(unknowns[: self.family.node_unknowns + 2])
        blank = np.zeros((len(orbit), len(unknowns) - orbit.shape[1]))
        columns = [
            central_difference(conditions, unknowns, i, *limits.get(i, FREE), step=1e-6 * scale)
            for i, scale in enumerate(self.scale[: len(unknowns)])
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
        if nearest_miss(orbit)[0] < -OVERLAP:
            return "a flight grazes" if self.kind != Kind.TOUCHING else "another flight grazes"
        if weakest_force(orbit)[0] < -OVERLAP:
            earlier = self.kind == Kind.EARLIER_RELEASE
            return "a still earlier release" if earlier else "an earlier release"
        if self.kind == Kind.TORUS and not 0.0 < unknowns[-1] < np.pi:
            return "a resonance 1:1 or 1:2"
        return ""


def bordered_orbit_jacobian(curve: BifurcationCurve, unknowns: Floats) -> NDArray[np.complex128]:
    """Return the orbit's scaled Jacobian with the curve's bordering vectors: it is regular."""
    size = curve.family.node_unknowns
    bordered = np.zeros((size + 1, size + 1), dtype=complex)
    bordered[:size, :size] = curve.scaled_orbit_jacobian(unknowns)
    bordered[:size, size], bordered[size, :size] = curve.columns, curve.rows.conj()
    return bordered


def rotate_leading_component_to_real(vector: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Rotate a complex vector so that its leading component is real and positive."""
    first = vector[leading_index(vector)]
    return np.asarray(vector * (first.conjugate() / abs(first)), dtype=complex)


class BifurcationTracer(BranchTracer[BifurcationCurve, Root]):
    """Traces a bifurcation over two parameters by pseudo-arclength continuation."""

    def make_point(self, root: Root) -> Root:
        return root

    def first_limited_unknown_and_limits(self) -> tuple[int, Sequence[tuple[float, float]]]:
        family = self.stepper.curve.family
        return family.node_unknowns, family.setting.limits

    def move_stepper_to(self, point: Root) -> Root:
        self.stepper.root = point
        self.stepper.curve.update_bordering_vectors(point.unknowns)
        return point

    def end_reason_and_last_points(self, step: BranchStep[Root]) -> tuple[str, Iterable[Root]]:
        """Return why the curve ends within a step, and the last root that is a possible motion."""
        last: list[Root] = []
        reason = self.stepper.curve.why_no_motion(step.after.unknowns)
        if not reason:
            return "", last
        low, high = 0.0, step.length
        with contextlib.suppress(NoConvergenceError):
            for _ in range(24):  # its end is known to 1e-7 of the step then
                middle = 0.5 * (low + high)
                root = self.stepper.root_after(middle)
                if self.stepper.curve.why_no_motion(root.unknowns):
                    high = middle
                else:
                    low, last = middle, [root]
        return reason, last
