"""Stiffness and damping constants from frequencies and damping ratios, and back."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping

from ..errors import InputError
from .ranges import invert_exactly


def stiffness_from_frequency(f: float, mass: float) -> float:
    """Return the stiffness, N/m, that gives a mass the natural frequency f, Hz: m (2 pi f)^2."""
    omega = 2.0 * math.pi * f
    return mass * (omega * omega)


def damping_from_ratio(ratio: float, omega: float, mass: float) -> float:
    """Return the damping constant, N s/m, from a damping ratio D: d = 2 D omega m (8)."""
    return 2.0 * ratio * omega * mass


def natural_frequency(spring: float, mass: float) -> float:
    """Return a mass's natural frequency, Hz; inverse of :func:`stiffness_from_frequency`."""
    guess = math.sqrt(spring / mass) / (2.0 * math.pi)
    return invert_exactly(guess, lambda f: stiffness_from_frequency(f, mass), spring)


def damping_ratio(damper: float, f: float, mass: float) -> float:
    """Return the damping ratio (1: critical) from a damping constant and a frequency, Hz."""
    omega = 2.0 * math.pi * f
    ratio = damper / (2.0 * omega * mass)
    return invert_exactly(ratio, lambda guess: damping_from_ratio(guess, omega, mass), damper)


def checked_thicknesses(thicknesses: tuple[float, float]) -> tuple[float, float]:
    try:
        h1, h2 = (float(h) for h in thicknesses)
        share = h1 / (h1 + h2)
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        share = math.nan
    if not (0.0 < share < 1.0 and h1 > 0.0):
        text = "expected two numbers > 0, of layers 1 and 2"
        raise InputError(f"thicknesses = {thicknesses!r}: {text}")
    return h1, h2


def warn_of_ratios_in_per_cent(ratios: Mapping[str, float]) -> None:
    """Warn about damping ratios, by name, so large that per cent was probably meant."""
    for name, ratio in ratios.items():
        if ratio > 0.3:  # damping ratio above which a half of a beam would hardly ring
            text = f"{name} = {ratio:g} is {100.0 * ratio:.4g} % of critical damping"
            hint = f"a ratio is meant, {ratio:g} % is {0.01 * ratio:g}"
            warnings.warn(f"{text}: {hint}", stacklevel=3)
