"""Lumped models: two masses with compliant contact, a bonded beam, a rattling clamp."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh

from orchestrate.constants import TURN

from . import restitution
from .system import Contacts, CubicSprings, Floats, Frictions, ModalSystem


@dataclass(frozen=True, kw_only=True)
class Faces:
    """Contact law of two faces: stiffness by frequency, restitution, clearance and friction."""

    law: str = "hunt-crossley"  # `"linear"`, `"hunt-crossley"` or `"hertz"`
    frequency: float = 1000.0  # hz, of both masses on the contact's stiffness
    restitution: float = 0.6  # at the closing speed `speed`, in m/s
    speed: float = 0.05
    clearance: float = 0.0  # m; negative where the faces are pressed into each other
    # coefficient with which sliding of closed faces brakes the bending of both
    friction: float = 0.0

    def contacts(self, rows: Floats, clearance: Floats, mass: float) -> Contacts:
        """Return contacts along rows of modes, between bodies of reduced mass ``mass``, kg."""
        w = TURN * self.frequency
        if self.law == "linear":
            damping = 2.0 * restitution.linear_damping_ratio(self.restitution) * w * mass
        else:
            damping = restitution.hunt_crossley_damping(self.restitution, self.speed)
        stiffness = mass * w * w
        if self.law == "hertz":  # as deep at the speed as the linear spring
            stiffness *= 1.25 / math.sqrt(self.speed / w)
        count = len(rows)
        return Contacts(
            rows, clearance, np.full(count, stiffness), np.full(count, damping), self.law
        )


@dataclass(frozen=True, kw_only=True)
class Halves:
    """Both halves of a beam as masses on springs."""

    # kg
    m1: float = 1.5
    m2: float = 1.2
    # hz, natural frequency of each half alone
    f1: float = 42.0
    f2: float = 52.0
    # damping ratio of each half alone
    zeta1: float = 0.008
    zeta2: float = 0.008

    def delaminated(self, faces: Faces, cubic: float = 0.0) -> ModalSystem:
        """Return a ``ModalSystem`` of two masses that touch by a contact law."""
        roots = np.sqrt([self.m1, self.m2])
        gap = np.array([[-1.0, 1.0]]) / roots
        reduced = self.m1 * self.m2 / (self.m1 + self.m2)
        own = np.eye(2) / roots
        masses = np.array([self.m1, self.m2])
        sliding = Frictions(own, np.zeros(2), 0.5 * np.full(2, faces.friction), np.full(2, 1e-3))
        return ModalSystem(
            frequency=TURN * np.array([self.f1, self.f2]),
            damping_ratio=np.array([self.zeta1, self.zeta2]),
            participation=roots,
            output_rows=own,
            contacts=faces.contacts(gap, np.array([faces.clearance]), reduced),
            springs=CubicSprings(own, cubic * masses, np.zeros(2)) if cubic else None,
            frictions=sliding if faces.friction else None,
        )

    def bonded(self, cubic: float = 0.0, friction: float = 0.0, sag: float = 0.0) -> ModalSystem:
        """Return a ``ModalSystem`` of one mass that carries both sensors."""
        whole = self.bonded_beam()
        row = np.array([[1.0 / math.sqrt(whole.mass)]])
        dry = Frictions(row, np.array([friction * whole.mass]), np.zeros(1), np.array([1e-3]))
        return ModalSystem(
            frequency=np.array([TURN * whole.f]),
            damping_ratio=np.array([whole.zeta]),
            participation=np.array([math.sqrt(whole.mass)]),
            output_rows=np.vstack([row, row]),
            springs=CubicSprings(row, np.array([cubic * whole.mass]), np.array([sag]))
            if cubic
            else None,
            frictions=dry if friction else None,
        )

    def bonded_with_torsion(self, ratio: float, participation: float, offset: float) -> ModalSystem:
        """Return a ``ModalSystem`` of the bonded beam that twists too, its sensors not opposite.

        Parameters are torsion's natural frequency and excitation by the base over those of bending,
        and what the sensors read of it over bending: one plus, one minus.
        """
        whole = self.bonded_beam()
        root = math.sqrt(whole.mass)
        faces = np.array([[1.0, offset], [1.0, -offset]])
        return ModalSystem(
            frequency=TURN * np.array([whole.f, ratio * whole.f]),
            damping_ratio=np.full(2, whole.zeta),
            participation=root * np.array([1.0, participation]),
            output_rows=faces / root,
        )

    def bonded_beam(self) -> BondedBeam:
        """Return mass, frequency and damping of the bonded beam of both halves."""
        masses, turns = np.array([self.m1, self.m2]), TURN * np.array([self.f1, self.f2])
        mass, stiffness = masses.sum(), (masses * turns**2).sum()
        damper = (2.0 * masses * turns * [self.zeta1, self.zeta2]).sum()
        w = math.sqrt(stiffness / mass)
        return BondedBeam(float(mass), w / TURN, float(damper / (2.0 * mass * w)))


class BondedBeam(NamedTuple):
    """A bonded beam: mass in kg, natural frequency in Hz, damping ratio."""

    mass: float
    f: float
    zeta: float


@dataclass(frozen=True, kw_only=True)
class Clamp:
    """A clamp with play, which the root of a sound beam strikes."""

    faces: Faces  # of the root and the stops; its clearance is not used
    # m from the root at rest to each stop; negative where it is pressed against it
    play: float = 2e-4
    both_sides: bool = True  # whether there are two stops
    mass: float = 0.1  # of the root, parts of the beam's
    centring: float = 3.0  # stiffness that holds the root, parts of the beam's


def in_rattling_clamp(own: ModalSystem, mass: float, clamp: Clamp) -> ModalSystem:
    """Return a sound beam of a mass, kg, in a clamp with play, from its modes in a firm one."""
    whole, part = np.full((1, 1), (1.0 + clamp.mass) * mass), own.participation[np.newaxis]
    inertia = np.block([[whole, part], [part.T, np.eye(own.modes)]])
    centring = clamp.centring * (own.participation[0] * own.frequency[0]) ** 2
    squares, shapes = eigh(np.diag([centring, *own.frequency**2]), inertia)
    stops = np.array([shapes[0], -shapes[0]])[: 1 + clamp.both_sides]
    return ModalSystem(
        frequency=np.sqrt(squares),
        damping_ratio=np.full(own.modes + 1, own.damping_ratio[0]),
        participation=shapes.T @ inertia[0],
        output_rows=np.column_stack([np.ones(2), own.output_rows]) @ shapes,
        contacts=clamp.faces.contacts(stops, np.full(len(stops), clamp.play), clamp.mass * mass),
    )


def cubic_stiffness(change: float, f: float, amplitude: float) -> float:
    """Return the cubic stiffness over mass, N/(kg m3), for a relative change of frequency."""
    return 4.0 / 3.0 * (TURN * f) ** 2 * ((1.0 + change) ** 2 - 1.0) / amplitude**2
