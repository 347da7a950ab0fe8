"""Names of the models."""

OSCILLATOR = "TwoMassImpactOscillator"
SHAKER = "MotorShaker"
