"""What drives the masses over one segment: right-hand sides of (6), a harmonic plus cubics in time.

A segment lasts as long as the inputs stay as they are. A cubic begins where one of its inputs was
set, and runs on over communication steps and segments until one is set again. Relative to the box a
mass is driven by minus the box's acceleration, ``a Omega^2 sin(phase)`` minus the cubic, and by the
force on it over its mass; each oscillator, and the gap, has its shares of these.
"""

from ..numerics.elementary import TWO_PI
from ..numerics.first_root import INFINITE
from . import memory as at
from .nodes import set_node_grid
from .parameters import set_side_constants
from .secular import set_growing_amplitudes


def have_inputs_changed(m):
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        for i in range(3):
            if m[at.CUBIC + 6 * i + at.ON] != 0.0 and m[at.CUBIC_SET + i] != 0.0:
                return True
    changed = False
    for i in range(6):
        if m[at.SEGMENT_INPUTS + i] != m[at.BOX_AMPLITUDE + i]:
            changed = True
    for i in range(10):
        if m[at.SEGMENT_INPUTS + 6 + i] != m[at.FORCE1_AMPLITUDE + i]:
            changed = True
    return changed


def begin_segment(m):
    """Set the excitation from the present inputs; a cubic runs on where its inputs were not set."""
    scale = 1.0 / m[at.OMEGA]
    restart_cubic_if_set(m, 0, at.BOX_ACCELERATION, at.SEGMENT_INPUTS + 2, -scale * scale)
    restart_cubic_if_set(m, 1, at.FORCE1, at.SEGMENT_INPUTS + 8, 1.0)
    restart_cubic_if_set(m, 2, at.FORCE2, at.SEGMENT_INPUTS + 12, 1.0)
    for i in range(6):
        m[at.SEGMENT_INPUTS + i] = m[at.BOX_AMPLITUDE + i]
    for i in range(10):
        m[at.SEGMENT_INPUTS + 6 + i] = m[at.FORCE1_AMPLITUDE + i]
    set_excitation(m)


def restart_cubic_if_set(m, number, inputs, segment_inputs, factor):
    """Restart a cubic if an input was set or changed; ``factor`` turns SI into a forcing."""
    begins = m[at.CUBIC_SET + number] != 0.0
    for i in range(4):
        if m[segment_inputs + i] != m[inputs + i]:
            begins = True
    if not begins:
        return
    cubic, scale = at.CUBIC + 6 * number, 1.0 / m[at.OMEGA]
    m[cubic + at.AGE] = 0.0
    m[cubic + at.ON] = 0.0
    for i in range(4):
        m[cubic + i] = m[inputs + i] * factor
        factor *= scale
        if i > 0 and m[inputs + i] != 0.0:
            m[cubic + at.ON] = 1.0


def mirror_system(m):
    m[at.SIDE] = -m[at.SIDE]
    set_side_constants(m)
    set_excitation(m)


def set_excitation(m):
    """Set the constants of the excitation from the segment's inputs."""
    amplitude, frequency = m[at.SEGMENT_INPUTS], m[at.SEGMENT_INPUTS + 1]
    scale = 1.0 / m[at.OMEGA]
    eta = frequency * scale
    m[at.ETA] = eta
    m[at.ETA_TURNS] = eta / TWO_PI
    m[at.FORCING] = amplitude * eta * eta
    pushed = is_any_nonzero(m, at.SEGMENT_INPUTS + 8, 8)
    m[at.CUBIC_PRESENT] = 1.0 if pushed or is_any_nonzero(m, at.SEGMENT_INPUTS + 2, 4) else 0.0
    forced = is_any_nonzero(m, at.SEGMENT_INPUTS + 6, 2)
    m[at.SHAKEN] = 1.0 if forced or m[at.FORCING] != 0.0 else 0.0
    m[at.UNEQUAL] = 1.0 if forced or pushed or m[at.WALL] != 0.0 or m[at.LIMIT] < INFINITE else 0.0
    set_harmonic_drive(m, at.BOX)
    set_harmonic_drive(m, at.GAP)
    set_harmonic_drive(m, at.OSCILLATOR_1)
    set_harmonic_drive(m, at.OSCILLATOR_2)
    set_harmonic_drive(m, at.OSCILLATOR_3)
    set_node_grid(m)
    set_growing_amplitudes(m)
    set_forced_amplitudes(m, at.OSCILLATOR_1, at.HARMONIC_1)
    set_forced_amplitudes(m, at.OSCILLATOR_2, at.HARMONIC_2)
    set_forced_amplitudes(m, at.OSCILLATOR_3, at.HARMONIC_3)


def is_any_nonzero(m, first, count):
    for i in range(count):
        if m[first + i] != 0.0:
            return True
    return False


