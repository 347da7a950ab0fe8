"""Amplitude spectrum of a sampled signal of any length, written once for Python and C.

In the subset of Python that :mod:`fmu_src.export.translation` translates, over a flat memory: a
head, the signal, which the amplitudes of the lines replace, and room for the transform.
"""

import math

from .numerics.elementary import sincos_turns

COUNT, HEAD = range(2)  # samples


def transform_length(count):
    """Return the power of two of numbers that so many samples are transformed by."""
    length = 1
    while length < 2 * count:
        length *= 2
    return length


def amplitudes(m, time):
    """Replace a signal by the amplitudes of its lines, through a Hann window.

    The window takes the mean, which it would spread to the line beside it, from all lines but the
    mean's own. The discrete Fourier transform is Bluestein's: a convolution with a chirp.
    """
    count = int(m[COUNT])
    length = transform_length(count)
    one = HEAD + count
    other = one + 2 * length
    mean, whole, part = 0.0, 0.0, 0
    for k in range(count):
        mean += m[HEAD + k] / count
    for k in range(2 * length):
        m[one + k] = 0.0
        m[other + k] = 0.0
    for k in range(count):
        _, turn = sincos_turns(k / count)
        weight = 0.5 - 0.5 * turn
        whole += weight * m[HEAD + k]
        value = weight * (m[HEAD + k] - mean)
        sine, cosine = sincos_turns(0.5 * part / count)
        m[one + 2 * k], m[one + 2 * k + 1] = value * cosine, 0.0 - value * sine
        m[other + 2 * k], m[other + 2 * k + 1] = cosine, sine
        if k > 0:
            m[other + 2 * (length - k)], m[other + 2 * (length - k) + 1] = cosine, sine
        part += 2 * k + 1  # k^2, without whole turns of the chirp
        if part >= 2 * count:
            part -= 2 * count
    turns = other + 2 * length
    for k in range(int(length / 2)):
        m[turns + 2 * k + 1], m[turns + 2 * k] = sincos_turns(0.0 - k / length)
    transform(m, one, turns, length)
    transform(m, other, turns, length)
    for k in range(length):  # conjugated, so that the transform is the inverse one
        real, imaginary = m[one + 2 * k], m[one + 2 * k + 1]
        a, b = m[other + 2 * k], m[other + 2 * k + 1]
        m[one + 2 * k] = real * a - imaginary * b
        m[one + 2 * k + 1] = 0.0 - (real * b + imaginary * a)
    transform(m, one, turns, length)
    for k in range(int(count / 2) + 1):
        real, imaginary = m[one + 2 * k] / length, m[one + 2 * k + 1] / length
        # a half of a line is at the negative frequency, and the window's mean is a half
        m[HEAD + k] = 4.0 / count * math.sqrt(real * real + imaginary * imaginary)
    if 2 * int(count / 2) == count:  # its own negative frequency
        m[HEAD + int(count / 2)] *= 0.5
    m[HEAD] = abs(2.0 * whole / count)
    return 0


def transform(m, first, turns, length):
    """Transform complex numbers in place, a power of two of them."""
    swap = 0
    for k in range(1, length):
        bit = int(length / 2)
        while swap >= bit:
            swap -= bit
            bit = int(bit / 2)
        swap += bit
        if k < swap:
            for part in range(2):
                one, other = first + 2 * k + part, first + 2 * swap + part
                kept = m[one]
                m[one] = m[other]
                m[other] = kept
    half = 1
    while half < length:
        stride = int(length / (2 * half))
        for block in range(stride):
            for k in range(half):
                one = first + 2 * (2 * half * block + k)
                other, turn = one + 2 * half, turns + 2 * stride * k
                real = m[other] * m[turn] - m[other + 1] * m[turn + 1]
                imaginary = m[other] * m[turn + 1] + m[other + 1] * m[turn]
                m[other] = m[one] - real
                m[other + 1] = m[one + 1] - imaginary
                m[one] += real
                m[one + 1] += imaginary
        half *= 2
