"""``modelDescription.xml`` of FMI 3.0 from a variable table."""

from xml.etree import ElementTree as ET

from ..runtime.table import BOOLEAN, INTEGER, REAL
from .model_description import LOG_CATEGORIES, add_units, number, start_text

TYPES = {REAL: "Float64", INTEGER: "Int32", BOOLEAN: "Boolean"}
ARRAY_BASE = 1000  # value references of arrays begin here
CLOCK_REFERENCE = 2000
COSIMULATION = {
    "canHandleVariableCommunicationStepSize": "true",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "maxOutputDerivativeOrder": "1",
}
EVENT_MODE = {"hasEventMode": "true"}  # of models with a clock


def fmi3_xml(model, token):
    """The model description, as bytes that depend on nothing but the arguments.

    Parameters
    ----------
    model : Model
    token : str
        Instantiation token.

    Returns
    -------
    bytes
    """
    root = ET.Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=model.name,
        instantiationToken=token,
        description=model.description,
        author=model.author,
        version=model.version,
        license=model.license,
        generationTool=f"vibroimpact {model.version}",
        variableNamingConvention="flat",
    )
    ET.SubElement(
        root,
        "CoSimulation",
        {"modelIdentifier": model.name, **COSIMULATION, **(EVENT_MODE if model.clock else {})},
    )
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
    time = {
        "name": "time",
        "valueReference": str(model.time_slot),
        "description": "Time",
        "causality": "independent",
    }
    ET.SubElement(variables, "Float64", {**time, "variability": "continuous", "unit": "s"})
    for variable in model.variables:
        if not variable.series:
            add_variable(variables, variable)
    for i, array in enumerate(model.arrays):
        add_array(variables, model, array, ARRAY_BASE + i)
    if model.clock:
        clock = {
            "name": model.clock.name,
            "valueReference": str(CLOCK_REFERENCE),
            "description": model.clock.description,
            "causality": "output",
        }
        ET.SubElement(variables, "Clock", clock, intervalVariability="triggered")
    add_structure(root, model)
    ET.indent(root)
    return ET.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def attributes_of(variable, reference):
    """Attributes every variable has."""
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.initial:
        attributes["initial"] = variable.initial
    return attributes


def add_variable(parent, variable):
    """One scalar variable."""
    typed = ET.SubElement(parent, TYPES[variable.type], attributes_of(variable, variable.slot))
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


def elements(model, array):
    """The variables an array is made of."""
    first = next(i for i, variable in enumerate(model.variables) if variable.name == array.first)
    return model.variables[first : first + array.size]


def add_array(parent, model, array, reference):
    """One array output."""
    scalar = elements(model, array)[0]
    attributes = {
        **attributes_of(scalar, reference),
        "name": array.name,
        "description": array.description,
        "unit": scalar.unit,
    }
    typed = ET.SubElement(parent, "Float64", attributes)
    ET.SubElement(typed, "Dimension", start=str(array.size))


def add_structure(root, model):
    """Dependencies: outputs belong to the last communication point, so few depend on an input as it
    is set now.
    """
    structure = ET.SubElement(root, "ModelStructure")
    calculated = [(v.slot, [v]) for v in model.variables if v.causality == "output"]
    arrays = [(ARRAY_BASE + i, elements(model, array)) for i, array in enumerate(model.arrays)]
    calculated += [
        (reference, members) for reference, members in arrays if members[0].causality == "output"
    ]
    if model.clock:
        calculated.append((CLOCK_REFERENCE, []))
    for kind, attribute in (("Output", "dependencies"), ("InitialUnknown", "initial_dependencies")):
        for reference, members in calculated:
            names = {name for variable in members for name in getattr(variable, attribute)}
            known = sorted(v.slot for v in model.variables if v.name in names)
            ET.SubElement(
                structure,
                kind,
                valueReference=str(reference),
                dependencies=" ".join(map(str, known)),
            )
