"""Rest positions, and the box amplitude above which no response without impacts exists.

In the subset of Python that :mod:`fmu_src.export.translation` translates, over a flat memory.
"""

import math

# given; then written
M1, M2, K1, K2, D1, D2, CLEARANCE, BONDED, WALL, STROKE = range(10)
OMEGA, BOX_FREQUENCY, BOX_AMPLITUDE, PUSHED = range(10, 14)
GAP_OFFSET, REST_1, REST_2, THRESHOLD, MUST_IMPACT, TRAITS = range(14, 20)
LEVEL_ROUNDING = 1e-12  # of the level at which the linear response opens or touches
NEVER = float("inf")


def write_rest_and_threshold(m, time):
    """Write the unloaded gap, places of rest, threshold, and whether the excitation exceeds it."""
    offset = m[CLEARANCE]
    if m[BONDED] != 0.0:
        offset = 0.0
    preload = max(0.0, -offset) * m[K2] / (1.0 + m[K2] / m[K1])
    m[GAP_OFFSET] = offset
    m[REST_1] = 0.0 - preload / m[K1]
    m[REST_2] = preload / m[K2]
    if m[WALL] != 0.0:
        m[REST_1] = min(0.0, offset)
        m[REST_2] = 0.0
    m[THRESHOLD] = contact_threshold(m, offset)
    m[MUST_IMPACT] = 0.0
    if m[WALL] != 0.0 or m[STROKE] != 0.0 or m[PUSHED] != 0.0:
        return 0
    if offset != 0.0 and m[BOX_AMPLITUDE] > m[THRESHOLD] * (1.0 + LEVEL_ROUNDING):
        m[MUST_IMPACT] = 1.0
    return 0


def contact_threshold(m, offset):
    """Return the box amplitude at which the linear response opens or touches.

    With a gap each mass moves freely, (11) with i = 1, 2, and touch where the amplitude of x2 - x1
    is the gap; with a preload they move as one, i = 3, and part where the force (18) is 0.
    """
    if m[BONDED] != 0.0:
        return NEVER
    omega = m[OMEGA]
    eta, square = m[BOX_FREQUENCY] / omega, omega * omega
    both, mass = m[K1] + m[K2], m[M1] + m[M2]
    stiff_1, stiff_2, stiff_3 = m[K1] / m[M1] / square, m[K2] / m[M2] / square, both / mass / square
    loss_1, loss_2 = eta * m[D1] / m[M1] / omega, eta * m[D2] / m[M2] / omega
    answer = magnitude(stiff_1 - stiff_2, loss_1 - loss_2) * eta * eta
    if offset < 0.0:
        loss_3 = eta * (m[D1] + m[D2]) / mass / omega
        level = -offset * stiff_2 / stiff_3 * magnitude(stiff_3 - eta * eta, loss_3)
    else:
        level = (
            offset * magnitude(stiff_1 - eta * eta, loss_1) * magnitude(stiff_2 - eta * eta, loss_2)
        )
    if level == 0.0:
        return 0.0
    if answer == 0.0:  # the halves move alike
        return NEVER
    return level / answer


def magnitude(real, imaginary):
    return math.sqrt(real * real + imaginary * imaginary)
