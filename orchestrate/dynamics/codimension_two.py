"""Locate points of codimension two on a bifurcation curve, by test functions.

Names and conditions: Kuznetsov, Elements of Applied Bifurcation Theory, chapter 9, for maps; Thota
and Dankowicz, SIAM Journal on Applied Dynamical Systems 5, 672 (2006), for grazing. All but cusps
are signs of the polynomial whose roots are the multipliers: it is finite where an impact grazes and
multipliers are not. A point is located by Brent's method on the curve, or where the curve ends by
Newton's on the equations of the point.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .bifurcation_curve import BifurcationCurve, bordered_orbit_jacobian
from .bifurcation_kinds import Kind, NamedKind
from .closed_form import Floats
from .continuation import (
    SOLVER_ERRORS,
    ArclengthStepper,
    NoConvergenceError,
    Root,
    solve_by_brent,
    solve_linear,
)
from .orbit_tracer import unit_circle_test
from .periodic_orbit import CLOSING, PeriodicOrbit
from .turning_points import nearest_miss

DEGREE = 4  # of D: as many multipliers as states
LOCATED = 1e-6  # a located point's test function, at most: what is above is no root of it
TOLERANCE = {"xtol": 1e-14, "rtol": 1e-14}  # of Brent's method, in unknowns over their scale


class PointKind(NamedKind):
    """Kinds of codimension-two points on a bifurcation curve."""

    CUSP = 0, "cusp"
    FOLD_FLIP = 1, "fold-flip"
    RESONANCE_1 = 2, "resonance 1:1"
    RESONANCE_2 = 3, "resonance 1:2"
    RESONANCE_3 = 4, "resonance 1:3"
    RESONANCE_4 = 5, "resonance 1:4"
    FOLD_TORUS = 6, "fold-Neimark-Sacker"
    FLIP_TORUS = 7, "flip-Neimark-Sacker"
    GRAZING_FOLD = 8, "grazing fold"
    GRAZING_FLIP = 9, "grazing period doubling"
    GRAZING_TORUS = 10, "grazing Neimark-Sacker"


POINT_KINDS: dict[int, str] = {kind: kind.label for kind in PointKind}
ON_CURVE: dict[int, tuple[PointKind, ...]] = {  # with a test function, by the curve's kind
    Kind.FOLD: (PointKind.CUSP, PointKind.FOLD_FLIP, PointKind.RESONANCE_1, PointKind.FOLD_TORUS),
    Kind.FLIP: (PointKind.FOLD_FLIP, PointKind.RESONANCE_2, PointKind.FLIP_TORUS),
    Kind.TORUS: (
        *(PointKind.RESONANCE_3, PointKind.RESONANCE_4),
        *(PointKind.FOLD_TORUS, PointKind.FLIP_TORUS),
    ),
    Kind.GRAZING: (PointKind.GRAZING_FOLD, PointKind.GRAZING_FLIP),
    Kind.TOUCHING: (PointKind.GRAZING_FOLD, PointKind.GRAZING_FLIP),
}
GRAZES: dict[int, PointKind] = {
    Kind.FOLD: PointKind.GRAZING_FOLD,
    Kind.FLIP: PointKind.GRAZING_FLIP,
    Kind.TORUS: PointKind.GRAZING_TORUS,
}
ANGLES = {PointKind.RESONANCE_3: 2.0 * np.pi / 3.0, PointKind.RESONANCE_4: 0.5 * np.pi}


@dataclass(frozen=True)
class CodimensionTwoPoint:
    """A codimension-two point: its kind, the root there, and its position on the curve."""

    kind: PointKind
    unknowns: Floats  # those of the nodes, and both parameters
    # among the curve's points: between two numbers where it lies between two points
    position: float
    residual: float  # what is left of its two conditions, of D over its largest coefficient


class CharacteristicPolynomial:
    """Characteristic polynomial of an orbit's monodromy matrix: roots are multipliers.

    Its largest coefficient is 1, or smaller where that of others, ``log_size``, was larger: beside
    a wall all of it may vanish.
    """

    def __init__(self, orbit: PeriodicOrbit, scale: Floats, log_size: float = -np.inf) -> None:
        circle = np.exp(2j * np.pi * np.arange(DEGREE + 1) / (DEGREE + 1))
        signs, logs = zip(
            *(np.linalg.slogdet(orbit.jacobian(complex(z)) * scale) for z in circle), strict=True
        )
        largest = max(logs)
        if not np.isfinite(largest):
            raise NoConvergenceError("the orbit's matrix is singular for all multipliers")
        values = np.array(signs) * np.exp(np.array(logs) - largest)
        coefficients = np.fft.fft(values).real / (DEGREE + 1)
        with np.errstate(divide="ignore"):
            self.log_size = max(largest + np.log(np.abs(coefficients).max()), log_size)
        self.coefficients: Floats = coefficients * np.exp(largest - self.log_size)

    def __call__(self, multiplier: complex) -> complex:
        return complex(np.polynomial.polynomial.polyval(multiplier, self.coefficients))

    def slope(self, multiplier: float) -> float:
        polynomial = np.polynomial.Polynomial(self.coefficients)
        return float(polynomial.deriv()(multiplier))

    def other_multipliers(self, multiplier: float) -> NDArray[np.complex128]:
        """Return the other three roots where one multiplier is known."""
        quotient, _ = np.polydiv(self.coefficients[::-1], np.array([1.0, -multiplier]))
        return np.asarray(np.roots(quotient), dtype=complex)


def locate_codimension_two_points(
    curve: BifurcationCurve, roots: list[Root], end_reasons: tuple[str, str]
) -> list[CodimensionTwoPoint]:
    """Locate all points along a curve's roots in their order, at its ends too."""
    points = list(locate_end_point(curve, roots[0], end_reasons[0], 0.0))
    for index, (before, after) in enumerate(zip(roots[:-1], roots[1:], strict=True)):
        points += sorted(
            locate_points_between(curve, before, after, float(index)),
            key=lambda each: each.position,
        )
    if len(roots) > 1:
        points += locate_end_point(curve, roots[-1], end_reasons[1], len(roots) - 1.0)
    return points


