"""The messages for the return codes of the kernel. Standard library only: it travels inside the
FMU.
"""

from ...kernels.electrodynamic_shaker import memory as at
from ...runtime.table import messages_with_slot_numbers

MESSAGES = messages_with_slot_numbers(
    {
        at.UNFINISHED: "the step to time = {TARGET} s cannot finish: it needs at least {WORK:0} "
        "power series, and reached {REPORT} s; a time constant is too short for such a step: "
        "coil_inductance = {COIL_INDUCTANCE} H over coil_resistance = {COIL_RESISTANCE} Ohm "
        "(expected 0 H, or more), or table_mass = {TABLE_MASS} kg with "
        "suspension_stiffness = {SUSPENSION_STIFFNESS} N/m, "
        "suspension_damping = {SUSPENSION_DAMPING} N.s/m and force_factor = {FORCE_FACTOR} N/A",
        at.LIMITED_WORK: "the step to time = {TARGET} s is discarded: evaluation_limit = "
        "{EVALUATION_LIMIT}, it needs at least {WORK:0} evaluations, and reached {REPORT} s; "
        "expected a shorter step, or a larger limit",
        at.NOT_FINITE: "the motion leaves the range of floating-point numbers in the step to "
        "time = {TARGET} s: command = {COMMAND}, box_force = {BOX_FORCE} N; expected values that "
        "keep it finite",
        at.TRAVEL: "box_position = {BOX_POSITION} m at time = {REPORT} s, in the step to time = "
        "{TARGET} s: the table reaches its stop; expected motion within travel_limit = "
        "{TRAVEL_LIMIT} m",
        at.START_TRAVEL: "position_start = {POSITION_START} m: expected a position within "
        "travel_limit = {TRAVEL_LIMIT} m",
        at.START_CURRENT: "current_start = {CURRENT_START} A: expected a current within "
        "current_limit = {CURRENT_LIMIT} A",
        at.INDUCTANCE: "coil_inductance = {COIL_INDUCTANCE} H with coil_resistance = "
        "{COIL_RESISTANCE} Ohm and force_factor = {FORCE_FACTOR} N/A: expected 0 H, or time "
        "constants above {REPORT} s",
    },
    at,
)
