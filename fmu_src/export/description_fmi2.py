"""Write ``modelDescription.xml`` of FMI 2.0 from a variable table."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as ET

from ..runtime.table import Model, Variable
from . import description_common as common

PYTHON = {
    "needsExecutionTool": "true",
    "canHandleVariableCommunicationStepSize": "true",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}
NATIVE = {
    "canHandleVariableCommunicationStepSize": "true",
    "maxOutputDerivativeOrder": "1",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}


def fmi2_xml(
    model: Model, guid: str, capabilities: dict[str, str] = NATIVE, sources: Sequence[str] = ()
) -> bytes:
    """Return the model description; ``sources`` are the C files that make its library."""
    root = common.root_element(model, fmiVersion="2.0", guid=guid, numberOfEventIndicators="0")
    attributes = {"modelIdentifier": model.name, **capabilities}
    simulation = ET.SubElement(root, "CoSimulation", attributes)
    if sources:
        files = ET.SubElement(simulation, "SourceFiles")
        for name in sources:
            ET.SubElement(files, "File", name=name)
    variables = common.add_shared_elements(root, model)
    for variable in model.variables:
        add_variable(variables, variable)
    add_model_structure(root, model)
    return common.xml_bytes(root)


def add_variable(parent: ET.Element, variable: Variable) -> None:
    attributes = common.variable_attributes(variable, variable.slot)
    scalar = ET.SubElement(parent, "ScalarVariable", attributes)
    common.add_type_attributes(ET.SubElement(scalar, variable.type), variable)


def add_model_structure(root: ET.Element, model: Model) -> None:
    """Add dependencies: outputs belong to the last communication point, few depend on inputs."""
    structure = ET.SubElement(root, "ModelStructure")
    index = {variable.name: str(i + 1) for i, variable in enumerate(model.variables)}
    outputs = ET.SubElement(structure, "Outputs")
    unknowns = ET.SubElement(structure, "InitialUnknowns")
    for variable in model.variables:
        if variable.causality == "output":
            for parent, names in (
                (outputs, variable.dependencies),
                (unknowns, variable.initial_dependencies),
            ):
                known = sorted(int(index[name]) for name in names)
                dependencies = " ".join(map(str, known))
                place = index[variable.name]
                ET.SubElement(parent, "Unknown", index=place, dependencies=dependencies)
