"""The equations of motion of box and rotor, the motor's circuit, and the energies they exchange.

With S = unbalance_mass unbalance_radius, position y, angle phi, speed w, current i:

    (a)  M y'' + S cos(phi) w' = S w^2 sin(phi) - c y' - k y + F(t)
    (b)  S cos(phi) y'' + J w' = K i
    (c)  L i' = U - R i - K w,   or i = (U - K w) / R where L = 0
"""

from ..numerics.elementary import TWO_PI, sincos_turns
from . import memory as at

# turns of the rotor in a stage: beyond, its rates are no numbers, so that the sub-step is halved
MOST_TURNS = 1e9
NO_NUMBER = 1e400 - 1e400


def restart_force_cubic(m):
    """Begin the force's cubic at the communication point, where one of its inputs was set."""
    if m[at.FORCE_SET] != 0.0:
        m[at.FORCE_TIME] = m[at.TIME]
        m[at.FORCE_SET] = 0.0


def box_force_at(m, t):
    """Return the force on the box, N, ``t`` after it was set."""
    return m[at.BOX_FORCE] + t * (
        m[at.BOX_FORCE_1] + 0.5 * t * (m[at.BOX_FORCE_2] + t * m[at.BOX_FORCE_3] / 3.0)
    )


def box_force_and_rates(m):
    """Return the force on the box at the communication point, N, and two time derivatives."""
    t = m[at.TIME] - m[at.FORCE_TIME]
    second = m[at.BOX_FORCE_2] + t * m[at.BOX_FORCE_3]
    first = m[at.BOX_FORCE_1] + t * (m[at.BOX_FORCE_2] + 0.5 * t * m[at.BOX_FORCE_3])
    return box_force_at(m, t), first, second


def current_without_inductance(m, speed):
    """Return the current without inductance, A: (c) with L = 0."""
    return (m[at.VOLTAGE] - m[at.MOTOR_CONSTANT] * speed) / m[at.ARMATURE_RESISTANCE]


def box_right_side(m, position, velocity, speed, sine, pushed):
    """Return the right-hand side of (a), N, for a force ``pushed`` on the box."""
    p = m[at.UNBALANCE] * speed * speed * sine - m[at.BOX_DAMPING] * velocity
    return p - m[at.BOX_STIFFNESS] * position + pushed


def box_and_rotor_accelerations(m, sine, cosine, p, q):
    """Return y'' and w' that (a) and (b) have for right-hand sides ``p`` and ``q``."""
    mass, inertia, coupling = m[at.BOX_MASS], m[at.ROTOR_INERTIA], m[at.UNBALANCE] * cosine
    unbalance = m[at.UNBALANCE]
    # M J - S^2 cos^2 = (M J - S^2) + S^2 sin^2, without cancelling
    free = mass * inertia - unbalance * unbalance
    determinant = free + unbalance * sine * (unbalance * sine)
    return (inertia * p - coupling * q) / determinant, (mass * q - coupling * p) / determinant


def write_rates(m, stage, t):
    """Write the rates at STAGE, ``t`` s after the force was set, to row ``stage`` of RATES."""
    turn = m[at.TURN] + m[at.STAGE + at.ROTATION] / TWO_PI
    position, velocity = m[at.STAGE + at.POSITION], m[at.STAGE + at.VELOCITY]
    speed = m[at.STAGE + at.ROTATION_SPEED]
    sine, cosine = NO_NUMBER, NO_NUMBER
    if abs(turn) < MOST_TURNS:
        sine, cosine = sincos_turns(turn)
    current = m[at.STAGE + at.CURRENT]
    current_rate = 0.0
    if m[at.ARMATURE_INDUCTANCE] > 0.0:
        drop = m[at.VOLTAGE] - m[at.ARMATURE_RESISTANCE] * current - m[at.MOTOR_CONSTANT] * speed
        current_rate = drop / m[at.ARMATURE_INDUCTANCE]  # (c)
    else:
        current = current_without_inductance(m, speed)
    torque = m[at.MOTOR_CONSTANT] * current  # right-hand side of (b)
    pushed = box_force_at(m, t)
    p = box_right_side(m, position, velocity, speed, sine, pushed)
    box, rotor = box_and_rotor_accelerations(m, sine, cosine, p, torque)
    row = at.RATES + stage * at.STATES
    m[row + at.POSITION] = velocity
    m[row + at.VELOCITY] = box
    m[row + at.ROTATION] = speed
    m[row + at.ROTATION_SPEED] = rotor
    m[row + at.CURRENT] = current_rate
    m[row + at.MOTOR_WORK] = torque * speed
    m[row + at.DAMPER_LOSS] = m[at.BOX_DAMPING] * velocity * velocity
    m[row + at.FORCE_WORK] = pushed * velocity
