"""Finite-element model of an Euler-Bernoulli beam with a through-width delamination.

Over the delamination the beam is two beams, one upon the other, each with its own axis, that share
the cross-sections where the delamination ends: the four beams of Mujumdar and Suryanarayan (Journal
of Sound and Vibration 125, 1988, 441-461). Their nodes touch by a penalty. What moves is a sum of
modes of the beam without contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from orchestrate.constants import TURN

from .lumped import Faces
from .system import Contacts, Floats, ModalSystem

AXIAL, DEFLECTION, SLOPE = range(3)  # of a node's displacements


@dataclass(frozen=True, kw_only=True)
class Section:
    """Cross-section per length: stiffness EI in N m2, EA in N, mass in kg/m."""

    bending: float
    axial: float
    mass: float

    def stiffness(self, length: float) -> Floats:
        """Return an element's stiffness matrix, for (u, w, slope) at both ends."""
        b = self.bending / length**3
        k = np.zeros((6, 6))
        k[np.ix_([0, 3], [0, 3])] = self.axial / length * np.array([[1.0, -1.0], [-1.0, 1.0]])
        half, full = 6.0 * length, 2.0 * length**2
        rows = [
            [12.0, half, -12.0, half],
            [half, 2.0 * full, -half, full],
            [-12.0, -half, 12.0, -half],
            [half, full, -half, 2.0 * full],
        ]
        k[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = b * np.array(rows)
        return k

    def inertia(self, length: float) -> Floats:
        """Return an element's consistent mass matrix, without rotary inertia."""
        m = np.zeros((6, 6))
        m[np.ix_([0, 3], [0, 3])] = self.mass * length / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
        a, b, c = 22.0 * length, 13.0 * length, length**2
        rows = [
            [156.0, a, 54.0, -b],
            [a, 4.0 * c, b, -3.0 * c],
            [54.0, b, 156.0, -a],
            [-b, -3.0 * c, -a, 4.0 * c],
        ]
        m[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = self.mass * length / 420.0 * np.array(rows)
        return m


@dataclass(frozen=True, kw_only=True)
class DelaminatedBeam:
    """A beam clamped at one end or both, delaminated between two positions."""

    # m
    length: float = 0.5
    thickness: float = 0.0148
    width: float = 0.03
    # N/m2, kg/m3
    modulus: float = 40e9
    density: float = 1800.0
    # where the delamination begins and ends, parts of the length; equal where there is none. `last
    # = 1` opens at the free end
    first: float = 0.4
    last: float = 1.0
    share: float = 0.4  # thickness of the upper beam, parts of the whole
    clamped_both: bool = False
    elements: int = 40  # over the whole length

    def section(self, share: float) -> Section:
        """Return the cross-section of a layer that has a share of the thickness."""
        h = share * self.thickness
        area, inertia = h * self.width, self.width * h**3 / 12.0
        bending, axial = self.modulus * inertia, self.modulus * area
        return Section(bending=bending, axial=axial, mass=self.density * area)

    @cached_property
    def nodes(self) -> Floats:
        """Positions of the nodes, m; the delamination's ends are among them."""
        ends = np.unique([0.0, self.first, self.last, 1.0])
        counts = [max(2, round(part * self.elements)) for part in np.diff(ends)]
        parts = [
            np.linspace(a, b, n, endpoint=False)
            for a, b, n in zip(ends[:-1], ends[1:], counts, strict=True)
        ]
        return self.length * np.append(np.concatenate(parts), 1.0)

    @cached_property
    def inside(self) -> NDArray[np.bool_]:
        """Whether nodes lie in the delamination, its ends included."""
        share, margin = self.nodes / self.length, 1e-9
        low, high = self.first - margin, self.last + margin
        return np.asarray((self.last > self.first) & (share >= low) & (share <= high))

    @cached_property
    def node_numbers(self) -> dict[tuple[int, int], int]:
        """Number of each pair (layer, node); layer 0 is the whole beam, 1 and 2 its halves."""
        layers = [(1, 2) if split else (0,) for split in self.inside]
        pairs = [(layer, node) for node, some in enumerate(layers) for layer in some]
        return {pair: number for number, pair in enumerate(pairs)}

    @cached_property
    def matrices(self) -> tuple[Floats, Floats, Floats]:
        """Return stiffness, mass matrix and base excitation of the free displacements."""
        size = 3 * len(self.node_numbers)
        stiffness, inertia = np.zeros((size, size)), np.zeros((size, size))
        sections = [self.section(share) for share in (1.0, self.share, 1.0 - self.share)]
        for i, length in enumerate(np.diff(self.nodes)):
            for layer in (1, 2) if self.inside[i] and self.inside[i + 1] else (0,):
                to = np.concatenate([self.node_selector(layer, node) for node in (i, i + 1)])
                used = np.flatnonzero(to.any(axis=0))
                to, where = to[:, used], np.ix_(used, used)
                stiffness[where] += to.T @ sections[layer].stiffness(length) @ to
                inertia[where] += to.T @ sections[layer].inertia(length) @ to
        kept, rigid = self.constraint_matrix(), np.zeros(size)
        rigid[DEFLECTION::3] = 1.0
        return kept.T @ stiffness @ kept, kept.T @ inertia @ kept, kept.T @ inertia @ rigid

    def node_selector(self, layer: int, node: int) -> Floats:
        """Return the (3, all) matrix of a layer's, else of layer 1's displacements at a node."""
        number = self.node_numbers.get((layer, node))
        if number is None:
            return self.selector_by_layer_1(layer, node)
        return np.eye(3, 3 * len(self.node_numbers), 3 * number)

    def selector_by_layer_1(self, layer: int, node: int) -> Floats:
        """Return the same of a layer whose cross-section at a node is that of layer 1."""
        above = 3 * self.node_numbers[1, node]
        heights = (0.0, 1.0 - self.share, -self.share)  # of the axes, above the whole beam's
        matrix = np.eye(3, 3 * len(self.node_numbers), above)
        # the axial displacement at the height z is u - z slope
        of_1, own = (0.5 * self.thickness * heights[one] for one in (1, layer))
        matrix[AXIAL, above + SLOPE] = of_1 - own
        return matrix

    def constraint_matrix(self) -> Floats:
        """Return the (all, free) matrix of the constraints by clamps and delamination tips."""
        matrix, dropped = np.eye(3 * len(self.node_numbers)), []
        clamped = {0, len(self.nodes) - 1} if self.clamped_both else {0}
        for (layer, node), number in self.node_numbers.items():
            own = slice(3 * number, 3 * number + 3)
            if node in clamped:
                matrix[own] = 0.0
            elif layer == 2 and self.is_tip(node):
                matrix[own] = self.selector_by_layer_1(layer, node)
            else:
                continue
            dropped += range(own.start, own.stop)
        return np.delete(matrix, dropped, axis=1)

    def is_tip(self, node: int) -> bool:
        """Return whether the delamination ends at a node inside the beam."""
        around = self.inside[max(node - 1, 0) : node + 2]
        return bool(self.inside[node]) and not around.all()

    def modes(self, count: int) -> tuple[Floats, Floats, Floats]:
        """Compute the lowest modes without contact; return frequencies, shapes, participations."""
        stiffness, inertia, pull = self.matrices
        squares, shapes = eigh(stiffness, inertia, subset_by_index=[0, count - 1])
        return np.sqrt(squares), self.constraint_matrix() @ shapes, shapes.T @ pull

    def deflection_rows(self, shapes: Floats, layer: int, places: Floats) -> Floats:
        """Return a layer's deflections at positions by modes, shape (places, modes)."""
        known = self.node_numbers
        pairs = [(layer if (layer, node) in known else 0, node) for node in range(len(self.nodes))]
        table = shapes[[3 * known[pair] + DEFLECTION for pair in pairs]]
        return np.array([np.interp(places, self.nodes, column) for column in table.T]).T

    def single_mass_position(self) -> float:
        """Return the position at which mode 1 moves like a mass on a spring, m."""
        whole = replace(self, first=0.0, last=0.0)
        _, shapes, participation = whole.modes(1)
        moved = participation[0] * whole.deflection_rows(shapes, 0, whole.nodes)[:, 0]
        top = int(moved.argmax())
        return float(np.interp(1.0, moved[: top + 1], whole.nodes[: top + 1]))

    def system(
        self,
        faces: Faces,
        zeta: float = 0.008,
        modes: int = 16,
        sensor: float | None = None,
    ) -> ModalSystem:
        """Return the beam as a ``ModalSystem`` with contacts at the delamination's nodes."""
        frequency, shapes, participation = self.modes(modes)
        position = np.array([self.single_mass_position() if sensor is None else sensor])
        faces_rows = [self.deflection_rows(shapes, layer, position)[0] for layer in (1, 2)]
        return ModalSystem(
            frequency=frequency,
            damping_ratio=np.full(modes, zeta),
            participation=participation,
            output_rows=np.array(faces_rows),
            contacts=self.contacts(faces, shapes),
        )

    def contacts(self, faces: Faces, shapes: Floats) -> Contacts | None:
        """Return contacts between node pairs in the delamination; None without one."""
        apart = [int(i) for i in np.flatnonzero(self.inside) if i > 0 and not self.is_tip(i)]
        pairs = apart[::-1]
        if not pairs:
            return None
        numbers = self.node_numbers
        rows = [[3 * numbers[layer, i] + DEFLECTION for i in pairs] for layer in (1, 2)]
        upper, lower = (shapes[row] for row in rows)
        upper_part, lower_part = self.section(self.share), self.section(1.0 - self.share)
        mass = upper_part.mass * lower_part.mass / (upper_part.mass + lower_part.mass)
        mass *= self.length / self.elements
        return faces.contacts(upper - lower, np.full(len(pairs), faces.clearance), mass)


def intact_frequency(beam: DelaminatedBeam) -> float:
    """Return the intact beam's first natural frequency in closed form, Hz."""
    root = 4.730040744862704 if beam.clamped_both else 1.8751040687119611
    whole = beam.section(1.0)
    return root**2 / beam.length**2 * math.sqrt(whole.bending / whole.mass) / TURN
