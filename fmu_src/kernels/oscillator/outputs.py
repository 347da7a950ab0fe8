"""What an importer sees at a communication point, in SI units."""

from ..numerics.elementary import TWO_PI, fraction_of_turn, sincos_turns
from . import memory as at
from .contact import gap_acceleration
from .excitation import (
    cubic_ages,
    drive_and_rate_at,
    drive_and_rate_by_ages,
    harmonic_drive_and_rate,
    input_derivative,
)
from .motion import (
    displacements_from_unloaded,
    gap_between,
    motion_as_importer_sees,
    side_number,
    state_and_phase_at,
)

LEAST_UNIT = 1e-200  # m: displacements over a smaller a eta^2 could leave the range of numbers
# of a radian of the fastest change: over shorter steps the difference of momenta loses digits, and
# a quintic of the force is the better integral, which misses 1e-17 of the momentum
SHORT = 0.01


def is_only_box_shaken(m):  # inline
    """Return whether only the box's harmonic motion and a wide gap are there."""
    return m[at.UNEQUAL] == 0.0 and m[at.CUBIC_PRESENT] == 0.0


def outputs_at(m, tau):  # inline
    """Return the outputs ``tau`` after the state's start, then cosine and sine of the phase."""
    x1, v1, x2, v2, cosine, sine = state_and_phase_at(m, tau)
    omega = m[at.OMEGA]
    flight = m[at.MODE] == at.FLIGHT
    gap, gap_speed = gap_between(m, tau, x1, x2), omega * (v2 - v1)
    force = 0.0 if flight else -gap_acceleration(m, x1, v1, cosine, sine, tau)
    pull_1, pull_2 = m[at.K1] * x1, m[at.K2] * x2  # at rest together, the springs balance
    x1, x2 = displacements_from_unloaded(m, x1, x2)
    contact = m[at.REDUCED_MASS] * omega * omega * force if force > 0.0 else 0.0
    v1, v2 = omega * v1, omega * v2
    box_force = pull_1 + m[at.D1] * v1 + pull_2 + m[at.D2] * v2
    if m[at.UNEQUAL] != 0.0:  # rarely
        if m[at.WALL] != 0.0:
            box_force = box_force_with_wall(m, x1, v1, cosine, sine, tau)
        gap_speed, box_force = m[at.SIDE] * gap_speed, m[at.SIDE] * box_force
        x1, v1, x2, v2, gap = motion_as_importer_sees(m, x1, v1, x2, v2, gap)
    unit = unit_of_length(m)
    xi1 = x1 / unit if unit != 0.0 else 0.0  # (3)
    xi2 = x2 / unit if unit != 0.0 else 0.0
    xi_rel = gap / unit if unit != 0.0 else 0.0
    phase = TWO_PI * fraction_of_turn(m[at.TURN] + m[at.ETA_TURNS] * tau)
    phase = phase if phase < TWO_PI else 0.0
    touch, side = (0.0, 0.0) if flight else (1.0, side_number(m))
    motion = x1, x2, v1, v2, gap, gap_speed, xi1, xi2, xi_rel, box_force
    return motion, (contact, touch, phase, side), (cosine, sine)


def box_force_with_wall(m, x1, v1, cosine, sine, tau):
    """Return the force on the box with the wall as its part: spring and damper, or what drives."""
    if m[at.MODE] == at.FLIGHT:
        return m[at.K1] * x1 + m[at.D1] * v1
    drive, _ = drive_and_rate_at(m, at.GAP, cosine, sine, tau)
    return -m[at.K1] * drive


def unit_of_length(m):  # inline
    """Return ``a eta^2`` of (3), m; 0 where it is too small to divide by."""
    unit = m[at.FORCING]
    return unit if abs(unit) >= LEAST_UNIT else 0.0


def write_outputs(m, outputs):  # inline
    motion, boundary, rotation = outputs
    m[at.X1], m[at.X2], m[at.V1], m[at.V2], m[at.X_REL], m[at.V_REL] = motion[:6]
    m[at.XI1], m[at.XI2], m[at.XI_REL], m[at.BOX_FORCE] = motion[6:]
    m[at.CONTACT_FORCE], m[at.IN_CONTACT], m[at.PHASE], m[at.CONTACT_SIDE] = boundary
    m[at.PHASE_COSINE], m[at.PHASE_SINE] = rotation


