"""``ElectrodynamicShaker`` as the exporters see it. Standard library only: it travels inside the
FMU.
"""

from ...kernels.electrodynamic_shaker import memory as at
from ...kernels.electrodynamic_shaker import rates, stepper
from ...runtime.table import Model, SlotRange, Terminal
from ...version import VERSION
from .messages import MESSAGES
from .variables import VARIABLES

COUNTABLE = 2.0**53  # intervals: up to there each has its own number
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
