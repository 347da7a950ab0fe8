"""Equations of periodic orbits with a fixed sequence of impacts, over varying parameters."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import InputError
from ..model import PARAMETERS, Structure
from ..model.ranges import PUSHES
from ..model.spelling import expected_one_of
from ..response.questions import QUANTITIES, Point, make_point
from .closed_form import ClosedForm, Floats
from .periodic_orbit import POSITION, ImpactSequence, PeriodicOrbit

RESIDUAL = 1e-10  # of the motion's size: what a root may leave of the equations


@dataclass(frozen=True)
class Setting:
    """A structure and excitation with the names and limits of the parameters that vary."""

    structure: Structure
    # `eta`, or `frequency` and `amplitude`, and the loads other than the box's harmonic motion
    excitation: tuple[tuple[str, float], ...]
    over: tuple[str, ...]  # names of the parameters that vary
    limits: tuple[tuple[float, float], ...]  # between which

    @classmethod
    def fixed(cls, structure: Structure, excitation: tuple[tuple[str, float], ...]) -> Setting:
        """Return a setting for a single orbit, in which parameters do not really vary."""
        name, value = excitation[0]
        limits = (value * 0.999, value * 1.001)  # only the parameter's scale matters
        return cls(structure, excitation, (name,), (limits,))

    def point(self, values: Floats) -> Point:
        """Return structure and excitation at values of the parameters that vary."""
        varied = zip(self.over, map(float, values), strict=True)
        return make_point(self.structure, {**dict(self.excitation), **dict(varied)})

    def closed_form(self, values: Floats) -> ClosedForm:
        return cached_closed_form(self, np.asarray(values, dtype=float).tobytes())


@functools.lru_cache(maxsize=64)
def cached_closed_form(setting: Setting, values: bytes) -> ClosedForm:
    """Return the coefficients at values of the varying parameters, given as the array's bytes."""
    point = setting.point(np.frombuffer(values))
    point.excitation.check(point.structure)
    return ClosedForm.from_structure(*point)


def nonzero_pushes(pushes: Mapping[str, Any]) -> tuple[tuple[str, float], ...]:
    """Return the loads other than the box's harmonic motion, as (name, number), where not zero."""
    return tuple((name, float(pushes[name])) for name in PUSHES if pushes[name] != 0.0)


def require_known_parameters(over: tuple[str, ...]) -> None:
    box = (name for name in QUANTITIES if name != "level")  # the amplitude varies instead
    known = (*box, *PARAMETERS)
    for name in over:
        if not isinstance(name, str) or name not in known:
            raise InputError(f"over = {name!r}: no parameter; {expected_one_of(name, known)}")


@dataclass
class Family:
    """Equations of orbits with one impact sequence; unknowns: nodes, then parameters."""

    setting: Setting
    sequence: ImpactSequence
    scale: Floats  # sizes of the unknowns
    fixed: bool = False  # whether Newton's method solves for the nodes at fixed parameters
    last: tuple[bytes, PeriodicOrbit] | None = None  # residual and Jacobian ask for the same

    @classmethod
    def from_nodes(cls, setting: Setting, sequence: ImpactSequence, nodes: Floats) -> Family:
        """Return the equations, scaled by the nodes of one of their orbits."""
        size = max(float(np.abs(nodes[:, 1:]).max(initial=0.0)), 1e-3)  # all but at rest
        spans = [high - low for low, high in setting.limits]
        each = np.tile([1.0, size, size, size], len(nodes)) * np.sqrt(max(len(nodes), 1))
        return cls(setting, sequence, np.append(each, spans))

    @property
    def node_unknowns(self) -> int:
        """Return the number of unknowns that are node coordinates (four per node)."""
        return 4 * len(self.sequence.kinds)

    @property
    def accuracy(self) -> float:
        if not self.node_unknowns:
            return RESIDUAL
        return RESIDUAL * float(self.scale[POSITION]) / np.sqrt(len(self.sequence.kinds))

    def orbit(self, unknowns: Floats) -> PeriodicOrbit:
        key = unknowns.tobytes()
        if self.last is None or self.last[0] != key:
            count = self.node_unknowns
            form = self.setting.closed_form(unknowns[count:])
            nodes = unknowns[:count].copy().reshape(-1, 4)
            self.last = key, PeriodicOrbit(self.sequence, form, nodes)
        return self.last[1]

    def residual(self, unknowns: Floats) -> Floats:
        return self.orbit(unknowns).residual()

    def jacobian(self, unknowns: Floats, at_root: bool = False) -> Floats:
        """Return the residual's Jacobian: exact by nodes, by differences by parameters."""
        count, limits = self.node_unknowns, self.setting.limits
        columns = np.zeros((count, len(limits)))  # those of fixed ones only at the root
        if at_root or not self.fixed:
            for i, (low, high) in enumerate(limits):
                columns[:, i] = central_difference(self.residual, unknowns, count + i, low, high)
        return np.hstack([self.orbit(unknowns).jacobian().real, columns])


def central_difference(
    function: Callable[[Floats], Floats],
    unknowns: Floats,
    which: int,
    low: float,
    high: float,
    step: float = 0.0,
) -> Floats:
    """Return a function's derivative by one unknown, by differences within its limits."""
    value = unknowns[which]
    step = step or 1e-6 * max(abs(value), 1e-3 * (high - low))
    ends = []
    for end in (value - step, value + step):
        moved = unknowns.copy()
        moved[which] = min(max(end, min(low, value)), max(high, value))
        ends.append((function(moved), moved[which]))
    (before, first), (after, last) = ends
    return np.asarray((after - before) / (last - first))
