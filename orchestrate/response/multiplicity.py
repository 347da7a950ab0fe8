"""After how many periods a response repeats."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def multiplicity(samples: ArrayLike, tolerance: float) -> int:
    """The least n such that the state repeats after n periods.

    Parameters
    ----------
    samples : array_like, shape (n_samples, n_co-ordinates)
        The state at the same phase of successive periods.
    tolerance : float
        Largest deviation of a repeated co-ordinate, over that co-ordinate's largest absolute value.

    Returns
    -------
    int
        0 where no n up to a quarter of the samples does: irregular.

    Notes
    -----
    Only the later half of the samples is compared: at low damping and high frequency a transient
    outlives hundreds of periods. A quasi-periodic response narrower than the tolerance counts as
    periodic.

    Examples
    --------
    >>> multiplicity([[1.0], [2.0]] * 20, 1e-2)
    2
    """
    states = np.asarray(samples, dtype=float)
    limit = max(1, len(states) // 4)
    later = states[len(states) // 2 :].T  # a row a co-ordinate
    scale = np.abs(later).max(axis=1, keepdims=True)
    if not scale.all():
        scale[scale == 0.0] = 1.0
    scaled = later / scale
    first = np.abs(scaled[:, 1 : limit + 1] - scaled[:, :1]).max(axis=0, initial=0.0)
    candidates: list[int] = ((first <= tolerance).nonzero()[0] + 1).tolist()
    for n in candidates:
        if np.abs(scaled[:, n:] - scaled[:, :-n]).max() <= tolerance:
            return n
    return 0
