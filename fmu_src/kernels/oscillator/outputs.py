"""What an importer sees at a communication point, in SI units."""

from ..numerics.elementary import TWO_PI, fraction, sincos_turns
from . import memory as at
from .contact import contact_force
from .motion import state_and_phase_at


def write(m, tau):
    """Write the outputs that belong to a point of time, ``tau`` after the present state's start."""
    x1, v1, x2, v2, cosine, sine = state_and_phase_at(m, tau)
    m[at.PHASE_COSINE] = cosine
    m[at.PHASE_SINE] = sine
    omega = m[at.OMEGA]
    flight = m[at.MODE] == at.FLIGHT
    m[at.X1], m[at.X2], m[at.X_REL] = x1, x2, x2 - x1
    m[at.V1], m[at.V2], m[at.V_REL] = omega * v1, omega * v2, omega * (v2 - v1)
    unit = m[at.FORCING]
    m[at.XI1] = x1 / unit if unit != 0.0 else 0.0  # (3)
    m[at.XI2] = x2 / unit if unit != 0.0 else 0.0
    m[at.XI_REL] = (x2 - x1) / unit if unit != 0.0 else 0.0
    m[at.BOX_FORCE] = m[at.K1] * x1 + m[at.D1] * m[at.V1] + m[at.K2] * x2 + m[at.D2] * m[at.V2]
    force = 0.0 if flight else -contact_force(m, x1, v1)
    reduced_mass = m[at.M2] * m[at.SHARE]
    m[at.CONTACT_FORCE] = reduced_mass * omega * omega * force if force > 0.0 else 0.0
    m[at.IN_CONTACT] = 0.0 if flight else 1.0
    phase = TWO_PI * fraction(m[at.TURN] + m[at.ETA_TURNS] * tau)
    m[at.PHASE] = phase if phase < TWO_PI else 0.0


def momentum(m):
    """Momentum relative to the box, and its integral, the moment of mass."""
    return m[at.M1] * m[at.V1] + m[at.M2] * m[at.V2], m[at.M1] * m[at.X1] + m[at.M2] * m[at.X2]


def write_impulse(m, h, momentum_before, moment_before, cosine, sine):
    """Integrals of the force on the box over a step of ``h`` seconds, by momentum: impacts are
    internal and drop out.

    ``box_force = -P' - (m1 + m2) y''`` with P the momentum relative to the box and y'' its
    acceleration, so the integral is a difference of momenta, its moment a difference of
    displacements, and what the box's motion adds is known in closed form. ``cosine`` and ``sine``
    are those of the phase before the step.
    """
    after, moment_after = momentum(m)
    mass = m[at.M1] + m[at.M2]
    drive, drive_moment = 0.0, 0.0
    if m[at.NODE_ETA] != 0.0:
        amplitude, speed = m[at.SEGMENT_INPUTS], m[at.SEGMENT_INPUTS + 1]
        sine_half, cosine_half = sincos_turns(speed * h * (0.5 / TWO_PI))
        sine_mid = sine * cosine_half + cosine * sine_half
        cosine_mid = cosine * cosine_half - sine * sine_half
        drive = 2.0 * amplitude * speed * sine_mid * sine_half
        drive_moment = amplitude * (2.0 * cosine_mid * sine_half - speed * h * m[at.PHASE_COSINE])
    if m[at.CUBIC_PRESENT] != 0.0:
        power = h
        for i in range(4):  # integrals of tau^i/i! and of tau^(i+1)/i!
            derivative = m[at.SEGMENT_INPUTS + 2 + i]
            drive -= derivative * power / (i + 1)
            drive_moment -= derivative * power * h / (i + 2)
            power *= h / (i + 1)
    m[at.BOX_IMPULSE] = momentum_before - after + mass * drive
    m[at.BOX_IMPULSE_MOMENT] = (moment_after - moment_before) - h * after + mass * drive_moment
