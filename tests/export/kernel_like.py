"""Functions as a kernel has them, one for each thing the translator has to get right."""

import math

from . import kernel_like_slots as at

TWICE = 2.0
THIRD = 1.0 / 3.0
NOWHERE = math.inf


def bump(m, slot):
    """Count a slot up; gives what it was."""
    before = m[slot]
    m[slot] += 1.0
    return before


def between(x, first, second):
    """A number of its own for each order."""
    return x + 3.0 * first - 5.0 * second


def halves(m, x):
    """Half of a number and what is left; a slot is changed too."""
    m[at.SCRATCH] = m[at.SCRATCH] * 0.5 + x
    return 0.5 * x, x - 0.5 * x


def order(m, x):
    """Left to right: each call changes what the next one sees."""
    a = bump(m, at.COUNT) - TWICE * bump(m, at.COUNT) + m[at.COUNT] * x
    # C's compilers like to begin with the last argument
    m[at.OUT] = between(x, bump(m, at.COUNT), bump(m, at.COUNT) * bump(m, at.COUNT))
    m[at.OUT + 1], m[at.OUT + 2] = bump(m, at.COUNT), m[at.COUNT]
    m[at.RESULT] = a
    return 0


def swaps(m, x):
    """Parallel assignment."""
    a, b = x, THIRD
    for _ in range(5):
        a, b = b - a * 0.25, a + b
    m[at.OUT], m[at.OUT + 1] = m[at.OUT + 1], m[at.OUT]
    m[at.OUT + 2] = a - b
    m[at.RESULT] = a
    return 0


def loops(m, x):
    """Loops up, down, with steps, left early; a limit that changes inside; a variable lives on."""
    total = 0.0
    for k in range(7, 1, -1):
        total += x / k
    for k in range(3, 20, 4):
        total = total * 0.5 + k
    n = 4
    for k in range(n):
        n = 2
        total += k * x
    last = 0.0
    while total < 1e3:
        last = total
        total = 2.0 * abs(total) + 1.0
        if total > 700.0:
            break
    m[at.OUT] = last
    m[at.RESULT] = total + n
    return 0


def tuples(m, x):
    """Nested tuples, parts and slices of them, and of a call."""
    low, high = halves(m, x)
    whole = (low, high, x), (x < 0.0, 3), halves(m, high)[1]
    m[at.OUT], m[at.OUT + 1] = whole[0][:2]
    p, q, _ = whole[0]
    negative, three = whole[1]
    m[at.RESULT] = p - q * three if negative else whole[2] + halves(m, p)[0]
    return 0


def numbers(m, x):
    """Whole, real and mixed numbers; floor and remainder as Python has them."""
    quarters = math.floor(4.0 * x)
    rest = quarters & 3
    share = 1 / (rest + 2)
    k = 0
    if rest % 2 == 0:
        k = 2.5
    inside = -1.0 < x <= m[at.LIMIT] and not x >= 0.5 or rest == 3
    m[at.OUT] = 1.0 if inside else 0.0
    m[at.RESULT] = share + k + max(x, share, 0.125) - min(x, 0.0) + math.sqrt(abs(x)) - -x
    return 0


WEIGHTS, BEGIN = (0.1, -0.2, 1.0 / 3.0), (0, 1, 3)


def tables(m, x):
    """Entries of tables, by an index that is computed, or read from another table."""
    total = x
    for row in range(2):
        for i in range(BEGIN[row], BEGIN[row + 1]):
            total = total / 3.0 + WEIGHTS[i] * x
    m[at.RESULT] = total * BEGIN[2] + WEIGHTS[2 if m[at.COUNT] > 0.0 else 0]
    return 0


def chosen(m, x):
    """What is not chosen is not evaluated."""
    y = bump(m, at.COUNT) if x > 0.0 else -bump(m, at.OUT)
    if x > 1.0 and bump(m, at.COUNT) > 2.0 or x < -1.0 and bump(m, at.OUT) > 2.0:
        y += 100.0
    elif y < NOWHERE:
        short = y * y
        y = short - x
    else:
        y = int(m[at.COUNT]) * x
    m[at.RESULT] = y
    return 0


ENTRIES = {one.__name__: one for one in (order, swaps, loops, tuples, tables, numbers, chosen)}
