"""Warnings about parameters that are in range but implausible, such as damping in per cent."""

from __future__ import annotations

import warnings
from collections.abc import Mapping


def warn_of_per_cent(ratios: Mapping[str, float]) -> None:
    """Warn about damping ratios, by name, so large that per cent was probably meant."""
    for name, ratio in ratios.items():
        if ratio > 0.3:  # damping ratio above which a half of a beam would hardly ring
            warnings.warn(
                f"{name} = {ratio:g} is {100.0 * ratio:.4g} % of critical damping: a ratio is "
                f"meant, {ratio:g} % is {0.01 * ratio:g}",
                stacklevel=3,
            )
