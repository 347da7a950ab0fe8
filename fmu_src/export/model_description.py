"""``modelDescription.xml`` of FMI 2.0 from a variable table."""

from xml.etree import ElementTree as ET

from ..runtime.table import BOOLEAN, INTEGER, REAL

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
}
COSIMULATION = {
    "needsExecutionTool": "true",
    "canHandleVariableCommunicationStepSize": "true",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}
NATIVE_COSIMULATION = {
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "true",
    "maxOutputDerivativeOrder": "1",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}
LOG_CATEGORIES = {
    "logStatusError": "Errors: what was wrong, its value and what is allowed",
    "logAll": "All messages",
}


def number(value):
    """A float as XML writes it, to the last bit."""
    return repr(float(value))


def fmi2_xml(model, guid, cosimulation=COSIMULATION):
    """The model description, as bytes that depend on nothing but the arguments.

    Parameters
    ----------
    model : Model
    guid : str
    cosimulation : dict
        Capability flags.

    Returns
    -------
    bytes
    """
    root = ET.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=model.name,
        guid=guid,
        description=model.description,
        author=model.author,
        version=model.version,
        license=model.license,
        generationTool=f"vibroimpact {model.version}",
        variableNamingConvention="flat",
        numberOfEventIndicators="0",
    )
    ET.SubElement(root, "CoSimulation", modelIdentifier=model.name, **cosimulation)
    add_units(root, model)
    categories = ET.SubElement(root, "LogCategories")
    for name, description in LOG_CATEGORIES.items():
        ET.SubElement(categories, "Category", name=name, description=description)
    ET.SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime=number(model.stop_time),
        stepSize=number(model.step_size),
    )
    variables = ET.SubElement(root, "ModelVariables")
    for variable in model.variables:
        add_variable(variables, variable)
    add_structure(root, model)
    ET.indent(root)
    return ET.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def fmi2_native_xml(model, guid):
    """The model description of the native form."""
    return fmi2_xml(model, guid, NATIVE_COSIMULATION)


def add_units(root, model):
    """Definitions of the units in use."""
    definitions = ET.SubElement(root, "UnitDefinitions")
    used = {variable.unit for variable in model.variables} | {"s"}  # of time
    for name, exponents in UNITS.items():
        if name in used:
            unit = ET.SubElement(definitions, "Unit", name=name)
            ET.SubElement(unit, "BaseUnit", {key: str(value) for key, value in exponents.items()})


def add_variable(parent, variable):
    """One ScalarVariable."""
    attributes = {
        "name": variable.name,
        "valueReference": str(variable.slot),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.initial:
        attributes["initial"] = variable.initial
    scalar = ET.SubElement(parent, "ScalarVariable", attributes)
    typed = ET.SubElement(scalar, variable.type)
    if variable.type == REAL:
        typed.set("unit", variable.unit)
        for key, value in (("min", variable.minimum), ("max", variable.maximum)):
            if value is not None:
                typed.set(key, number(value))
        typed.set("nominal", number(variable.nominal))
    for key, value in (("min", variable.minimum), ("max", variable.maximum)):
        if value is not None and variable.type == INTEGER:
            typed.set(key, str(int(value)))
    if not variable.calculated:
        typed.set("start", start_text(variable))


def start_text(variable):
    """A start value as XML writes it."""
    if variable.type == BOOLEAN:
        return str(bool(variable.start)).lower()
    return number(variable.start) if variable.type == REAL else str(int(variable.start))


def add_structure(root, model):
    """Dependencies: outputs belong to the last communication point, so few depend on an input as it
    is set now.
    """
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
                ET.SubElement(
                    parent,
                    "Unknown",
                    index=index[variable.name],
                    dependencies=" ".join(map(str, known)),
                )
