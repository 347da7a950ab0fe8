"""``ElectrodynamicShaker`` as the exporters see it. Standard library only: it travels inside the
FMU.
"""

from ...kernels.electrodynamic_shaker import memory as at
from ...kernels.electrodynamic_shaker import rates, stepper
from ...runtime.table import Model, SlotRange, Terminal, messages_with_slot_numbers
from ...version import VERSION
from .variables import VARIABLES

COUNTABLE = 2.0**53  # intervals: up to there each has its own number
MESSAGES = messages_with_slot_numbers(  # for the return codes of the kernel
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
MODEL = Model(
    name="ElectrodynamicShaker",
    description="A coil in a magnet's field, with an amplifier whose voltage and current are "
    "limited, shakes a table on its suspension",
    version=VERSION,
    author="The vibroimpact developers",
    license="MIT",
    variables=VARIABLES,
    memory_size=at.SIZE,
    written_only=(at.GUARD, at.TERMS),
    limited=at.LIMITED_WORK,
    time_slot=at.TIME,
    stop_slot=at.STOP,
    set_slot=at.COMMAND_SET,
    initialize=stepper.initialize,
    advance=stepper.advance,
    differentiate=rates.differentiate,
    restore=stepper.restore,
    ranges=(
        SlotRange(at.COMMAND_LOWEST, 2, 0.0, 1.0),  # and OTHER_LOWEST
        SlotRange(at.COMMAND_ORDER, 1, 0.0, at.TERMS),
        SlotRange(at.OTHER_ORDER, 1, 0.0, at.TERMS),
        SlotRange(at.INTERVAL, 1, 0.0, COUNTABLE),
        SlotRange(at.FORCE_SERIES + at.CUBIC, at.TERMS - at.CUBIC, 0.0, 0.0),  # never written
        SlotRange(at.GUARD, at.TERMS),  # written before they are read
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
            "What is fastened to the table: its force, and the table's acceleration",
            {"force": "box_force", "acceleration": "box_acceleration", "jerk": "box_jerk"},
        ),
    ),
)
