"""What an importer sees at a communication point, with the inputs as they are now."""

from . import memory as at
from .motion import interval_part_at
from .series import series_slopes, series_value, write_states_at


def write_outputs(m):
    part, h = interval_part_at(m, m[at.TIME]), m[at.SPACING]
    write_states_at(m, at.GUARD, part)
    position, velocity = m[at.GUARD + at.POSITION], m[at.GUARD + at.VELOCITY]
    current = m[at.GUARD + at.COIL_CURRENT]
    voltage = series_value(m, at.VOLTAGE_SERIES, at.DEGREE, part)
    factor, mass, stiffness = m[at.FORCE_FACTOR], m[at.TABLE_MASS], m[at.SUSPENSION_STIFFNESS]
    force = factor * current + series_value(m, at.FORCE_SERIES, at.CUBIC - 1, part)
    force -= m[at.SUSPENSION_DAMPING] * velocity + stiffness * position
    acceleration = force / mass
    rise = factor * series_slopes(m, at.CURRENT_SERIES, at.DEGREE, part)[0] / h
    rise += series_slopes(m, at.FORCE_SERIES, at.CUBIC - 1, part)[0] / h
    rise -= m[at.SUSPENSION_DAMPING] * acceleration + stiffness * velocity
    m[at.BOX_POSITION] = position
    m[at.BOX_VELOCITY] = velocity
    m[at.BOX_ACCELERATION] = acceleration
    m[at.BOX_JERK] = rise / mass
    m[at.CURRENT] = current
    m[at.VOLTAGE] = voltage
    m[at.COIL_FORCE] = factor * current
    m[at.POWER] = voltage * current
    m[at.ENERGY] = m[at.GUARD + at.INPUT_WORK]
    m[at.COIL_HEAT] = m[at.GUARD + at.HEAT]
    m[at.SUSPENSION_LOSS] = m[at.GUARD + at.LOSS]
    m[at.BOX_FORCE_WORK] = m[at.GUARD + at.FORCE_WORK]
    m[at.STORED_ENERGY] = 0.5 * (
        mass * velocity * velocity
        + stiffness * position * position
        + m[at.COIL_INDUCTANCE] * current * current
    )
    m[at.LIMITED] = 1.0 if m[at.CLIPPED] != 0.0 or m[at.HELD] != 0.0 else 0.0


def check_finite(m):
    """Return OK, or NOT_FINITE if an output is no finite number."""
    total = m[at.EVENT]
    for i in range(at.BOX_POSITION, at.TIME):
        total += m[i]
    return at.OK if total - total == 0.0 else at.NOT_FINITE
