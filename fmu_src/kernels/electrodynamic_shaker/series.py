"""The motion over an interval as power series in parts of it, and the energies by their products.

With table mass M, suspension k and c, force factor Bl, coil R and L:

    M x'' + c x' + k x = Bl i + F(t)
    L i' + R i + Bl x' = u(t)

Either a voltage drives the coil, and i follows; or the current is prescribed, and u is what it
takes. Each equation gives the next term of a series from those before it.
"""

from . import memory as at


def is_voltage_driven(m):
    """Return whether a voltage drives the coil: commanded, or held at its limit."""
    if m[at.CURRENT_CONTROL] != 0.0:
        return m[at.HELD] != 0.0
    return m[at.HELD] == 0.0


def write_interval_series(m):
    driven = is_voltage_driven(m)
    driver = at.VOLTAGE_SERIES if driven else at.CURRENT_SERIES
    if m[at.HELD] != 0.0:
        write_constant_series(m, driver, m[at.HELD] * m[at.OTHER_LIMIT])
    else:
        write_source_into(m, driver)
    if driven:
        write_motion_and_current_series(m, m[at.SPACING])
    else:
        write_motion_and_voltage_series(m, m[at.SPACING])
    write_energy_series(m, m[at.SPACING], driven)


def write_constant_series(m, series, number):
    for k in range(at.TERMS):
        m[series + k] = 0.0
    m[series] = number


def write_source_into(m, series):
    for k in range(at.TERMS):
        m[series + k] = 0.0
    for k in range(at.CUBIC):
        m[series + k] = m[at.SOURCE_SERIES + k]


def write_next_motion_terms(m, k, part):
    """Write the terms k + 1 of position and velocity; ``part`` is the interval over k + 1."""
    position, velocity = m[at.POSITION_SERIES + k], m[at.VELOCITY_SERIES + k]
    force = m[at.FORCE_FACTOR] * m[at.CURRENT_SERIES + k] + m[at.FORCE_SERIES + k]
    force -= m[at.SUSPENSION_DAMPING] * velocity + m[at.SUSPENSION_STIFFNESS] * position
    m[at.POSITION_SERIES + k + 1] = part * velocity
    m[at.VELOCITY_SERIES + k + 1] = part * (force / m[at.TABLE_MASS])


def opposing_voltage_term(m, k):
    """Return term k of the voltage over the resistance and that induced by the motion."""
    drop = m[at.COIL_RESISTANCE] * m[at.CURRENT_SERIES + k]
    return drop + m[at.FORCE_FACTOR] * m[at.VELOCITY_SERIES + k]


def write_motion_and_current_series(m, h):
    """Write the series of motion and current for the voltage in VOLTAGE_SERIES."""
    inductance = m[at.COIL_INDUCTANCE]
    m[at.POSITION_SERIES] = m[at.STATE + at.POSITION]
    m[at.VELOCITY_SERIES] = m[at.STATE + at.VELOCITY]
    m[at.CURRENT_SERIES] = m[at.STATE + at.COIL_CURRENT]
    for k in range(at.DEGREE):
        part = h / (k + 1)
        if inductance > 0.0:
            rest = m[at.VOLTAGE_SERIES + k] - opposing_voltage_term(m, k)
            m[at.CURRENT_SERIES + k + 1] = part * (rest / inductance)
        else:
            m[at.CURRENT_SERIES + k] = current_term_without_inductance(m, k)
        write_next_motion_terms(m, k, part)
    if inductance == 0.0:
        m[at.CURRENT_SERIES + at.DEGREE] = current_term_without_inductance(m, at.DEGREE)


def current_term_without_inductance(m, k):
    rest = m[at.VOLTAGE_SERIES + k] - m[at.FORCE_FACTOR] * m[at.VELOCITY_SERIES + k]
    return rest / m[at.COIL_RESISTANCE]


