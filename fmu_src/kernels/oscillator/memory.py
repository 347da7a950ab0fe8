"""The flat memory: one array of floats holds an instance whole, hidden state included.

The first slots are the FMU's variables, each at its FMI value reference; the hidden state follows. Saving an instance is
copying this array. Flags and counts are floats too (exact to 2**53).
"""

# -- variables: the slot is the value reference -----------------------------------------------------------------------
M1, M2, K1, K2, D1, D2, E, GAMMA, BONDED = 0, 1, 2, 3, 4, 5, 6, 7, 8
X1_START, X2_START, V1_START, V2_START, PHASE_START, X_REL_MAX_ON = 9, 10, 11, 12, 13, 14
BOX_AMPLITUDE, BOX_FREQUENCY, BOX_ACCELERATION, BOX_JERK, BOX_SNAP, BOX_CRACKLE = 15, 16, 17, 18, 19, 20
X1, X2, V1, V2, X_REL, V_REL, XI1, XI2, XI_REL = 21, 22, 23, 24, 25, 26, 27, 28, 29
BOX_FORCE, BOX_IMPULSE, BOX_IMPULSE_MOMENT, CONTACT_FORCE, IN_CONTACT, PHASE = 30, 31, 32, 33, 34, 35
IMPACT_COUNT, IMPACT_TIME, IMPACT_VELOCITY, IMPACT_ENERGY, X_REL_MAX, CONTACT_COUNT = 36, 37, 38, 39, 40, 41
SAMPLE_COUNT = 42  # tunable parameter: states to keep inside a step
SAMPLES = 200  # and room for so many, equally spaced, the last one at its end
X1_SAMPLE, X2_SAMPLE, V1_SAMPLE, V2_SAMPLE = 43, 243, 443, 643
TIME = 843  # communication point reached, s (the independent variable)

# -- constants derived from the parameters ----------------------------------------------------------------------------
OMEGA, MU = 844, 845  # (2)
FORCE_V, FORCE_X = 846, 847  # 2 (D1 - D2), omega1^2 - omega2^2: the coefficients of (18)
FASTEST = 848  # largest omega_i
BRANCH_1, BRANCH_2, BRANCH_3, BRANCH_SIZE = 849, 856, 863, 7
# inside a branch: damping D_i (8), omega_i^2 (7), nu_i^2 = omega_i^2 - D_i^2 (11), sqrt|nu_i^2|, the same in turns,
# and the envelope |e^{-D t} cos| <= e^{-r t}, |e^{-D t} sin/nu| <= s e^{-r t}
DAMPING, OMEGA_SQUARED, NU_SQUARED, NU, NU_TURNS, ENVELOPE_RATE, ENVELOPE_SINE = 0, 1, 2, 3, 4, 5, 6

# -- excitation of the present segment (until an input changes) -------------------------------------------------------
ETA, ETA_TURNS, FORCING = 870, 871, 872  # eta (2), eta/2pi, a eta^2
HARMONIC_1, HARMONIC_2, HARMONIC_3 = 873, 875, 877  # a eta^2 (a_i, b_i) of (11), cosine and sine
SEGMENT_INPUTS = 879  # the six inputs the segment was made of
CUBIC_ON = 885  # the cubic part has more than its constant term: it must be set anew at each communication point
CUBIC = 886  # value and three derivatives of the cubic part of the forcing at the segment's start
SEGMENT_AGE = 890  # tau since the segment's start, at the present state's start

# -- the present state (1) --------------------------------------------------------------------------------------------
MODE = 891
FLIGHT, CONTACT, GLUED = 0.0, 1.0, 2.0
ORIGIN, ORIGIN_LOW, TURN = 892, 893, 894  # tau_s (5) as an unevaluated sum of two floats; phase there in turns, [0, 1)
FREE_A, FREE_B = 895, 897  # c and v + D c of the free part, branch 1 or 3, and 2
CUBIC_A, CUBIC_B = 899, 903  # response to the cubic: value and three derivatives at the state's start
# the barrier: positive inside the state, its first root is the state's end
BARRIER_HARMONIC, BARRIER_CUBIC, BARRIER_FREE_A, BARRIER_FREE_B = 907, 909, 913, 915
BOUND = 917  # of its fifth derivative: steady part, free part A, free part B
SINE, COSINE = 920, 921  # of the phase at the state's start
CUBIC_PRESENT = 922  # the cubic part of the forcing is not zero
CLEAR, END, END_KIND = 923, 924, 925  # no root before CLEAR; the state's end once found
END_OPEN, END_EVENT, END_RENEWAL = 0.0, 1.0, 2.0

# -- book-keeping -----------------------------------------------------------------------------------------------------
START_TIME = 926
WORK, WORK_LIMIT = 927, 928  # evaluations spent and allowed in this step
TARGET, REPORT = 929, 930  # for messages: the time a step was to reach, and what a return code is about
STOP_AT_IMPACT = 931  # set from outside: a step ends at its first impact
BEGIN = 932  # displacements and velocities at the state's start: x1, v1, x2, v2
STOPPED = 936  # the step has ended so
SERIES = 937  # order of the Taylor series that describe a short flight; 0: the closed form does
SERIES_LONGEST = 12
SERIES_DRIVE, SERIES_X, SERIES_GAP = 938, 951, 964  # coefficients of the harmonic forcing, of xi_1, and of the gap
SIZE = 977

# -- return codes of the entry points ---------------------------------------------------------------------------------
OK, UNFINISHED, RESONANCE_1, RESONANCE_2, RESONANCE_3, NOT_FINITE, START_OVERLAP, START_BONDED = 0, 1, 2, 3, 4, 5, 6, 7
