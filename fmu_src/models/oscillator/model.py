"""``TwoMassImpactOscillator`` as the exporters see it.

Standard library only: it travels inside the FMU.
"""

from math import inf

from ...kernels.oscillator import memory as at
from ...kernels.oscillator import rates, stepper
from ...kernels.oscillator.nodes import FURTHEST
from ...runtime.table import Array, Clock, Model, SlotRange, Terminal, messages_with_slot_numbers
from ...version import VERSION
from .variables import VARIABLES

MESSAGES = messages_with_slot_numbers(  # for the return codes of the kernel
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
MODEL = Model(
    name="TwoMassImpactOscillator",
    description="Two oscillators in a shaken box that impact, stick and part: a delaminated beam, "
    "exact between and through impacts",
    version=VERSION,
    author="The vibroimpact developers",
    license="MIT",
    variables=VARIABLES,
    memory_size=at.SIZE,
    written_only=(at.X1_SAMPLE, 4 * at.SAMPLES),
    limited=at.LIMITED,
    time_slot=at.TIME,
    stop_slot=at.STOP_AT_IMPACT,
    set_slot=at.CUBIC_SET,
    initialize=stepper.initialize,
    advance=stepper.advance,
    coast=stepper.coast,
    differentiate=rates.differentiate,
    restore=stepper.restore,
    ranges=(
        SlotRange(at.OMEGA, at.SEGMENT_INPUTS - at.OMEGA),  # recomputed, as the next ones
        SlotRange(at.SPACING, at.NODE_SINE + 1 - at.SPACING),
        SlotRange(at.EVENT_DRIVE, 2 * at.EVENT_ORDERS),
        *(
            SlotRange(at.SEGMENT_INPUTS + i, 1, v.minimum or 0.0, v.maximum or 0.0)
            for i, v in enumerate(
                VARIABLES[at.BOX_AMPLITUDE : at.BOX_CRACKLE + 1]
                + VARIABLES[at.FORCE1_AMPLITUDE : at.FORCE2_3 + 1]
            )
        ),
        SlotRange(at.MODE, 1, at.FLIGHT, at.GLUED),
        SlotRange(at.SIDE, 1, -1.0, 1.0),
        SlotRange(at.TURN, 1, 0.0, 1.0),
        SlotRange(at.CLEAR, 2, 0.0, inf),  # and END
        SlotRange(at.END_KIND, 1, at.END_OPEN, at.END_OTHER),
        SlotRange(at.NODE, 1, 0.0, FURTHEST),
        SlotRange(at.POINT, 6),  # may have overflowed, as the next ones, where nothing reads them
        SlotRange(at.REMAINDER, 1, 0.0, inf),
        SlotRange(at.SERIES, 1, 0.0, at.SERIES_LONGEST),
        SlotRange(at.SERIES_X, at.STEP - at.SERIES_X),
        SlotRange(at.RATES, at.CUBIC_SET - at.RATES),
    ),
    rates={at.X1: at.RATES, at.EVALUATIONS: at.ADDED_RATES},
    messages=MESSAGES,
    stop_time=157.0,
    step_size=0.1,
    arrays=(
        Array("positions", "Displacements x1, x2 relative to the box", "x1", 2),
        Array("velocities", "Velocities v1, v2 relative to the box", "v1", 2),
        Array(
            "x1_sample",
            "x1 at equal parts of the last step, as many as sample_count",
            "x1_sample[1]",
            at.SAMPLES,
        ),
        Array("x2_sample", "x2 at equal parts of the last step", "x2_sample[1]", at.SAMPLES),
        Array("v1_sample", "v1 at equal parts of the last step", "v1_sample[1]", at.SAMPLES),
        Array("v2_sample", "v2 at equal parts of the last step", "v2_sample[1]", at.SAMPLES),
    ),
    terminals=(
        Terminal(
            "box",
            "The structure's fastening to the box: its force, and the box's acceleration",
            {
                "force": "box_force",
                "impulse": "box_impulse",
                "impulse_moment": "box_impulse_moment",
                "acceleration": "box_acceleration",
                "jerk": "box_jerk",
                "snap": "box_snap",
                "crackle": "box_crackle",
            },
        ),
    ),
    series_count="sample_count",
    excitation=("box_amplitude", "box_frequency"),
    clock=Clock("impact", "Ticks at each impact", "impact_count"),
)
