"""A single mass on a spring that is not linear, on a shaken base: what a sound beam may be.

With x relative to the base and a its acceleration,

    x'' = -a - w^2 (x + q x^2 + c x^3 + stop) - 2 zeta w x' - friction x'/sqrt(x'^2 + slow^2),

where ``stop = s b r max(0, b x - p)`` is a spring that the mass touches on one side (b = 1 or -1).
Classical Runge-Kutta steps, compiled: ``fmu_src/kernels/loops/single_mass.c``.
"""

from __future__ import annotations

import math
from ctypes import c_double, c_int, c_size_t, c_void_p
from dataclasses import dataclass

import numpy as np

from ..constants import TURN
from ..fmu.c_library import load_loop
from ..laboratory.pieces import Floats

# Angle of the natural vibration in a step, rad: its amplitude errs by 1e-7 in a period
MAX_STEP_ANGLE = 0.12


@dataclass(frozen=True)
class SingleMass:
    """Hold the parameters of a single mass on a nonlinear spring, see the equation above."""

    f: float  # hz, w/(2 pi)
    zeta: float
    # q in 1/m, c in 1/m2
    square: float = 0.0
    cube: float = 0.0
    # m/s2 and m/s
    friction: float = 0.0
    slow: float = 1.0
    stop: float = 0.0  # stiffness of the stop over that of the spring, r
    position: float = 0.0  # p, m
    side: float = 1.0  # b

    def displacements(self, cubics: Floats, step: float, bound: float = 1e3) -> Floats:
        """Return displacements, m, at the cubics' beginnings and the end; NaN beyond ``bound``."""
        if not (self.square or self.cube or self.friction or self.stop):
            return self.linear_displacements(cubics, step)
        stiffest = self.f * math.sqrt(1.0 + max(self.stop, 0.0))
        parts = max(1, math.ceil(TURN * stiffest * step / MAX_STEP_ANGLE))
        displacement, w = np.full(len(cubics) + 1, np.nan), TURN * self.f
        smooth = (w * w, 2.0 * self.zeta * w, self.square, self.cube, self.friction, self.slow)
        mass = np.array([*smooth, self.stop, self.position, self.side])
        cubics = np.ascontiguousarray(cubics)
        run = load_loop("single_mass").displace
        run.argtypes = [c_void_p, c_void_p, c_size_t, c_double, c_int, c_double, c_void_p]
        places = mass.ctypes.data, cubics.ctypes.data
        run(*places, len(cubics), step, parts, bound, displacement.ctypes.data)
        return displacement

    def linear_displacements(self, cubics: Floats, step: float) -> Floats:
        """Return the same on a linear spring, exactly: a recursion over the displacements."""
        from scipy.linalg import expm
        from scipy.signal import lfilter

        w = TURN * self.f
        # of displacement, speed, and the base's acceleration with its derivatives
        rates = np.eye(6, k=1)
        rates[1, :3] = -w * w, -2.0 * self.zeta * w, -1.0
        whole = expm(rates * step)
        moved, sped = whole[:2, 2:] @ cubics.T
        (own, by_speed), (_, slows) = whole[:2, :2]
        kicks = np.concatenate([[0.0], moved])
        kicks[2:] += by_speed * sped[:-1] - slows * moved[:-1]
        determinant = math.exp(-2.0 * self.zeta * w * step)
        return np.asarray(lfilter([1.0], [1.0, -own - slows, determinant], kicks))