def locate_points_between(
    curve: BifurcationCurve, before: Root, after: Root, index: float
) -> Iterator[CodimensionTwoPoint]:
    """Yield the points between a root, with its index on the curve, and the next one."""
    curve.update_bordering_vectors(before.unknowns)
    chord = (after.unknowns - before.unknowns) / curve.scale
    before, after = (
        root if root.tangent @ chord > 0.0 else root.reversed() for root in (before, after)
    )
    length = float(chord @ before.tangent)
    stepper = ArclengthStepper(curve, before, length, length)
    try:
        polynomials = [characteristic_polynomial(curve, root.unknowns) for root in (before, after)]
    except SOLVER_ERRORS:
        return
    log_size = max(polynomial.log_size for polynomial in polynomials)
    for kind in ON_CURVE.get(curve.kind, ()):

        def value(position: float, kind: PointKind = kind) -> float:
            root = stepper.root_after(position) if position else before
            return test_function_value(curve, root, kind, log_size=log_size)

        try:
            ends = [
                test_function_value(curve, root, kind, polynomial)
                for root, polynomial in zip((before, after), polynomials, strict=True)
            ]
            changes = np.isfinite(ends).all() and ends[0] * ends[1] < 0.0
            if not (changes and ends[0] * value(length) < 0.0):  # else it is only rounding
                continue
            position = solve_by_brent(value, 0.0, length, **TOLERANCE)
            root = stepper.root_after(position)
            residual = abs(test_function_value(curve, root, kind, log_size=log_size))
            is_point = residual < LOCATED and is_point_of_kind(curve, root, kind)
        except SOLVER_ERRORS:
            continue
        if is_point:
            unknowns = root.unknowns[: curve.family.node_unknowns + 2]
            yield CodimensionTwoPoint(kind, unknowns, index + position / length, residual)


def characteristic_polynomial(
    curve: BifurcationCurve, unknowns: Floats, log_size: float = -np.inf
) -> CharacteristicPolynomial:
    scale = curve.scale[: curve.family.node_unknowns]
    return CharacteristicPolynomial(curve.orbit(unknowns), scale, log_size)


def test_function_value(
    curve: BifurcationCurve,
    root: Root,
    kind: PointKind,
    polynomial: CharacteristicPolynomial | None = None,
    log_size: float = -np.inf,
) -> float:
    """Return a kind's test function at a root; the polynomial is computed unless it is known."""
    if kind in ANGLES:
        return float(root.unknowns[-1] - ANGLES[kind])
    if kind == PointKind.CUSP:
        return cusp_test(curve, root)
    polynomial = polynomial or characteristic_polynomial(curve, root.unknowns, log_size)
    if kind == PointKind.RESONANCE_1:
        return polynomial.slope(1.0)
    if kind == PointKind.RESONANCE_2:
        return polynomial.slope(-1.0)
    if kind in (PointKind.FOLD_TORUS, PointKind.FLIP_TORUS) and curve.kind != Kind.TORUS:
        others = polynomial.other_multipliers(1.0 if kind == PointKind.FOLD_TORUS else -1.0)
        return unit_circle_test(others, pairs=True)
    fold = kind in (PointKind.FOLD_TORUS, PointKind.GRAZING_FOLD)
    fold = fold or kind == PointKind.FOLD_FLIP and curve.kind == Kind.FLIP
    return polynomial(1.0 if fold else -1.0).real


