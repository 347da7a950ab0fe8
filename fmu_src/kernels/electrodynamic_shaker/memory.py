"""The flat memory: one array of floats holds an instance whole, hidden state included.

The first slots are the FMU's variables, each at its FMI value reference; the hidden state follows.
Saving an instance is copying this array.
"""

from ..numerics.slots import Slots

DEGREE = 18  # of the power series of an interval: the next term is below the last digit
TERMS = DEGREE + 1
WORK_DEGREE = 25  # of those of the energies, which grow twice as fast
WORK_TERMS = WORK_DEGREE + 1
CUBIC = 4  # terms of an input's cubic
slot = Slots()

# -- variables, in the order of the variable table: the slot is the value reference ----------------
TABLE_MASS = slot()
SUSPENSION_STIFFNESS = slot()
SUSPENSION_DAMPING = slot()
FORCE_FACTOR = slot()
COIL_RESISTANCE = slot()
COIL_INDUCTANCE = slot()
CURRENT_CONTROL = slot()
VOLTAGE_LIMIT = slot()
CURRENT_LIMIT = slot()
TRAVEL_LIMIT = slot()
POSITION_START = slot()
VELOCITY_START = slot()
CURRENT_START = slot()
COMMAND = slot()  # the eight inputs follow one another
COMMAND_1 = slot()
COMMAND_2 = slot()
COMMAND_3 = slot()
BOX_FORCE = slot()
BOX_FORCE_1 = slot()
BOX_FORCE_2 = slot()
BOX_FORCE_3 = slot()
BOX_POSITION = slot()
BOX_VELOCITY = slot()
BOX_ACCELERATION = slot()
BOX_JERK = slot()
CURRENT = slot()
VOLTAGE = slot()
COIL_FORCE = slot()
POWER = slot()
ENERGY = slot()
COIL_HEAT = slot()
SUSPENSION_LOSS = slot()
BOX_FORCE_WORK = slot()
STORED_ENERGY = slot()
LIMITED = slot()
EVALUATIONS = slot()
EVALUATION_LIMIT = slot()
TIME = slot()  # communication point reached, s (the independent variable)

# -- constants derived from the parameters ---------------------------------------------------------
VOLTAGE_SPACING = slot()  # length of an interval in which a voltage drives the coil, s,
CURRENT_SPACING = slot()  # and of one in which the current is prescribed; powers of two
COMMAND_LIMIT = slot()  # of the commanded quantity, V or A, and of the other one, A or V;
OTHER_LIMIT = slot()  # 0: none

# -- where the present state began: at an event, or where an input was set -------------------------
inside = Slots()
POSITION = inside()
VELOCITY = inside()
COIL_CURRENT = inside()
INPUT_WORK = inside()  # of the amplifier,
HEAT = inside()  # of the resistance,
LOSS = inside()  # of the suspension's damper,
FORCE_WORK = inside()  # and of the force on the box, since the start
STATES = inside.used
BEGIN = slot(STATES)  # what it began with, before a jump of a commanded current
ORIGIN = slot()  # when, s, as an unevaluated sum of two floats
ORIGIN_LOW = slot()
STATE_INPUTS = slot(2 * CUBIC)  # with which inputs
COMMAND_TIME = slot()  # when the command was set, s: there its cubic begins,
FORCE_TIME = slot()  # and when the force on the box was
FOLLOWED = slot()  # the current was the commanded one, and is so still: no jump
COMMAND_LOWEST = slot()  # 1 where the command was at its limit, so that its slope decides; else 0
OTHER_LOWEST = slot()  # the same of the other limit

# -- the amplifier in the present state ------------------------------------------------------------
CLIPPED = slot()  # the command is clipped: at its upper (1) or lower (-1) limit; 0: it is not
COMMAND_SIDE = slot()  # the side on which the command is, or was found at its limit,
COMMAND_ORDER = slot()  # and how many terms of its distance vanish where the state begins
HELD = slot()  # the same of the other quantity, which is held at its limit
OTHER_SIDE = slot()
OTHER_ORDER = slot()

# -- the present interval --------------------------------------------------------------------------
INTERVAL = slot()  # its number, from 0
STATE = slot(STATES)  # at its beginning

# -- what follows from the above -------------------------------------------------------------------
SPACING = slot()  # its length, s; all series are in parts of it
COMMAND_SERIES = slot(CUBIC)
SOURCE_SERIES = slot(CUBIC)  # of the command, clipped
FORCE_SERIES = slot(TERMS)  # zeros behind its cubic
POSITION_SERIES = slot(TERMS)
VELOCITY_SERIES = slot(TERMS)
CURRENT_SERIES = slot(TERMS)
VOLTAGE_SERIES = slot(TERMS)
WORK_SERIES = slot(WORK_TERMS)  # of the four energies
HEAT_SERIES = slot(WORK_TERMS)
LOSS_SERIES = slot(WORK_TERMS)
FORCE_WORK_SERIES = slot(WORK_TERMS)
EVENT = slot()  # where in the interval its first event is; beyond 1 there is none
EVENT_KIND = slot()
NO_EVENT, COMMAND_EVENT, OTHER_EVENT, TRAVEL_EVENT = 0.0, 1.0, 2.0, 3.0
GUARD = slot(TERMS)  # written and read at once

# -- of the step -----------------------------------------------------------------------------------
# set from outside: an input of the cubic was set, to whatever value; its cubic begins now
COMMAND_SET = slot()
FORCE_SET = slot()
WORK = slot()  # series spent
WORK_LIMIT = slot()  # and allowed in this step
TARGET = slot()  # for messages: the time a step was to reach,
REPORT = slot()  # and the one it did
STOP = slot()  # the exporters' flag to end a step at an event; there are none
OUTPUT_RATES = slot(TIME - BOX_POSITION)  # time derivatives of the outputs, where asked for
SIZE = slot.used

# -- return codes of the entry points --------------------------------------------------------------
OK, UNFINISHED, NOT_FINITE, LIMITED_WORK, TRAVEL, START_TRAVEL, START_CURRENT = 0, 1, 2, 3, 4, 5, 6
INDUCTANCE = 7
