"""The box's motion over one segment: right-hand side of (6), a harmonic plus a cubic in time.

A segment lasts as long as the inputs stay as they are. The cubic begins where one of its inputs was
set, and runs on over communication steps and segments until one is set again. Relative to the box a
mass is driven by minus the box's acceleration: ``a Omega^2 sin(phase)`` minus the cubic.
"""

from ..numerics.elementary import TWO_PI
from . import memory as at
from .nodes import set_grid
from .secular import set_secular


def inputs_changed(m):
    """Return whether the present inputs call for a new segment."""
    if m[at.CUBIC_ON] != 0.0 and m[at.CUBIC_SET] != 0.0:
        return True
    for i in range(6):
        if m[at.SEGMENT_INPUTS + i] != m[at.BOX_AMPLITUDE + i]:
            return True
    return False


def cubic_begins(m):
    """Return whether the present inputs call for a new cubic: one was set, or has another value."""
    if m[at.CUBIC_SET] != 0.0:
        return True
    for i in range(2, 6):
        if m[at.SEGMENT_INPUTS + i] != m[at.BOX_AMPLITUDE + i]:
            return True
    return False


def begin_segment(m):
    """Set the excitation constants from the present inputs; the cubic goes on where its inputs were
    not set.
    """
    if cubic_begins(m):
        begin_cubic(m)
    for i in range(6):
        m[at.SEGMENT_INPUTS + i] = m[at.BOX_AMPLITUDE + i]
    set_excitation(m)


def set_excitation(m):
    """Set the constants of the harmonic excitation from the segment's inputs."""
    amplitude, frequency = m[at.SEGMENT_INPUTS], m[at.SEGMENT_INPUTS + 1]
    scale = 1.0 / m[at.OMEGA]
    eta = frequency * scale
    m[at.ETA] = eta
    m[at.ETA_TURNS] = eta / TWO_PI
    m[at.FORCING] = amplitude * eta * eta
    set_grid(m)
    set_secular(m)
    set_harmonic(m, at.OSCILLATOR_1, at.HARMONIC_1)
    set_harmonic(m, at.OSCILLATOR_2, at.HARMONIC_2)
    set_harmonic(m, at.OSCILLATOR_3, at.HARMONIC_3)


def begin_cubic(m):
    """Begin the present inputs' cubic at the present state's start."""
    scale = 1.0 / m[at.OMEGA]
    unit = scale * scale
    m[at.CUBIC_ON] = 0.0
    m[at.CUBIC_PRESENT] = 0.0
    for i in range(4):
        derivative = m[at.BOX_ACCELERATION + i]
        m[at.CUBIC + i] = -derivative * unit
        unit *= scale
        if derivative != 0.0:
            m[at.CUBIC_PRESENT] = 1.0
            if i > 0:
                m[at.CUBIC_ON] = 1.0
    m[at.CUBIC_AGE] = 0.0


def set_harmonic(m, b, harmonic):
    """Set the forced amplitudes a_i, b_i of (11), times ``a eta^2``; zeros where the amplitude
    grows.
    """
    forcing, eta = m[at.FORCING], m[at.ETA]
    m[harmonic] = 0.0
    m[harmonic + 1] = 0.0
    if forcing == 0.0 or m[b + at.DRIVEN] != 0.0:
        return
    detuning = m[b + at.OMEGA_SQUARED] - eta * eta
    twice = 2.0 * m[b + at.DAMPING] * eta
    square = detuning * detuning + twice * twice
    m[harmonic] = -forcing * twice / square
    m[harmonic + 1] = forcing * detuning / square


def cubic_at(m, age):
    """Return the value and three derivatives of the forcing's cubic, ``age`` after it began, in
    tau.
    """
    p0, p1, p2, p3 = m[at.CUBIC], m[at.CUBIC + 1], m[at.CUBIC + 2], m[at.CUBIC + 3]
    q2 = p2 + p3 * age
    q1 = p1 + age * (p2 + 0.5 * age * p3)
    q0 = p0 + age * (p1 + 0.5 * age * (p2 + age * p3 / 3.0))
    return q0, q1, q2, p3


def box_derivative(m, order, age):
    """Return a derivative, in SI, of the box acceleration that the inputs' cubic gives, ``age`` (in
    tau) after it began.

    A constant keeps its bits.
    """
    time = age / m[at.OMEGA]
    value = 0.0
    for i in range(3, order - 1, -1):
        value = m[at.SEGMENT_INPUTS + 2 + i] + value * time / (i - order + 1)
    return value


def set_cubic_response(m, b, response, cubic):
    """Set the cubic that solves (6) for a cubic forcing: value and three derivatives.

    By comparing coefficients.
    """
    w, twice = m[b + at.OMEGA_SQUARED], 2.0 * m[b + at.DAMPING]
    q3 = cubic[3] / w
    q2 = (cubic[2] - twice * q3) / w
    q1 = (cubic[1] - twice * q2 - q3) / w
    q0 = (cubic[0] - twice * q1 - q2) / w
    m[response] = q0
    m[response + 1] = q1
    m[response + 2] = q2
    m[response + 3] = q3
