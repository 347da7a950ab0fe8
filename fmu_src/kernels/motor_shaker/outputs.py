"""What an importer sees at a communication point.

The states reached, and what follows from them with the inputs as they are now.
"""

from ..numerics.elementary import sincos_turns
from . import memory as at
from .equations import (
    box_and_rotor_accelerations,
    box_force_and_rates,
    box_right_side,
    current_without_inductance,
)


def write_outputs(m):
    sine, cosine = sincos_turns(m[at.TURN])
    position, velocity = m[at.STATE + at.POSITION], m[at.STATE + at.VELOCITY]
    speed = m[at.STATE + at.ROTATION_SPEED]
    current = (
        m[at.STATE + at.CURRENT]
        if m[at.ARMATURE_INDUCTANCE] > 0.0
        else current_without_inductance(m, speed)
    )
    torque = m[at.MOTOR_CONSTANT] * current
    p = box_right_side(m, position, velocity, speed, sine, box_force_and_rates(m)[0])
    box, rotor = box_and_rotor_accelerations(m, sine, cosine, p, torque)
    m[at.BOX_POSITION] = position
    m[at.BOX_VELOCITY] = velocity
    m[at.BOX_ACCELERATION] = box
    m[at.BOX_JERK] = box_and_rotor_jerks(m, sine, cosine, box, rotor)[0]
    m[at.SPEED] = speed
    m[at.MOTOR_CURRENT] = current
    m[at.MOTOR_TORQUE] = torque
    m[at.MOTOR_POWER] = torque * speed
    m[at.MOTOR_ENERGY] = m[at.STATE + at.MOTOR_WORK]
    m[at.BOX_DAMPER_ENERGY] = m[at.STATE + at.DAMPER_LOSS]
    m[at.BOX_FORCE_WORK] = m[at.STATE + at.FORCE_WORK]
    kinetic = (
        0.5 * m[at.BOX_MASS] * velocity * velocity
        + 0.5 * m[at.ROTOR_INERTIA] * speed * speed
        + m[at.UNBALANCE] * velocity * speed * cosine
    )
    m[at.STORED_ENERGY] = kinetic + 0.5 * m[at.BOX_STIFFNESS] * position * position


def current_rate(m, rotor):
    """Return the time derivative of the current, A/s, with the voltage constant."""
    constant = m[at.MOTOR_CONSTANT]
    if m[at.ARMATURE_INDUCTANCE] > 0.0:
        drop = m[at.VOLTAGE] - m[at.ARMATURE_RESISTANCE] * m[at.STATE + at.CURRENT]
        drop -= constant * m[at.STATE + at.ROTATION_SPEED]
        return drop / m[at.ARMATURE_INDUCTANCE]
    return -constant * rotor / m[at.ARMATURE_RESISTANCE]


def box_and_rotor_jerks(m, sine, cosine, box, rotor):
    """Return the third derivatives of box and rotor: the equations once more, voltage constant."""
    unbalance, speed = m[at.UNBALANCE], m[at.STATE + at.ROTATION_SPEED]
    p = (
        box_force_and_rates(m)[1]
        - m[at.BOX_DAMPING] * box
        - m[at.BOX_STIFFNESS] * m[at.STATE + at.VELOCITY]
    )
    p += unbalance * speed * (3.0 * rotor * sine + speed * speed * cosine)
    q = m[at.MOTOR_CONSTANT] * current_rate(m, rotor) + unbalance * box * speed * sine
    return box_and_rotor_accelerations(m, sine, cosine, p, q)
