"""Driven on a natural frequency with next to no damping: an amplitude that grows with time.

The forced amplitudes of (11) have no limit there, and the free part is as large against them. So
the motion is not split in two: the free part is the whole displacement, driven on from node to
node. From rest but for a push, an oscillator driven by ``F sin(phase)`` moves by the imaginary part
of ``c e^{i phase}`` with ``c(t) = c'(0) (e^{sigma t} - 1)/sigma``, ``c'(0) = F/(D + i (nu + eta))``
and ``sigma = -D + i (nu - eta)``: the secular term ``c'(0) t`` where damping and detuning vanish.

An amplitude stands as two slots, its parts by the cosine and by the sine of the phase.
"""

from ..numerics.elementary import TWO_PI, exp_decay, sincos_turns
from . import memory as at
from .parameters import are_halves_nearly_equal

# detuning^2 + (damping over critical)^2 below which the closed form has no four digits to spare
NEAR_RESONANCE = 1e-8
# nodes after which a state driven so is rewritten: what it may grow by stays small
LONGEST_DRIVEN = 32.0
SMALL = 0.5  # of |sigma t|: fourteen terms are exact


def is_resonant(m, b):
    """Return whether an oscillator is driven on its natural frequency, with next to no damping."""
    eta, square = m[at.ETA], m[b + at.OMEGA_SQUARED]
    detuning, twice = square - eta * eta, 2.0 * m[b + at.DAMPING] * eta
    near = detuning * detuning + twice * twice <= 4.0 * NEAR_RESONANCE * square * square
    return (m[b + at.DRIVE] != 0.0 or m[b + at.DRIVE + 1] != 0.0) and near


def set_growing_amplitudes(m):
    """Find the oscillators whose amplitudes grow, and set their growth; the nodes are set already.

    Of two oscillators that are nearly equal both do or none: so their gap keeps its digits.
    """
    if m[at.SECULAR] != 0.0:  # rarely
        clear_growing_amplitudes(m)
    near_1, near_2 = is_resonant(m, at.OSCILLATOR_1), is_resonant(m, at.OSCILLATOR_2)
    both = (near_1 or near_2) and are_halves_nearly_equal(m)
    if near_1 or both:
        set_amplitude_growth(m, at.OSCILLATOR_1)
    if near_2 or both:
        set_amplitude_growth(m, at.OSCILLATOR_2)
    if is_resonant(m, at.OSCILLATOR_3):
        set_amplitude_growth(m, at.OSCILLATOR_3)


def clear_growing_amplitudes(m):
    m[at.SECULAR] = 0.0
    for i in range(at.GROWTH_SIZE):
        m[at.OSCILLATOR_1 + at.DRIVEN + i] = 0.0
        m[at.OSCILLATOR_2 + at.DRIVEN + i] = 0.0
        m[at.OSCILLATOR_3 + at.DRIVEN + i] = 0.0
    for i in range(2 * at.EVENT_ORDERS):
        m[at.EVENT_DRIVE + i] = 0.0


def set_amplitude_growth(m, b):
    m[at.SECULAR] = 1.0
    m[b + at.DRIVEN] = 1.0
    eta, damping, nu = m[at.ETA], m[b + at.DAMPING], m[b + at.NU]
    together = nu + eta
    square = damping * damping + together * together
    d_cos, d_sin = m[b + at.DRIVE] / square, m[b + at.DRIVE + 1] / square
    m[b + at.PUSH] = d_cos * damping - d_sin * together
    m[b + at.PUSH + 1] = d_sin * damping + d_cos * together
    m[b + at.DRIFT] = (m[b + at.NU_SQUARED] - eta * eta) / together
    m[b + at.OWN_RATE] = max(eta, nu + 3.0 * damping)
    set_step_growth(m, b)


def set_step_growth(m, b):
    h_cos, h_sin, d_cos, d_sin = grown_amplitude(m, b, m[at.SPACING])
    m[b + at.STEP_GROWTH] = h_cos
    m[b + at.STEP_GROWTH + 1] = h_sin
    m[b + at.STEP_GROWTH + 2] = d_cos
    m[b + at.STEP_GROWTH + 3] = d_sin


def grown_amplitude(m, b, t):
    """Return the amplitude ``c`` and its rate ``t`` after it was zero, by cosine and by sine."""
    # z = sigma t, and (e^z - 1)/z
    real, imag = -m[b + at.DAMPING] * t, m[b + at.DRIFT] * t
    square = real * real + imag * imag
    if square < SMALL * SMALL:
        p, q = exponential_quotient(real, imag)
        e_real, e_imag = 1.0 + (real * p - imag * q), real * q + imag * p
    else:
        decay = exp_decay(-real)
        sine, cosine = sincos_turns(m[b + at.DRIFT] / TWO_PI * t)
        e_real, e_imag = decay * cosine, decay * sine
        p = ((e_real - 1.0) * real + e_imag * imag) / square
        q = (e_imag * real - (e_real - 1.0) * imag) / square
    push_cos, push_sin = m[b + at.PUSH], m[b + at.PUSH + 1]
    h_cos, h_sin = t * (p * push_cos + q * push_sin), t * (p * push_sin - q * push_cos)
    d_cos, d_sin = e_real * push_cos + e_imag * push_sin, e_real * push_sin - e_imag * push_cos
    return h_cos, h_sin, d_cos, d_sin


