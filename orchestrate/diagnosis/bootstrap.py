"""Odds of both kinds of structures by a parametric bootstrap of both fits.

Two hypotheses that do not contain each other are compared by simulation (Cox, Proc. 4th Berkeley
Symp. 1 (1961) 105-123 and J. R. Stat. Soc. B 24 (1962) 406-424; Williams, J. R. Stat. Soc. B 32
(1970) 350; Hinde, in: Advances in GLIM and Statistical Modelling (1992) 115-121). Records are
simulated from the best sound fit and from the best delaminated one, both kinds are fitted to each,
and the logarithm of the ratio of misfits of the measured record is looked up among those of the
simulated ones.

A simulated record is the motion of its fit with

* noise of the base and of the sensors, of the size of the record's floor, and
* what the fit misses beyond noise, multiplied by a normal random function of variance 1 that
  changes slowly over the record (the dependent wild bootstrap: Wu, Ann. Stat. 14 (1986) 1261; Shao,
  J. Am. Stat. Assoc. 105 (2010) 218): real contacts miss more than noise, and what they miss hangs
  together over a resonance. With a function that changes ten times faster, rattling clamps, which
  are sound, get odds of hundreds to one for a delamination.

The fits to simulated records are linearised: residuals are a regression over a cloud of points
(:mod:`.linear`) around the fit to the record, and around the fit to the other hypothesis's motion.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..fmu import Player
from ..laboratory.pieces import Floats
from .evidence import Evidence
from .refit import linear_fit, nearest_fit
from .simulation import SEED, SIMULATED, Fitted, Simulation

WIDE = 1.3  # sound hypotheses up to so many times the lowest misfit are fitted again
# A density that is wide keeps 1 part in so many: what simulations cannot exclude
WIDE_SHARE = 1.0 / SIMULATED
RESAMPLES = 200  # of simulated ratios, for the error of the odds


@dataclass(frozen=True)
class Bootstrap:
    """Hold the ratios of misfits of simulated records, beside that of the measured record."""

    observed: float  # misfit of the best sound fit over that of the delaminated one
    # the same in records of the best sound fit and in records of the delaminated one
    sound: Floats
    delaminated: Floats

    @classmethod
    def from_row(cls, observed: float, ratios: Floats) -> Bootstrap | None:
        """Read the ratios from a job's table, shape (2, records); None if it has none."""
        return cls(observed, *ratios) if np.isfinite(ratios).all() else None

    @property
    def lookalikes(self) -> tuple[int, int]:
        """Count the simulated sound records that look as delaminated as the measured record.

        And of those of the delaminated fit that look as sound.
        """
        above, below = self.sound >= self.observed, self.delaminated <= self.observed
        return int(above.sum()), int(below.sum())

    def sentence(self) -> str:
        """Return sentences on how many of the simulated records look as the measured one does."""
        above, below = (str(number or "none") for number in self.lookalikes)
        count, (odds, error) = len(self.sound), self.odds_with_error()
        ends = " to ".join(f"{odds * math.exp(sign * error):.2g}" for sign in (-1.0, 1.0))
        return (
            f"Of {count} simulated records of the best sound model, {above} looked as delaminated "
            f"as this record. Of {count} simulated records of the delaminated model, {below} "
            "looked as sound as this record. If one of the two models is true, the odds of "
            f"delaminated are {odds:.2g} ({ends}) to 1."
        )

    def odds_with_error(self) -> tuple[float, float]:
        """Return the odds of delaminated against sound, and the standard error of their logarithm.

        The ratio of both densities at the measured record's logarithm of the ratio of misfits.
        The error is that of resampled simulations.
        """
        at = math.log(self.observed)
        logs = np.log(self.delaminated), np.log(self.sound)
        scale = float(np.ptp(np.concatenate([*logs, [at]])))
        best = log_odds(at, logs, scale)
        rng = np.random.default_rng([SEED, 3])
        again = [
            log_odds(at, tuple(rng.choice(one, len(one)) for one in logs), scale)
            for _ in range(RESAMPLES)
        ]
        return math.exp(best), float(np.std(again))


def log_odds(at: float, logs: Sequence[Floats], scale: float) -> float:
    """Return the logarithm of the odds of two densities at one value, from samples of both."""
    over, under = (log_density(at, one, scale) for one in logs)
    return over - under


def log_density(at: float, samples: Floats, scale: float) -> float:
    """Estimate the logarithm of a density from samples, by normal kernels of Silverman's width.

    A wide normal distribution takes part with a share of ``WIDE_SHARE``: samples that are few
    exclude nothing far away.
    """
    low, high = np.quantile(samples, (0.25, 0.75))
    spread = min(float(np.std(samples)), float(high - low) / 1.34)
    width = max(0.9 * spread * len(samples) ** -0.2, 1e-3)
    near = float(np.mean(np.exp(-0.5 * ((at - samples) / width) ** 2))) / width
    away = max(scale, width)
    wide = math.exp(-0.5 * ((at - float(np.median(samples))) / away) ** 2) / away
    return math.log((1.0 - WIDE_SHARE) * near + WIDE_SHARE * wide)


def bootstrap(
    evidence: Evidence,
    coarse: Evidence,
    sound: Sequence[Fitted],
    delaminated: Fitted,
    player: Player,
) -> Bootstrap:
    """Simulate records of the best sound and of the delaminated fit, and fit both kinds to each."""
    best = min(sound, key=lambda one: one.misfit)
    kept = [one for one in sound if one.misfit <= WIDE * best.misfit]
    kinds = (kept, [delaminated])
    simulations = [
        Simulation.from_fit(evidence, one, player, seed)
        for seed, one in enumerate((best, delaminated))
    ]
    at_record = [[linear_fit(evidence, one, player) for one in kind] for kind in kinds]
    ratios = []
    for number, simulation in enumerate(simulations):
        models = [list(one) for one in at_record]
        places = (evidence, coarse), simulation, player
        models[1 - number] += [nearest_fit(*places, one, best) for one in kinds[1 - number]]
        misfits = [np.min([m.misfits(simulation.changes) for m in kind], axis=0) for kind in models]
        ratios.append(misfits[0] / misfits[1])
    return Bootstrap(best.misfit / delaminated.misfit, *ratios)
