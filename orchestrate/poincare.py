"""What stroboscopic samples tell: multiplicity and impacts per period."""

import numpy as np


def multiplicity(samples, tolerance):
    """The least n such that the state repeats after n periods.

    Parameters
    ----------
    samples : ndarray, shape (n_samples, n_co-ordinates)
        The state at the same phase of successive periods.
    tolerance : float
        Largest deviation of a repeated co-ordinate, over that co-ordinate's largest absolute value.

    Returns
    -------
    int
        0 where no n up to a quarter of the samples does: irregular.
    """
    samples = np.asarray(samples, dtype=float)
    scale = np.abs(samples).max(axis=0)
    scale[scale == 0.0] = 1.0
    scaled = samples / scale
    for n in range(1, len(samples) // 4 + 1):
        if np.abs(scaled[n:] - scaled[:-n]).max() <= tolerance:
            return n
    return 0
