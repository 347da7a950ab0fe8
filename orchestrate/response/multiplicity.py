"""After how many periods a response repeats."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

LEAST_GAP = 2.0**-20  # of the motion's size: smaller gaps are not compared with their own size
Floats = NDArray[np.float64]


class Repetition(NamedTuple):
    """How a response repeats.

    Attributes
    ----------
    multiplicity : int
        Least n such that the state repeats after n periods; 0: none.
    deviation : float
        Largest difference of states n periods apart over the motion's size; infinity where there is
        no n.
    """

    multiplicity: int
    deviation: float


def over_size(samples: ArrayLike, frequency: float = 1.0, gap: float | None = None) -> Floats:
    """States over the size of the motion, so that their differences compare with a tolerance.

    Parameters
    ----------
    samples : array_like, shape (n_samples, 4)
        x1, x2 in m, v1, v2 in m/s at the same phase of successive periods.
    frequency : float
        Of the excitation, rad/s: a velocity over it is a length.
    gap : float, optional
        Largest gap of the motion, between samples too, m.

    Returns
    -------
    ndarray, shape (n_samples, 4) or (n_samples, 6)
        Displacements and velocities of both masses over one length, and, where ``gap`` is there,
        the gap and its rate over theirs.

    Notes
    -----
    The length is the largest of all displacements and velocities over the frequency in the later
    half of the samples. That of one co-ordinate would not do: at the sampled phase it may pass 0.
    Masses move by many times the gap between them, and impacts depend on the gap: it is compared
    with the largest gap, and its rate with the larger one of that times the frequency and the
    sampled rates. All is homogeneous in the amplitude.
    """
    states = np.array(samples, dtype=float)
    states[:, 2:] /= frequency
    later = states[len(states) // 2 :]
    size = float(np.abs(later).max(initial=0.0)) or 1.0
    if gap is None:
        return states / size
    apart = states[:, 1::2] - states[:, ::2]  # the gap, and its rate over the frequency
    of_gap = max(gap, LEAST_GAP * size)
    of_rate = max(of_gap, float(np.abs(apart[len(states) // 2 :, 1]).max(initial=0.0)))
    return np.column_stack([states / size, apart / (of_gap, of_rate)])


def repetition(states: Floats, tolerance: float) -> Repetition:
    """The least n such that the state repeats after n periods, and how closely it does.

    Parameters
    ----------
    states : ndarray, shape (n_samples, n_co-ordinates)
        Of :func:`over_size`.
    tolerance : float
        Largest deviation of a repeated state.
    """
    limit = max(1, len(states) // 4)
    later = np.ascontiguousarray(states[len(states) // 2 :].T)  # a row a co-ordinate
    first = np.abs(later[:, 1 : limit + 1] - later[:, :1]).max(axis=0, initial=0.0)
    candidates: list[int] = ((first <= tolerance).nonzero()[0] + 1).tolist()
    for n in candidates:
        deviation = float(np.abs(later[:, n:] - later[:, :-n]).max())
        if deviation <= tolerance:
            return Repetition(n, deviation)
    return Repetition(0, np.inf)


def multiplicity(
    samples: ArrayLike, tolerance: float, frequency: float = 1.0, gap: float | None = None
) -> int:
    """The least n such that the state repeats after n periods.

    Parameters
    ----------
    samples : array_like, shape (n_samples, 4)
        x1, x2 in m, v1, v2 in m/s at the same phase of successive periods.
    tolerance : float
        Largest deviation of a repeated state over the motion's size, see :func:`over_size`.
    frequency : float
        Of the excitation, rad/s.
    gap : float, optional
        Largest gap of the motion, m.

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
    >>> one, other = [1.0, 1.5, 0.0, 0.1], [1.2, 1.5, 0.0, 0.1]
    >>> multiplicity([one, other] * 20, 1e-2)
    2
    """
    return repetition(over_size(samples, frequency, gap), tolerance).multiplicity
