"""Names of the FMU models."""

OSCILLATOR = "TwoMassImpactOscillator"
SHAKER = "MotorShaker"
ELECTRODYNAMIC_SHAKER = "ElectrodynamicShaker"
