"""Growth rate of a vector under a product of matrices, with its error by batch means."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .closed_form import Floats

FIRST_VECTOR = np.array([1.0, 0.7, 0.3, -0.5, 0.2, -0.4])  # in no special direction


class BlockGrowth(NamedTuple):
    """Logarithmic growth of a vector over successive blocks of matrices, and their durations."""

    growth: Floats  # logarithm of a vector's growth over each block
    durations: Floats  # of the blocks, in units of tau


def block_growth(matrices: Floats, times: Floats, end: float, blocks: int) -> BlockGrowth | None:
    """Return a vector's logarithmic growth over blocks of matrices; None if it becomes zero."""
    size = max(1, len(matrices) // blocks)
    growth = vector_log_growth(*scaled_products(matrices, size))
    if growth is None:
        return None
    return BlockGrowth(growth, np.diff(np.append(times[::size], end)))


def growth_by_batch_means(blocks: BlockGrowth, batches: int) -> tuple[float, float]:
    """Return the mean growth per unit of tau, and its standard error by batch means.

    The first batch is left out: meanwhile the vector turns into the direction that grows most.
    """
    growth, durations = blocks
    skip = len(growth) // batches
    groups = np.array_split(np.arange(skip, len(growth)), batches - 1)
    means = np.array([growth[group].sum() / durations[group].sum() for group in groups])
    mean = growth[skip:].sum() / durations[skip:].sum()
    return float(mean), float(means.std(ddof=1) / np.sqrt(len(means)))


def scaled_products(matrices: Floats, size: int) -> tuple[Floats, Floats]:
    """Multiply each ``size`` successive matrices; return scaled products and the scales' logs."""
    count, rows = -(-len(matrices) // size), matrices.shape[-1]
    stack = np.broadcast_to(np.eye(rows), (count * size, rows, rows)).copy()
    stack[: len(matrices)] = matrices
    stack = stack.reshape(count, size, rows, rows)
    logs = np.zeros((count, size))
    while stack.shape[1] > 1:
        if stack.shape[1] % 2:
            rest = np.broadcast_to(np.eye(rows), (count, 1, rows, rows))
            stack = np.concatenate([stack, rest], axis=1)
            logs = np.concatenate([logs, np.zeros((count, 1))], axis=1)
        stack, logs = stack[:, 1::2] @ stack[:, 0::2], logs[:, 0::2] + logs[:, 1::2]
        scale = np.maximum(np.abs(stack).max(axis=(2, 3)), 1e-300)
        stack, logs = stack / scale[:, :, None, None], logs + np.log(scale)
    return stack[:, 0], logs[:, 0]


def vector_log_growth(blocks: Floats, logs: Floats) -> Floats | None:
    """Multiply a vector by blocks in turn; return its log growth by each, None if it vanishes."""
    growth, vector = np.empty(len(blocks)), FIRST_VECTOR[: blocks.shape[-1]]
    for i, (block, log) in enumerate(zip(blocks, logs, strict=True)):
        vector = block @ vector
        norm = np.linalg.norm(vector)
        if norm == 0.0:
            return None
        growth[i], vector = log + np.log(norm), vector / norm
    return growth
