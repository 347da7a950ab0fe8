"""``MotorShaker`` as the exporters see it. Standard library only: it travels inside the FMU."""

from ...kernels.motor_shaker import memory as at
from ...kernels.motor_shaker import rates, stepper
from ...runtime.table import Model, SlotRange, Terminal
from ...version import VERSION
from .messages import MESSAGES
from .variables import VARIABLES

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
