"""The paper's three structures, and the parameter ranges of the maps around the first."""

from __future__ import annotations

import numpy as np

from ..structures import Structure

CASES = {
    "elastic": Structure.nondimensional(e=0.7, D=0.005),  # section 3
    "damped": Structure.nondimensional(e=0.7, D=0.05),  # section 4.1
    "plastic": Structure.nondimensional(e=0.3, D=0.005),  # section 4.2
}
ORBITS = {"6": "elastic", "10": "damped", "11": "plastic"}  # figures that are sweeps
RIG = "rig"  # the shipped set that is nearest to the paper's experiment
MAPS = {"e": (0.05, 0.95), "D": (0.005, 0.15), "kappa": (1.02, 2.0)}  # D in equal ratios
MAP_ETAS = (0.4, 2.2)


def map_values(parameter: str, count: int) -> np.ndarray:
    """Return ``count`` values of a parameter over the range of its map."""
    low, high = MAPS[parameter]
    return (np.geomspace if parameter == "D" else np.linspace)(low, high, count)