def write_motion_and_voltage_series(m, h):
    """Write the series of motion and voltage for the current in CURRENT_SERIES."""
    m[at.POSITION_SERIES] = m[at.STATE + at.POSITION]
    m[at.VELOCITY_SERIES] = m[at.STATE + at.VELOCITY]
    for k in range(at.DEGREE):
        write_next_motion_terms(m, k, h / (k + 1))
        rise = m[at.COIL_INDUCTANCE] * m[at.CURRENT_SERIES + k + 1] * ((k + 1) / h)
        m[at.VOLTAGE_SERIES + k] = opposing_voltage_term(m, k) + rise
    m[at.VOLTAGE_SERIES + at.DEGREE] = opposing_voltage_term(m, at.DEGREE)


def write_energy_series(m, h, driven):
    """Write the series of the amplifier's work, heat, loss, and work of the force on the box."""
    cubic, other = at.CURRENT_SERIES, at.VOLTAGE_SERIES
    if driven:
        cubic, other = at.VOLTAGE_SERIES, at.CURRENT_SERIES
    current, speed = at.CURRENT_SERIES, at.VELOCITY_SERIES
    write_work_series(m, at.WORK_SERIES, m[at.STATE + at.INPUT_WORK], cubic, other, h)
    resistance = h * m[at.COIL_RESISTANCE]
    if driven:
        write_square_series(m, at.HEAT_SERIES, m[at.STATE + at.HEAT], current, resistance)
    else:
        write_work_series(m, at.HEAT_SERIES, m[at.STATE + at.HEAT], current, current, resistance)
    damping = h * m[at.SUSPENSION_DAMPING]
    write_square_series(m, at.LOSS_SERIES, m[at.STATE + at.LOSS], speed, damping)
    begun = m[at.STATE + at.FORCE_WORK]
    write_work_series(m, at.FORCE_WORK_SERIES, begun, at.FORCE_SERIES, speed, h)


def write_work_series(m, to, start_value, cubic, other, factor):
    """Write the series of a start value plus ``factor`` times an integral of cubic times other."""
    m[to] = start_value
    for n in range(at.WORK_DEGREE):
        first = n - at.DEGREE if n > at.DEGREE else 0
        last = n if n < at.CUBIC else at.CUBIC - 1
        total = 0.0
        for j in range(first, last + 1):
            total += m[cubic + j] * m[other + n - j]
        m[to + n + 1] = factor * total / (n + 1)


def write_square_series(m, to, start_value, series, factor):
    """Write the series of a start value plus ``factor`` times the integral of a square."""
    m[to] = start_value
    for n in range(at.WORK_DEGREE):
        j = n - at.DEGREE if n > at.DEGREE else 0
        total = 0.0
        while 2 * j < n:
            total += m[series + j] * m[series + n - j]
            j += 1
        total *= 2.0
        if 2 * j == n:
            total += m[series + j] * m[series + j]
        m[to + n + 1] = factor * total / (n + 1)


def series_value(m, series, degree, part):
    total = m[series + degree]
    for k in range(degree - 1, -1, -1):
        total = total * part + m[series + k]
    return total


def series_slopes(m, series, degree, part):
    """Return a series' first and second derivative by the part of its interval."""
    first, second = 0.0, 0.0
    for k in range(degree, 0, -1):
        second = second * part + first
        first = first * part + k * m[series + k]
    return first, second


def write_states_at(m, to, part):
    position, velocity, current = 0.0, 0.0, 0.0
    for k in range(at.DEGREE, -1, -1):
        position = position * part + m[at.POSITION_SERIES + k]
        velocity = velocity * part + m[at.VELOCITY_SERIES + k]
        current = current * part + m[at.CURRENT_SERIES + k]
    m[to + at.POSITION] = position
    m[to + at.VELOCITY] = velocity
    m[to + at.COIL_CURRENT] = current
    work, heat, loss, pushed = 0.0, 0.0, 0.0, 0.0
    for k in range(at.WORK_DEGREE, -1, -1):
        work = work * part + m[at.WORK_SERIES + k]
        heat = heat * part + m[at.HEAT_SERIES + k]
        loss = loss * part + m[at.LOSS_SERIES + k]
        pushed = pushed * part + m[at.FORCE_WORK_SERIES + k]
    m[to + at.INPUT_WORK] = work
    m[to + at.HEAT] = heat
    m[to + at.LOSS] = loss
    m[to + at.FORCE_WORK] = pushed