def sum_of_outputs(outputs):  # inline
    """Return the sum of these outputs: finite only where all are."""
    x1, x2, v1, v2, gap, gap_speed, xi1, xi2, xi_rel, box_force = outputs[0]
    contact, _, phase, _ = outputs[1]
    sum_1, sum_2 = (x1 + v1) + (xi1 + box_force), (x2 + v2) + (xi2 + gap)
    return sum_1 + sum_2 + ((gap_speed + xi_rel) + (contact + phase))


def last_written_point(m, tau):  # inline
    """Return the point written last: x1, x2, v1, v2; box force; cosine, sine; the cubics' ages."""
    motion = m[at.X1], m[at.X2], m[at.V1], m[at.V2]
    return motion, m[at.BOX_FORCE], (m[at.PHASE_COSINE], m[at.PHASE_SINE]), cubic_ages(m, tau)


def point_from_outputs(m, outputs, tau):  # inline
    return outputs[0][:4], outputs[0][9], outputs[2], cubic_ages(m, tau)


def drives_of_masses(m, point):  # inline
    """Return the forcings of masses 1 and 2 at a point, each with its derivative by tau."""
    _, _, rotation, ages = point
    cosine, sine = rotation
    first = harmonic_drive_and_rate(m, at.OSCILLATOR_1, cosine, sine)
    second = first
    if not is_only_box_shaken(m):  # rarely
        one, two = at.OSCILLATOR_1, at.OSCILLATOR_2
        if m[at.MODE] != at.FLIGHT:
            one, two = at.OSCILLATOR_3, at.OSCILLATOR_3
        first = drive_and_rate_by_ages(m, one, cosine, sine, ages)
        second = drive_and_rate_by_ages(m, two, cosine, sine, ages)
    return first, second


def relative_accelerations(m, motion, drive_1, drive_2):  # inline
    """Return the accelerations of both masses relative to the box at a point, m/s2, by (6)."""
    x1, x2, v1, v2 = motion
    if m[at.SIDE] < 0.0:  # rarely
        x1, x2, v1, v2 = -x1, -x2, -v1, -v2
    if m[at.GAP_OFFSET] != 0.0 and m[at.MODE] != at.FLIGHT:  # rarely
        x1 -= m[at.REST_1]
    a1, a2 = accelerations_or_jerks(m, drive_1, drive_2, x1, v1, x2, v2)
    return m[at.SIDE] * a1, m[at.SIDE] * a2


def accelerations_or_jerks(m, drive_1, drive_2, x1, v1, x2, v2):  # inline
    """Return both accelerations, or jerks from velocities, accelerations and drives' rates."""
    if m[at.MODE] == at.FLIGHT:
        a1 = oscillator_acceleration(m, at.OSCILLATOR_1, drive_1, x1, v1)
        return a1, oscillator_acceleration(m, at.OSCILLATOR_2, drive_2, x2, v2)
    both = oscillator_acceleration(m, at.OSCILLATOR_3, drive_1, x1, v1)
    return both, both


def oscillator_acceleration(m, b, drive, x, v):  # inline
    omega = m[at.OMEGA]
    pull = m[b + at.OMEGA_SQUARED] * x
    return omega * (omega * (drive - pull) - 2.0 * m[b + at.DAMPING] * v)


def box_force_rates(m, point):  # inline
    motion, _, _, _ = point
    _, _, v1, v2 = motion
    first, second = drives_of_masses(m, point)
    a1, a2 = relative_accelerations(m, motion, first[0], second[0])
    unit = m[at.SIDE] * m[at.OMEGA]
    j1, j2 = accelerations_or_jerks(m, first[1] * unit, second[1] * unit, v1, a1, v2, a2)
    k1, k2, d1, d2 = m[at.K1], m[at.K2], m[at.D1], m[at.D2]
    rate = k1 * v1 + d1 * a1 + k2 * v2 + d2 * a2
    return rate, k1 * a1 + d1 * j1 + k2 * a2 + d2 * j2


def momentum_and_moment(m, motion):  # inline
    """Return the momentum relative to the box, and its integral, the moment of mass."""
    x1, x2, v1, v2 = motion
    return m[at.M1] * v1 + m[at.M2] * v2, m[at.M1] * x1 + m[at.M2] * x2


