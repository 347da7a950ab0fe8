"""Random sets, as a laboratory would build and as users may enter, against the whole system."""

import numpy as np
import pytest

from orchestrate import Drive, Structure
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.couple import scheme_from_arguments

from ...sparing import ordinary
from .coupled import System, master, rest, state_of
from .monolithic import Monolith

SEED = 13
RANGES = {  # of what a laboratory would build
    **{"m1": (0.5, 5.0), "omega": (20.0, 200.0), "length": (1e-4, 1e-3), "constant": (0.02, 0.2)},
    **{"mu": (0.5, 2.0), "kappa": (1.05, 2.0), "D1": (0.005, 0.02), "D2": (0.005, 0.02)},
    **{"e": (0.3, 0.9), "beta": (0.1, 0.4), "epsilon": (3e-4, 2e-3), "b": (0.02, 0.1)},
    **{"Omega_b": (0.05, 0.3), "D_b": (0.005, 0.05), "lag": (0.0, 1.0)},
}
WIDE = {  # of what users may enter
    **RANGES,
    **{"mu": (0.25, 4.0), "kappa": (0.4, 3.0), "D1": (0.0, 0.2), "D2": (0.0, 0.2)},
    **{"e": (0.05, 0.95), "b": (0.004, 0.1)},
}


def random_sets(count, seed=SEED, ranges=RANGES):
    rng = np.random.default_rng(seed)
    return [made({name: rng.uniform(*ends) for name, ends in ranges.items()}) for _ in range(count)]


def made(v):
    m1, omega = v["m1"], v["omega"]
    k1, m2 = m1 * omega**2, v["mu"] * m1
    dampers = {"d1": 2.0 * v["D1"] * omega * m1, "d2": 2.0 * v["D2"] * omega * m2}
    structure = Structure(m1=m1, m2=m2, k1=k1, k2=v["kappa"] * k1, e=v["e"], **dampers)
    units = {"structure": structure, "length": v["length"], "motor_constant": v["constant"]}
    names = ("beta", "epsilon", "b", "Omega_b", "D_b")
    drive = Drive.nondimensional(**{name: v[name] for name in names}, **units)
    return System(structure, drive).with_lag(v["lag"] / omega)


def trajectory_error(system, time, lead=300.0):
    """Largest error of the displacements over the amplitude, and the impacts on the way; after a
    lead in 1/omega, below the resonance, from a flight unless bonded.
    """
    structure, drive = system
    Omega = 0.985 * averaged.bonded_resonance(*system.as_bonded())
    volts = float(averaged.stationary_voltage(*system.as_bonded(), Omega)) * drive.volts(structure)
    scheme = scheme_from_arguments(structure, None)
    with master(system, scheme, rest(Omega * structure.omega)) as m:
        while m.time * structure.omega < lead or (
            m.motion.x1 == m.motion.x2 and not structure.bonded
        ):
            m.step(volts)
        state = state_of(m)
    state[6] %= 2.0 * np.pi
    rows = [state]
    with master(system, scheme, state) as m:
        for _ in range(round(time / structure.omega / scheme.h)):
            m.step(volts)
            rows.append(state_of(m))
    times = scheme.h * np.arange(len(rows))
    truth, impacts = Monolith(*system, volts).solve(state, times)
    errors = np.abs(np.array(rows) - truth)[:, [0, 2]]
    return errors.max() / np.abs(truth[:, 0]).max(), impacts


@pytest.mark.parametrize("system", ordinary(random_sets(5), 1), ids=range(5))
def test_a_set(system):
    error, impacts = trajectory_error(system, 20.0)
    assert impacts > 2 and error < 1e-6
    assert trajectory_error(system.as_bonded(), 20.0) == (pytest.approx(0.0, abs=1e-6), 0)


@pytest.mark.parametrize("system", ordinary(random_sets(12, 5, WIDE)), ids=range(12))
def test_a_set_as_users_may_enter(system):
    """Strong dampers of different ratios make the force jump at impacts: a larger error."""
    assert trajectory_error(system, 20.0)[0] < 1e-5
