"""The flat memory: one array of floats holds an instance whole, hidden state included.

The first slots are the FMU's variables, each at its FMI value reference; the hidden state follows.
Saving an instance is copying this array. Flags and counts are floats too (exact to 2**53). It is
called memory, because a state is one of the paper's (1): flight or permanent contact.
"""

from ..numerics.slots import Slots

SAMPLES = 200  # states that a step can keep, equally spaced, the last one at its end
SERIES_LONGEST = 12  # order of the longest Taylor series
slot = Slots()

# -- variables, in the order of the variable table: the slot is the value reference ----------------
M1 = slot()
M2 = slot()
K1 = slot()
K2 = slot()
D1 = slot()
D2 = slot()
E = slot()  # the paper's letter, and the variable's name
GAMMA = slot()
BONDED = slot()
X1_START = slot()
X2_START = slot()
V1_START = slot()
V2_START = slot()
PHASE_START = slot()
X_REL_MAX_ON = slot()
BOX_AMPLITUDE = slot()  # the six inputs follow one another
BOX_FREQUENCY = slot()
BOX_ACCELERATION = slot()
BOX_JERK = slot()
BOX_SNAP = slot()
BOX_CRACKLE = slot()
X1 = slot()
X2 = slot()
V1 = slot()
V2 = slot()
X_REL = slot()
V_REL = slot()
XI1 = slot()
XI2 = slot()
XI_REL = slot()
BOX_FORCE = slot()
BOX_IMPULSE = slot()
BOX_IMPULSE_MOMENT = slot()
CONTACT_FORCE = slot()
IN_CONTACT = slot()
PHASE = slot()
IMPACT_COUNT = slot()
IMPACT_TIME = slot()
IMPACT_VELOCITY = slot()
IMPACT_ENERGY = slot()
X_REL_MAX = slot()
CONTACT_COUNT = slot()
SAMPLE_COUNT = slot()
X1_SAMPLE = slot(SAMPLES)
X2_SAMPLE = slot(SAMPLES)
V1_SAMPLE = slot(SAMPLES)
V2_SAMPLE = slot(SAMPLES)
EVALUATIONS = slot()
EVALUATION_LIMIT = slot()
CLEARANCE = slot()
E_SLOPE = slot()
STICKING_ENERGY = slot()
PEAKS_ON = slot()
X1_MAX = slot()  # the four peaks follow one another
X2_MAX = slot()
A1_MAX = slot()
A2_MAX = slot()
FORCE1_AMPLITUDE = slot()  # the ten inputs that are forces follow one another
FORCE2_AMPLITUDE = slot()
FORCE1 = slot()
FORCE1_1 = slot()
FORCE1_2 = slot()
FORCE1_3 = slot()
FORCE2 = slot()
FORCE2_1 = slot()
FORCE2_2 = slot()
FORCE2_3 = slot()
WALL = slot()
STROKE = slot()
IMPACT_SIDE = slot()
CONTACT_SIDE = slot()
TIME = slot()  # communication point reached, s (the independent variable)

# -- constants derived from the parameters ---------------------------------------------------------
OMEGA = slot()  # (2)
MU = slot()
SHARE = slot()  # 1/(1 + mu), the part of mass 1 in both; 0 for a wall
REDUCED_MASS = slot()  # kg
FORCE_V = slot()  # 2 (D1 - D2), and
FORCE_X = slot()  # omega1^2 - omega2^2: the coefficients of (18)
FASTEST = slot()  # largest omega_i
STICKING_TIME = slot()  # gamma (1 - e)/FASTEST: where masses stick, the next flight is shorter
LIMIT = slot()  # of the gap, m: the stroke, or infinity
GAP_OFFSET = slot()  # the gap between unloaded springs, m: the clearance; 0 where bonded
REST_1 = slot()  # where both masses rest while they are held together, from unloaded springs, m
REST_2 = slot()
PRELOAD = slot()  # f of (18) there, m: < 0 presses the masses together

