"""Whether a speed has settled: records whose limit is known, and each threshold from both sides."""

import numpy as np
import pytest

from orchestrate.weak_drive.steady_speed import SettledSettings, settled_speed

SETTLED = SettledSettings()


def record(means):
    """A record of revolutions by the means of its blocks, after a first block."""
    return np.repeat(np.concatenate([[0.0], means]), 12)


def approach(change, ratios):
    """Means that end at 1.3, whose changes keep some ratios."""
    changes = change * np.cumprod([1.0, *ratios])
    return 1.3 + np.concatenate([[0.0], np.cumsum(changes)]) - changes.sum()


def thirds(count, scatter, rise, earlier=0.0):
    """Means to and fro, the last third of the later half higher, the earlier half elsewhere."""
    means = 1.3 + scatter * (-1.0) ** np.arange(count)
    means[-max(48, count // 2) // 3 :] += rise
    means[: count - max(48, count // 2)] += earlier
    return means


LAST = 1.049 / 2.049, 1.051 / 2.051  # the limit is 0.49 and 0.51 of the tolerance off
NEVER = (np.nan, 0.0)
SPREAD = (1e-6 + 0.5e-6 / 9.0) ** 0.5


@pytest.mark.parametrize(
    ("means", "expected"),
    [
        (np.full(5, 1.3), (1.3, 0.0)),  # four changes after the first block
        (np.full(4, 1.3), NEVER),
        (approach(0.98e-6, [1.0] * 3), (1.3, 0.0)),  # `still`, however they go on
        (approach(1.02e-6, [1.0] * 3), NEVER),
        (1.3 + 1e-4 * np.array([0.145, -0.145] * 3), (1.3 - 0.029e-4, 0.0)),  # `to_and_fro`
        (1.3 + 1e-4 * np.array([0.155, -0.155] * 3), NEVER),
        (approach(1e-3, [0.945] * 4), (1.3 + 0.945**5 * 1e-3 / 0.055, 0.0)),  # `slowest`
        (2.6 - approach(1e-3, [0.945] * 4), (1.3 - 0.945**5 * 1e-3 / 0.055, 0.0)),
        (approach(1e-3, [0.955] * 4), NEVER),
        (approach(4e-3, [0.5, 0.5, LAST[0]]), (1.3 + 1.049e-3 * LAST[0], 0.0)),
        (approach(4e-3, [0.5, 0.5, LAST[1]]), NEVER),  # `agreement`
        (thirds(48, 1e-3, 0.0), (1.3, 1e-3)),  # `blocks`
        (thirds(47, 1e-3, 0.0), NEVER),
        (thirds(48, 2e-5, 0.98e-4), (1.3 + 0.98e-4 / 3.0, 1e-4)),  # the tolerance
        (thirds(48, 2e-5, 1.02e-4), NEVER),
        (thirds(48, 1e-3, 0.50e-3), (1.3 + 0.5e-3 / 3.0, SPREAD)),  # `scatter`
        (thirds(48, 1e-3, 0.53e-3), NEVER),
        (thirds(120, 1e-3, 0.0, 0.1), (1.3, 1e-3)),  # the later half alone,
        (thirds(120, 1e-3, 0.53e-3), NEVER),  # and all of it
        (thirds(102, 2e-5, 0.0), (1.3 - 2e-5 / 51.0, 1e-4)),  # thirds of 17 blocks
        (thirds(104, 2e-5, 0.0), (1.3 - 2e-5 / 51.0, 1e-4)),  # of the 52 later ones but the first
    ],
)
def test_each_threshold_of_a_settled_speed(means, expected):
    speed, error = settled_speed(record(means), SETTLED)
    assert (speed, error) == pytest.approx(expected, rel=1e-9, abs=1e-12, nan_ok=True)


def test_an_approach_to_a_fold_has_not_settled():
    """Slower than any exponential, and then on through the bottleneck."""
    slow = 1.3 - 0.3 / (10.0 + np.arange(30))
    through = 1.3 + 0.005 * np.tan(np.linspace(-1.5, 1.4, 30))
    for means in (slow, through):
        assert all(np.isnan(settled_speed(record(means[:n]), SETTLED)[0]) for n in range(31))
