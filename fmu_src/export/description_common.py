"""Parts of ``modelDescription.xml`` that :func:`.description_fmi2.fmi2_xml` and
:func:`.description_fmi3.fmi3_xml` share.
"""

from __future__ import annotations

import math
from xml.etree import ElementTree as ET

from ..runtime.table import BOOLEAN, INTEGER, REAL, Model, Variable

UNITS = {  # SI exponents
    "kg": {"kg": 1},
    "N/m": {"kg": 1, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
    "1": {},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "m/s3": {"m": 1, "s": -3},
    "m/s4": {"m": 1, "s": -4},
    "m/s5": {"m": 1, "s": -5},
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "s": {"s": 1},
    "s/m": {"s": 1, "m": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.s": {"kg": 1, "m": 1, "s": -1},
    "N.s2": {"kg": 1, "m": 1},
    "N/s": {"kg": 1, "m": 1, "s": -3},
    "N/s2": {"kg": 1, "m": 1, "s": -4},
    "N/s3": {"kg": 1, "m": 1, "s": -5},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "kg.m2": {"kg": 1, "m": 2},
    "A": {"A": 1},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "Ohm": {"kg": 1, "m": 2, "s": -3, "A": -2},
    "H": {"kg": 1, "m": 2, "s": -2, "A": -2},
    "N.m/A": {"kg": 1, "m": 2, "s": -2, "A": -1},
    "N/A": {"kg": 1, "m": 1, "s": -2, "A": -1},
    "V/s": {"kg": 1, "m": 2, "s": -4, "A": -1},
    "V/s2": {"kg": 1, "m": 2, "s": -5, "A": -1},
    "V/s3": {"kg": 1, "m": 2, "s": -6, "A": -1},
}
QUANTITIES = {  # what a unit measures
    "kg": "Mass",
    "N/m": "Stiffness",
    "N.s/m": "Damping",
    "m": "Length",
    "m/s": "Velocity",
    "m/s2": "Acceleration",
    "m/s3": "Jerk",
    "rad": "Angle",
    "rad/s": "AngularVelocity",
    "s": "Time",
    "N": "Force",
    "N.s": "Impulse",
    "N.m": "Torque",
    "J": "Energy",
    "W": "Power",
    "kg.m2": "MomentOfInertia",
    "A": "ElectricCurrent",
    "V": "ElectricPotential",
    "Ohm": "Resistance",
    "H": "Inductance",
}
DISPLAY_UNITS = {  # how many of them an SI unit is
    "m": {"mm": 1e3},
    "m/s": {"mm/s": 1e3},
    "m/s2": {"g": 1.0 / 9.80665},
    "rad": {"deg": 180.0 / math.pi},
    "rad/s": {"Hz": 0.5 / math.pi, "rpm": 30.0 / math.pi},
    "s": {"ms": 1e3},
}
LOG_CATEGORIES = {
    "logStatusWarning": "Steps too short to advance the time, once",
    "logStatusError": "Errors and discarded steps: what was wrong, its value and what is expected",
}
# the standard's name for all of them: taken, not offered, since a good run has no message
TAKEN_CATEGORIES = (*LOG_CATEGORIES, "logAll")


def float_text(value: float) -> str:
    """Return a float as XML writes it, to the last bit."""
    return repr(float(value))


def root_element(model: Model, **attributes: str) -> ET.Element:
    """Create the root element, with the attributes that the FMI versions do not share."""
    shared = {
        "modelName": model.name,
        "description": model.description,
        "author": model.author,
        "version": model.version,
        "license": model.license,
        "generationTool": f"vibroimpact {model.version}",
        "variableNamingConvention": "flat",
    }
    return ET.Element("fmiModelDescription", {**attributes, **shared})


def add_shared_elements(parent: ET.Element, model: Model) -> ET.Element:
    """Add units, log categories, default experiment and an empty table; return the table."""
    add_units(parent, model)
    categories = ET.SubElement(parent, "LogCategories")
    for name, explanation in LOG_CATEGORIES.items():
        ET.SubElement(categories, "Category", name=name, description=explanation)
    stop, step = float_text(model.stop_time), float_text(model.step_size)
    ET.SubElement(parent, "DefaultExperiment", startTime="0.0", stopTime=stop, stepSize=step)
    return ET.SubElement(parent, "ModelVariables")


def add_units(parent: ET.Element, model: Model) -> None:
    definitions = ET.SubElement(parent, "UnitDefinitions")
    used = {variable.unit for variable in model.variables} | {"s"}  # of time
    for name, exponents in UNITS.items():
        if name in used:
            unit = ET.SubElement(definitions, "Unit", name=name)
            base = {key: str(value) for key, value in exponents.items()}
            ET.SubElement(unit, "BaseUnit", base)
            for other, factor in DISPLAY_UNITS.get(name, {}).items():
                ET.SubElement(unit, "DisplayUnit", name=other, factor=float_text(factor))


def variable_attributes(variable: Variable, reference: int) -> dict[str, str]:
    found = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    return {**found, "initial": variable.initial} if variable.initial else found


def add_type_attributes(typed: ET.Element, variable: Variable) -> None:
    limits = {"min": variable.minimum, "max": variable.maximum}
    given = {key: value for key, value in limits.items() if value is not None}
    if variable.type == REAL:
        if variable.unit in QUANTITIES:
            typed.set("quantity", QUANTITIES[variable.unit])
        typed.set("unit", variable.unit)
        if variable.display_unit:
            typed.set("displayUnit", variable.display_unit)
        for key, value in given.items():
            typed.set(key, float_text(value))
        typed.set("nominal", float_text(variable.nominal or abs(variable.start) or 1.0))
    if variable.type == INTEGER:
        for key, value in given.items():
            typed.set(key, str(int(value)))
    if not variable.calculated:
        kind = {REAL: float, INTEGER: int, BOOLEAN: bool}[variable.type]
        typed.set("start", repr(kind(variable.start)).lower())


def xml_bytes(element: ET.Element) -> bytes:
    ET.indent(element)
    whole = ET.tostring(element, encoding="UTF-8", xml_declaration=True)
    assert isinstance(whole, bytes)
    return whole + b"\n"
