"""Time derivatives of the outputs, from the equations, with the inputs as they are now."""

from ..numerics.elementary import sincos_turns
from . import memory as at
from .equations import box_and_rotor_accelerations, box_force_and_rates, box_right_side
from .outputs import box_and_rotor_jerks, current_rate


def differentiate(m, time):
    """Write the rates of change of the outputs into OUTPUT_RATES; ``time`` is not used."""
    sine, cosine = sincos_turns(m[at.TURN])
    box, speed, pushed = m[at.BOX_ACCELERATION], m[at.SPEED], box_force_and_rates(m)[0]
    p = box_right_side(m, m[at.BOX_POSITION], m[at.BOX_VELOCITY], speed, sine, pushed)
    rotor = box_and_rotor_accelerations(m, sine, cosine, p, m[at.MOTOR_TORQUE])[1]
    current = current_rate(m, rotor)
    torque = m[at.MOTOR_CONSTANT] * current
    damping = m[at.BOX_DAMPING] * m[at.BOX_VELOCITY] * m[at.BOX_VELOCITY]
    work = pushed * m[at.BOX_VELOCITY]
    to = at.OUTPUT_RATES - at.BOX_POSITION
    m[to + at.BOX_POSITION] = m[at.BOX_VELOCITY]
    m[to + at.BOX_VELOCITY] = box
    m[to + at.BOX_ACCELERATION] = m[at.BOX_JERK]
    m[to + at.BOX_JERK] = box_snap(m, sine, cosine, rotor)
    m[to + at.ANGLE] = speed
    m[to + at.SPEED] = rotor
    m[to + at.MOTOR_CURRENT] = current
    m[to + at.MOTOR_TORQUE] = torque
    m[to + at.MOTOR_POWER] = torque * speed + m[at.MOTOR_TORQUE] * rotor
    m[to + at.MOTOR_ENERGY] = m[at.MOTOR_POWER]
    m[to + at.BOX_DAMPER_ENERGY] = damping
    m[to + at.BOX_FORCE_WORK] = work
    m[to + at.STORED_ENERGY] = m[at.MOTOR_POWER] + work - damping
    return at.OK


def box_snap(m, sine, cosine, b):
    """Return the fourth derivative of the box's position; ``b`` is the rotor's acceleration."""
    unbalance, w, a = m[at.UNBALANCE], m[at.SPEED], m[at.BOX_ACCELERATION]
    a_dot, b_dot = box_and_rotor_jerks(m, sine, cosine, a, b)
    resistance, constant = m[at.ARMATURE_RESISTANCE], m[at.MOTOR_CONSTANT]
    if m[at.ARMATURE_INDUCTANCE] > 0.0:
        current = -(resistance * current_rate(m, b) + constant * b) / m[at.ARMATURE_INDUCTANCE]
    else:
        current = -constant * b_dot / resistance
    p = box_force_and_rates(m)[2] - m[at.BOX_DAMPING] * a_dot - m[at.BOX_STIFFNESS] * a
    p += unbalance * (
        (3.0 * b * b - w * w * w * w) * sine + 6.0 * w * w * b * cosine + 4.0 * w * b_dot * sine
    )
    q = constant * current + unbalance * ((w * w * cosine + b * sine) * a + 2.0 * w * sine * a_dot)
    return box_and_rotor_accelerations(m, sine, cosine, p, q)[0]
