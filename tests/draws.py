"""Random structures, drives and beams of the campaigns and of the referee, each from a seed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from orchestrate import Drive, Structure
from orchestrate.weak_drive import averaged

from .benches.recipe import Case, Conditions, draw_levels, draw_log_uniform

USUAL, WIDE = (0.01, 0.05), (0.001, 0.1)  # noise of a record: usual of a laboratory, and any
BEAMS = (  # kinds, one after the other: the two that the targets are about are drawn more often
    *("sound", "delaminated", "hardening", "delaminated", "friction", "gap"),
    *("sound", "preloaded", "clamp", "delaminated", "intact elements", "elements", "sagging"),
)
RATES = (2e-4, 1e-4, 5e-5, 2e-5)  # of ramps of a drive, of eta0 in a time 1/omega
NARROW = 2e-4  # of eta0: folds so close are left out, a bracket is half as wide


class System(NamedTuple):
    """A structure and its drive."""

    structure: Structure
    drive: Drive

    def of_kind(self, kind: str) -> System:
        bonded = kind == "bonded"
        structure = self.structure.as_bonded() if bonded else self.structure.as_delaminated()
        return self._replace(structure=structure)


def draw_structure(rng: np.random.Generator) -> tuple[Structure, float]:
    """Draw a structure and a frequency ratio, as widely as users may enter them."""
    ratios = draw_ratios(rng, 0.002)
    e, clearance = float(rng.uniform(0.05, 0.95)), float(rng.choice([-1.0, 0.0, 1.0]))
    clearance *= draw_log_uniform(rng, 1e-3, 8.0)
    structure = Structure.nondimensional(**ratios, e=e, clearance=clearance)
    return structure, draw_log_uniform(rng, 0.3, 5.0)


def draw_ratios(rng: np.random.Generator, least_damping: float) -> dict[str, float]:
    ends = {"mu": (0.25, 4.0), "kappa": (0.4, 3.0)}
    ends |= dict.fromkeys(("D1", "D2"), (least_damping, 0.2))
    return {name: draw_log_uniform(rng, *pair) for name, pair in ends.items()}


def draw_system(rng: np.random.Generator) -> System:
    """Draw a structure with a drive, as widely as users may enter them."""
    ratios = draw_ratios(rng, 0.003)
    contact = {"e": float(rng.uniform(0.05, 0.95)), "clearance": float(rng.uniform(-8.0, 8.0))}
    contact["clearance"] *= bool(rng.random() < 0.7)
    motor = {"b": draw_log_uniform(rng, 0.004, 0.5), "beta": float(rng.uniform(0.05, 0.4))}
    motor["epsilon"] = float(rng.uniform(3e-4, 2e-3))
    box = {"Omega_b": float(rng.uniform(0.05, 0.3)), "D_b": float(rng.uniform(0.005, 0.05))}
    structure = Structure.nondimensional(**ratios, **contact)
    return System(structure, Drive.nondimensional(**motor, **box, structure=structure))


def draw_with_folds(rng: np.random.Generator) -> System:
    """Draw systems until one has clearly separated averaged folds."""
    while True:
        system = draw_system(rng)
        folds = averaged.folds(*system)
        if folds and folds[0].eta0 - folds[-1].eta0 > NARROW:
            return system


def smallest_slope(system: System, count: int = 10_001) -> float:
    """Return the smallest slope d eta0 / d Omega at the resonance; negative with folds."""
    numerator, denominator = averaged.slope_polynomials(*system)
    low = averaged.eta_between_box_and_bonded_resonance(*system)
    peak = averaged.bonded_resonance(*system)
    near = peak + averaged.bonded_resonance_half_width(*system) * np.linspace(-20.0, 20.0, count)
    speeds = np.concatenate([np.linspace(low, 2.0 * peak, count), near[near > low]])
    return float((numerator(speeds) / denominator(speeds)).min())


def scale_to_slope(system: System, slope: float) -> System:
    """Scale the unbalance so that the branch has a given smallest slope."""
    structure, drive = system
    share = (1.0 - slope) / (1.0 - smallest_slope(system))
    numbers = {n: getattr(drive, n)(structure) for n in ("beta", "b", "Omega_b", "D_b")}
    numbers["epsilon"] = drive.epsilon * share
    return System(structure, Drive.nondimensional(**numbers, structure=structure))


def ramp_ends(system: System) -> tuple[float, float]:
    """Return the two ends of the voltage ramp, over K omega, past both jumps."""
    at_resonance = averaged.stationary_voltage(*system, averaged.bonded_resonance(*system))
    places = [fold.eta0 for fold in averaged.folds(*system)] or [float(at_resonance)]
    return min(places) - 0.15, max(places) + 0.15


def draw_beam(seed: int, number: int) -> Case:
    """Draw a beam of the benches with its record; its kind follows from its number and seed."""
    rng = np.random.default_rng([seed, number])
    kind = BEAMS[(seed + number) % len(BEAMS)]
    noise = USUAL if rng.random() < 0.6 else WIDE
    return draw_levels(rng, kind, Conditions(noise=noise, excitation="any"))[0]
