"""``TwoMassImpactOscillator`` as the exporters see it. Standard library only: it travels inside the
FMU.
"""

from ...kernels.oscillator import memory as at
from ...kernels.oscillator import stepper
from ...runtime.table import Array, Clock, Model
from .variables import VARIABLES


def resonance(mass, damping):
    """Text for a driven oscillator without damping."""
    return (
        f"box_frequency = {{{at.BOX_FREQUENCY}}} rad/s is the natural frequency of {mass} ({{{at.REPORT}}} rad/s), which has no damping: "
        f"allowed is {damping} > 0 or a box_frequency that differs by more than 1e-6 of it"
    )


MESSAGES = {
    at.UNFINISHED: f"the step to time = {{{at.TARGET}}} s cannot finish: {{{at.WORK}}} evaluations (allowed {{{at.WORK_LIMIT}}}) reached only "
    f"{{{at.REPORT}}} s, in {{{at.MODE}:flight|permanent contact|bonded motion}} after {{{at.IMPACT_COUNT}}} impacts; "
    f"e = {{{at.E}}} and gamma = {{{at.GAMMA}}} decide how many impacts chattering has",
    at.RESONANCE_1: resonance("mass 1", "d1"),
    at.RESONANCE_2: resonance("mass 2", "d2"),
    at.RESONANCE_3: resonance("both masses together", "d1 + d2"),
    at.NOT_FINITE: f"the motion leaves the range of floating-point numbers in the step to time = {{{at.TARGET}}} s: "
    f"box_amplitude = {{{at.BOX_AMPLITUDE}}} m, box_frequency = {{{at.BOX_FREQUENCY}}} rad/s, "
    f"box_acceleration = {{{at.BOX_ACCELERATION}}} m/s2; allowed is what keeps it finite",
    at.START_OVERLAP: f"x2_start = {{{at.X2_START}}} m: allowed is x2_start >= x1_start = {{{at.X1_START}}} m",
    at.START_BONDED: f"bonded = true with x2_start = {{{at.X2_START}}} m, v2_start = {{{at.V2_START}}} m/s: "
    f"allowed is x2_start = x1_start = {{{at.X1_START}}} m and v2_start = v1_start = {{{at.V1_START}}} m/s",
}
MODEL = Model(
    name="TwoMassImpactOscillator",
    description="Two oscillators in a shaken box that impact, stick and part: a delaminated beam, exact between and through impacts",
    version="0.1.0",
    author="The vibroimpact developers",
    license="MIT",
    variables=VARIABLES,
    memory_size=at.SIZE,
    written_only=(at.X1_SAMPLE, 4 * at.SAMPLES),
    time_slot=at.TIME,
    stop_slot=at.STOP_AT_IMPACT,
    initialize=stepper.initialize,
    advance=stepper.advance,
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
    clock=Clock("impact", "Ticks at each impact", "impact_count"),
)
