"""How a small deviation travels along a motion: flow matrices between impacts, saltation at them.

All is non-dimensional; the state is (xi_1, xi_2, xi_1', xi_2'). In flight both masses are free
oscillators (6), so the flow matrix is closed-form and does not know the excitation. At an impact
the deviation jumps by the saltation matrix, which also knows that the deviated motion impacts a
little earlier or later (di Bernardo et al., Piecewise-smooth Dynamical Systems, 2008, section 2.5).
Where chattering ends in permanent contact the deviation of the gap dies: what is left is that of
the common centre of mass. At a release the forces are continuous (19): nothing jumps.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..access import Impacts
from ..response.questions import Point
from ..structures import Structure

Floats = NDArray[np.float64]


def period(eta: float) -> float:
    """T = 2 pi/eta in units of tau, (22) as it must read."""
    return 2.0 * math.pi / eta


class Branch(NamedTuple):
    """A linear oscillator: D_i (8) and omega_i^2 (7)."""

    damping: float
    square: float


class Branches(NamedTuple):
    """Those of a structure: mass 1, mass 2, both as one."""

    one: Branch
    two: Branch
    both: Branch

    @classmethod
    def of(cls, structure: Structure) -> Branches:
        """By (7) and (8)."""
        mu, kappa = structure.mu, structure.kappa
        return cls(
            Branch(structure.D1, 1.0),
            Branch(structure.D2, kappa / mu),
            Branch(structure.D3, (1.0 + kappa) / (1.0 + mu)),
        )


def basis(time: Floats, branch: Branch) -> tuple[Floats, Floats, Floats]:
    """``e^{-D t}``, ``cos nu t``, ``sin(nu t)/nu`` of (10), and their like beyond critical damping.

    There the exponential is that of the slower part, so that nothing overflows.
    """
    damping, square = branch
    excess = square - damping**2  # nu^2 of (11)
    nu = math.sqrt(abs(excess))
    if excess > 0.0:
        return np.exp(-damping * time), np.cos(nu * time), np.sin(nu * time) / nu
    if excess == 0.0:
        return np.exp(-damping * time), np.ones_like(time), np.array(time)
    faster = np.expm1(-2.0 * nu * time)
    return np.exp(-slowest_rate(branch) * time), 1.0 + 0.5 * faster, -0.5 * faster / nu


def slowest_rate(branch: Branch) -> float:
    """The rate at which an oscillator's free motion decays in the long run."""
    damping, square = branch
    excess = square - damping**2
    return damping if excess >= 0.0 else square / (damping + math.sqrt(-excess))


def oscillator(time: Floats, branch: Branch) -> Floats:
    """Flow matrices of one free oscillator, the free part of (10).

    Parameters
    ----------
    time : ndarray, shape (n,)
        Durations.
    branch : Branch

    Returns
    -------
    ndarray, shape (n, 2, 2)
    """
    damping, square = branch
    decay, cosine, sine = basis(time, branch)
    rows = [[cosine + damping * sine, sine], [-square * sine, cosine - damping * sine]]
    matrices: Floats = decay[:, None, None] * np.moveaxis(np.array(rows), -1, 0)
    return matrices


def flight(time: Floats, structure: Structure) -> Floats:
    """Flow matrices with both masses free, shape (n, 4, 4)."""
    branches = Branches.of(structure)
    matrices = np.zeros((len(time), 4, 4))
    matrices[:, 0::2, 0::2] = oscillator(time, branches.one)
    matrices[:, 1::2, 1::2] = oscillator(time, branches.two)
    return matrices


def centre(structure: Structure) -> Floats:
    """The projection to the centre of mass, shape (4, 4)."""
    mu = structure.mu
    weights = np.array([[1.0, mu], [1.0, mu]]) / (1.0 + mu)
    return np.asarray(np.kron(np.eye(2), weights), dtype=float)


def contact(time: Floats, structure: Structure) -> Floats:
    """Flow matrices in permanent contact, with the projection that begins it, shape (n, 4, 4)."""
    common = oscillator(time, Branches.of(structure).both)
    matrices: Floats = np.kron(common, np.eye(2)) @ centre(structure)
    return matrices


def field(state: Floats, time: Floats, eta: float, structure: Structure) -> Floats:
    """Right-hand side of (6) in flight, shape (n, 4)."""
    one, two, _ = Branches.of(structure)
    drive = np.sin(eta * time)
    a1 = drive - 2.0 * one.damping * state[:, 2] - state[:, 0]
    a2 = drive - 2.0 * two.damping * state[:, 3] - two.square * state[:, 1]
    return np.stack([state[:, 2], state[:, 3], a1, a2], axis=1)


def saltation(impacts: Impacts, eta: float, structure: Structure) -> Floats:
    """``R + (F+ - R F-) n^T / (n F-)`` with the restitution R of (15), shape (n, 4, 4)."""
    mu = structure.mu
    part = (1.0 + structure.e) / (1.0 + mu)
    restitution = np.eye(4)
    restitution[2, 2:] += np.array([-part, part]) * mu
    restitution[3, 2:] += np.array([part, -part])
    after = field(impacts.state, impacts.time, eta, structure)
    before = field(impacts.before(structure), impacts.time, eta, structure)
    jump = after - before @ restitution.T
    normal = np.array([-1.0, 1.0, 0.0, 0.0])
    speed = np.maximum(impacts.closing, 1e-300)[:, None, None]
    matrices: Floats = restitution - jump[:, :, None] * normal / speed
    matrices[impacts.sticks] = centre(structure)
    return matrices


