"""Numbers that the whole package shares."""

import math

TURN = 2.0 * math.pi  # rad
GRAVITY = 9.80665  # m/s^2, standard gravity by definition
