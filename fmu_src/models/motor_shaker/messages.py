"""The messages for the return codes of the kernel. Standard library only: it travels inside the
FMU.
"""

from ...kernels.motor_shaker import memory as at
from ...runtime.table import messages_with_slot_numbers

MESSAGES = messages_with_slot_numbers(
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
