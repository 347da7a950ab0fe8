"""The event function between two nodes: a quintic through both, and what it may miss.

The quintic that shares value and two derivatives with the event function at both ends of an
interval of length h misses at most ``B6 s^3 (1-s)^3 h^6/720``, B6 a bound of the sixth derivative,
s in [0, 1]. As ``s (1-s) <= 1/4`` that is at most ``r (b_2(s) + b_3(s))`` with ``r = B6 h^6/28800``
and the Bernstein polynomials b_2, b_3 of degree five: lowering two Bernstein coefficients by r
gives a quintic below the event function, and where no coefficient of it is negative there is no
root.
"""

import math

from . import memory as at

SAFETY = (
    1.0 - 0.00048828125
)  # how far before the lower quintic's root the clear part is taken to end


def bernstein_coefficients(m, l0, l1, l2, r0, r1, r2, low):
    """Return the six Bernstein coefficients of the quintic, b_2 and b_3 lowered by ``low``."""
    fifth, twentieth = m[at.HERMITE], m[at.HERMITE + 1]
    l1, r1 = fifth * l1, fifth * r1
    b2 = (l0 + 2.0 * l1) + (twentieth * l2 - low)
    b3 = (r0 - 2.0 * r1) + (twentieth * r2 - low)
    return l0, l0 + l1, b2, b3, r0 - r1, r0


def interval_coefficients(m, low):
    return bernstein_coefficients(
        m,
        m[at.LEFT_VALUES],
        m[at.LEFT_VALUES + 1],
        m[at.LEFT_VALUES + 2],
        m[at.RIGHT_VALUES],
        m[at.RIGHT_VALUES + 1],
        m[at.RIGHT_VALUES + 2],
        low,
    )


def lowest_left_coefficient(m, h0, h1, h2, low):
    """Return the lowest of the three coefficients at the left end of an interval."""
    fifth = m[at.HERMITE] * h1
    b2 = (h0 + 2.0 * fifth) + (m[at.HERMITE + 1] * h2 - low)
    return min(h0, min(h0 + fifth, b2))


def lowest_right_coefficient(m, h0, h1, h2, low):
    """Return the lower of the two inner coefficients at the right end of an interval."""
    fifth = m[at.HERMITE] * h1
    b3 = (h0 - 2.0 * fifth) + (m[at.HERMITE + 1] * h2 - low)
    return min(h0 - fifth, b3)


def excludes_root(b0, b1, b2, b3, b4, b5):
    """Return whether the coefficients prove no root, but perhaps at the interval's start."""
    return min(min(b0, b1), min(b2, b3), b4) >= 0.0 and b5 > 0.0


def is_interval_below(m, ceiling):
    b0, b1, b2, b3, b4, b5 = interval_coefficients(m, -m[at.REMAINDER])
    return max(max(b0, b1), max(b2, b3), max(b4, b5)) <= ceiling


def may_have_summit(m, start, stop):
    """Return whether the event function may have a summit in a part of the present interval.

    It has none where its slope at the start outweighs what curvature and third derivative make of
    it. The quintic's derivatives miss at most ``sqrt(5) h^5 B6/30000``, ``h^4 B6/1920`` and ``h^3
    B6/120``: 2.15, 15 and 240 times the remainder over h, h^2 and h^3.
    """
    low = m[at.REMAINDER]
    b0, b1, b2, b3, b4, b5 = interval_coefficients(m, 0.0)
    d0, d1, d2, d3, d4 = b1 - b0, b2 - b1, b3 - b2, b4 - b3, b5 - b4
    e0, e1, e2, e3 = d1 - d0, d2 - d1, d3 - d2, d4 - d3
    f0, f1, f2 = e1 - e0, e2 - e1, e3 - e2
    g0, g1 = f1 - f0, f2 - f1
    part = 1.0 / m[at.SPACING]
    s, length = (start - m[at.LEFT_AGE]) * part, (stop - start) * part
    slope = 5.0 * (d0 + s * (4.0 * e0 + s * (6.0 * f0 + s * (4.0 * g0 + s * (g1 - g0)))))
    curvature = 20.0 * (e0 + s * (3.0 * f0 + s * (3.0 * g0 + s * (g1 - g0))))
    third = 60.0 * max(abs(f0), abs(f1), abs(f2)) + 240.0 * low
    change = (abs(curvature) + 15.0 * low + 0.5 * third * length) * length
    return abs(slope) <= change + 2.15 * low


def clear_part(b0, b1, b2, b3, b4, b5):
    """Return a part of an interval, from its start, where a quintic has no root; 0 if none is
    proved.

    Near the quintic's root from the right, found by Newton's method; the coefficients of the
    quintic's part before it prove that it is clear.
    """
    s = 0.5
    if b5 < 0.0:
        s = point_before_last_root(b0, b1, b2, b3, b4, b5)
    return s if 0.0 < s < 1.0 and is_part_clear(b0, b1, b2, b3, b4, b5, s) else 0.0


def point_before_last_root(b0, b1, b2, b3, b4, b5):
    """Return a point just before the last root of a quintic negative at 1; 0 if none is found."""
    a1, a2 = 5.0 * (b1 - b0), 10.0 * ((b2 - b1) - (b1 - b0))
    a3 = 10.0 * ((b3 - b0) - 3.0 * (b2 - b1))
    a4 = 5.0 * ((b4 + b0) - 4.0 * (b3 + b1) + 6.0 * b2)
    a5 = (b5 - b0) - 5.0 * (b4 - b1) + 10.0 * (b3 - b2)
    fall, bend = 5.0 * (b4 - b5), 10.0 * ((b5 - b4) - (b4 - b3))
    square = fall * fall - 4.0 * bend * b5
    if square <= 0.0:
        return 0.0
    root = math.sqrt(square)
    if fall + root <= 0.0:
        return 0.0
    s = 1.0 + 2.0 * b5 / (fall + root)
    for _ in range(4):
        value = (b0 + s * a1) + s * s * ((a2 + s * a3) + s * s * (a4 + s * a5))
        slope = (a1 + 2.0 * s * a2) + s * s * ((3.0 * a3 + 4.0 * s * a4) + s * s * 5.0 * a5)
        if slope >= 0.0:
            return 0.0
        step = value / slope
        s -= step
        if -0.004 < step < 0.004:
            break
    return s * SAFETY


def is_part_clear(b0, b1, b2, b3, b4, b5, s):
    """Return whether the part up to s has no negative coefficient, by de Casteljau's algorithm."""
    if b0 < 0.0:
        return False
    b0, b1, b2, b3, b4 = (
        b0 + s * (b1 - b0),
        b1 + s * (b2 - b1),
        b2 + s * (b3 - b2),
        b3 + s * (b4 - b3),
        b4 + s * (b5 - b4),
    )
    if b0 < 0.0:
        return False
    b0, b1, b2, b3 = b0 + s * (b1 - b0), b1 + s * (b2 - b1), b2 + s * (b3 - b2), b3 + s * (b4 - b3)
    if b0 < 0.0:
        return False
    b0, b1, b2 = b0 + s * (b1 - b0), b1 + s * (b2 - b1), b2 + s * (b3 - b2)
    if b0 < 0.0:
        return False
    b0, b1 = b0 + s * (b1 - b0), b1 + s * (b2 - b1)
    return b0 >= 0.0 and b0 + s * (b1 - b0) > 0.0
