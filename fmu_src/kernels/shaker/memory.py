"""The flat memory: one array of floats holds an instance whole, hidden state included.

The first slots are the FMU's variables, each at its FMI value reference; the hidden state follows. Saving an instance is copying this array.
"""

# -- variables: the slot is the value reference -----------------------------------------------------------------------
BOX_MASS, BOX_STIFFNESS, BOX_DAMPING, UNBALANCE_MASS, UNBALANCE_RADIUS, ROTOR_INERTIA = 0, 1, 2, 3, 4, 5
MOTOR_CONSTANT, ARMATURE_RESISTANCE, ARMATURE_INDUCTANCE = 6, 7, 8
ANGLE_START, SPEED_START, POSITION_START, VELOCITY_START, CURRENT_START = 9, 10, 11, 12, 13
VOLTAGE, BOX_FORCE, BOX_FORCE_1, BOX_FORCE_2, BOX_FORCE_3 = 14, 15, 16, 17, 18
BOX_POSITION, BOX_VELOCITY, BOX_ACCELERATION, BOX_JERK, ANGLE, SPEED = 19, 20, 21, 22, 23, 24
MOTOR_CURRENT, MOTOR_TORQUE, MOTOR_POWER, MOTOR_ENERGY = 25, 26, 27, 28
BOX_DAMPER_ENERGY, BOX_FORCE_WORK, STORED_ENERGY = 29, 30, 31
TIME = 32  # communication point reached, s (the independent variable)

# -- what a step writes and never reads from an earlier one -----------------------------------------------------------
STATES = 8  # position, velocity, angle since the sub-step began, speed, current, then the three energies
Y, V, PHI, W, CURRENT, E_MOTOR, E_DAMPER, E_FORCE = 0, 1, 2, 3, 4, 5, 6, 7
CONTROLLED = 5  # of them decide the length of the sub-steps
STAGES = 12
RATES = 33  # right-hand side at the stages, STATES each
STAGE = RATES + STAGES * STATES  # the states at a stage
NEXT = STAGE + STATES  # the states at the sub-step's end

# -- hidden state -----------------------------------------------------------------------------------------------------
STATE = NEXT + STATES  # at the communication point (its angle is 0: it counts from the sub-step's beginning)
TURN = STATE + STATES  # the angle in turns, [0, 1)
ANGLE_LOW = TURN + 1  # what the sum ANGLE has lost to rounding
HINT = ANGLE_LOW + 1  # length of sub-step that the tolerance allows, s; 0: not known yet
UNBALANCE = HINT + 1  # S, product of mass and radius
WORK, WORK_LIMIT = UNBALANCE + 1, UNBALANCE + 2  # evaluations spent and allowed in this step
TARGET, REPORT = UNBALANCE + 3, UNBALANCE + 4  # for messages: the time a step was to reach, and the one it did
STOP = UNBALANCE + 5  # the exporters' flag to end a step at an event; there are none
SIZE = UNBALANCE + 6

# -- return codes of the entry points ---------------------------------------------------------------------------------
OK, UNFINISHED, NOT_FINITE, INERTIA = 0, 1, 2, 3
