"""``TwoMassImpactOscillator`` as the exporters see it. Standard library only: it travels inside the FMU."""

from ..export.table import Model
from ..vibroimpact import memory as at
from ..vibroimpact import stepper
from .variables import VARIABLES

MODES = {at.FLIGHT: "flight", at.CONTACT: "permanent contact", at.GLUED: "bonded motion"}


def resonance(m, mass, damping, branch):
    """Text for a driven oscillator without damping."""
    natural = m[at.OMEGA] * m[branch + at.OMEGA_SQUARED] ** 0.5
    return (
        f"box_frequency = {m[at.BOX_FREQUENCY]!r} rad/s is the natural frequency of {mass} ({natural!r} rad/s), which has no damping: "
        f"allowed is {damping} > 0 or a box_frequency that differs by more than 1e-6 of it"
    )


def explain(m, code, time):
    """What a return code of the kernel says, as one line that names variable, value and allowed range."""
    if code == at.UNFINISHED:
        return (
            f"the step to time = {time!r} s cannot finish: {int(m[at.WORK])} evaluations (allowed {int(m[at.WORK_LIMIT])}) reached only "
            f"{(m[at.ORIGIN] / m[at.OMEGA] + m[at.START_TIME])!r} s, in {MODES[m[at.MODE]]} after {int(m[at.IMPACT_COUNT])} impacts; "
            f"e = {m[at.E]!r} and gamma = {m[at.GAMMA]!r} decide how many impacts chattering has"
        )
    if code == at.RESONANCE_1:
        return resonance(m, "mass 1", "d1", at.BRANCH_1)
    if code == at.RESONANCE_2:
        return resonance(m, "mass 2", "d2", at.BRANCH_2)
    if code == at.RESONANCE_3:
        return resonance(m, "both masses together", "d1 + d2", at.BRANCH_3)
    if code == at.START_OVERLAP:
        return f"x2_start = {m[at.X2_START]!r} m: allowed is x2_start >= x1_start = {m[at.X1_START]!r} m"
    if code == at.START_BONDED:
        return (
            f"bonded = true with x2_start = {m[at.X2_START]!r} m, v2_start = {m[at.V2_START]!r} m/s: "
            f"allowed is x2_start = x1_start = {m[at.X1_START]!r} m and v2_start = v1_start = {m[at.V1_START]!r} m/s"
        )
    return (
        f"the motion leaves the range of floating-point numbers in the step to time = {time!r} s: box_amplitude = {m[at.BOX_AMPLITUDE]!r} m, "
        f"box_frequency = {m[at.BOX_FREQUENCY]!r} rad/s, box_acceleration = {m[at.BOX_ACCELERATION]!r} m/s2; allowed is what keeps it finite"
    )


MODEL = Model(
    name="TwoMassImpactOscillator",
    description="Two oscillators in a shaken box that impact, stick and part: a delaminated beam, exact between and through impacts",
    version="0.1.0",
    author="The vibroimpact developers",
    license="MIT",
    variables=VARIABLES,
    memory_size=at.SIZE,
    time_slot=at.TIME,
    initialize=stepper.initialize,
    advance=stepper.advance,
    explain=explain,
    stop_time=157.0,
    step_size=0.1,
)
