"""From state to state, and from interval to interval.

A state lasts from an event, or from where an input was set, to the next: its equations are the
same throughout. Intervals of one length follow one another from its beginning.
"""

from . import memory as at
from .amplifier import decide_active_limits
from .inputs import does_cubic_restart, store_inputs, write_input_series
from .limits import find_event
from .series import is_voltage_driven, write_interval_series, write_states_at


def begin_state(m):
    for i in range(at.STATES):
        m[at.STATE + i] = m[at.BEGIN + i]
    m[at.INTERVAL] = 0.0
    decide_active_limits(m)
    write_interval_and_find_event(m)


def write_interval_and_find_event(m):
    set_spacing(m)
    write_input_series(m, m[at.SPACING])
    write_interval_series(m)
    find_event(m)


def set_spacing(m):
    m[at.SPACING] = m[at.VOLTAGE_SPACING] if is_voltage_driven(m) else m[at.CURRENT_SPACING]


def local_time(m, time):
    """Return the time since the present state began, s."""
    local = (time - m[at.ORIGIN]) - m[at.ORIGIN_LOW]
    return local if local > 0.0 else 0.0


def interval_part_at(m, time):
    """Return which part of the present interval has passed at a ``time``."""
    h = m[at.SPACING]
    return (local_time(m, time) - m[at.INTERVAL] * h) / h


def restart_at_new_inputs(m):
    """Begin a state where an input was set; once more there, from the same states."""
    command = does_cubic_restart(m, at.COMMAND_SET, at.COMMAND)
    force = does_cubic_restart(m, at.FORCE_SET, at.BOX_FORCE)
    m[at.COMMAND_SET] = 0.0
    m[at.FORCE_SET] = 0.0
    if not (command or force):
        return
    time = m[at.TIME]
    moved = local_time(m, time) > 0.0
    if moved:
        write_states_at(m, at.BEGIN, interval_part_at(m, time))
        m[at.FOLLOWED] = 1.0 if m[at.HELD] == 0.0 else 0.0
    if moved or command:
        m[at.COMMAND_LOWEST] = 0.0
        m[at.OTHER_LOWEST] = 0.0
    if command:
        m[at.FOLLOWED] = 0.0
        m[at.COMMAND_TIME] = time
    if force:
        m[at.FORCE_TIME] = time
    m[at.ORIGIN] = time
    m[at.ORIGIN_LOW] = 0.0
    store_inputs(m)
    begin_state(m)


def end_state_at_event(m):
    """Carry out the present interval's event, and begin the state after it."""
    write_states_at(m, at.BEGIN, m[at.EVENT])
    other = m[at.EVENT_KIND] == at.OTHER_EVENT
    lags, held = m[at.COIL_INDUCTANCE] > 0.0, m[at.HELD] != 0.0
    commanded = m[at.CURRENT_CONTROL] != 0.0
    if other and lags and not held and not commanded:
        limit = m[at.OTHER_LIMIT]
        m[at.BEGIN + at.COIL_CURRENT] = limit if m[at.BEGIN + at.COIL_CURRENT] > 0.0 else -limit
    m[at.FOLLOWED] = 1.0 if other or not held else 0.0
    m[at.COMMAND_LOWEST] = 0.0 if other else 1.0
    # an inductive current comes to its limit, or to the command, at any balance
    m[at.OTHER_LOWEST] = 1.0 if other and (not lags or held != commanded) else 0.0
    move_origin(m, m[at.INTERVAL] * m[at.SPACING] + m[at.EVENT] * m[at.SPACING])
    begin_state(m)


def move_origin(m, age):
    """Move the beginning of the present state by ``age`` (s), without losing digits."""
    total = m[at.ORIGIN] + age
    part = total - m[at.ORIGIN]
    error = (m[at.ORIGIN] - (total - part)) + (age - part)
    low = m[at.ORIGIN_LOW] + error
    m[at.ORIGIN] = total + low
    m[at.ORIGIN_LOW] = low - (m[at.ORIGIN] - total)


def run_to(m, time):
    """Run through all intervals and events up to ``time``; in REPORT is how far it came."""
    while True:
        local = local_time(m, time)
        begun = m[at.INTERVAL] * m[at.SPACING]
        if m[at.EVENT] != m[at.EVENT]:  # rarely
            return at.NOT_FINITE
        event = begun + m[at.EVENT] * m[at.SPACING]
        if m[at.EVENT_KIND] != at.NO_EVENT and event <= local:
            if m[at.EVENT_KIND] == at.TRAVEL_EVENT:
                write_states_at(m, at.BEGIN, m[at.EVENT])
                m[at.BOX_POSITION] = m[at.BEGIN + at.POSITION]
                m[at.REPORT] = m[at.ORIGIN] + event
                return at.TRAVEL
            end_state_at_event(m)
        elif begun + m[at.SPACING] <= local:
            write_states_at(m, at.STATE, 1.0)
            m[at.INTERVAL] += 1.0
            write_interval_and_find_event(m)
        else:
            return at.OK
        m[at.WORK] += 1.0
        if m[at.WORK] >= m[at.WORK_LIMIT]:
            m[at.REPORT] = m[at.ORIGIN] + m[at.INTERVAL] * m[at.SPACING]
            return at.UNFINISHED