def impulse_and_moment(m, h, start, end):  # inline
    """Return the impulse of the force on the box, and its moment, over a step of ``h`` seconds
    between two points, by momentum: impacts are internal and drop out.

    ``box_force = -P' - (m1 + m2) y'' + force 1 + force 2`` with P the momentum relative to the box
    and y'' its acceleration, so the integral is a difference of momenta, its moment a difference of
    displacements, and what the box's motion and the forces add is known in closed form.
    """
    before, moment_before = momentum_and_moment(m, start[0])
    after, moment_after = momentum_and_moment(m, end[0])
    cosine, sine = start[2]
    mass = m[at.M1] + m[at.M2] if m[at.WALL] == 0.0 else m[at.M1]
    drive, drive_moment = 0.0, 0.0
    if m[at.NODE_ETA] != 0.0:  # usually
        amplitude, speed = m[at.SEGMENT_INPUTS], m[at.SEGMENT_INPUTS + 1]
        sine_half, cosine_half = sincos_turns(speed * h * (0.5 / TWO_PI))
        sine_mid = sine * cosine_half + cosine * sine_half
        cosine_mid = cosine * cosine_half - sine * sine_half
        drive = 2.0 * amplitude * speed * sine_mid * sine_half
        drive_moment = amplitude * (2.0 * cosine_mid * sine_half - speed * h * end[2][0])
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        drive, drive_moment = add_cubic_impulse(
            m, at.SEGMENT_INPUTS + 2, start[3][0], -1.0, h, drive, drive_moment
        )
    moment = (moment_after - moment_before) - h * after + mass * drive_moment
    total = before - after + mass * drive
    if m[at.UNEQUAL] != 0.0:  # rarely
        pushed, pushed_moment = harmonic_impulse_and_moment(m, h, start[2], end[2])
        pushed, pushed_moment = add_cubic_impulse(
            m, at.SEGMENT_INPUTS + 8, start[3][1], 1.0, h, pushed, pushed_moment
        )
        if m[at.WALL] == 0.0:
            pushed, pushed_moment = add_cubic_impulse(
                m, at.SEGMENT_INPUTS + 12, start[3][2], 1.0, h, pushed, pushed_moment
            )
        total, moment = total + pushed, moment + pushed_moment
    return total, moment


def add_cubic_impulse(m, first, age, sign, h, total, moment):
    """Add ``sign`` times the integral, and moment, over ``h`` of the cubic of slot ``first``."""
    power = h
    for i in range(4):  # integrals of tau^i/i! and of tau^(i+1)/i!
        derivative = sign * input_derivative(m, first, i, age)
        total += derivative * power / (i + 1)
        moment += derivative * power * h / (i + 2)
        power *= h / (i + 1)
    return total, moment


def harmonic_impulse_and_moment(m, h, start, end):
    """Return impulse and moment of both harmonic forces over a step, by its ends' phases."""
    amplitude = m[at.SEGMENT_INPUTS + 6]
    if m[at.WALL] == 0.0:
        amplitude += m[at.SEGMENT_INPUTS + 7]
    angle = 0.5 * m[at.SEGMENT_INPUTS + 1] * h  # half of what the phase moves by
    sine_half, cosine_half = sincos_turns(angle * (1.0 / TWO_PI))
    part = sine_half / angle if angle > 1e-8 else 1.0
    sine_mid = start[1] * cosine_half + start[0] * sine_half
    cosine_mid = start[0] * cosine_half - start[1] * sine_half
    if angle > 0.1:
        first = (part - cosine_half) / angle
    else:
        square = angle * angle
        first = 1.0 / 30.0 - square * (1.0 / 840.0 - square * (1.0 / 45360.0))
        first = angle * (1.0 / 3.0 - square * first)
    half = 0.5 * h
    total = amplitude * h * sine_mid * part
    return total, half * total + amplitude * half * h * cosine_mid * first


def short_impulse_and_moment(m, h, start, end):  # inline
    """Return impulse and moment of a short step without event, by the force's quintic."""
    rates, rates_after = box_force_rates(m, start), box_force_rates(m, end)
    force, after, square = start[1], end[1], h * h
    p1, p2, q1, q2 = rates[0] * h, rates[1] * square, rates_after[0] * h, rates_after[1] * square
    moment = square * (
        (force * (1.0 / 7.0) + after * (5.0 / 14.0))
        + (p1 * (4.0 / 105.0) - q1 * (13.0 / 210.0))
        + (p2 * (1.0 / 280.0) + q2 * (1.0 / 210.0))
    )
    return h * (0.5 * (force + after) + ((p1 - q1) * 0.1 + (p2 + q2) * (1.0 / 120.0))), moment
