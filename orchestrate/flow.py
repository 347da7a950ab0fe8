"""How a small deviation travels along a motion: exact flow matrices between impacts, saltation matrices at them.

The state is (xi_1, xi_2, xi_1', xi_2'). In flight both masses are free oscillators (6), so the flow matrix is closed-form and does not know the
excitation; at an impact the deviation jumps by the saltation matrix, which also knows that the deviated motion impacts a little earlier or later
(di Bernardo et al., Piecewise-smooth Dynamical Systems, 2008, section 2.5). Where chattering ends in permanent contact the deviation of the gap
dies: what is left is that of the common centre of mass. At a release the forces are continuous (19): nothing jumps. For D1 = D2.
"""

import numpy as np

from .trace import period

RELEASE_SAMPLES = 64  # looks at the contact force between two impacts, to find the first change of its sign


def oscillator(time, damping, omega_squared):
    """Flow matrices of one free oscillator, the free part of (10).

    Parameters
    ----------
    time : ndarray, shape (n,)
        Durations.
    damping, omega_squared : float
        D_i and omega_i^2, underdamped.

    Returns
    -------
    ndarray, shape (n, 2, 2)
    """
    nu = np.sqrt(omega_squared - damping**2)
    decay, cosine, sine = np.exp(-damping * time), np.cos(nu * time), np.sin(nu * time) / nu
    rows = [[cosine + damping * sine, sine], [-omega_squared * sine, cosine - damping * sine]]
    return decay[:, None, None] * np.moveaxis(np.array(rows), -1, 0)


def flight(time, case):
    """Flow matrices with both masses free, shape (n, 4, 4)."""
    matrices = np.zeros((len(time), 4, 4))
    matrices[:, 0::2, 0::2] = oscillator(time, case.D, 1.0)
    matrices[:, 1::2, 1::2] = oscillator(time, case.D, case.kappa / case.mu)
    return matrices


def centre(case):
    """The projection to the centre of mass, shape (4, 4)."""
    weights = np.array([[1.0, case.mu], [1.0, case.mu]]) / (1.0 + case.mu)
    return np.block([[weights, np.zeros((2, 2))], [np.zeros((2, 2)), weights]])


def contact(time, case):
    """Flow matrices in permanent contact, with the projection that begins it, shape (n, 4, 4)."""
    common = oscillator(time, case.D, (1.0 + case.kappa) / (1.0 + case.mu))
    return np.kron(common, np.eye(2)) @ centre(case)


def field(state, time, eta, case):
    """Right-hand side of (6) in flight, shape (n, 4)."""
    drive = np.sin(eta * time)
    a1 = drive - 2.0 * case.D * state[:, 2] - state[:, 0]
    a2 = drive - 2.0 * case.D * state[:, 3] - case.kappa / case.mu * state[:, 1]
    return np.stack([state[:, 2], state[:, 3], a1, a2], axis=1)


def saltation(impacts, eta, case):
    """Saltation matrices of impacts, ``R + (F+ - R F-) n^T / (n F-)`` with the restitution R of (15), shape (n, 4, 4)."""
    part = (1.0 + case.e) / (1.0 + case.mu)
    restitution = np.eye(4)
    restitution[2, 2:] += np.array([-part, part]) * case.mu
    restitution[3, 2:] += np.array([part, -part])
    jump = field(impacts.state, impacts.time, eta, case) - field(impacts.before(case), impacts.time, eta, case) @ restitution.T
    normal = np.array([-1.0, 1.0, 0.0, 0.0])
    matrices = restitution - jump[:, :, None] * normal / np.maximum(impacts.closing, 1e-300)[:, None, None]
    matrices[impacts.sticks] = centre(case)
    return matrices


def releases(impacts, ends, eta, case):
    """Duration of the permanent contact after each impact, 0 where none follows, shape (n,).

    The first root of (19), which for D1 = D2 is the common oscillator's zero (18), between the impact and the end of the span.
    """
    durations = np.zeros(len(impacts.time))
    which = np.flatnonzero(impacts.sticks)
    if not len(which):
        return durations
    span, start = (ends - impacts.time)[which], impacts.state[which]
    grid = np.linspace(0.0, 1.0, RELEASE_SAMPLES + 1)[1:] * span[:, None]
    values = together(grid, start, impacts.time[which], eta, case)
    changed = values * values[:, :1] <= 0.0
    first = np.where(changed.any(axis=1), changed.argmax(axis=1), RELEASE_SAMPLES - 1)
    high = np.take_along_axis(grid, first[:, None], 1)
    low = high - span[:, None] / RELEASE_SAMPLES
    for _ in range(50):
        middle = 0.5 * (low + high)
        beyond = together(middle, start, impacts.time[which], eta, case) * values[:, :1] <= 0.0
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    durations[which] = np.where(changed.any(axis=1), high[:, 0], span)
    return durations


def together(time, start, begin, eta, case):
    """xi_3 a time after the start of contact, (10) and (11); ``time`` has shape (n, k), the rest (n, ...)."""
    omega_squared, damping = (1.0 + case.kappa) / (1.0 + case.mu), case.D
    nu = np.sqrt(omega_squared - damping**2)
    reach = (omega_squared - eta**2) ** 2 + (2.0 * damping * eta) ** 2
    a, b = -2.0 * damping * eta / reach, (omega_squared - eta**2) / reach
    angle = eta * begin[:, None]
    free = start[:, :1] - (a * np.cos(angle) + b * np.sin(angle))
    rate = (start[:, 2:3] + damping * free - eta * (b * np.cos(angle) - a * np.sin(angle))) / nu
    steady = a * np.cos(angle + eta * time) + b * np.sin(angle + eta * time)
    return steady + np.exp(-damping * time) * (free * np.cos(nu * time) + rate * np.sin(nu * time))


def steps(impacts, end, eta, case):
    """For each impact, the matrix from just before it to just before the next one or to ``end``, shape (n, 4, 4)."""
    ends = np.append(impacts.time[1:], end)
    touching = releases(impacts, ends, eta, case)
    matrices = saltation(impacts, eta, case)
    which = np.flatnonzero(touching > 0.0)
    matrices[which] = contact(touching[which], case)
    return flight(ends - impacts.time - touching, case) @ matrices


def monodromy(impacts, eta, case, periods=1):
    """The matrix of a span of periods from phase 0, in flight there, with its impacts."""
    end = periods * period(eta)
    matrix = flight(np.array([impacts.time[0] if len(impacts.time) else end]), case)[0]
    for step in steps(impacts, end, eta, case):
        matrix = step @ matrix
    return matrix
