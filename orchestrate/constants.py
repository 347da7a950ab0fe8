"""Physical and mathematical constants of the whole package: gravity and one turn."""

import math

TURN = 2.0 * math.pi  # rad
GRAVITY = 9.80665  # m/s^2, standard gravity by definition