def cusp_test(curve: BifurcationCurve, root: Root) -> float:
    """Return the test function of a cusp: the fold's speed in the parameter plane, signed."""
    # along a fold the motion is orthogonal to what the left null vector makes of the parameters'
    # derivatives: its sign on that line changes at a cusp
    size = curve.family.node_unknowns
    bordered = bordered_orbit_jacobian(curve, root.unknowns).real
    left = np.linalg.solve(bordered.T, np.eye(size + 1)[-1])[:size]
    derivative = curve.family.jacobian(root.unknowns[: size + 2])[:, size:]
    normal = left @ (derivative * curve.scale[size : size + 2])
    along = root.tangent[size : size + 2]
    return float(along @ np.array([-normal[1], normal[0]]) / np.linalg.norm(normal))


def is_point_of_kind(curve: BifurcationCurve, root: Root, kind: PointKind) -> bool:
    """Return whether a test function's zero is truly such a point (pair on the unit circle)."""
    # two real multipliers may have the product 1 too
    if kind not in (PointKind.FOLD_TORUS, PointKind.FLIP_TORUS) or curve.kind == Kind.TORUS:
        return True
    real = 1.0 if kind == PointKind.FOLD_TORUS else -1.0
    others = characteristic_polynomial(curve, root.unknowns).other_multipliers(real)
    pair = others[others.imag > 0.0]
    return bool((np.abs(np.abs(pair) - 1.0) < 1e-6).any())


# -- where a curve ends ----------------------------------------------------------------------------


def locate_end_point(
    curve: BifurcationCurve, root: Root, reason: str, position: float
) -> Iterator[CodimensionTwoPoint]:
    """Yield the point at which a curve ends for this reason, if it is one of codimension two."""
    grazes = reason in ("another impact grazes", "a flight grazes")
    if curve.kind == Kind.TORUS and "resonance" in reason:
        first = root.unknowns[-1] < 0.5 * np.pi
        kind = PointKind.RESONANCE_1 if first else PointKind.RESONANCE_2
    elif curve.kind in GRAZES and grazes:
        kind = GRAZES[curve.kind]
    else:
        return
    try:
        yield solve_end_point(curve, root, kind, reason, position)
    except (*SOLVER_ERRORS, InputError):
        return


def solve_end_point(
    curve: BifurcationCurve, root: Root, kind: PointKind, reason: str, position: float
) -> CodimensionTwoPoint:
    """Solve by Newton's method for the point next to a curve's last root."""
    size = curve.family.node_unknowns + 2
    resonance = kind in (PointKind.RESONANCE_1, PointKind.RESONANCE_2)
    curve.update_bordering_vectors(root.unknowns)

    def conditions(unknowns: Floats) -> Floats:
        if resonance:
            polynomial = characteristic_polynomial(curve, unknowns)
            at = 1.0 if kind == PointKind.RESONANCE_1 else -1.0
            return np.array([polynomial(at).real, polynomial.slope(at)])
        orbit = curve.orbit(unknowns)
        closing = orbit.nodes[~orbit.sequence.releases, CLOSING]
        flight = reason == "a flight grazes"
        grazing = nearest_miss(orbit)[0] if flight else closing[np.abs(closing).argmin()]
        return np.append(curve.bifurcation_condition(unknowns), grazing)

    unknowns = root.unknowns[:size] if resonance else root.unknowns
    scale, first = curve.scale[: len(unknowns)], unknowns.copy()
    for _ in range(20):
        matrix = curve.jacobian_with(conditions, unknowns, {}) * scale
        residual = np.append(curve.family.residual(unknowns[:size]), conditions(unknowns))
        step = solve_linear(matrix, residual)
        unknowns = unknowns - scale * step
        if np.abs((unknowns - first) / scale).max() > 0.1:
            raise NoConvergenceError("Newton's method went too far")
        if np.abs(step).max() < 1e-9:
            left = float(np.abs(conditions(unknowns)).max())
            orbit_left = float(np.abs(curve.family.residual(unknowns[:size])).max())
            if not (left <= LOCATED and orbit_left <= curve.accuracy):
                raise NoConvergenceError(f"no root: the residuals are {orbit_left:.0e}, {left:.0e}")
            return CodimensionTwoPoint(kind, unknowns[:size], position, left)
    raise NoConvergenceError("no root after 20 iterations")
