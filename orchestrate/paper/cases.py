"""The paper's three structures, and the numbers of its figures and of what is computed for them."""

from __future__ import annotations

from ..model import Structure

CASES = {
    "elastic": Structure.nondimensional(e=0.7, D=0.005),  # section 3
    "damped": Structure.nondimensional(e=0.7, D=0.05),  # section 4.1
    "plastic": Structure.nondimensional(e=0.3, D=0.005),  # section 4.2
}
ORBITS = {"6": "elastic", "10": "damped", "11": "plastic"}  # figures that are sweeps
BEAM, RIG = "beam", "rig"  # shipped sets: the paper's beam; the nearest to its experiment
MAPS = {"e": (0.05, 0.95), "D": (0.005, 0.15), "kappa": (1.02, 2.0)}  # D in equal ratios
MAP_ETAS = (0.4, 2.2)
GAMMAS = (1e-5, 1e-4, 1e-3, 1e-2, 5e-2)  # ends of chattering (17)
CONTACT_RANGES = {"elastic": (0.400, 0.445), "damped": (0.450, 0.500), "plastic": (0.930, 0.985)}
RESTITUTIONS = (0.01, 0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.95, 0.99, 1.0)  # of sequences (16)
STICKING_GAMMAS = (1e-3, 1e-5, 1e-7, 1e-9)
PANELS: dict[str, tuple[tuple[float, ...], int, int]] = {  # eta, periods (0: many), points a period
    "5": ((0.4,), 1, 4000),
    "7": ((), 20, 200),  # at the relative peaks
    "8": ((0.45, 0.49, 0.59, 0.63, 0.70, 0.80, 0.88, 1.047, 1.08, 1.13, 1.24, 1.31), 0, 150),
    "9": ((2.60, 2.65, 2.69, 2.737, 2.83, 2.92, 3.05, 3.17, 3.30, 3.49, 3.56, 3.70), 0, 60),
    "12": ((), 1, 2000),  # at the main peaks
}
Branch = tuple[float, int, tuple[float, float]]  # eta on it, periods, limits of eta
OF_ALL: dict[str, Branch] = {  # mT/k: k impacts in m periods
    "T/1": (1.6, 1, (0.9, 3.0)),
    "2T/1": (4.2, 2, (3.3, 5.1)),
    "3T/1": (6.2, 3, (5.4, 7.2)),
    "4T/1": (8.0, 4, (7.45, 9.3)),
}
BRANCHES: dict[str, dict[str, Branch]] = {
    "elastic": {
        "T, contact": (0.41, 1, (0.405, 0.45)),
        "T/13": (0.421, 1, (0.41, 0.45)),
        "T/2": (1.0, 1, (0.42, 1.37)),
        "2T/3": (1.36, 2, (1.06, 1.5)),
        **OF_ALL,
    },
    "damped": {
        "T, contact": (0.44, 1, (0.42, 0.5)),
        "T/2": (1.06, 1, (0.42, 1.37)),
        "2T/3": (1.2, 2, (1.06, 1.5)),
        **OF_ALL,
    },
    "plastic": {
        "T, contact": (0.94, 1, (0.92, 1.0)),
        "T/3": (1.0, 1, (0.9, 1.2)),
        "T/2": (1.1, 1, (0.9, 1.37)),
        **OF_ALL,
    },
}
