"""Names of the FMU models."""

OSCILLATOR = "TwoMassImpactOscillator"
MOTOR_SHAKER = "MotorShaker"
ELECTRODYNAMIC_SHAKER = "ElectrodynamicShaker"
