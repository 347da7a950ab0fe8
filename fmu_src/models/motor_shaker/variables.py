"""The variable table of ``MotorShaker``. Standard library only: it travels inside the FMU."""

from __future__ import annotations

from typing import Any

from ...kernels.motor_shaker import memory
from ...runtime.table import (
    COUNT,
    DRIVE_LIMIT,
    cubic_input,
    evaluation_limit_parameter,
    input_variable,
    non_negative_parameter,
    output_variable,
    positive_parameter,
    start_value_parameter,
    with_slot_numbers,
)

BOX = ("box_mass", "box_stiffness", "box_damping", "position_start", "velocity_start")
ROTOR = ("unbalance_mass", "unbalance_radius", "rotor_inertia", "angle_start", "speed_start")
CIRCUIT = (
    "motor_constant",
    "armature_resistance",
    "armature_inductance",
    "current_start",
    "speed_start",
)
STORED = (*(name for name in BOX if name != "box_damping"), *ROTOR)
FORCE = ("box_force", "box_force_1")
ALL = (*BOX, *ROTOR, *(name for name in CIRCUIT if name not in ROTOR), "voltage")


RPM: dict[str, Any] = {"display_unit": "rpm"}
MILLIMETRES: dict[str, Any] = {"display_unit": "mm"}
PARAMETERS = (
    positive_parameter("box_mass", "kg", 5.5, "Box with motor and unbalance, M_t"),
    non_negative_parameter(
        "box_stiffness", "N/m", 309.375, "Stiffness of the box's suspension, k_b"
    ),
    non_negative_parameter("box_damping", "N.s/m", 4.125, "Damping of the box's suspension, c_b"),
    non_negative_parameter("unbalance_mass", "kg", 0.025, "Mass of the unbalance, m_u"),
    non_negative_parameter("unbalance_radius", "m", 0.02, "Its distance from the axis, r"),
    positive_parameter(
        "rotor_inertia", "kg.m2", 5e-5, "Moment of inertia of the rotor with the unbalance, J"
    ),
    non_negative_parameter(
        "motor_constant", "N.m/A", 0.06, "Torque over current, and voltage over speed, K"
    ),
    positive_parameter("armature_resistance", "Ohm", 12.0, "Resistance of the armature, R_a"),
    non_negative_parameter(
        "armature_inductance", "H", 0.0, "Inductance of the armature, L; 0: static torque line"
    ),
    start_value_parameter("angle_start", "rad", "Angle of the unbalance at the start", 1e6),
    start_value_parameter(
        "speed_start", "rad/s", "Speed of the rotor at the start", 1e9, nominal=100.0, **RPM
    ),
    start_value_parameter(
        "position_start", "m", "Position of the box at the start", nominal=1e-3, **MILLIMETRES
    ),
    start_value_parameter("velocity_start", "m/s", "Velocity of the box at the start"),
    start_value_parameter(
        "current_start", "A", "Current at the start, where armature_inductance > 0"
    ),
)
INPUTS = (
    input_variable(
        *("voltage", "V", 8.0, "Voltage of the motor, U, constant over the step"),
        minimum=-DRIVE_LIMIT,
        maximum=DRIVE_LIMIT,
    ),
    *cubic_input("box_force", "N", "Force on the box", DRIVE_LIMIT),
)
NOW: dict[str, Any] = {"dependencies": ("voltage", "box_force")}
JERK: dict[str, Any] = {"dependencies": ("voltage", *FORCE)}
ELECTRIC: dict[str, Any] = {"dependencies": ("voltage",)}
OUTPUTS = (
    output_variable(
        "box_position",
        "m",
        "Position of the box, y",
        ("position_start",),
        nominal=1e-3,
        **MILLIMETRES,
    ),
    output_variable(
        "box_velocity", "m/s", "Velocity of the box", ("velocity_start",), nominal=1e-2
    ),
    output_variable(
        "box_acceleration",
        "m/s2",
        "Acceleration of the box, with the inputs as they are now",
        (*ALL, "box_force"),
        **NOW,
    ),
    output_variable(
        "box_jerk",
        "m/s3",
        "Time derivative of box_acceleration, with the inputs as they are now",
        (*ALL, *FORCE),
        nominal=100.0,
        **JERK,
    ),
    output_variable(
        "angle",
        "rad",
        "Angle of the unbalance since angle_start = 0, phi, full turns included",
        ("angle_start",),
        nominal=100.0,
    ),
    output_variable("speed", "rad/s", "Speed of the rotor", ("speed_start",), nominal=100.0, **RPM),
    output_variable(
        "motor_current", "A", "Current of the motor", (*CIRCUIT, "voltage"), **ELECTRIC
    ),
    output_variable(
        "motor_torque",
        "N.m",
        "Torque of the motor on the rotor, K i",
        (*CIRCUIT, "voltage"),
        **ELECTRIC,
    ),
    output_variable(
        "motor_power",
        "W",
        "Mechanical power of the motor, torque times speed",
        (*CIRCUIT, "voltage"),
        **ELECTRIC,
    ),
    output_variable(
        "motor_energy", "J", "Mechanical work of the motor since the start, integral of motor_power"
    ),
    output_variable(
        "box_damper_energy",
        "J",
        "Energy lost in the damper of the box's suspension since the start",
    ),
    output_variable("box_force_work", "J", "Work of box_force on the box since the start"),
    output_variable(
        "stored_energy",
        "J",
        "Kinetic energy of box and rotor, and energy of the box's spring",
        STORED,
    ),
    output_variable(
        "evaluations",
        "",
        "Evaluations of the right-hand side in the last communication step",
        **COUNT,
    ),
)
LIMITS = (evaluation_limit_parameter("right-hand side"),)
VARIABLES = with_slot_numbers(PARAMETERS + INPUTS + OUTPUTS + LIMITS, memory)
