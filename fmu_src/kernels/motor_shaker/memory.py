"""The flat memory: one array of floats holds an instance whole, hidden state included.

The first slots are the FMU's variables, each at its FMI value reference; the hidden state follows.
Saving an instance is copying this array.
"""

from ..numerics.slots import Slots

slot = Slots()

# -- variables, in the order of the variable table: the slot is the value reference ----------------
BOX_MASS = slot()
BOX_STIFFNESS = slot()
BOX_DAMPING = slot()
UNBALANCE_MASS = slot()
UNBALANCE_RADIUS = slot()
ROTOR_INERTIA = slot()
MOTOR_CONSTANT = slot()
ARMATURE_RESISTANCE = slot()
ARMATURE_INDUCTANCE = slot()
ANGLE_START = slot()
SPEED_START = slot()
POSITION_START = slot()
VELOCITY_START = slot()
CURRENT_START = slot()
VOLTAGE = slot()
BOX_FORCE = slot()
BOX_FORCE_1 = slot()
BOX_FORCE_2 = slot()
BOX_FORCE_3 = slot()
BOX_POSITION = slot()
BOX_VELOCITY = slot()
BOX_ACCELERATION = slot()
BOX_JERK = slot()
ANGLE = slot()
SPEED = slot()
MOTOR_CURRENT = slot()
MOTOR_TORQUE = slot()
MOTOR_POWER = slot()
MOTOR_ENERGY = slot()
BOX_DAMPER_ENERGY = slot()
BOX_FORCE_WORK = slot()
STORED_ENERGY = slot()
EVALUATIONS = slot()
EVALUATION_LIMIT = slot()
TIME = slot()  # communication point reached, s (the independent variable)

# -- what is integrated, in this order -------------------------------------------------------------
inside = Slots()
POSITION = inside()
VELOCITY = inside()
ROTATION = inside()  # angle since the sub-step began
ROTATION_SPEED = inside()
CURRENT = inside()
CONTROLLED = inside.used  # the first ones, which decide the length of the sub-steps
MOTOR_WORK = inside()
DAMPER_LOSS = inside()
FORCE_WORK = inside()
STATES = inside.used
STAGES = 12  # of the formula

# -- what a step writes and never reads from an earlier one ----------------------------------------
RATES = slot(STAGES * STATES)  # right-hand side at the stages
STAGE = slot(STATES)  # the states at a stage
NEXT = slot(STATES)  # the states at the sub-step's end

# -- hidden state ----------------------------------------------------------------------------------
STATE = slot(STATES)  # at the communication point (its ROTATION is 0)
TURN = slot()  # the angle in turns, [0, 1)
ANGLE_LOW = slot()  # what the sum ANGLE has lost to rounding
HINT = slot()  # length of sub-step that the tolerance allows, s; 0: not known yet
FORCE_TIME = slot()  # when the force on the box was set, s: there its cubic begins
# set from outside: an input of the force was set, to whatever value; its cubic begins now
FORCE_SET = slot()
UNBALANCE = slot()  # S, product of mass and radius
WORK = slot()  # evaluations spent
WORK_LIMIT = slot()  # and allowed in this step
TARGET = slot()  # for messages: the time a step was to reach,
REPORT = slot()  # and the one it did
STOP = slot()  # the exporters' flag to end a step at an event; there are none
OUTPUT_RATES = slot(TIME - BOX_POSITION)  # time derivatives of the outputs, where asked for
SIZE = slot.used

# -- return codes of the entry points --------------------------------------------------------------
OK, UNFINISHED, NOT_FINITE, INERTIA, LIMITED = 0, 1, 2, 3, 4
