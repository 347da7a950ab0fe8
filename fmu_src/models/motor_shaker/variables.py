"""The variable table of ``MotorShaker``. Standard library only: it travels inside the FMU."""

from __future__ import annotations

from typing import Any

from ...kernels.motor_shaker import memory
from ...runtime.table import (
    COUNT,
    DRIVE_LIMIT,
    cubic,
    drive,
    evaluation_limit,
    not_negative,
    numbered,
    output,
    positive,
    start_value,
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
    positive("box_mass", "kg", 5.5, "Box with motor and unbalance, M_t"),
    not_negative("box_stiffness", "N/m", 309.375, "Stiffness of the box's suspension, k_b"),
    not_negative("box_damping", "N.s/m", 4.125, "Damping of the box's suspension, c_b"),
    not_negative("unbalance_mass", "kg", 0.025, "Mass of the unbalance, m_u"),
    not_negative("unbalance_radius", "m", 0.02, "Its distance from the axis, r"),
    positive(
        "rotor_inertia", "kg.m2", 5e-5, "Moment of inertia of the rotor with the unbalance, J"
    ),
    not_negative("motor_constant", "N.m/A", 0.06, "Torque over current, and voltage over speed, K"),
    positive("armature_resistance", "Ohm", 12.0, "Resistance of the armature, R_a"),
    not_negative(
        "armature_inductance", "H", 0.0, "Inductance of the armature, L; 0: static torque line"
    ),
    start_value("angle_start", "rad", "Angle of the unbalance at the start", 1e6),
    start_value(
        "speed_start", "rad/s", "Speed of the rotor at the start", 1e9, nominal=100.0, **RPM
    ),
    start_value(
        "position_start", "m", "Position of the box at the start", nominal=1e-3, **MILLIMETRES
    ),
    start_value("velocity_start", "m/s", "Velocity of the box at the start"),
    start_value("current_start", "A", "Current at the start, where armature_inductance > 0"),
)
INPUTS = (
    drive(
        *("voltage", "V", 8.0, "Voltage of the motor, U, constant over the step"),
        minimum=-DRIVE_LIMIT,
        maximum=DRIVE_LIMIT,
    ),
    *cubic("box_force", "N", "Force on the box", DRIVE_LIMIT),
)
NOW: dict[str, Any] = {"dependencies": ("voltage", "box_force")}
JERK: dict[str, Any] = {"dependencies": ("voltage", *FORCE)}
ELECTRIC: dict[str, Any] = {"dependencies": ("voltage",)}
OUTPUTS = (
    output(
        "box_position",
        "m",
        "Position of the box, y",
        ("position_start",),
        nominal=1e-3,
        **MILLIMETRES,
    ),
    output("box_velocity", "m/s", "Velocity of the box", ("velocity_start",), nominal=1e-2),
    output(
        "box_acceleration",
        "m/s2",
        "Acceleration of the box, with the inputs as they are now",
        (*ALL, "box_force"),
        **NOW,
    ),
    output(
        "box_jerk",
        "m/s3",
        "Time derivative of box_acceleration, with the inputs as they are now",
        (*ALL, *FORCE),
        nominal=100.0,
        **JERK,
    ),
    output(
        "angle",
        "rad",
        "Angle of the unbalance since angle_start = 0, phi, full turns included",
        ("angle_start",),
        nominal=100.0,
    ),
    output("speed", "rad/s", "Speed of the rotor", ("speed_start",), nominal=100.0, **RPM),
    output("motor_current", "A", "Current of the motor", (*CIRCUIT, "voltage"), **ELECTRIC),
    output(
        "motor_torque",
        "N.m",
        "Torque of the motor on the rotor, K i",
        (*CIRCUIT, "voltage"),
        **ELECTRIC,
    ),
    output(
        "motor_power",
        "W",
        "Mechanical power of the motor, torque times speed",
        (*CIRCUIT, "voltage"),
        **ELECTRIC,
    ),
    output(
        "motor_energy", "J", "Mechanical work of the motor since the start, integral of motor_power"
    ),
    output(
        "box_damper_energy",
        "J",
        "Energy lost in the damper of the box's suspension since the start",
    ),
    output("box_force_work", "J", "Work of box_force on the box since the start"),
    output(
        "stored_energy",
        "J",
        "Kinetic energy of box and rotor, and energy of the box's spring",
        STORED,
    ),
    output(
        "evaluations",
        "",
        "Evaluations of the right-hand side in the last communication step",
        **COUNT,
    ),
)
LIMITS = (evaluation_limit("right-hand side"),)
VARIABLES = numbered(PARAMETERS + INPUTS + OUTPUTS + LIMITS, memory)
