"""The coupled system as an SSP 1.0 package: two FMUs, their connections, and a parameter set, for other tools.

What a tool makes of it depends on its master. Most hold inputs constant over a fixed step (Jacobi, see :mod:`.coupling`): negative damping,
and the step has to be very short.
"""

import zipfile
from pathlib import Path
from xml.etree import ElementTree as ET

from .exchange import OSCILLATOR, OSCILLATOR_INPUTS, SHAKER

NAMESPACES = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
}
COMPONENTS = {"oscillator": OSCILLATOR, "shaker": SHAKER}
INPUTS = (("oscillator", OSCILLATOR_INPUTS[0]), ("oscillator", OSCILLATOR_INPUTS[1]), ("shaker", "box_force"), ("shaker", "voltage"))
OUTPUTS = (
    *(("oscillator", name) for name in ("box_force", "x1", "x2", "x_rel", "impact_energy")),
    *(("shaker", name) for name in ("box_acceleration", "box_jerk", "box_position", "speed", "angle", "motor_energy")),
)
CONNECTIONS = (
    ("oscillator", "box_force", "shaker", "box_force"),
    ("shaker", "box_acceleration", "oscillator", "box_acceleration"),
    ("shaker", "box_jerk", "oscillator", "box_jerk"),
)
VALUES = "resources/parameters.ssv"


def tag(prefix, name):
    """A qualified name."""
    return f"{{{NAMESPACES[prefix]}}}{name}"


def document(root):
    """An XML document, as bytes."""
    for prefix, address in NAMESPACES.items():
        ET.register_namespace(prefix, address)
    ET.indent(root)
    return ET.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def connectors(parent, ports):
    """Connectors of a component: pairs of kind and name."""
    group = ET.SubElement(parent, tag("ssd", "Connectors"))
    for kind, name in ports:
        ET.SubElement(ET.SubElement(group, tag("ssd", "Connector"), name=name, kind=kind), tag("ssc", "Real"))


def structure(setup):
    """``SystemStructure.ssd``, as bytes."""
    root = ET.Element(tag("ssd", "SystemStructureDescription"), name="WeakDrive", version="1.0")
    system = ET.SubElement(root, tag("ssd", "System"), name="WeakDrive", description=f"Motor, box and structure: parameter set {setup.name}")
    connectors(system, [("input", "voltage"), ("output", "speed"), ("output", "x1")])
    bindings = ET.SubElement(system, tag("ssd", "ParameterBindings"))
    ET.SubElement(bindings, tag("ssd", "ParameterBinding"), source=VALUES)
    elements = ET.SubElement(system, tag("ssd", "Elements"))
    for name, model in COMPONENTS.items():
        component = ET.SubElement(
            elements, tag("ssd", "Component"), name=name, type="application/x-fmu-sharedlibrary", source=f"resources/{model}.fmu"
        )
        ports = [("input", port) for owner, port in INPUTS if owner == name] + [("output", port) for owner, port in OUTPUTS if owner == name]
        connectors(component, ports)
    links = ET.SubElement(system, tag("ssd", "Connections"))
    for start, port, end, other in CONNECTIONS:
        ET.SubElement(links, tag("ssd", "Connection"), startElement=start, startConnector=port, endElement=end, endConnector=other)
    ET.SubElement(links, tag("ssd", "Connection"), startConnector="voltage", endElement="shaker", endConnector="voltage")
    for owner, port in (("shaker", "speed"), ("oscillator", "x1")):
        ET.SubElement(links, tag("ssd", "Connection"), startElement=owner, startConnector=port, endConnector=port)
    stop = 100.0 / setup.omega
    ET.SubElement(root, tag("ssd", "DefaultExperiment"), startTime="0.0", stopTime=repr(stop))
    return document(root)


def values(setup, eta0, speed):
    """``parameters.ssv``: both FMUs' parameters, voltage and speed at the start."""
    root = ET.Element(tag("ssv", "ParameterSet"), version="1.0", name=setup.name)
    group = ET.SubElement(root, tag("ssv", "Parameters"))
    given = {
        "oscillator": setup.oscillator(),
        "shaker": {**setup.shaker(), "speed_start": speed * setup.omega, "voltage": eta0 * setup.volts},
    }
    for component, numbers in given.items():
        for name, value in numbers.items():
            parameter = ET.SubElement(group, tag("ssv", "Parameter"), name=f"{component}.{name}")
            if isinstance(value, bool):
                ET.SubElement(parameter, tag("ssv", "Boolean"), value=str(value).lower())
            else:
                ET.SubElement(parameter, tag("ssv", "Real"), value=repr(float(value)))
    return document(root)


def write(path, setup, fmus, eta0, speed=1.0):
    """Write the package.

    Parameters
    ----------
    path : path-like
    setup : Setup
    fmus : (path-like, path-like)
        Oscillator and shaker.
    eta0, speed : float
        Voltage and speed at the start, non-dimensional.

    Returns
    -------
    Path
    """
    files = {"SystemStructure.ssd": structure(setup), VALUES: values(setup, eta0, speed)}
    for model, fmu in zip(COMPONENTS.values(), fmus, strict=True):
        files[f"resources/{model}.fmu"] = Path(fmu).read_bytes()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content)
    return Path(path)
