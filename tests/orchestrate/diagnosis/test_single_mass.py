"""The sound structure's motion against another integrator."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orchestrate.diagnosis.single_mass import SingleMass
from orchestrate.laboratory.sampled import Sampled

RATE = 500.0
TIME = np.arange(600) / RATE
BASE = 5.0 * np.sin(2 * np.pi * 20.0 * TIME) * np.minimum(1.0, 10.0 * TIME)
MASS = SingleMass(f=22.0, zeta=0.02)
KINDS = {
    "linear": MASS,
    "curved": replace(MASS, square=30.0, cube=8e4),
    "softening": replace(MASS, cube=-2e4),
    "friction": replace(MASS, friction=1.0, slow=0.05),
    "stop": replace(MASS, stop=0.8, position=5e-4, side=-1.0),
}


@pytest.mark.parametrize("name", KINDS)
def test_motion_is_that_of_an_adaptive_integrator(name):
    """One that escapes is no number from there on."""
    mass, pieces = KINDS[name], Sampled(acceleration=tuple(BASE), sample_rate=RATE).pieces()
    w = 2 * np.pi * mass.f

    def slope(t, state):
        x, v = state
        beyond = max(0.0, mass.side * x - mass.position)
        spring = x + mass.square * x**2 + mass.cube * x**3 + mass.side * mass.stop * beyond
        rub = mass.friction * v / np.hypot(v, mass.slow)
        base = pieces.derivatives_at(np.array([t]))[0, 0]
        return [v, -base - w**2 * spring - 2 * mass.zeta * w * v - rub]

    tight = {"rtol": 1e-8, "atol": 1e-12, "max_step": 1e-3}
    exact = solve_ivp(slope, (0.0, TIME[150]), [0.0, 0.0], t_eval=TIME[:150], **tight)
    found = mass.displacements(pieces.derivatives, 1.0 / RATE)
    allowed = 1e-6 if name == "linear" else 2e-4
    np.testing.assert_allclose(found[:150], exact.y[0], atol=allowed * abs(exact.y[0]).max())
    gone = replace(MASS, cube=-1e9).displacements(pieces.derivatives, 1.0 / RATE, bound=0.1)
    assert np.isfinite(gone[0]) and np.isnan(gone[-1])
