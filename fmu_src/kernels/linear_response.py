"""What a response's structure and excitation tell of it: places at rest, and whether it impacts.

In the subset of Python that :mod:`fmu_src.export.translation` translates, over a flat memory.
"""

import math

# given, then found
M1, M2, K1, K2, D1, D2, CLEARANCE, BONDED, OMEGA, BOX_FREQUENCY, BOX_AMPLITUDE = range(11)
GAP_OFFSET, REST_1, REST_2, MUST_IMPACT, TRAITS = range(11, 16)
ROUNDING = 1e-12  # of the level at which the linear response opens or touches


def describe(m, time):
    """Write the gap between unloaded springs, the places of rest, and whether it must impact."""
    offset = m[CLEARANCE]
    if m[BONDED] != 0.0:
        offset = 0.0
    preload = max(0.0, -offset) * m[K2] / (1.0 + m[K2] / m[K1])
    m[GAP_OFFSET] = offset
    m[REST_1] = 0.0 - preload / m[K1]
    m[REST_2] = preload / m[K2]
    m[MUST_IMPACT] = 0.0
    if exceeds_threshold(m, offset):
        m[MUST_IMPACT] = 1.0
    return 0


def exceeds_threshold(m, offset):
    """Return whether the linear response opens or touches, so that no response can stay linear.

    With a gap the masses move alone, (11) with i = 1, 2, and touch where the amplitude of x2 - x1
    is the gap; with a preload they move as one, i = 3, and part where the force (18) is 0.
    """
    if offset == 0.0:
        return False
    eta = m[BOX_FREQUENCY] / m[OMEGA]
    first, second = m[K1] / m[M1], m[K2] / m[M2]
    both, mass = m[K1] + m[K2], m[M1] + m[M2]
    rate, square = m[OMEGA], m[OMEGA] * m[OMEGA]
    loss_1, loss_2 = eta * m[D1] / m[M1] / rate, eta * m[D2] / m[M2] / rate
    difference = length((first - second) / square, loss_1 - loss_2) * eta * eta * m[BOX_AMPLITUDE]
    if offset < 0.0:
        share = second / (both / mass)
        answer = length(both / mass / square - eta * eta, eta * (m[D1] + m[D2]) / mass / rate)
        return difference > -offset * share * answer * (1.0 + ROUNDING)
    answer = length(first / square - eta * eta, loss_1)
    answer = answer * length(second / square - eta * eta, loss_2)
    return difference > offset * answer * (1.0 + ROUNDING)


def length(real, imaginary):
    """Return the absolute value of a complex number."""
    return math.sqrt(real * real + imaginary * imaginary)
