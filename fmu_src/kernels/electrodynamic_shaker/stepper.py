"""The entry points: initialise once, then advance from one communication point to the next.

An instance is one flat memory.
"""

from . import memory as at
from .inputs import store_inputs
from .intervals import SHORTEST, set_spacings
from .motion import begin_state, local_time, restart_at_new_inputs, run_to, set_spacing
from .outputs import check_finite, write_outputs

WORK_MOST = 4e6  # series of a step: some seconds, compiled; EVALUATION_LIMIT may allow less


def initialize(m, time):
    """Begin at ``time`` (s) from parameters, start values and inputs; return a code of memory."""
    for i in range(at.BOX_POSITION, at.EVALUATION_LIMIT):
        m[i] = 0.0
    for i in range(at.TIME, at.SIZE):
        m[i] = 0.0
    m[at.TIME] = time
    m[at.TARGET] = time
    m[at.ORIGIN] = time
    m[at.COMMAND_TIME] = time
    m[at.FORCE_TIME] = time
    code = derive_constants(m)
    if code != at.OK:
        return code
    if m[at.TRAVEL_LIMIT] > 0.0 and abs(m[at.POSITION_START]) > m[at.TRAVEL_LIMIT]:
        return at.START_TRAVEL
    limited = m[at.CURRENT_CONTROL] == 0.0 and m[at.CURRENT_LIMIT] > 0.0
    if limited and m[at.COIL_INDUCTANCE] > 0.0 and abs(m[at.CURRENT_START]) > m[at.CURRENT_LIMIT]:
        return at.START_CURRENT
    m[at.BEGIN + at.POSITION] = m[at.POSITION_START]
    m[at.BEGIN + at.VELOCITY] = m[at.VELOCITY_START]
    # without a voltage limit a commanded current jumps from zero to the first command
    jumps = m[at.CURRENT_CONTROL] != 0.0 and m[at.VOLTAGE_LIMIT] == 0.0
    m[at.BEGIN + at.COIL_CURRENT] = 0.0 if jumps else m[at.CURRENT_START]
    store_inputs(m)
    begin_state(m)
    write_outputs(m)
    return check_finite(m)


def derive_constants(m):
    """Compute what follows from the parameters; INDUCTANCE: a time constant is too short."""
    set_spacings(m)
    m[at.REPORT] = SHORTEST
    if m[at.CURRENT_CONTROL] != 0.0:
        m[at.COMMAND_LIMIT] = m[at.CURRENT_LIMIT]
        m[at.OTHER_LIMIT] = m[at.VOLTAGE_LIMIT]
    else:
        m[at.COMMAND_LIMIT] = m[at.VOLTAGE_LIMIT]
        m[at.OTHER_LIMIT] = m[at.CURRENT_LIMIT]
    return at.OK if m[at.VOLTAGE_SPACING] >= SHORTEST else at.INDUCTANCE


def restore(m, time):
    """Recompute what the parameters decide in a saved memory; ``time`` is not used."""
    code = derive_constants(m)
    set_spacing(m)
    return code


def advance(m, time):
    """Advance to ``time`` (s); after another code than OK the memory is to be thrown away."""
    restart_at_new_inputs(m)
    m[at.TARGET] = time
    m[at.WORK] = 0.0
    m[at.WORK_LIMIT] = min(WORK_MOST, m[at.EVALUATION_LIMIT])
    too_many = at.LIMITED_WORK if m[at.WORK_LIMIT] < WORK_MOST else at.UNFINISHED
    needed = local_time(m, time) / m[at.SPACING] - m[at.INTERVAL]
    if needed > WORK_MOST:
        m[at.WORK] = needed
        m[at.REPORT] = m[at.TIME]
        return too_many
    code = run_to(m, time)
    if code != at.OK:
        return too_many if code == at.UNFINISHED else code
    m[at.TIME] = time
    m[at.EVALUATIONS] = m[at.WORK]
    write_outputs(m)
    return check_finite(m)


def refresh(m, time):
    """Write the outputs for the inputs as they are now; ``time`` is not used."""
    restart_at_new_inputs(m)
    write_outputs(m)
    return check_finite(m)
