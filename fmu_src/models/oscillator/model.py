"""``TwoMassImpactOscillator`` as the exporters see it.

Standard library only: it travels inside the FMU.
"""

from math import inf

from ...kernels.oscillator import memory as at
from ...kernels.oscillator import rates, stepper
from ...kernels.oscillator.nodes import FURTHEST
from ...runtime.table import Array, Clock, Model, SlotRange, Terminal
from ...version import VERSION
from .messages import MESSAGES
from .variables import VARIABLES

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
