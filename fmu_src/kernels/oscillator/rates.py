"""Time derivatives of the outputs, from the equations (6) themselves.

They belong to the motion reached, with the inputs as they were on the way there: at an impact, or
where an input jumps, to what comes before the jump of an input and after the impact.
"""

from . import memory as at
from .excitation import drive_and_rate_at
from .outputs import drives_of_masses, last_written_point, relative_accelerations, unit_of_length
from .stepper import local_time


def differentiate(m, time):
    """Write the rates of change of the outputs into RATES; ``time`` is not used."""
    tau = local_time(m, m[at.TIME])
    point = last_written_point(m, tau)
    first, second = drives_of_masses(m, point)
    a1, a2 = relative_accelerations(m, point[0], first[0], second[0])
    omega = m[at.OMEGA]
    v1, v2, v_rel = m[at.V1], m[at.V2], m[at.V_REL]
    unit = unit_of_length(m)
    force = m[at.BOX_FORCE]
    contact, box = 0.0, m[at.K1] * v1 + m[at.D1] * a1 + m[at.K2] * v2 + m[at.D2] * a2
    drive = 0.0
    if m[at.UNEQUAL] != 0.0:  # rarely
        _, drive = drive_and_rate_at(m, at.GAP, m[at.PHASE_COSINE], m[at.PHASE_SINE], tau)
    if m[at.WALL] != 0.0 and m[at.MODE] != at.FLIGHT:  # rarely
        box = -m[at.K1] * (m[at.SIDE] * omega * drive)
    if m[at.CONTACT_FORCE] > 0.0:
        contact = m[at.FORCE_V] * a1 + m[at.FORCE_X] * omega * v1
        contact = -m[at.REDUCED_MASS] * omega * (m[at.SIDE] * contact + omega * omega * drive)
    largest = 0.0
    if m[at.X_REL_MAX_ON] != 0.0 and m[at.X_REL] == m[at.X_REL_MAX] and v_rel > 0.0:
        largest = v_rel
    for i in range(at.RATES, at.CUBIC_SET):
        m[i] = 0.0
    to = at.RATES - at.X1
    m[to + at.X1], m[to + at.X2], m[to + at.X_REL] = v1, v2, v_rel
    m[to + at.V1], m[to + at.V2], m[to + at.V_REL] = a1, a2, a2 - a1
    m[to + at.XI1] = v1 / unit if unit != 0.0 else 0.0
    m[to + at.XI2] = v2 / unit if unit != 0.0 else 0.0
    m[to + at.XI_REL] = v_rel / unit if unit != 0.0 else 0.0
    m[to + at.BOX_FORCE] = box
    m[to + at.BOX_IMPULSE] = force
    m[to + at.BOX_IMPULSE_MOMENT] = m[at.STEP] * force
    m[to + at.CONTACT_FORCE] = contact
    m[to + at.PHASE] = m[at.ETA] * omega
    m[to + at.X_REL_MAX] = largest
    return at.OK
