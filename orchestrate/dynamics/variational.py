"""Linearised motion (variational equations): saltation matrices at impacts, flow matrices between.

Non-dimensional, as in :mod:`.closed_form`. The saltation matrix includes that the deviated motion
impacts earlier or later (di Bernardo et al., Piecewise-smooth Dynamical Systems, 2008, 2.5). Where
chattering ends in permanent contact the deviation of the gap dies; at a release nothing jumps (19).
"""

from __future__ import annotations

import math

import numpy as np

from ..fmu import Impacts
from ..response.questions import Point
from .closed_form import ClosedForm, Floats, contact_durations


def period_in_tau(eta: float) -> float:
    """Return the excitation period 2 pi/eta in units of tau, (22) as it must read."""
    return 2.0 * math.pi / eta


def saltation_matrices(impacts: Impacts, point: Point) -> Floats:
    """Return the saltation matrix ``R + (F+ - R F-) n^T/(n F-)`` of each impact, (n, 4, 4)."""
    form = ClosedForm.from_structure(*point)
    part = (1.0 + form.e) / (1.0 + form.mu)
    restitution = np.eye(4)
    restitution[2, 2:] += np.array([-part, part]) * form.mu
    restitution[3, 2:] += np.array([part, -part])
    exchange = np.zeros((4, 4))  # R is linear in the coefficient: its derivative by that
    exchange[2:, 2:] = np.array([[-form.mu, form.mu], [1.0, -1.0]]) / (1.0 + form.mu)
    phase = form.eta * impacts.time
    after = form.field(impacts.state, phase)
    before = form.field(impacts.before(point.structure), phase)
    jump = after - before @ restitution.T
    matrices: Floats = np.broadcast_to(restitution, (len(jump), 4, 4)).copy()
    if form.e_slope:
        slower = (form.parting_rate(impacts.closing) - form.e)[:, None]
        jump -= slower * (before @ exchange.T)
        matrices += slower[:, :, None] * exchange
    # a grazing impact has no closing speed: its matrix is very large instead
    jump /= np.maximum(impacts.closing, 1e-300)[:, None]
    matrices[:, :, 0] += jump  # times the normal (-1, 1, 0, 0)
    matrices[:, :, 1] -= jump
    matrices[impacts.sticks] = form.centre()
    return matrices


def contact_durations_after(impacts: Impacts, ends: Floats, point: Point) -> Floats:
    """Return how long permanent contact lasts after each impact, in tau; 0 without."""
    times = np.zeros(len(impacts.time))
    sticks, form = impacts.sticks, ClosedForm.from_structure(*point)
    begins, states = impacts.time[sticks], impacts.state[sticks]
    spans = ends[sticks] - begins
    durations = contact_durations(form, form.eta * begins, states[:, 0], states[:, 2], spans)
    times[sticks] = np.minimum(durations, spans)
    return times


def impact_matrices(impacts: Impacts, end: float, point: Point) -> Floats:
    """Return matrices that map a deviation from each impact to the next, just before both."""
    form = ClosedForm.from_structure(*point)
    ends = np.append(impacts.time[1:], end)
    touching = contact_durations_after(impacts, ends, point)
    matrices = saltation_matrices(impacts, point)
    sticks = touching > 0.0
    matrices[sticks] = form.contact(touching[sticks]) @ form.centre()
    products: Floats = form.flight(ends - impacts.time - touching) @ matrices
    return products


def monodromy(impacts: Impacts, point: Point, periods: int = 1) -> Floats:
    """Return the monodromy matrix (4, 4) over some periods from phase 0, impacts included."""
    form = ClosedForm.from_structure(*point)
    end = periods * period_in_tau(form.eta)
    first = impacts.time[0] if len(impacts.time) else end
    matrix: Floats = form.flight(np.array([first]))[0]
    for each in impact_matrices(impacts, end, point):
        matrix = each @ matrix
    return matrix


def nondimensional_impacts(impacts: Impacts, point: Point) -> Impacts:
    """Convert impacts from SI to the paper's units, displacements to those of the faces."""
    tau, closing = point.structure.omega * impacts.time, impacts.closing / point.speed
    return Impacts(tau, point.faces(impacts.state), closing, impacts.sticks)
