"""How long an interval may be: what its series leaves out is below the last digit.

With displacement, velocity and current scaled by the energies that they store, the system's matrix
is a skew one, of norm ``sqrt(k/M + Bl^2/(M L))``, and a diagonal one, of norm ``max(c/M, R/L)``.
Behind the terms that the cubics reach, term n + 1 of a series is at most the sum of both, times the
interval over n + 1, of term n: with 1 radian and degree 18 all that follow are below 1e-15 of the
fourth.
"""

import math

from . import memory as at

LONGEST = 1024.0  # s
SHORTEST = 2.0**-192  # s: whatever the parameters, unless the inductance is next to nothing


def set_spacings(m):
    """Set the lengths of intervals: powers of two, so that their sums are exact."""
    mass, damping = m[at.TABLE_MASS], m[at.SUSPENSION_DAMPING]
    stiffness, factor = m[at.SUSPENSION_STIFFNESS] / mass, m[at.FORCE_FACTOR] * m[at.FORCE_FACTOR]
    free = math.sqrt(stiffness)
    inductance, resistance = m[at.COIL_INDUCTANCE], m[at.COIL_RESISTANCE]
    if inductance > 0.0:
        coupled = math.sqrt(stiffness + factor / mass / inductance)
        driven = coupled + max(damping / mass, resistance / inductance)
    else:
        driven = free + (damping + factor / resistance) / mass
    m[at.VOLTAGE_SPACING] = longest_spacing(driven)
    m[at.CURRENT_SPACING] = longest_spacing(free + damping / mass)


def longest_spacing(rate):
    """Return the longest power of two, s, in which a ``rate`` makes no more than one radian."""
    length = LONGEST
    while length * rate > 1.0:
        length *= 0.5
    return length
