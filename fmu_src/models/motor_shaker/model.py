"""``MotorShaker`` as the exporters see it. Standard library only: it travels inside the FMU."""

from ...kernels.shaker import memory as at
from ...kernels.shaker import stepper
from ...runtime.table import Model
from .variables import VARIABLES

MESSAGES = {
    at.UNFINISHED: f"the step to time = {{{at.TARGET}}} s cannot finish: {{{at.WORK}}} evaluations (allowed {{{at.WORK_LIMIT}}}) reached only "
    f"{{{at.REPORT}}} s; a time constant is too short for such a step: armature_inductance = {{{at.ARMATURE_INDUCTANCE}}} H over "
    f"armature_resistance = {{{at.ARMATURE_RESISTANCE}}} Ohm (allowed is 0 H, or more), rotor_inertia = {{{at.ROTOR_INERTIA}}} kg.m2 with "
    f"motor_constant = {{{at.MOTOR_CONSTANT}}} N.m/A, or box_damping = {{{at.BOX_DAMPING}}} N.s/m with box_mass = {{{at.BOX_MASS}}} kg",
    at.NOT_FINITE: f"the motion leaves the range of floating-point numbers in the step to time = {{{at.TARGET}}} s: voltage = {{{at.VOLTAGE}}} V, "
    f"box_force = {{{at.BOX_FORCE}}} N, speed = {{{at.SPEED}}} rad/s; allowed is what keeps it finite",
    at.INERTIA: f"rotor_inertia = {{{at.ROTOR_INERTIA}}} kg.m2 with unbalance_mass = {{{at.UNBALANCE_MASS}}} kg, unbalance_radius = "
    f"{{{at.UNBALANCE_RADIUS}}} m and box_mass = {{{at.BOX_MASS}}} kg: allowed is rotor_inertia >= {{{at.REPORT}}} kg.m2, "
    "a little more than (unbalance_mass unbalance_radius)^2 / box_mass",
}
MODEL = Model(
    name="MotorShaker",
    description="A motor of limited power with an unbalance shakes a box on a spring and a damper: the weak drive of the Sommerfeld effect",
    version="0.1.0",
    author="The vibroimpact developers",
    license="MIT",
    variables=VARIABLES,
    memory_size=at.SIZE,
    written_only=(at.RATES, at.STATE - at.RATES),
    time_slot=at.TIME,
    stop_slot=at.STOP,
    initialize=stepper.initialize,
    advance=stepper.advance,
    refresh=stepper.refresh,
    messages=MESSAGES,
    stop_time=10.0,
    step_size=0.001,
)
