"""Fits to simulated records, by residuals that are linear around a few minima."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..fmu import Player
from ..laboratory.pieces import Floats
from .evidence import GAIN_DEVIATION, PARTICIPATION_DEVIATION, PRIOR_WEIGHT, Evidence
from .fitting import Search, Solution, difference_step
from .hypotheses import Delaminated
from .linear import LinearModel
from .misfit import soft_squares, soft_weights
from .orders import Complexes
from .simulation import Fitted, Simulation, rounded

Values = Mapping[str, float]
ROUNDS = 6  # of reweighted least squares
REACH = 3.0  # standard deviations of the cloud within which its regression is used
DESCENTS = (1.0, 1.0, 1.0, 0.3, 0.3)  # sizes of the clouds on the way to the other one's motion


@dataclass(frozen=True)
class SimulatedEvidence(Evidence):
    """Hold a record's evidence with simulated orders in place of the measured ones.

    Numbers that are relative to the record's resonance and displacement keep their meaning.
    """

    reference: Evidence = field(kw_only=True)  # of the record
    simulated: Complexes = field(kw_only=True)  # complex, m/s2

    def __post_init__(self) -> None:
        names = ("operator", "windows", "base", "resonance", "displacement", "peaks", "error")
        self.__dict__.update({name: getattr(self.reference, name) for name in names})
        self.__dict__["measured"] = self.simulated

    @classmethod
    def from_motion(cls, evidence: Evidence, motion: Floats) -> SimulatedEvidence:
        """Return the evidence of a record that has the orders of a motion, without noise."""
        return cls(
            evidence.orders,
            evidence.pieces,
            evidence.relative,
            reference=evidence,
            simulated=evidence.fitted_orders(motion),
        )


@dataclass(frozen=True)
class LinearFit:
    """Hold a hypothesis's residuals as a linear model, for fits to records near the measured
    one.
    """

    residuals: Floats  # against the measured record
    slopes: Floats
    # changes of the numbers within which the slopes are used
    low: Floats
    high: Floats
    sensors: Floats  # what gains and delays of the sensors change, and
    estimator: Floats  # how they follow from residuals

    @classmethod
    def from_search(cls, search: Search, values: Values, covariance: Floats) -> LinearFit:
        """Compute the slopes by regression over a cloud of points with this covariance."""
        here = {name: rounded(value) for name, value in values.items()}
        bounds = search.hypothesis.bounds(search.evidence)
        model = LinearModel.from_cloud(search.residuals, bounds, here, covariance)
        reach = REACH * np.sqrt(np.diag(covariance))
        now = np.array(list(here.values()))
        ends = np.array([bounds[name] for name in here]).T
        low, high = np.maximum(-reach, ends[0] - now), np.minimum(reach, ends[1] - now)
        motion = search.hypothesis.displacements(here, search.evidence, search.player)
        columns, estimator = sensor_error_columns(
            search.evidence, search.evidence.fitted_orders(motion)
        )
        residuals = search.evidence.residuals(motion).ravel()
        slopes = model.slopes.reshape(len(residuals), -1)
        return cls(residuals, slopes, low, high, columns, estimator)

    def misfits(self, changes: Floats) -> Floats:
        """Fit the linear model to records whose residuals are changed; return their misfits."""
        wanted = self.residuals + changes - (changes @ self.estimator.T) @ self.sensors.T
        scale = np.maximum(np.sqrt(np.sum(self.slopes**2, axis=0)), 1e-300)
        slopes, low, high = self.slopes / scale, self.low * scale, self.high * scale
        steps = np.zeros((len(wanted), len(scale)))
        best = mean_square(wanted)
        for _ in range(ROUNDS):
            here = wanted + steps @ slopes.T
            weighted = soft_weights(here)[:, :, np.newaxis] * slopes
            normal = weighted.transpose(0, 2, 1) @ slopes + 1e-6 * np.eye(len(scale))
            target = np.einsum("nrp,nr->np", weighted, wanted)
            steps = np.clip(-np.linalg.solve(normal, target[..., np.newaxis])[..., 0], low, high)
            best = np.minimum(best, mean_square(wanted + steps @ slopes.T))
        return np.sqrt(best)


def mean_square(residuals: Floats) -> Floats:
    """Return the mean soft loss of each record's residuals."""
    return np.asarray(soft_squares(residuals).mean(axis=-1))


