"""The largest Lyapunov exponent of a motion from its impacts, with its uncertainty, and the verdict it allows."""

import numpy as np

from .flow import flight, steps

BLOCKS = 40  # products of matrices whose growth is told apart
BATCHES = 8  # groups of blocks; the spread of their means is the uncertainty
PERIODIC, QUASI_PERIODIC, CHAOTIC = -1, 0, 1
WORDS = {PERIODIC: "periodic", QUASI_PERIODIC: "neutral", CHAOTIC: "chaotic"}
SIGMAS = 3.0  # standard errors that an exponent must be away from zero


def products(matrices, size):
    """Products of ``size`` matrices in turn, scaled, with the logarithms of the scales; the last one may have fewer factors."""
    count = -(-len(matrices) // size)
    stack = np.broadcast_to(np.eye(4), (count * size, 4, 4)).copy()
    stack[: len(matrices)] = matrices
    stack = stack.reshape(count, size, 4, 4)
    logs = np.zeros((count, size))
    while stack.shape[1] > 1:
        if stack.shape[1] % 2:
            rest = np.broadcast_to(np.eye(4), (count, 1, 4, 4))
            stack, logs = np.concatenate([stack, rest], axis=1), np.concatenate([logs, np.zeros((count, 1))], axis=1)
        stack, logs = stack[:, 1::2] @ stack[:, 0::2], logs[:, 0::2] + logs[:, 1::2]
        scale = np.maximum(np.abs(stack).max(axis=(2, 3)), 1e-300)
        stack, logs = stack / scale[:, :, None, None], logs + np.log(scale)
    return stack[:, 0], logs[:, 0]


def largest_exponent(impacts, end, eta, case):
    """The largest Lyapunov exponent over a span.

    Parameters
    ----------
    impacts : .trace.Impacts
        Of the span.
    end : float
        tau at the span's end.
    eta : float
    case : .sweep.Case

    Returns
    -------
    exponent, error : float
        Per unit of tau, natural logarithm, and the standard error of the mean over batches. Without impacts the exponent of the
        free oscillators, -D.
    """
    if len(impacts.time) < 2 * BATCHES:
        return -case.D, 0.0
    matrices = steps(impacts, end, eta, case)
    size = max(1, len(matrices) // BLOCKS)
    blocks, logs = products(matrices, size)
    edges = np.append(impacts.time[::size], end)
    growth, vector = np.empty(len(blocks)), np.array([1.0, 0.7, 0.3, -0.5])
    for i, (block, log) in enumerate(zip(blocks, logs, strict=True)):
        vector = block @ vector
        norm = np.linalg.norm(vector)
        if norm == 0.0:
            return -np.inf, 0.0
        growth[i], vector = log + np.log(norm), vector / norm
    skip = len(growth) // BATCHES  # the vector turns into its own direction first
    durations = np.diff(edges)
    groups = np.array_split(np.arange(skip, len(growth)), BATCHES - 1)
    means = np.array([growth[group].sum() / durations[group].sum() for group in groups])
    return float(growth[skip:].sum() / durations[skip:].sum()), float(means.std(ddof=1) / np.sqrt(len(means)))


def verdict(exponent, error, floor):
    """Periodic, neutral (quasi-periodic, or not decided) or chaotic.

    Parameters
    ----------
    exponent, error : array_like
    floor : array_like
        Least distance from zero that counts: a deviation that neither grows nor shrinks still wanders by a factor of a few.
    """
    distance = np.maximum(SIGMAS * np.asarray(error), floor)
    return np.where(exponent > distance, CHAOTIC, np.where(exponent < -distance, PERIODIC, QUASI_PERIODIC))


def free_matrix(duration, case):
    """Flow matrix of a span without impacts, for comparisons."""
    return flight(np.array([duration]), case)[0]
