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

    Notes
    -----
    Only the later half of the samples is compared: at low damping and high frequency a transient outlives hundreds of periods. A
    quasi-periodic response narrower than the tolerance counts as periodic.
    """
    samples = np.asarray(samples, dtype=float)
    limit = max(1, len(samples) // 4)
    samples = samples[len(samples) // 2 :]
    scale = np.abs(samples).max(axis=0)
    scale[scale == 0.0] = 1.0
    scaled = samples / scale
    for n in range(1, min(limit, len(samples) - 1) + 1):
        if np.abs(scaled[n:] - scaled[:-n]).max() <= tolerance:
            return n
    return 0
