"""Where the speed jumps, as the voltage comes and goes.

The slip, no-load speed less speed, is what the vibration takes from the motor. It falls at the jump
up and rises at the jump down; where it passes half of its largest value on that way is where the
jump is said to be.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Jumps(NamedTuple):
    """Rows at which the speed jumps, up and down; None where it does not."""

    up: int | None
    down: int | None


def find_jumps(eta0: np.ndarray, Omega: np.ndarray, trend: np.ndarray) -> Jumps:
    """Find the revolutions in which the speed jumps.

    Parameters
    ----------
    eta0 : ndarray, shape (n,)
        Voltage of each revolution, as no-load speed over omega.
    Omega : ndarray, shape (n,)
        Mean speed over omega.
    trend : ndarray, shape (n,)
        Positive where the voltage rises, negative where it falls.
    """
    slip = eta0 - Omega
    return Jumps(
        first_fall(slip, np.flatnonzero(trend > 0)), first_rise(slip, np.flatnonzero(trend < 0))
    )


def first_fall(slip: np.ndarray, rows: np.ndarray) -> int | None:
    """The row at which the slip falls below half of its largest value, after that."""
    if not rows.size:
        return None
    level = slip[rows]
    highest = int(np.argmax(level))
    after = 1 + np.flatnonzero(level[highest + 1 :] < 0.5 * level[highest])
    return int(rows[highest + after[0]]) if after.size else None


def first_rise(slip: np.ndarray, rows: np.ndarray) -> int | None:
    """The row at which the slip rises above half of its largest value."""
    if not rows.size:
        return None
    level = slip[rows]
    after = np.flatnonzero(level > 0.5 * level.max())
    return int(rows[after[0]]) if after.size and after[0] > 0 else None