inside = Slots()  # one linear oscillator: 1, 2, or 3, both masses together
DAMPING = inside()  # D_i (8)
OMEGA_SQUARED = inside()  # omega_i^2 (7)
NU_SQUARED = inside()  # nu_i^2 = omega_i^2 - D_i^2 (11)
NU = inside()  # sqrt|nu_i^2|
NU_TURNS = inside()  # the same in turns
ENVELOPE_RATE = inside()  # r and s of |e^{-D t} cos| <= e^{-r t}, |e^{-D t} sin/nu| <= s e^{-r t}
ENVELOPE_SINE = inside()
SIXTH = inside(4)  # sixth derivatives of a free part's displacement and velocity, by both
STEP_ON = inside(4)  # both one spacing of nodes later, by displacement and by velocity
DRIVE = inside(2)  # its harmonic forcing, by cosine and by sine
SHARES = inside(3)  # of the box's motion in its forcing, and of a force on mass 1 and on 2, m/N
DRIVE_SIZE = inside.used - DRIVE
DRIVEN = inside()  # 1 where its amplitude grows with time, at a resonance; else 0
PUSH = inside(2)  # the growing amplitude's first rate of change, by cosine and by sine
DRIFT = inside()  # nu_i - eta
OWN_RATE = inside()  # at least every rate of change of its motion
STEP_GROWTH = inside(4)  # the amplitude one spacing later, and its rate of change
GROWTH_SIZE = inside.used - DRIVEN
OSCILLATOR_1 = slot(inside.used)
OSCILLATOR_2 = slot(inside.used)
OSCILLATOR_3 = slot(inside.used)
BOX = slot(DRIVE_SIZE) - DRIVE  # what drives the box, in the same places,
GAP = slot(DRIVE_SIZE) - DRIVE  # and what drives the gap: oscillator 2 less oscillator 1

# -- excitation of the present segment (until an input changes) ------------------------------------
ETA = slot()  # (2)
ETA_TURNS = slot()  # eta/2pi
FORCING = slot()  # a eta^2
SHAKEN = slot()  # something is driven by a harmonic
UNEQUAL = slot()  # the oscillators are driven in different ways: forces act, a wall, a stroke
SECULAR = slot()  # some oscillator's amplitude grows with time
HARMONIC_1 = slot(2)  # a eta^2 (a_i, b_i) of (11), cosine and sine; 0 where the amplitude grows
HARMONIC_2 = slot(2)
HARMONIC_3 = slot(2)
SEGMENT_INPUTS = slot(16)  # the inputs the segment was made of: six of the box, ten forces
CUBIC = slot(6)  # of the box: value and three derivatives where it began,
AGE, ON = 4, 5  # tau since then at the present state's start; it has more than its constant
CUBIC_1 = slot(6)  # of the force on mass 1,
CUBIC_2 = slot(6)  # and on mass 2
CUBIC_AGE = CUBIC + AGE
SPACING = slot()  # of the nodes, in tau; a few bits long, so that ages of nodes are exact
HALF_SPACING = slot()
HERMITE = slot(3)  # h/5, h^2/20, h^6/28800
STEEP = slot()  # some free part decays too fast for a polynomial over half a spacing
RATE = slot()  # at least every rate of change of a flight, and its inverse
RATE_INVERSE = slot()
NODE_ETA = slot()  # eta; 0 where there is no harmonic forcing
NODE_COSINE = slot()  # of eta times the spacing
NODE_SINE = slot()

