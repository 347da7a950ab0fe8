"""The entry points: initialise once, then advance from one communication point to the next.

``coast`` is the fast path of ``advance`` if neither an event nor a new input comes. An instance is
one flat memory.
"""

from ..numerics.elementary import TWO_PI
from . import memory as at
from .event_function import evaluate_event_function
from .excitation import (
    begin_segment,
    drive_and_rate_at,
    have_inputs_changed,
    mirror_system,
    set_excitation,
)
from .hermite import may_have_summit
from .maximum import record_peaks, walk_with_largest_gap
from .motion import (
    begin_contact_or_glued,
    begin_flight,
    begin_state,
    displacements_from_rest_together,
    displacements_from_unloaded,
    end_state,
    gap_between,
    motion_as_importer_sees,
    move_origin,
    set_phase,
    state_at,
)
from .nodes import is_countable, is_too_fast
from .outputs import (
    SHORT,
    impulse_and_moment,
    last_written_point,
    outputs_at,
    point_from_outputs,
    short_impulse_and_moment,
    sum_of_outputs,
    write_outputs,
)
from .parameters import derive_constants
from .roots import value_on_decided_side, walk_to_event
from .secular import clear_growing_amplitudes, set_event_drive

TOUCHING = 4.440892098500626e-16  # 2**-51, relative: a gap at the start that is only rounding
WORK_BASE = 100000.0  # evaluations of the event function a step may take whatever its length,
WORK_RATE = 256.0  # and in gamma radians of the fastest oscillation,
WORK_MOST = 1e7  # and at the very most: a second or two, compiled; EVALUATION_LIMIT may allow less


def initialize(m, time):
    """Begin at ``time`` (s) from parameters, start values and inputs; return a code of memory."""
    m[at.SIDE] = 1.0
    derive_constants(m)
    m[at.START_TIME] = time
    m[at.TIME] = time
    for i in range(at.ORIGIN, at.START_TIME):
        m[i] = 0.0
    for i in range(at.BEGIN, at.SIZE):
        m[i] = 0.0
    for i in range(at.IMPACT_COUNT, at.SAMPLE_COUNT):
        m[i] = 0.0
    for i in range(at.X1_SAMPLE, at.EVALUATION_LIMIT):
        m[i] = 0.0
    clear_peaks(m)
    m[at.BOX_IMPULSE] = 0.0
    m[at.BOX_IMPULSE_MOMENT] = 0.0
    m[at.STICKING_ENERGY] = 0.0
    m[at.IMPACT_SIDE] = 0.0
    x1, x2, gap = start_displacements_and_gap(m)
    code = start_problem_code(m, gap)
    if code != at.OK:
        return code
    set_phase(m, m[at.PHASE_START] / TWO_PI)
    for i in range(3):
        m[at.CUBIC_SET + i] = 1.0
    begin_segment(m)
    for i in range(3):
        m[at.CUBIC_SET + i] = 0.0
    if is_too_fast(m):
        return at.TOO_FAST
    m[at.WORK_LIMIT] = WORK_BASE
    m[at.MODE] = at.GLUED if m[at.BONDED] != 0.0 else at.CONTACT
    begin_first_state(m, x1, x2, gap)
    if m[at.NARROW] != 0.0:  # rarely
        return at.TOO_NARROW
    seen = outputs_at(m, 0.0)
    write_outputs(m, seen)
    m[at.X_REL_MAX] = m[at.X_REL] if m[at.X_REL_MAX_ON] != 0.0 else 0.0
    if m[at.PEAKS_ON] != 0.0:
        record_peaks(m, 0.0, 0.0)
    return check_finite(sum_of_outputs(seen) + sum_of_peaks(m))


def start_problem_code(m, gap):
    """Return OK, or the code of what contradicts itself in the start values."""
    if gap < 0.0:
        m[at.REPORT] = m[at.X1_START] - m[at.GAP_OFFSET]
        return at.START_OVERLAP if m[at.GAP_OFFSET] <= 0.0 else at.START_BEYOND_CLEARANCE
    if max(gap - start_rounding(m), m[at.CLEARANCE]) > m[at.LIMIT]:
        m[at.REPORT] = gap
        return at.START_BEYOND_STROKE
    if m[at.BONDED] != 0.0 and (
        m[at.X2_START] != m[at.X1_START] or m[at.V2_START] != m[at.V1_START]
    ):
        return at.START_BONDED
    if m[at.WALL] != 0.0 and (
        m[at.X2_START] != 0.0 or m[at.V2_START] != 0.0 or m[at.BONDED] != 0.0
    ):
        return at.START_WALL
    return at.OK


