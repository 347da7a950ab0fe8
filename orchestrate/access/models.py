"""Names of the FMU models: ``TwoMassImpactOscillator`` and ``MotorShaker``."""

OSCILLATOR = "TwoMassImpactOscillator"
SHAKER = "MotorShaker"
