"""Standard errors of fitted numbers: from noise that is simulated, and from what the model misses.

Near the minimum the numbers move by ``-(J'WJ)^-1 J'W d`` where the residuals move by d, with the
weights W of the soft loss. Three covariances of d are taken:

* noise: motions under the measured base with more noise of the same size, read with noise; and
  what single impacts that come or stay away make of the residuals around the minimum;
* blocks: the residuals that are there, summed over blocks of neighbouring windows (a sandwich):
  what the model misses hangs together over neighbours and is no noise;
* discrepancy: what a model misses beyond noise, it may also have hidden in its numbers, where no
  residual shows it. Numbers at which the squares beyond noise are larger by ``hidden_share`` of
  themselves are one standard deviation away; apart from that the restitution is in doubt by
  ``restitution_doubt``, ln(f2/f1) by ``split_doubt``, a damping ratio by the mean of both, each as
  far as the contact misses ``contact_misfit``.

The first two are linear in what moves the numbers, and the misfit is rugged: impacts come and go,
and a search ends in one of several minima that lie close. What that adds was measured, on 495
records of the model itself: with both multiplied by ``CALIBRATION``, 95 of 100 of their intervals
hold the truth. Most errors are smaller than a normal distribution of that width has them, few are
much larger. The campaign ``intervals`` checks it on other records.

The variance is the sum of them: each sees a part of what there is, and the blocks are few. ``J'J``
would take each window for an experiment of its own and the model for true; on real contacts
it is 20 to 100 times too small.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..laboratory.analysis.channels import BOX
from ..laboratory.pieces import Floats
from ..laboratory.sampled import Sampled
from .misfit import LinearModel, misfit, soft_l1_loss
from .multistart import Search, difference_step
from .order_windows import ORDERS, RecordOrders
from .settings import Settings

SEED = 20_241
POINTS = 4  # of a cloud, a number: more than searches take (`Settings.points`)
REPLICATES = 16  # of simulated noise
# Of errors, measured; the halves are alike, so that a number of both has one factor. The errors of
# both frequencies stay as they are: they hold the truth in 93 of 100 records
CALIBRATION = {"log_zeta1": 2.9, "log_zeta2": 2.9, "e": 1.35}
# The same of resonance curves: 40 points have little against which the linear model errs
CURVE_CALIBRATION = {"common": 3.0, "split": 3.0, "log_zeta1": 5.8, "log_zeta2": 5.8, "e": 2.6}


def estimate_with_errors(
    search: Search, values: Mapping[str, float]
) -> tuple[dict[str, float], Floats]:
    """Return the numbers at the minimum of the smoothed misfit, and their covariance."""
    here, bounds = dict(values), search.hypothesis.bounds(search.evidence)
    model = fit_linear_model_around(search, here)
    moved = model.damped_minima(bounds, here)[0]
    before, after = (misfit(search.residuals(one)) for one in (here, moved))
    allowed = 1.05 if search.hypothesis.is_rugged else 1.0  # more is a step too far
    chosen = moved if after <= allowed * before else here
    lifted = chosen if search.evidence.has_floor else share_damping(chosen)
    if lifted != chosen:
        model = fit_linear_model_around(search, lifted)
    covariance = covariance_of_numbers(search, chosen, model)
    # what is linear in the damping ratios themselves, as errors of the logarithms that were fitted
    scale = [math.exp(lifted[n] - chosen[n]) if n.startswith("log_") else 1.0 for n in chosen]
    return chosen, covariance * np.outer(scale, scale)


def fit_linear_model_around(search: Search, values: Mapping[str, float]) -> LinearModel:
    """Fit a linear model to the residuals at a cloud of points around these values."""
    bounds = search.hypothesis.bounds(search.evidence)
    steps = np.diag([difference_step(search, name) ** 2 for name in values])
    shape = 0.1 * steps
    for seed in (0, 1):
        model = LinearModel.fit_to_cloud(search.residuals, bounds, values, shape, seed, POINTS)
        shape = 0.3 * model.cloud_covariance()
    return model


def share_damping(values: Mapping[str, float]) -> dict[str, float]:
    """Raise a damping ratio that is nearly 0, and lower the other one by as much."""
    names = [name for name in ("log_zeta1", "log_zeta2") if name in values]
    ratios = np.exp([values[name] for name in names])
    least = 0.4 * ratios.mean() if len(names) == 2 else 0.0
    if len(names) != 2 or ratios.min() >= least:
        return dict(values)
    shared = np.where(ratios < least, least, ratios.sum() - least)
    return {**values, **dict(zip(names, np.log(shared).tolist(), strict=True))}


def covariance_of_numbers(search: Search, values: dict[str, float], model: LinearModel) -> Floats:
    """Compute the covariance of fitted numbers by noise, by blocks and by discrepancy."""
    count, rows, influence = len(values), model.weighted_slopes, model.minus_inverse_normal_matrix
    residuals, settings = search.residuals(values), search.evidence.settings
    if search.evidence.has_floor:
        changes, known = simulate_noise_changes(search, values), CALIBRATION
    else:
        changes, known = simulate_scatter_changes(residuals), CURVE_CALIBRATION
    moved = np.stack([rows.T @ change.ravel() for change in changes])
    bumps = model.scatter @ rows
    by_noise = influence @ (moved.T @ moved / len(moved)) @ influence.T
    by_noise += influence @ (bumps.T @ bumps / len(bumps)) @ influence.T
    scores = np.einsum("scwp,scw->wp", rows.reshape(model.slopes.shape), residuals)
    parts = np.array_split(scores, max(min(20, len(scores) // 3), count + 2))
    sums = np.stack([part.sum(axis=0) for part in parts])
    small = len(sums) / max(len(sums) - count, 1)
    by_blocks = small * influence @ (sums.T @ sums) @ influence.T
    measured = np.diag([known.get(name, 1.0) for name in values])
    by_noise, by_blocks = (measured @ one @ measured for one in (by_noise, by_blocks))
    squares_by_noise = float(np.mean([soft_l1_loss(change).sum() for change in changes]))
    squares = float(soft_l1_loss(residuals).sum())
    beyond = max(squares - settings.noise_squares * squares_by_noise, 0.0)
    hidden = contact_covariance(values, beyond / residuals.size, settings)
    hidden -= settings.hidden_share * beyond * influence
    return by_noise + by_blocks + hidden


def contact_covariance(values: Mapping[str, float], beyond: float, settings: Settings) -> Floats:
    """Return the covariance of damping, split and restitution that is due to real contacts."""
    size = min(1.0, math.sqrt(beyond) / settings.contact_misfit)
    damping = {
        name: math.exp(values[name]) for name in ("log_zeta1", "log_zeta2") if name in values
    }
    doubt = {name: float(np.mean(list(damping.values()))) / zeta for name, zeta in damping.items()}
    doubt |= {"e": settings.restitution_doubt, "split": settings.split_doubt}
    return np.diag([(size * doubt.get(name, 0.0)) ** 2 for name in values])


def simulate_noise_changes(search: Search, values: Mapping[str, float]) -> list[Floats]:
    """Simulate noise of base and sensors, of their floors' size; return changes of residuals."""
    evidence, rng, hypothesis = search.evidence, np.random.default_rng(SEED), search.hypothesis
    channels, count = evidence.orders.channels, evidence.sample_count
    sizes = sample_noise_of_channels(evidence.orders)
    motion = hypothesis.displacements(values, evidence, search.player)
    before = evidence.residuals_of_orders(evidence.sensor_orders(motion))
    changes = []
    for _ in range(REPLICATES):
        base = channels.box + sizes[BOX] * rng.standard_normal(count)
        pieces = Sampled(acceleration=tuple(base), sample_rate=evidence.sample_rate).pieces()
        moved = hypothesis.displacements(values, replace(evidence, pieces=pieces), search.player)
        search.evaluations += 1
        noise = [sizes[name] * rng.standard_normal(count) for name in evidence.orders.sensors]
        read = evidence.windows.amplitudes(np.stack(noise))
        # noise of what is read counts the other way: as if the motion had moved by less
        computed = evidence.correct_for_sensors(evidence.ideal_orders(moved) - read)
        changes.append(evidence.residuals_of_orders(computed) - before)
    return changes


def simulate_scatter_changes(residuals: Floats) -> list[Floats]:
    """Simulate the scatter of a curve's points; return the change of the residuals each time."""
    differences = np.diff(residuals, n=2, axis=-1)
    size = np.sqrt(np.mean(differences**2, axis=-1, keepdims=True) / 6.0)
    rng = np.random.default_rng(SEED)
    return [size * rng.standard_normal(residuals.shape) for _ in range(100)]


def sample_noise_of_channels(orders: RecordOrders) -> dict[str, float]:
    """Return the standard deviation of white noise that makes each channel's floor, m/s2."""
    squares = [np.sum(np.abs(s[:, len(ORDERS) :]) ** 2, axis=0) for s in orders.windows.solutions]
    share = math.sqrt(float(np.nanmean(squares)))
    sizes = zip(orders.channels.names, orders.noise, strict=True)
    return {name: float(size) / share for name, size in sizes}