def start_rounding(m):
    return TOUCHING * (abs(m[at.X1_START]) + abs(m[at.X2_START]) + m[at.STROKE])


def begin_first_state(m, x1, x2, gap):
    """Begin the first state, mirrored at the outer end of the play."""
    v1, v2 = m[at.V1_START] / m[at.OMEGA], m[at.V2_START] / m[at.OMEGA]
    if gap + start_rounding(m) >= m[at.LIMIT]:  # rarely
        mirror_system(m)
        x1 = x2 = -x1 - m[at.REST_1]
        v1, v2, gap = -v1, -v2, 0.0
    begin_state(m, x1, v1, x2, v2, gap, 0)


def restore(m, time):
    """Recompute what parameters and inputs decide in a saved memory: then every step of it ends."""
    m[at.START_TIME] = time
    m[at.SIDE] = 1.0 if m[at.SIDE] >= 0.0 else -1.0
    derive_constants(m)
    clear_growing_amplitudes(m)
    set_excitation(m)
    if m[at.SECULAR] != 0.0:  # rarely
        set_event_drive(m)
    m[at.LEFT_AGE] = m[at.NODE] * m[at.SPACING]
    m[at.RIGHT_AGE] = (m[at.NODE] + 1.0) * m[at.SPACING]
    if is_too_fast(m):
        return at.TOO_FAST
    if not is_countable(m, local_time(m, m[at.TIME])):
        m[at.TARGET] = m[at.TIME]
        m[at.REPORT] = time
        return at.BEYOND
    return at.OK


def clear_peaks(m):
    for i in range(at.X1_MAX, at.A2_MAX + 1):
        m[i] = 0.0


def sum_of_peaks(m):
    """Return a sum of the peaks: finite only where all are."""
    return (m[at.X1_MAX] + m[at.X2_MAX]) + (m[at.A1_MAX] + m[at.A2_MAX])


def start_displacements_and_gap(m):
    """Return the displacements from the position at rest, and the gap; below 0: overlap."""
    x1, x2, clearance = m[at.X1_START], m[at.X2_START], m[at.GAP_OFFSET]
    gap = x2 - x1
    if clearance > 0.0:  # rarely
        gap += clearance
        if abs(gap) <= TOUCHING * (abs(x1) + abs(x2) + clearance):
            return x1 - m[at.REST_1], x1 - m[at.REST_1], 0.0
    elif clearance < 0.0 and gap > 0.0:  # rarely
        return x1 + m[at.REST_1], x2 + m[at.REST_2], gap
    return x1, x2, gap


def local_time(m, time):
    tau = (m[at.OMEGA] * (time - m[at.START_TIME]) - m[at.ORIGIN]) - m[at.ORIGIN_LOW]
    return tau if tau > 0.0 else 0.0


