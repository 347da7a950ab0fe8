"""Sine, cosine and exponential function from ``+ - * /`` and ``floor``.

The mathematical libraries of different systems, and different processors under one library, round
these functions differently; a chaotic trajectory shows it after some hundred impacts. Here they are
Taylor polynomials on a reduced argument, truncated below 1e-19, so that every machine gives the
same bits. Errors stay within 2 units in the last place.
"""

import math

TWO_PI = 6.283185307179586
LOG2_E = 1.4426950408889634
LN2_HIGH = 6.93147180369123816490e-01  # the upper 33 bits of ln 2: k times it is exact
LN2_LOW = 1.90821492927058770002e-10
EXP_ZERO = 700.0  # e^-700 = 1e-304: from here on zero, before subnormal numbers begin


def sincos_turns(u):
    """Return sine and cosine of ``2 pi u``, ``|u| < 2**50``: turns reduce without any rounding."""
    nearest = 4.0 * u + 0.5
    x = (u - 0.25 * math.floor(nearest)) * TWO_PI
    y = x * x
    y2 = y * y  # the polynomials in pairs of pairs: shorter chains of dependent operations
    y4 = y2 * y2
    s = (-1.0 / 6.0 + y * (1.0 / 120.0)) + y2 * (-1.0 / 5040.0 + y * (1.0 / 362880.0))
    s += y4 * (
        (-1.0 / 39916800.0 + y * (1.0 / 6227020800.0))
        + y2 * (-1.0 / 1307674368000.0 + y * (1.0 / 355687428096000.0))
    )
    s = s * y * x + x
    c = (1.0 / 24.0 - y * (1.0 / 720.0)) + y2 * (1.0 / 40320.0 - y * (1.0 / 3628800.0))
    c += y4 * ((1.0 / 479001600.0 - y * (1.0 / 87178291200.0)) + y2 * (1.0 / 20922789888000.0))
    c = c * y2 - 0.5 * y + 1.0
    quarter = math.floor(nearest) & 3
    if quarter == 0:
        return s, c
    if quarter == 1:
        return c, -s
    if quarter == 2:
        return -s, -c
    return -c, s


def exp_decay(x):
    """Return ``e**-x`` for ``x >= 0``; 0 from 700 on."""
    if x > EXP_ZERO:
        return 0.0
    k = math.floor(x * LOG2_E + 0.5)
    r = (k * LN2_HIGH - x) + k * LN2_LOW
    r2 = r * r
    r4 = r2 * r2
    y = (1.0 / 6.0 + r * (1.0 / 24.0)) + r2 * (1.0 / 120.0 + r * (1.0 / 720.0))
    y += r4 * ((1.0 / 5040.0 + r * (1.0 / 40320.0)) + r2 * (1.0 / 362880.0 + r * (1.0 / 3628800.0)))
    y += r4 * r4 * (1.0 / 39916800.0 + r * (1.0 / 479001600.0 + r * (1.0 / 6227020800.0)))
    y = r2 * (r * y + 0.5) + r + 1.0
    while k >= 16:
        y *= 1.0 / 65536.0
        k -= 16
    while k > 0:
        y *= 0.5
        k -= 1
    return y


def fraction_of_turn(u):
    """Return the part of ``u`` in [0, 1): an angle in turns without its full turns."""
    f = u - math.floor(u)
    return f if f < 1.0 else 0.0


def cosine_and_sinc(y):  # inline
    """Return ``cos x``, ``sin(x)/x`` of ``y = x**2``, ``|y| <= 0.42``; cosh, sinh where y < 0."""
    y2 = y * y
    y4 = y2 * y2
    c = (1.0 - y * 0.5) + y2 * (1.0 / 24.0 - y * (1.0 / 720.0))
    c += y4 * (
        (1.0 / 40320.0 - y * (1.0 / 3628800.0))
        + y2 * (1.0 / 479001600.0 - y * (1.0 / 87178291200.0))
    )
    s = (1.0 - y * (1.0 / 6.0)) + y2 * (1.0 / 120.0 - y * (1.0 / 5040.0))
    s += y4 * (
        (1.0 / 362880.0 - y * (1.0 / 39916800.0))
        + y2 * (1.0 / 6227020800.0 - y * (1.0 / 1307674368000.0))
    )
    return c, s


def small_decay(x):  # inline
    """Return ``e**-x`` for ``|x| <= 0.7``."""
    if -0.03125 <= x <= 0.03125:
        x2 = x * x
        y = (0.5 - x * (1.0 / 6.0)) + x2 * (1.0 / 24.0 - x * (1.0 / 120.0))
        return 1.0 - (x - x2 * (y + x2 * x2 * (1.0 / 720.0 - x * (1.0 / 5040.0))))
    z = 0.5 * x
    z2 = z * z
    z4 = z2 * z2
    y = (0.5 - z * (1.0 / 6.0)) + z2 * (1.0 / 24.0 - z * (1.0 / 120.0))
    y += z4 * ((1.0 / 720.0 - z * (1.0 / 5040.0)) + z2 * (1.0 / 40320.0 - z * (1.0 / 362880.0)))
    y += z4 * z4 * ((1.0 / 3628800.0 - z * (1.0 / 39916800.0)) + z2 * (1.0 / 479001600.0))
    root = 1.0 - (z - z2 * y)
    return root * root