def sensor_error_columns(evidence: Evidence, computed: Complexes) -> tuple[Floats, Floats]:
    """Return how sensors' errors change the residuals, and how they are fitted to them.

    As :meth:`.Evidence.sensor_error` has it: by order 1 alone, with a prior.
    """
    sensors, windows = len(computed), computed.shape[-1]
    columns = np.zeros((sensors, 4, windows, sensors, 3))
    first = np.zeros_like(columns)
    for row in range(sensors):
        changes = evidence.sensor_columns(row, computed[row, 0])
        columns[row, 0, :, row] = changes.real.T
        columns[row, 1, :, row] = changes.imag.T
        first[row] = columns[row]
        higher = np.nan_to_num(np.abs(computed[row, 1:]) / evidence.error[row, 1:])
        columns[row, 2:, :, row, 0] = GAIN_DEVIATION * higher
        columns[row, 2:, :, row, 2] = PARTICIPATION_DEVIATION * higher
    felt = first.reshape(-1, 3 * sensors)
    normal = felt.T @ felt + np.eye(3 * sensors) * PRIOR_WEIGHT**2 * windows
    return columns.reshape(-1, 3 * sensors), np.linalg.solve(normal, felt.T)


def linear_fit(evidence: Evidence, fitted: Fitted, player: Player) -> LinearFit:
    """Return a hypothesis linearised around its fit to the record."""
    search = Search(fitted.hypothesis, evidence, player)
    return LinearFit.from_search(search, fitted.values, cloud_covariance_of_fit(search, fitted))


def cloud_covariance_of_fit(search: Search, fitted: Fitted) -> Floats:
    """Return the covariance of a cloud around a fit: the fit's own, or steps of differences."""
    steps = np.array([difference_step(search, name) for name in fitted.values])
    own = np.sqrt(np.maximum(np.diag(fitted.covariance), 0.1 * steps**2))
    sizes = np.where(np.isfinite(own), own, steps)
    return np.diag([rounded(size) ** 2 for size in sizes.tolist()])


def nearest_fit(
    evidences: tuple[Evidence, Evidence],
    simulation: Simulation,
    player: Player,
    fitted: Fitted,
    bonded: Fitted,
) -> LinearFit:
    """Return a hypothesis linearised around its fit to the other hypothesis's motion."""
    whole, coarse = evidences
    other, values = simulation.fitted, simulation.fitted.values
    near = Search(
        fitted.hypothesis,
        SimulatedEvidence.from_motion(
            coarse, other.hypothesis.displacements(values, coarse, player)
        ),
        player,
    )
    starts = [dict(fitted.values)]
    if isinstance(fitted.hypothesis, Delaminated):
        starts += [bonded_like(fitted, bonded, whole)]
    found = min((descend(near, one, fitted) for one in starts), key=lambda one: one.misfit)
    search = Search(fitted.hypothesis, whole, player)
    return LinearFit.from_search(search, found.values, cloud_covariance_of_fit(search, fitted))


def descend(search: Search, start: Values, fitted: Fitted) -> Solution:
    """Lower the misfit by regressions over clouds of points; round the numbers at each step.

    So the way is the same on every processor, which a search that goes by last bits is not.
    """
    bounds, cloud = (
        search.hypothesis.bounds(search.evidence),
        cloud_covariance_of_fit(search, fitted),
    )
    (here,) = search.rank_starts([start])
    for number, size in enumerate(DESCENTS):
        values = {name: rounded(value) for name, value in here.values.items()}
        model = LinearModel.from_cloud(search.residuals, bounds, values, size * cloud, number)
        minima = [
            {name: rounded(value) for name, value in one.items()}
            for one in model.damped_minima(bounds, values)
        ]
        here = min(here, search.rank_starts(minima)[0], key=lambda one: one.misfit)
    return here


def bonded_like(fitted: Fitted, bonded: Fitted, evidence: Evidence) -> dict[str, float]:
    """Return the delaminated numbers at which both halves move as the bonded structure does."""
    alike = {
        "common": bonded.values["f"],
        "split": 0.0,
        "log_zeta1": bonded.values["log_zeta"],
        "log_zeta2": bonded.values["log_zeta"],
        "clearance": 0.0,
    }
    return {name: alike.get(name, value) for name, value in fitted.values.items()}