def advance(m, time):
    """Advance to ``time`` (s), or the first impact if STOP_AT_IMPACT; not OK: memory is lost."""
    before = m[at.TIME]
    h = time - before
    fastest = max(m[at.FASTEST], m[at.BOX_FREQUENCY] / m[at.OMEGA])
    m[at.TARGET] = time
    m[at.WORK] = 0.0
    m[at.STOPPED] = 0.0
    allowed = min(WORK_MOST, WORK_BASE + WORK_RATE * fastest * m[at.OMEGA] * abs(h) / m[at.GAMMA])
    m[at.WORK_LIMIT] = min(allowed, m[at.EVALUATION_LIMIT])
    now = local_time(m, before)
    if have_inputs_changed(m):
        begin_segment_and_state(m, now)
        now = 0.0
        m[at.PHASE_COSINE] = m[at.COSINE]
        m[at.PHASE_SINE] = m[at.SINE]
        if m[at.WALL] != 0.0:  # rarely
            m[at.BOX_FORCE] = outputs_at(m, 0.0)[0][9]
        if is_too_fast(m):
            return at.TOO_FAST
    if not is_countable(m, local_time(m, time)):  # rarely
        m[at.REPORT] = before
        return at.BEYOND
    left, mode, impacts = (last_written_point(m, now), m[at.MODE], m[at.IMPACT_COUNT])
    m[at.X_REL_MAX] = m[at.X_REL] if m[at.X_REL_MAX_ON] != 0.0 else 0.0
    if m[at.PEAKS_ON] != 0.0:
        clear_peaks(m)
    tau = run_samples(m, before, time, now)
    if m[at.WORK] >= m[at.WORK_LIMIT]:  # rarely
        m[at.REPORT] = m[at.START_TIME] + m[at.ORIGIN] / m[at.OMEGA]
        return at.LIMITED if m[at.WORK_LIMIT] < allowed else at.UNFINISHED
    if m[at.CLEAR] != m[at.CLEAR]:  # rarely
        return at.NOT_FINITE
    if m[at.NARROW] != 0.0:  # rarely
        return at.TOO_NARROW
    if m[at.STOPPED] != 0.0:  # rarely
        time = min(time, m[at.IMPACT_TIME])
    same = m[at.MODE] == mode and m[at.IMPACT_COUNT] == impacts
    return write_outputs_if_finite(m, time, tau, left, m[at.X_REL_MAX], same)


def coast(m, time):
    """Advance where the present state lasts; with another code nothing has changed."""
    tau = local_time(m, time)
    quick = m[at.SAMPLE_COUNT] == 0.0 and m[at.PEAKS_ON] == 0.0
    if not does_state_last_beyond(m, tau) or not quick or have_inputs_changed(m):
        return at.UNFINISHED
    if not is_countable(m, tau):  # rarely
        return at.UNFINISHED
    now = local_time(m, m[at.TIME])
    highest = 0.0
    if m[at.X_REL_MAX_ON] != 0.0:
        highest = m[at.X_REL]
        if not is_without_summit(m, now, tau):
            return at.UNFINISHED
    m[at.WORK] = 0.0
    left = last_written_point(m, now)
    return write_outputs_if_finite(m, time, tau, left, highest, True)


def does_state_last_beyond(m, tau):
    return (m[at.CLEAR] if m[at.END_KIND] == at.END_OPEN else m[at.END]) > tau


def is_without_summit(m, start, stop):
    """Return whether a quick test shows that a part's largest gap is at an end."""
    if m[at.MODE] != at.FLIGHT:
        return True
    within = m[at.LEFT_AGE] < start and stop < m[at.RIGHT_AGE] and m[at.CLEAR] <= m[at.RIGHT_AGE]
    return within and m[at.SERIES] == 0.0 and not may_have_summit(m, start, stop)


def write_outputs_if_finite(m, time, tau, start, highest, is_same_state):  # inline
    """Write all outputs at ``time``, age ``tau``, if they are finite; return a code of memory."""
    h = time - m[at.TIME]
    outputs = outputs_at(m, tau)
    end = point_from_outputs(m, outputs, tau)
    # no momentum at a wall: nothing cancels
    at_wall = m[at.WALL] != 0.0 and m[at.MODE] != at.FLIGHT
    if is_same_state and not at_wall and h * m[at.OMEGA] * m[at.RATE] < SHORT:
        force, moment = short_impulse_and_moment(m, h, start, end)
    else:
        force, moment = impulse_and_moment(m, h, start, end)
    gap = outputs[0][4]
    if m[at.X_REL_MAX_ON] != 0.0 and gap > highest:
        highest = gap
    last = m[at.IMPACT_TIME] + m[at.IMPACT_VELOCITY] + m[at.IMPACT_ENERGY]
    sums = sum_of_outputs(outputs) + (force + moment) + (highest + last)
    if m[at.PEAKS_ON] != 0.0:  # rarely
        sums += sum_of_peaks(m)
    code = check_finite(sums)
    if code == at.OK:
        m[at.TIME] = time
        m[at.STEP] = h
        for i in range(3):
            m[at.CUBIC_SET + i] = 0.0
        write_outputs(m, outputs)
        m[at.BOX_IMPULSE] = force
        m[at.BOX_IMPULSE_MOMENT] = moment
        m[at.X_REL_MAX] = highest
        m[at.EVALUATIONS] = m[at.WORK]
        if m[at.PEAKS_ON] == 0.0:
            clear_peaks(m)
    return code


