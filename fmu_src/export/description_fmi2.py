"""Write ``modelDescription.xml`` of FMI 2.0 from a variable table."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as ET

from ..runtime.table import Model
from . import description_common as common

SHARED = {  # capabilities
    "canHandleVariableCommunicationStepSize": "true",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}
PYTHON = {"needsExecutionTool": "true", **SHARED}
NATIVE = {"maxOutputDerivativeOrder": "1", **SHARED}


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
        attributes = common.variable_attributes(variable, variable.slot)
        scalar = ET.SubElement(variables, "ScalarVariable", attributes)
        common.add_type_attributes(ET.SubElement(scalar, variable.type), variable)
    add_model_structure(root, model)
    return common.xml_bytes(root)


def add_model_structure(root: ET.Element, model: Model) -> None:
    """Add dependencies: outputs belong to the last communication point, few depend on inputs."""
    structure = ET.SubElement(root, "ModelStructure")
    index = {variable.name: str(i + 1) for i, variable in enumerate(model.variables)}
    outputs = ET.SubElement(structure, "Outputs")
    unknowns = ET.SubElement(structure, "InitialUnknowns")
    for variable in model.variables:
        if variable.causality == "output":
            initial = variable.initial_dependencies
            for parent, names in ((outputs, variable.dependencies), (unknowns, initial)):
                dependencies = " ".join(sorted((index[name] for name in names), key=int))
                place = index[variable.name]
                ET.SubElement(parent, "Unknown", index=place, dependencies=dependencies)
