"""``MotorShaker`` as the exporters see it. Standard library only: it travels inside the FMU."""

from ...kernels.motor_shaker import memory as at
from ...kernels.motor_shaker import rates, stepper
from ...runtime.table import Model, SlotRange, Terminal, messages_with_slot_numbers
from ...version import VERSION
from .variables import VARIABLES

MESSAGES = messages_with_slot_numbers(  # for the return codes of the kernel
    {
        at.UNFINISHED: "the step to time = {TARGET} s cannot finish: it needs at least {WORK:0} "
        "evaluations (at most {WORK_LIMIT:0}), and reached {REPORT} s; a time constant is too "
        "short for such a step: armature_inductance = {ARMATURE_INDUCTANCE} H over "
        "armature_resistance = {ARMATURE_RESISTANCE} Ohm (expected 0 H, or more), "
        "rotor_inertia = {ROTOR_INERTIA} kg.m2 with motor_constant = {MOTOR_CONSTANT} N.m/A, "
        "or box_damping = {BOX_DAMPING} N.s/m with box_mass = {BOX_MASS} kg",
        at.LIMITED: "the step to time = {TARGET} s is discarded: evaluation_limit = "
        "{EVALUATION_LIMIT}, it needs at least {WORK:0} evaluations, and reached {REPORT} s; "
        "expected a shorter step, or a larger limit",
        at.NOT_FINITE: "the motion leaves the range of floating-point numbers in the step to "
        "time = {TARGET} s: voltage = {VOLTAGE} V, box_force = {BOX_FORCE} N, "
        "speed = {SPEED} rad/s; expected values that keep it finite",
        at.INERTIA: "rotor_inertia = {ROTOR_INERTIA} kg.m2 with "
        "unbalance_mass = {UNBALANCE_MASS} kg, unbalance_radius = {UNBALANCE_RADIUS} m and "
        "box_mass = {BOX_MASS} kg: expected rotor_inertia >= {REPORT} kg.m2, "
        "a little more than (unbalance_mass unbalance_radius)^2 / box_mass",
    },
    at,
)
MODEL = Model(
    name="MotorShaker",
    description="A motor of limited power with an unbalance shakes a box on a spring and a damper: "
    "the weak drive of the Sommerfeld effect",
    version=VERSION,
    author="The vibroimpact developers",
    license="MIT",
    variables=VARIABLES,
    memory_size=at.SIZE,
    written_only=(at.RATES, at.STATE - at.RATES),
    limited=at.LIMITED,
    time_slot=at.TIME,
    stop_slot=at.STOP,
    set_slot=at.FORCE_SET,
    initialize=stepper.initialize,
    advance=stepper.advance,
    differentiate=rates.differentiate,
    restore=stepper.restore,
    ranges=(
        SlotRange(at.RATES, at.STATE - at.RATES),  # written before they are read
        SlotRange(at.TURN, 1, 0.0, 1.0),
        SlotRange(at.OUTPUT_RATES, at.SIZE - at.OUTPUT_RATES),
    ),
    rates={at.BOX_POSITION: at.OUTPUT_RATES},
    refresh=stepper.refresh,
    messages=MESSAGES,
    stop_time=10.0,
    step_size=0.001,
    terminals=(
        Terminal(
            "box",
            "What is fastened to the box: its force, and the box's acceleration",
            {"force": "box_force", "acceleration": "box_acceleration", "jerk": "box_jerk"},
        ),
    ),
)