def check_finite(total):
    """Return OK, or NOT_FINITE if a sum of outputs is no finite number."""
    return at.OK if total - total == 0.0 else at.NOT_FINITE


def begin_segment_and_state(m, now):
    """Begin a segment with the present inputs; whether contact stays is decided again."""
    x1, v1, x2, v2 = state_at(m, now)
    gap = gap_between(m, now, x1, x2)
    goes_on = now > 0.0 and m[at.MODE] != at.GLUED and (gap > 0.0 or is_inside_state(m, now))
    move_origin(m, now)
    before = gap_drive(m)
    begin_segment(m)
    if gap <= 0.0 and gap_drive(m) != before:  # rarely
        goes_on = False
    if gap > 0.0 or (goes_on and m[at.MODE] == at.FLIGHT):
        x1, x2 = displacements_from_unloaded(m, x1, x2)
    else:
        x1, x2 = displacements_from_rest_together(m, x1, x2)
    if not goes_on:
        begin_state(m, x1, v1, x2, v2, gap, 0)
    elif m[at.MODE] == at.FLIGHT:
        begin_flight(m, x1, v1, x2, v2, gap)
    else:
        begin_contact_or_glued(m, at.CONTACT, x1, v1)


def gap_drive(m):
    drive = 0.0
    if m[at.UNEQUAL] != 0.0:  # rarely
        drive, _ = drive_and_rate_at(m, at.GAP, m[at.COSINE], m[at.SINE], 0.0)
    return drive


def is_inside_state(m, tau):
    """Return whether the event function is not crossed: positive, or zero but for rounding."""
    h0, h1, _, _, _, _ = evaluate_event_function(m, tau)
    return h0 > 0.0 or value_on_decided_side(m, tau, h0, h1) > 0.0


def run_samples(m, start, time, age):
    """Run to ``time``, keeping states at equal parts of the step; return the state's age there."""
    count = int(m[at.SAMPLE_COUNT])
    for i in range(count):
        if m[at.STOPPED] == 0.0:
            until = start + (time - start) * ((i + 1.0) / count) if i + 1 < count else time
            age = run_to(m, until, age)
        if m[at.WORK] >= m[at.WORK_LIMIT]:  # rarely
            return age
        write_sample(m, i, age)
    return age if count > 0 else run_to(m, time, age)


def write_sample(m, i, tau):
    x1, v1, x2, v2 = state_at(m, tau)
    gap = gap_between(m, tau, x1, x2)
    x1, x2 = displacements_from_unloaded(m, x1, x2)
    if m[at.UNEQUAL] != 0.0:  # rarely
        x1, v1, x2, v2, gap = motion_as_importer_sees(m, x1, v1, x2, v2, gap)
    m[at.X1_SAMPLE + i] = x1
    m[at.X2_SAMPLE + i] = x2
    m[at.V1_SAMPLE + i] = m[at.OMEGA] * v1
    m[at.V2_SAMPLE + i] = m[at.OMEGA] * v2
    if m[at.X_REL_MAX_ON] != 0.0 and gap > m[at.X_REL_MAX]:
        m[at.X_REL_MAX] = gap


def run_to(m, time, age):
    """Run from the present state's ``age`` to ``time``; return the age of the state there."""
    watching = m[at.X_REL_MAX_ON] != 0.0
    while True:
        tau = local_time(m, time)
        if watching and m[at.MODE] == at.FLIGHT:
            walk_with_largest_gap(m, age, tau)
        else:
            walk_to_event(m, tau)
        if m[at.PEAKS_ON] != 0.0:
            record_peaks(m, age, tau if tau < m[at.END] else m[at.END])
        if m[at.END_KIND] == at.END_OPEN or m[at.END] > tau or m[at.WORK] >= m[at.WORK_LIMIT]:
            return tau
        impacts = m[at.IMPACT_COUNT]
        end_state(m)
        if watching and m[at.SIDE] < 0.0 and m[at.BEGIN_GAP] == 0.0:  # rarely
            m[at.X_REL_MAX] = m[at.LIMIT]
        age = 0.0
        if m[at.STOP_AT_IMPACT] != 0.0 and m[at.IMPACT_COUNT] > impacts:
            m[at.STOPPED] = 1.0
            return 0.0
