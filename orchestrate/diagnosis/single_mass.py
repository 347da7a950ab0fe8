"""A single mass on a spring that is not linear, on a shaken base: what a sound beam may be.

With x relative to the base and a its acceleration,

    x'' = -a - w^2 (x + q x^2 + c x^3 + stop) - 2 zeta w x' - friction x'/sqrt(x'^2 + slow^2),

where ``stop = s b r max(0, b x - p)`` is a spring that the mass meets on one side (b = 1 or -1).
Classical Runge-Kutta steps, ``single_mass.c`` where it can be compiled.
"""

from __future__ import annotations

import functools
import logging
import math
from ctypes import c_double, c_int, c_ssize_t, c_void_p
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..fmu.c_library import loaded_function
from ..laboratory.pieces import Floats

log = logging.getLogger(__name__)
SOURCE = Path(__file__).with_suffix(".c")
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

    def coefficients(self) -> tuple[float, ...]:
        """Return the coefficients of the equation in the order that the integrator takes."""
        w = 2.0 * math.pi * self.f
        smooth = (w * w, 2.0 * self.zeta * w, self.square, self.cube, self.friction, self.slow)
        return (*smooth, self.stop, self.position, self.side)

    def displacements(self, cubics: Floats, step: float, bound: float = 1e3) -> Floats:
        """Return the relative displacement, m, at each cubic's beginning and at the end."""
        stiffest = self.f * math.sqrt(1.0 + max(self.stop, 0.0))
        parts = max(1, math.ceil(2.0 * math.pi * stiffest * step / MAX_STEP_ANGLE))
        found = np.full(len(cubics) + 1, np.nan)
        run = run_function() or run_in_python
        run(self.coefficients(), np.ascontiguousarray(cubics), step, parts, bound, found)
        return found


@functools.cache
def run_function() -> Any:
    """Load the library's function, once per process; return None where there is no library."""
    run = loaded_function(SOURCE)
    if run is None:
        return None
    run.argtypes = [c_void_p, c_void_p, c_ssize_t, c_double, c_int, c_double, c_void_p]
    run.restype = c_ssize_t

    def run_compiled(numbers: tuple[float, ...], cubics: Floats, *rest: Any) -> int:
        *settings, out = rest
        array = np.array(numbers)
        arguments = array.ctypes.data, cubics.ctypes.data, len(cubics), *settings
        return int(run(*arguments, out.ctypes.data))

    return run_compiled


def run_in_python(
    numbers: tuple[float, ...], cubics: Floats, step: float, parts: int, bound: float, out: Floats
) -> int:
    """Integrate one mass under cubic excitation in Python; return how many cubics were done."""
    stiffness, damping, square, cube, friction, slow, stop, position, side = numbers

    def acceleration(base: float, x: float, v: float) -> float:
        beyond = side * x - position
        spring = x + square * x * x + cube * x * x * x
        if beyond > 0.0:
            spring = spring + side * stop * beyond
        force = stiffness * spring + damping * v
        if friction != 0.0:
            force = force + friction * (v / math.sqrt(v * v + slow * slow))
        return -base - force

    x, v, h = 0.0, 0.0, step / parts
    out[0] = x
    for number, c in enumerate(cubics.tolist()):
        right = c[0]
        for part in range(parts):
            t, u, left = part * h + 0.5 * h, part * h + h, right
            middle = c[0] + t * (c[1] + t * (0.5 * c[2] + t * c[3] / 6.0))
            right = c[0] + u * (c[1] + u * (0.5 * c[2] + u * c[3] / 6.0))
            a1 = acceleration(left, x, v)
            v2 = v + 0.5 * h * a1
            a2 = acceleration(middle, x + 0.5 * h * v, v2)
            v3 = v + 0.5 * h * a2
            a3 = acceleration(middle, x + 0.5 * h * v2, v3)
            v4 = v + h * a3
            a4 = acceleration(right, x + h * v3, v4)
            x = x + h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
            v = v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        if not abs(x) < bound:
            return number
        out[number + 1] = x
    return len(cubics)
