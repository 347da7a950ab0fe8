"""Write ``modelDescription.xml`` of FMI 3.0 from a variable table."""

from __future__ import annotations

from xml.etree import ElementTree as ET

from ..runtime.table import BOOLEAN, INTEGER, REAL, Array, Model, Variable
from . import description_common as common

TYPES = {REAL: "Float64", INTEGER: "Int32", BOOLEAN: "Boolean"}
ARRAY_BASE = 1000  # value references of arrays begin here
CLOCK_REFERENCE = 2000
CAPABILITIES = {
    "canHandleVariableCommunicationStepSize": "true",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "maxOutputDerivativeOrder": "1",
}
EVENT_MODE = {"hasEventMode": "true"}  # of models with a clock


def fmi3_xml(model: Model, token: str) -> bytes:
    """Return the model description, as bytes that depend on nothing but the arguments."""
    root = common.root_element(model, fmiVersion="3.0", instantiationToken=token)
    capabilities = {**CAPABILITIES, **(EVENT_MODE if model.clock else {})}
    ET.SubElement(root, "CoSimulation", {"modelIdentifier": model.name, **capabilities})
    variables = common.add_shared_elements(root, model)
    add_time(variables, model)
    for variable in model.variables:
        if not variable.series:
            add_variable(variables, variable)
    for i, array in enumerate(model.arrays):
        add_array(variables, model, array, ARRAY_BASE + i)
    add_clock(variables, model)
    add_model_structure(root, model)
    return common.xml_bytes(root)


def add_time(parent: ET.Element, model: Model) -> None:
    attributes = {
        "name": "time",
        "valueReference": str(model.time_slot),
        "description": "Time",
        "causality": "independent",
        "variability": "continuous",
        "unit": "s",
    }
    ET.SubElement(parent, "Float64", attributes)


def add_variable(parent: ET.Element, variable: Variable) -> None:
    attributes = common.variable_attributes(variable, variable.slot)
    common.add_type_attributes(ET.SubElement(parent, TYPES[variable.type], attributes), variable)


def array_elements(model: Model, array: Array) -> tuple[Variable, ...]:
    first = [variable.name for variable in model.variables].index(array.first)
    return model.variables[first : first + array.size]


def add_array(parent: ET.Element, model: Model, array: Array, reference: int) -> None:
    scalar = array_elements(model, array)[0]
    attributes = common.variable_attributes(scalar, reference)
    attributes |= {"name": array.name, "description": array.description, "unit": scalar.unit}
    typed = ET.SubElement(parent, "Float64", attributes)
    ET.SubElement(typed, "Dimension", start=str(array.size))


def add_clock(parent: ET.Element, model: Model) -> None:
    if model.clock:
        attributes = {
            "name": model.clock.name,
            "valueReference": str(CLOCK_REFERENCE),
            "description": model.clock.description,
            "causality": "output",
            "intervalVariability": "triggered",
        }
        ET.SubElement(parent, "Clock", attributes)


def add_model_structure(root: ET.Element, model: Model) -> None:
    structure = ET.SubElement(root, "ModelStructure")
    calculated: list[tuple[int, tuple[Variable, ...]]]
    calculated = [(v.slot, (v,)) for v in model.variables if v.causality == "output"]
    arrays = [
        (ARRAY_BASE + i, array_elements(model, array)) for i, array in enumerate(model.arrays)
    ]
    calculated += [
        (reference, members) for reference, members in arrays if members[0].causality == "output"
    ]
    if model.clock:
        calculated.append((CLOCK_REFERENCE, ()))
    slots = {variable.name: variable.slot for variable in model.variables}
    for kind, attribute in (("Output", "dependencies"), ("InitialUnknown", "initial_dependencies")):
        for reference, members in calculated:
            names = {name for variable in members for name in getattr(variable, attribute)}
            known = " ".join(map(str, sorted(slots[name] for name in names)))
            ET.SubElement(structure, kind, valueReference=str(reference), dependencies=known)