def exponential_quotient(real, imag):
    """Return ``(e^z - 1)/z`` for ``|z| < SMALL`` by its series, real and imaginary part."""
    p, q = 1.0, 0.0
    for k in range(14, 1, -1):
        part = 1.0 / k
        p, q = 1.0 + part * (real * p - imag * q), part * (real * q + imag * p)
    return p, q


def initial_push(m, b, cosine, sine):
    return m[b + at.PUSH] * cosine + m[b + at.PUSH + 1] * sine


def motion_of_grown_amplitude(m, h_cos, h_sin, d_cos, d_sin, cosine, sine):
    forced = m[at.ETA] * (h_sin * cosine - h_cos * sine)
    return h_cos * cosine + h_sin * sine, forced + (d_cos * cosine + d_sin * sine)


def forced_derivative_amplitude(m, b, order):
    """Return what the forcing adds to a derivative of the displacement, by cosine and by sine."""
    if order < 2 or m[b + at.DRIVEN] == 0.0:
        return 0.0, 0.0
    drive_cosine, drive_sine = m[b + at.DRIVE], m[b + at.DRIVE + 1]
    cosine, sine, next_cosine, next_sine = 0.0, 0.0, drive_cosine, drive_sine
    eta, twice, square = m[at.ETA], 2.0 * m[b + at.DAMPING], m[b + at.OMEGA_SQUARED]
    for _ in range(order - 2):
        drive_cosine, drive_sine = eta * drive_sine, -eta * drive_cosine
        cosine, next_cosine = next_cosine, drive_cosine - twice * next_cosine - square * cosine
        sine, next_sine = next_sine, drive_sine - twice * next_sine - square * sine
    return next_cosine, next_sine


def set_event_drive(m):
    flight = m[at.MODE] == at.FLIGHT
    p, q = -m[at.FORCE_V], -m[at.FORCE_X]
    for k in range(1, at.EVENT_ORDERS + 1):
        if flight:
            low_cosine, low_sine = forced_derivative_amplitude(m, at.OSCILLATOR_1, k)
            cosine, sine = forced_derivative_amplitude(m, at.OSCILLATOR_2, k)
            cosine, sine = cosine - low_cosine, sine - low_sine
        else:
            low_cosine, low_sine = forced_derivative_amplitude(m, at.OSCILLATOR_3, k)
            cosine, sine = forced_derivative_amplitude(m, at.OSCILLATOR_3, k + 1)
            cosine, sine = p * cosine + q * low_cosine, p * sine + q * low_sine
        m[at.EVENT_DRIVE + 2 * k - 2] = cosine
        m[at.EVENT_DRIVE + 2 * k - 1] = sine


def event_drive(m, order, cosine, sine):
    """Return what the forcing adds to a derivative of the event function; ``order`` from 1 on."""
    i = at.EVENT_DRIVE + 2 * order - 2
    return m[i] * cosine + m[i + 1] * sine


def event_drive_bound(m, order):
    """Return a bound of :func:`event_drive` over all phases; ``order`` from 1 on."""
    i = at.EVENT_DRIVE + 2 * order - 2
    return abs(m[i]) + abs(m[i + 1])


def driven_derivative_bound(m, b, order, time):
    """Return a bound of what the forcing adds to a derivative of the displacement for a ``time``
    from now on.

    Each derivative is the response of the same oscillator to the forcing's. With R at least its
    rates, ``2 D/R + (omega/R)^2 <= 1``, the forcing's part of the k-th is at most ``(k - 1) F
    R^(k-2)`` at once; and it grows by ``F R^k`` times the envelope of the sine.
    """
    if m[b + at.DRIVEN] == 0.0:
        return 0.0
    power = abs(m[b + at.DRIVE]) + abs(m[b + at.DRIVE + 1])
    rate, envelope = m[b + at.OWN_RATE], m[b + at.ENVELOPE_SINE]
    for _ in range(order):
        power *= rate
    bound = envelope * time * power
    if order >= 1:
        bound += envelope * order * power / rate
    if order >= 2:
        bound += (1.0 + envelope * m[b + at.DAMPING]) * (order - 1.0) * power / (rate * rate)
    return bound


def driven_event_bound(m, order, time):
    """Return a bound of what forcing adds to the event function's derivative over a time."""
    if m[at.MODE] == at.FLIGHT:
        low = driven_derivative_bound(m, at.OSCILLATOR_1, order, time)
        return low + driven_derivative_bound(m, at.OSCILLATOR_2, order, time)
    high = abs(m[at.FORCE_V]) * driven_derivative_bound(m, at.OSCILLATOR_3, order + 1, time)
    return high + abs(m[at.FORCE_X]) * driven_derivative_bound(m, at.OSCILLATOR_3, order, time)
