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


def fmi3_xml(model: Model, token: str) -> bytes:
    """Return the model description, as bytes that depend on nothing but the arguments."""
    root = common.root_element(model, fmiVersion="3.0", instantiationToken=token)
    capabilities = {**CAPABILITIES, **({"hasEventMode": "true"} if model.clock else {})}
    ET.SubElement(root, "CoSimulation", {"modelIdentifier": model.name, **capabilities})
    variables = common.add_shared_elements(root, model)
    time = Variable("time", "Time", "independent")
    attributes = common.variable_attributes(time, model.time_slot)
    ET.SubElement(variables, "Float64", attributes, unit="s")
    for variable in model.variables:
        if not variable.series:
            attributes = common.variable_attributes(variable, variable.slot)
            typed = ET.SubElement(variables, TYPES[variable.type], attributes)
            common.add_type_attributes(typed, variable)
    for i, array in enumerate(model.arrays):
        add_array(variables, model, array, ARRAY_BASE + i)
    if model.clock:
        clock = {"name": model.clock.name, "description": model.clock.description}
        kind = {"causality": "output", "intervalVariability": "triggered"}
        reference = {"valueReference": str(CLOCK_REFERENCE)}
        ET.SubElement(variables, "Clock", {**clock, **reference, **kind})
    add_model_structure(root, model)
    return common.xml_bytes(root)


def array_elements(model: Model, array: Array) -> tuple[Variable, ...]:
    first = [variable.name for variable in model.variables].index(array.first)
    return model.variables[first : first + array.size]


def add_array(parent: ET.Element, model: Model, array: Array, reference: int) -> None:
    scalar = array_elements(model, array)[0]
    attributes = common.variable_attributes(scalar, reference)
    attributes |= {"name": array.name, "description": array.description, "unit": scalar.unit}
    typed = ET.SubElement(parent, "Float64", attributes)
    ET.SubElement(typed, "Dimension", start=str(array.size))


def add_model_structure(root: ET.Element, model: Model) -> None:
    structure = ET.SubElement(root, "ModelStructure")
    outputs = [v for v in model.variables if v.causality == "output"]
    calculated: list[tuple[int, tuple[Variable, ...]]] = [(v.slot, (v,)) for v in outputs]
    for i, array in enumerate(model.arrays):
        members = array_elements(model, array)
        if members[0].causality == "output":
            calculated.append((ARRAY_BASE + i, members))
    if model.clock:
        calculated.append((CLOCK_REFERENCE, ()))
    slots = {variable.name: variable.slot for variable in model.variables}
    for kind, attribute in (("Output", "dependencies"), ("InitialUnknown", "initial_dependencies")):
        for reference, members in calculated:
            names = {name for variable in members for name in getattr(variable, attribute)}
            known = " ".join(map(str, sorted(slots[name] for name in names)))
            ET.SubElement(structure, kind, valueReference=str(reference), dependencies=known)
