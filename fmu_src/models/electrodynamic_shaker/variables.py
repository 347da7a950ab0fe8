"""The variable table of ``ElectrodynamicShaker``. Standard library only: it travels inside the
FMU.
"""

from __future__ import annotations

from typing import Any

from ...kernels.electrodynamic_shaker import memory
from ...runtime.table import (
    BOOLEAN,
    COUNT,
    DRIVE_LIMIT,
    cubic_input,
    evaluation_limit_parameter,
    non_negative_parameter,
    output_variable,
    parameter,
    positive_parameter,
    start_value_parameter,
    with_slot_numbers,
)

MILLIMETRES: dict[str, Any] = {"display_unit": "mm"}
PARAMETERS = (
    positive_parameter("table_mass", "kg", 5.5, "Table with all that is fixed to it, M"),
    non_negative_parameter(
        "suspension_stiffness", "N/m", 1375.0, "Stiffness of the table's suspension, k"
    ),
    non_negative_parameter(
        "suspension_damping", "N.s/m", 11.0, "Damping of the table's suspension, c"
    ),
    non_negative_parameter(
        "force_factor", "N/A", 20.0, "Force over current, and voltage over velocity, Bl"
    ),
    positive_parameter(
        "coil_resistance", "Ohm", 4.0, "Resistance of the coil and of the amplifier's output, R"
    ),
    non_negative_parameter("coil_inductance", "H", 0.0, "Inductance of the coil, L; 0: none"),
    parameter(
        "current_control",
        "",
        0.0,
        "true: the command is the current, false: the voltage",
        type=BOOLEAN,
    ),
    non_negative_parameter(
        "voltage_limit", "V", 0.0, "Largest voltage of the amplifier; 0: no limit"
    ),
    non_negative_parameter(
        "current_limit", "A", 0.0, "Largest current of the amplifier; 0: no limit"
    ),
    non_negative_parameter(
        "travel_limit",
        "m",
        0.0,
        "Distance of the stops from the middle, at which a step fails; 0: no stops",
        **MILLIMETRES,
    ),
    start_value_parameter(
        "position_start", "m", "Position of the table at the start", nominal=1e-3, **MILLIMETRES
    ),
    start_value_parameter("velocity_start", "m/s", "Velocity of the table at the start"),
    start_value_parameter(
        "current_start",
        "A",
        "Current at the start, where coil_inductance > 0, and where current_control is true, with "
        "a voltage_limit",
    ),
)
INPUTS = (
    *cubic_input(
        "command",
        "V",
        "Voltage of the amplifier; where current_control is true its current, A",
        DRIVE_LIMIT,
    ),
    *cubic_input("box_force", "N", "Force on the table", DRIVE_LIMIT),
)
# what the current at the start follows from, and the voltage with the slope of a commanded current
CURRENT = (
    *("force_factor", "coil_resistance", "coil_inductance", "velocity_start", "current_start"),
    *("current_control", "voltage_limit", "current_limit", "command"),
)
VOLTAGE = (*CURRENT, "command_1")
MECHANICS = ("table_mass", "suspension_stiffness", "suspension_damping", "position_start")
ELECTRIC: dict[str, Any] = {"dependencies": ("command", "command_1")}
STORED = (
    *("table_mass", "suspension_stiffness", "position_start", "velocity_start"),
    *("coil_inductance", "current_start", "current_control", "voltage_limit", "current_limit"),
)
OUTPUTS = (
    output_variable(
        "box_position",
        "m",
        "Position of the table",
        ("position_start",),
        nominal=1e-3,
        **MILLIMETRES,
    ),
    output_variable(
        "box_velocity", "m/s", "Velocity of the table", ("velocity_start",), nominal=1e-2
    ),
    output_variable(
        "box_acceleration",
        "m/s2",
        "Acceleration of the table, with the inputs as they are now",
        (*MECHANICS, *CURRENT, "box_force"),
        dependencies=("command", "box_force"),
    ),
    output_variable(
        "box_jerk",
        "m/s3",
        "Time derivative of box_acceleration, with the inputs as they are now",
        (*MECHANICS, *VOLTAGE, "box_force", "box_force_1"),
        nominal=100.0,
        dependencies=("command", "command_1", "box_force", "box_force_1"),
    ),
    output_variable("current", "A", "Current of the coil", CURRENT, dependencies=("command",)),
    output_variable("voltage", "V", "Voltage of the amplifier", VOLTAGE, **ELECTRIC),
    output_variable(
        "coil_force",
        "N",
        "Force of the coil on the table, Bl i",
        CURRENT,
        dependencies=("command",),
    ),
    output_variable(
        "power",
        "W",
        "Electrical power of the amplifier, voltage times current",
        VOLTAGE,
        **ELECTRIC,
    ),
    output_variable(
        "energy",
        "J",
        "Electrical work of the amplifier since the start, integral of power; a commanded current "
        "puts the energy of coil_inductance in by its first jump, from zero, too",
        (
            *("coil_inductance", "current_start", "current_control"),
            *("voltage_limit", "current_limit", "command"),
        ),
        dependencies=("command",),
    ),
    output_variable("coil_heat", "J", "Heat of coil_resistance since the start"),
    output_variable(
        "suspension_loss",
        "J",
        "Energy lost in the damper of the table's suspension since the start",
    ),
    output_variable("box_force_work", "J", "Work of box_force on the table since the start"),
    output_variable(
        "stored_energy",
        "J",
        "Kinetic energy of the table, and energies of its spring and of coil_inductance",
        (*STORED, "command"),
        dependencies=("command",),
    ),
    output_variable(
        "limited",
        "",
        "A limit of voltage or current acts",
        VOLTAGE,
        type=BOOLEAN,
        variability="discrete",
        **ELECTRIC,
    ),
    output_variable(
        "evaluations", "", "Power series computed in the last communication step", **COUNT
    ),
)
LIMITS = (evaluation_limit_parameter("power series"),)
VARIABLES = with_slot_numbers(PARAMETERS + INPUTS + OUTPUTS + LIMITS, memory)