def releases(impacts: Impacts, ends: Floats, eta: float, structure: Structure) -> Floats:
    """Duration of the permanent contact after each impact, 0 where none follows, shape (n,).

    The first root (19) of the contact force (18) between the impact and the end of the span.

    Parameters
    ----------
    impacts : Impacts
    ends : ndarray, shape (n,)
        tau of the next impact or the end.
    eta : float
    structure : Structure
    """
    from scipy.optimize.elementwise import find_root

    durations = np.zeros(len(impacts.time))
    which = np.flatnonzero(impacts.sticks)
    if not len(which):
        return durations
    begin, start = impacts.time[which], impacts.state[which]
    span = ends[which] - begin
    force = ContactForce.of(eta, structure)
    looks = force.looks(float(span.max()))
    grid = np.linspace(0.0, 1.0, looks + 1)[1:] * span[:, None]
    arguments = (start[:, 0], start[:, 2], begin)
    values = force.at(grid, *(part[:, None] for part in arguments))
    opens = values >= 0.0  # it begins below zero: the masses are pressed together
    first = np.where(opens.any(axis=1), opens.argmax(axis=1), 0)
    high = np.take_along_axis(grid, first[:, None], 1)[:, 0]
    found = find_root(force.at, (high - span / looks, high), args=arguments)
    # where the bracket holds no change of sign, the end of the look itself is near enough
    roots = np.where(found.success, found.x, high)
    durations[which] = np.where(opens.any(axis=1), roots, span)
    return durations


class ContactForce(NamedTuple):
    """The f of (18) in permanent contact, (10) and (11) with i = 3.

    Attributes
    ----------
    eta : float
    branch : Branch
        Of both masses as one.
    of_rate, of_place : float
        Coefficients ``2 (D_1 - D_2)`` and ``omega_1^2 - omega_2^2``.
    """

    eta: float
    branch: Branch
    of_rate: float
    of_place: float

    @classmethod
    def of(cls, eta: float, structure: Structure) -> ContactForce:
        """Of a structure."""
        one, two, both = Branches.of(structure)
        return cls(eta, both, 2.0 * (one.damping - two.damping), one.square - two.square)

    def looks(self, span: float, least: int = 64, a_period: int = 16) -> int:
        """How many times to look at it in a span, not to miss a change of its sign.

        Parameters
        ----------
        span : float
        least, a_period : int
            At least, and in a period of the excitation or of the common oscillator.
        """
        fastest = max(self.eta, math.sqrt(self.branch.square))
        return max(least, math.ceil(a_period * fastest * span / (2.0 * math.pi)))

    def at(self, time: Floats, place: Floats, rate: Floats, begin: Floats) -> Floats:
        """Its value a time after contact has begun at ``begin`` with xi_3 and xi_3'."""
        eta, (damping, square) = self.eta, self.branch
        reach = (square - eta**2) ** 2 + (2.0 * damping * eta) ** 2
        a, b = -2.0 * damping * eta / reach, (square - eta**2) / reach
        angle = eta * begin
        free = place - (a * np.cos(angle) + b * np.sin(angle))
        swing = rate - eta * (b * np.cos(angle) - a * np.sin(angle))
        decay, cosine, sine = basis(time, self.branch)
        now = angle + eta * time
        x = a * np.cos(now) + b * np.sin(now)
        v = eta * (b * np.cos(now) - a * np.sin(now))
        x += decay * (free * cosine + (swing + damping * free) * sine)
        v += decay * (swing * cosine - (damping * swing + square * free) * sine)
        force: Floats = self.of_rate * v + self.of_place * x
        return force


def steps(impacts: Impacts, end: float, eta: float, structure: Structure) -> Floats:
    """For each impact, the matrix from just before it to just before the next one or to ``end``.

    Parameters
    ----------
    impacts : Impacts
        Non-dimensional, see :func:`nondimensional`; time 0 is at phase 0.
    end : float
        tau.
    eta : float
    structure : Structure

    Returns
    -------
    ndarray, shape (n, 4, 4)
    """
    ends = np.append(impacts.time[1:], end)
    touching = releases(impacts, ends, eta, structure)
    matrices = saltation(impacts, eta, structure)
    which = np.flatnonzero(touching > 0.0)
    matrices[which] = contact(touching[which], structure)
    found: Floats = flight(ends - impacts.time - touching, structure) @ matrices
    return found


def monodromy(impacts: Impacts, eta: float, structure: Structure, periods: int = 1) -> Floats:
    """The matrix of a span of periods from phase 0, in flight there, with its impacts.

    Parameters
    ----------
    impacts : Impacts
        Of the span, non-dimensional, see :func:`nondimensional`.
    eta : float
    structure : Structure
    periods : int

    Returns
    -------
    ndarray, shape (4, 4)
    """
    end = periods * period(eta)
    first = impacts.time[0] if len(impacts.time) else end
    matrix: Floats = flight(np.array([first]), structure)[0]
    for step in steps(impacts, end, eta, structure):
        matrix = step @ matrix
    return matrix


def nondimensional(impacts: Impacts, point: Point) -> Impacts:
    """Impacts in units of 1/omega, a eta^2 and omega a eta^2, (3) and (4)."""
    return Impacts(
        point.structure.omega * impacts.time,
        impacts.state / point.scale,
        impacts.closing / point.speed,
        impacts.sticks,
    )
