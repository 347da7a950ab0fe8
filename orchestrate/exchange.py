"""What is exchanged with the two FMUs of the weak drive: names, and the places of the values in what a channel reads."""

OSCILLATOR, SHAKER = "TwoMassImpactOscillator", "MotorShaker"
OSCILLATOR_INPUTS = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
OSCILLATOR_OUTPUTS = ("x1", "x2", "v1", "v2", "box_force", "box_impulse", "box_impulse_moment", "impact_energy")
X1, X2, V1, V2, R, IMPULSE, MOMENT, IMPACT_ENERGY = range(8)
SHAKER_INPUTS = ("box_force", "box_force_1", "box_force_2", "box_force_3", "voltage")
SHAKER_OUTPUTS = (
    *("box_position", "box_velocity", "box_acceleration", "box_jerk", "angle", "speed"),
    *("motor_energy", "box_damper_energy", "box_force_work", "stored_energy"),
)
Y, V, A, JERK, ANGLE, SPEED, E_MOTOR, E_DAMPER, E_FORCE, E_STORED = range(10)
