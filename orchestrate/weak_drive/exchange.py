"""Exchange of the master with the two FMUs: names and positions follow from one declaration."""

from __future__ import annotations

from typing import NamedTuple

Cubic = tuple[
    float, float, float, float
]  # value and first to third time derivative, at a step's beginning


class OscillatorInputs(NamedTuple):
    """Inputs of the structure: the box's acceleration over a step, as a cubic."""

    box_acceleration: float = 0.0
    box_jerk: float = 0.0
    box_snap: float = 0.0
    box_crackle: float = 0.0


class OscillatorOutputs(NamedTuple):
    """Outputs of the structure at a communication point, SI: displacements from the unloaded
    springs, and the gap, which is 0 in contact.
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
    """Inputs of the shaker: the force on the box over a step, as a cubic, and the voltage."""

    box_force: float = 0.0
    box_force_1: float = 0.0
    box_force_2: float = 0.0
    box_force_3: float = 0.0
    voltage: float = 0.0


class ShakerOutputs(NamedTuple):
    """Outputs of the shaker at a communication point, SI."""

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
    """A step that both sides have done: what the structure was told, and both ends of it."""

    acceleration: Cubic
    motion: OscillatorOutputs
    shaking: ShakerOutputs