# -- the present state (1) -------------------------------------------------------------------------
MODE = slot()
FLIGHT, CONTACT, GLUED = 0.0, 1.0, 2.0
# 1, or -1 in the mirrored system, whose displacements are those times -1 and whose gap is what the
# stroke leaves: there the outer end, x_rel = stroke, is where the gap is 0
SIDE = slot()
ORIGIN = slot()  # tau_s (5) as an unevaluated sum of two floats
ORIGIN_LOW = slot()
TURN = slot()  # phase there in turns, [0, 1)
FREE_A = slot(2)  # displacement and velocity of the free part of 1 or 3,
FREE_B = slot(2)  # and 2
CUBIC_A = slot(4)  # response to the cubic: value and three derivatives at the state's start
CUBIC_B = slot(4)
EVENT_HARMONIC = slot(2)  # the event function: positive inside the state, 0 at its end
EVENT_CUBIC = slot(4)
EVENT_FREE_A = slot(2)
EVENT_FREE_B = slot(2)
EVENT_OFFSET = slot()  # its constant part
EVENT_ORDERS = 7
EVENT_DRIVE = slot(2 * EVENT_ORDERS)  # the forcing in its derivatives, where amplitudes grow
SINE = slot()  # of the phase at the state's start
COSINE = slot()
CUBIC_PRESENT = slot()  # the cubic part of some forcing is not zero
CLEAR = slot()  # no root before this age of the state
END = slot()  # the state's end once found
END_KIND = slot()
END_OPEN, END_EVENT, END_RENEWAL, END_OTHER = 0.0, 1.0, 2.0, 3.0  # the last at the other end

# -- of the run, and of the step -------------------------------------------------------------------
START_TIME = slot()
WORK = slot()  # evaluations spent
WORK_LIMIT = slot()  # and allowed in this step
PHASE_SINE = slot()  # of the phase at the communication point; with harmonic forcing only
PHASE_COSINE = slot()
TARGET = slot()  # for messages: the time a step was to reach,
REPORT = slot()  # and what a return code is about
STOP_AT_IMPACT = slot()  # set from outside: a step ends at its first impact
BEGIN = slot(4)  # displacements and velocities at the state's start: x1, v1, x2, v2
BEGIN_GAP = slot()  # and the gap
STOPPED = slot()  # the step has ended so
NARROW = slot()  # the stroke is too small compared with the displacements
NODE = slot()  # number of the node before the present interval,
LEFT_AGE = slot()  # its age,
RIGHT_AGE = slot()  # and that of the node after it
LEFT = slot(6)  # phasors there: free part A, free part B, cosine and sine of the excitation
RIGHT = slot(6)
LEFT_VALUES = slot(3)  # the event function and two derivatives there
RIGHT_VALUES = slot(3)
POINT = slot(6)  # where the event function was evaluated last: phasors as above
AT_END = slot(6)  # and at the state's end, where they are known from it:
AT_END_NODE = slot()  # number of the node after it; 0 where they are not known
ROTATIONS = slot()  # that the phase at the state's start went through since it was recomputed
REMAINDER = slot()  # what a quintic between nodes may miss: bound of the sixth derivative, scaled
SERIES = slot()  # order of the Taylor series that describe a short flight; 0: the closed form does
SERIES_X = slot()  # derivatives of xi_1 at its start, in every second slot,
SERIES_GAP = slot(2 * SERIES_LONGEST + 9)  # and of the gap between them; zeros after its last
SERIES_BOUND = slot()  # of the gap's fifth derivative
STEP = slot()  # length of the last step, s
# of the outputs, in their order, where they were asked for; of those that were added later behind
RATES = slot(X1_SAMPLE - X1)
ADDED_RATES = slot(TIME - EVALUATIONS)
# set from outside: an input of a cubic was set, to whatever value; the cubic begins there
CUBIC_SET = slot(3)  # of the box, of the forces on mass 1 and on mass 2
SIZE = slot.used

# -- return codes of the entry points --------------------------------------------------------------
OK, UNFINISHED, NOT_FINITE, START_OVERLAP, START_BONDED, LIMITED = 0, 1, 2, 3, 4, 5
START_BEYOND_CLEARANCE, BEYOND, TOO_FAST, START_WALL, START_BEYOND_STROKE = 6, 7, 8, 9, 10
TOO_NARROW = 11
