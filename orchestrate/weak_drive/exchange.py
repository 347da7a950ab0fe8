"""Declare the input and output variables that the master exchanges with the two FMUs."""

from __future__ import annotations

from typing import NamedTuple

Cubic = tuple[
    float, float, float, float
]  # value and first to third time derivative, at a step's beginning


class OscillatorInputs(NamedTuple):
    """Store the inputs of the structure FMU: a step's box acceleration as a cubic."""

    box_acceleration: float = 0.0
    box_jerk: float = 0.0
    box_snap: float = 0.0
    box_crackle: float = 0.0


class OscillatorOutputs(NamedTuple):
    """Store the outputs of the structure FMU at a communication point, SI units.

    Displacements count from the unloaded springs; the gap ``x_rel`` is 0 in contact.
    """

    x1: float
    x2: float
    v1: float
    v2: float
    box_force: float
    box_impulse: float
    box_impulse_moment: float
    impact_energy: float
    impact_time: float
    x_rel: float


class ShakerInputs(NamedTuple):
    """Store the inputs of the motor FMU: force on the box as a cubic, and voltage."""

    box_force: float = 0.0
    box_force_1: float = 0.0
    box_force_2: float = 0.0
    box_force_3: float = 0.0
    voltage: float = 0.0


class ShakerOutputs(NamedTuple):
    """Store the outputs of the motor FMU at a communication point, SI units."""

    box_position: float
    box_velocity: float
    box_acceleration: float
    box_jerk: float
    angle: float
    speed: float
    motor_energy: float
    box_damper_energy: float
    box_force_work: float
    stored_energy: float


class Step(NamedTuple):
    """Store a finished communication step: acceleration used, and both FMUs' outputs."""

    acceleration: Cubic
    motion: OscillatorOutputs
    shaking: ShakerOutputs
