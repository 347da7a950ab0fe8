"""The messages for the return codes of the kernel. Standard library only: it travels inside the
FMU.
"""

from ...kernels.oscillator import memory as at
from ...runtime.table import messages_with_slot_numbers

MESSAGES = messages_with_slot_numbers(
    {
        at.UNFINISHED: "the step to time = {TARGET} s cannot finish: {WORK:0} evaluations (at most "
        "{WORK_LIMIT:0}) reached only {REPORT} s, in "
        "{MODE:flight|permanent contact|bonded motion} after {IMPACT_COUNT} impacts; "
        "e = {E} and gamma = {GAMMA} decide how many impacts chattering has",
        at.LIMITED: "the step to time = {TARGET} s is discarded: evaluation_limit = "
        "{EVALUATION_LIMIT}, and {WORK:0} evaluations reached only {REPORT} s, in "
        "{MODE:flight|permanent contact|bonded motion} after {IMPACT_COUNT} impacts; "
        "expected a shorter step, or a larger limit",
        at.BEYOND: "the step to time = {TARGET} s is too long: from {REPORT} s the number of "
        "oscillations leaves the range of floating-point numbers that count by one, with "
        "k1 = {K1} N/m, m1 = {M1} kg, k2 = {K2} N/m, m2 = {M2} kg and "
        "box_frequency = {BOX_FREQUENCY} rad/s; expected at most some 1e15 radians",
        at.TOO_FAST: "box_frequency = {BOX_FREQUENCY} rad/s, d1 = {D1} N.s/m, d2 = {D2} N.s/m, "
        "k2 = {K2} N/m and m2 = {M2} kg: expected frequencies and d/m of at most 1e36 sqrt(k1/m1), "
        "with k1 = {K1} N/m and m1 = {M1} kg",
        at.NOT_FINITE: "the motion leaves the range of floating-point numbers in the step to "
        "time = {TARGET} s: box_amplitude = {BOX_AMPLITUDE} m, "
        "box_frequency = {BOX_FREQUENCY} rad/s, box_acceleration = {BOX_ACCELERATION} m/s2, "
        "force1 = {FORCE1} N, force2 = {FORCE2} N; "
        "expected values that keep it finite",
        at.START_OVERLAP: "x2_start = {X2_START} m: expected x2_start >= x1_start = {X1_START} m",
        at.START_BEYOND_CLEARANCE: "x2_start = {X2_START} m: expected x2_start >= x1_start - "
        "clearance = {REPORT} m, with x1_start = {X1_START} m and clearance = {CLEARANCE} m",
        at.START_WALL: "wall = true with x2_start = {X2_START} m, v2_start = {V2_START} m/s, "
        "bonded = {BONDED}: expected x2_start = 0, v2_start = 0 and bonded = false",
        at.START_BEYOND_STROKE: "stroke = {STROKE} m: expected at least clearance = {CLEARANCE} m "
        "and x_rel = {REPORT} m at the start, with x1_start = {X1_START} m and "
        "x2_start = {X2_START} m; or 0 for no limit",
        at.TOO_NARROW: "stroke = {STROKE} m: expected a play that displacements do not exceed more "
        "than 1e8 times, with box_amplitude = {BOX_AMPLITUDE} m in the step to time = {TARGET} s",
        at.START_BONDED: "bonded = true with x2_start = {X2_START} m, v2_start = {V2_START} m/s: "
        "expected x2_start = x1_start = {X1_START} m and "
        "v2_start = v1_start = {V1_START} m/s",
    },
    at,
)
