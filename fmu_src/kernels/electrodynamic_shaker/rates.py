"""Time derivatives of the outputs, from the equations, with the inputs as they are now."""

from . import memory as at
from .motion import interval_part_at
from .series import series_slopes, series_value


def differentiate(m, time):
    """Write the rates of change of the outputs into OUTPUT_RATES; ``time`` is not used."""
    part, h = interval_part_at(m, m[at.TIME]), m[at.SPACING]
    velocity, acceleration = m[at.BOX_VELOCITY], m[at.BOX_ACCELERATION]
    current_1, current_2 = series_slopes(m, at.CURRENT_SERIES, at.DEGREE, part)
    _, force_2 = series_slopes(m, at.FORCE_SERIES, at.CUBIC - 1, part)
    voltage_1, _ = series_slopes(m, at.VOLTAGE_SERIES, at.DEGREE, part)
    current, voltage, factor = m[at.CURRENT], m[at.VOLTAGE], m[at.FORCE_FACTOR]
    snap = (factor * current_2 + force_2) / h / h - m[at.SUSPENSION_DAMPING] * m[at.BOX_JERK]
    heat = m[at.COIL_RESISTANCE] * current * current
    loss = m[at.SUSPENSION_DAMPING] * velocity * velocity
    work = series_value(m, at.FORCE_SERIES, at.CUBIC - 1, part) * velocity
    to = at.OUTPUT_RATES - at.BOX_POSITION
    m[to + at.BOX_POSITION] = velocity
    m[to + at.BOX_VELOCITY] = acceleration
    m[to + at.BOX_ACCELERATION] = m[at.BOX_JERK]
    m[to + at.BOX_JERK] = (snap - m[at.SUSPENSION_STIFFNESS] * acceleration) / m[at.TABLE_MASS]
    m[to + at.CURRENT] = current_1 / h
    m[to + at.VOLTAGE] = voltage_1 / h
    m[to + at.COIL_FORCE] = factor * (current_1 / h)
    m[to + at.POWER] = (voltage_1 * current + voltage * current_1) / h
    m[to + at.ENERGY] = m[at.POWER]
    m[to + at.COIL_HEAT] = heat
    m[to + at.SUSPENSION_LOSS] = loss
    m[to + at.BOX_FORCE_WORK] = work
    m[to + at.STORED_ENERGY] = m[at.POWER] + work - heat - loss
    return at.OK
