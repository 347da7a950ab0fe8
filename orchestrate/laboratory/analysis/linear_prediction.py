"""Linear prediction: the part of a signal that earlier samples do not predict."""

from __future__ import annotations

import numpy as np

from ..pieces import Floats


def prediction_error(signal: Floats, order: int) -> Floats:
    """Return the error of a forward linear prediction, by weights that serve both directions."""
    products = lagged_products(signal, order)
    products = products + products[::-1, ::-1]
    products[np.diag_indices(order + 1)] *= 1.0 + 1e-9  # of a signal without noise
    weights = np.linalg.solve(products[1:, 1:], products[1:, 0])
    error = np.zeros(len(signal))
    error[order:] = np.convolve(signal, np.concatenate([[1.0], -weights]), "valid")
    return error


def lagged_products(signal: Floats, order: int) -> Floats:
    """Return the sums of ``x[n-i] x[n-j]`` over n, for i and j up to an order.

    Each row follows from the one before, but for the ends: no product of large matrices, for which
    the threads of a BLAS would wait.
    """
    first = np.correlate(signal, signal[order:], "valid")[::-1]
    begin, end = signal[order - 1 :: -1], signal[: -order - 1 : -1]
    ends = np.outer(begin, begin) - np.outer(end, end)
    products = np.empty((order + 1, order + 1))
    products[0], products[:, 0] = first, first
    for row in range(order):
        products[row + 1, 1:] = products[row, :-1] + ends[row]
    return products