def set_harmonic_drive(m, b):
    """Set a harmonic forcing: of an oscillator, of the box or of the gap."""
    shares, forces = b + at.SHARES, at.SEGMENT_INPUTS + 6
    m[b + at.DRIVE] = 0.0
    m[b + at.DRIVE + 1] = m[shares] * m[at.FORCING] + (
        m[shares + 1] * m[forces] + m[shares + 2] * m[forces + 1]
    )


def harmonic_drive_and_rate(m, b, cosine, sine):  # inline
    """Return an oscillator's harmonic forcing, by sine alone, and its first derivative."""
    d_sin = m[b + at.DRIVE + 1]
    return d_sin * sine, d_sin * m[at.ETA] * cosine


def set_forced_amplitudes(m, b, harmonic):
    """Set the forced amplitudes a_i, b_i of (11), times the forcing; zeros where they grow."""
    d_cos, d_sin, eta = m[b + at.DRIVE], m[b + at.DRIVE + 1], m[at.ETA]
    m[harmonic] = 0.0
    m[harmonic + 1] = 0.0
    if (d_cos == 0.0 and d_sin == 0.0) or m[b + at.DRIVEN] != 0.0:
        return
    detuning = m[b + at.OMEGA_SQUARED] - eta * eta
    twice = 2.0 * m[b + at.DAMPING] * eta
    square = detuning * detuning + twice * twice
    m[harmonic] = (d_cos * detuning - d_sin * twice) / square
    m[harmonic + 1] = (d_sin * detuning + d_cos * twice) / square


def drive_and_rate_at(m, b, cosine, sine, tau):
    """Return a forcing and its derivative at a phase, ``tau`` after the state's start."""
    return drive_and_rate_by_ages(m, b, cosine, sine, cubic_ages(m, tau))


def drive_and_rate_by_ages(m, b, cosine, sine, ages):
    """Return a forcing and its derivative at a phase, the cubics being so old."""
    value, rate = harmonic_drive_and_rate(m, b, cosine, sine)
    if m[at.CUBIC_PRESENT] == 0.0:
        return value, rate
    q0, q1, _, _ = cubic_drive_by_ages(m, b, ages)
    return value + q0, rate + q1


def cubic_drive_derivatives(m, b, tau):
    """Return value and three derivatives of a forcing's cubic part."""
    return cubic_drive_by_ages(m, b, cubic_ages(m, tau))


def cubic_ages(m, tau):  # inline
    """Return how long ago the three cubics began, ``tau`` after the present state's start."""
    return m[at.CUBIC + at.AGE] + tau, m[at.CUBIC_1 + at.AGE] + tau, m[at.CUBIC_2 + at.AGE] + tau


def cubic_drive_by_ages(m, b, ages):  # inline
    """Return value and three derivatives of a forcing's cubic part, the cubics being so old."""
    age, age_1, age_2 = ages
    q0, q1, q2, q3 = cubic_derivatives(m, at.CUBIC, age)
    if m[at.UNEQUAL] != 0.0:  # rarely
        box, one, two = m[b + at.SHARES], m[b + at.SHARES + 1], m[b + at.SHARES + 2]
        r0, r1, r2, r3 = cubic_derivatives(m, at.CUBIC_1, age_1)
        s0, s1, s2, s3 = cubic_derivatives(m, at.CUBIC_2, age_2)
        q0, q1 = box * q0 + (one * r0 + two * s0), box * q1 + (one * r1 + two * s1)
        q2, q3 = box * q2 + (one * r2 + two * s2), box * q3 + (one * r3 + two * s3)
    return q0, q1, q2, q3


def cubic_derivatives(m, cubic, age):
    """Return value and three derivatives of a cubic, ``age`` after it began, in tau."""
    p0, p1, p2, p3 = m[cubic], m[cubic + 1], m[cubic + 2], m[cubic + 3]
    q2 = p2 + p3 * age
    q1 = p1 + age * (p2 + 0.5 * age * p3)
    q0 = p0 + age * (p1 + 0.5 * age * (p2 + age * p3 / 3.0))
    return q0, q1, q2, p3


def input_derivative(m, first, order, age):
    """Return a derivative, in SI, of the inputs' cubic at slot ``first``, ``age`` (tau) old."""
    if age == 0.0:  # usually
        return m[first + order] + 0.0
    time = age / m[at.OMEGA]
    value = 0.0
    for i in range(3, order - 1, -1):
        value = m[first + i] + value * time / (i - order + 1)
    return value


def set_cubic_response(m, b, response):
    """Set the cubic that solves (6) for a cubic forcing, by comparing coefficients."""
    cubic = cubic_drive_derivatives(m, b, 0.0)
    w, twice = m[b + at.OMEGA_SQUARED], 2.0 * m[b + at.DAMPING]
    q3 = cubic[3] / w
    q2 = (cubic[2] - twice * q3) / w
    q1 = (cubic[1] - twice * q2 - q3) / w
    q0 = (cubic[0] - twice * q1 - q2) / w
    m[response] = q0
    m[response + 1] = q1
    m[response + 2] = q2
    m[response + 3] = q3
