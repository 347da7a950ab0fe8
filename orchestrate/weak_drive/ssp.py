"""Write the coupled system as an SSP 1.0 package, for simulation in other tools.

What all tools read alike was found by trying: parameter bindings of the components, none of the
system; connections between components only; no connector for the voltage, which some tools would
set to 0 where nothing is connected to it; a Boolean only where it is true, since FMPy takes any
other for true as well.

What a tool makes of it depends on its master. Most hold inputs constant over a fixed step
(Jacobi): negative damping, and the step has to be very short. OMSimulator reads the step
from an annotation of its own, without which its C interface cannot load a package.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping, Sequence
from decimal import Decimal
from os import PathLike
from pathlib import Path
from xml.etree import ElementTree as ET

from ..files import write_whole
from ..fmu.description import Description, describe
from ..fmu.models import OSCILLATOR, SHAKER
from ..model.drive import Drive
from ..model.structure import Structure
from .run import oscillator_start
from .schedule import check

NAMESPACES = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
}
MODELS = {"oscillator": OSCILLATOR, "shaker": SHAKER}
INPUTS = {"oscillator": ("box_acceleration", "box_jerk"), "shaker": ("box_force",)}
OUTPUTS = {
    "oscillator": ("box_force", "x1", "x2", "x_rel", "impact_energy"),
    "shaker": ("box_acceleration", "box_jerk", "box_position", "speed", "angle", "motor_energy"),
}
CONNECTIONS = (
    ("oscillator", "shaker", "box_force"),
    ("shaker", "oscillator", "box_acceleration"),
    ("shaker", "oscillator", "box_jerk"),
)
SET = "initialValues"  # some tools apply sets by their name: the same for both components
Values = Mapping[str, float | bool]


def qualified_tag(prefix: str, name: str) -> str:
    """Return an XML tag with its namespace."""
    return f"{{{NAMESPACES[prefix]}}}{name}"


def xml_bytes(root: ET.Element) -> bytes:
    """Convert an XML element to the bytes of an XML file."""
    for prefix, address in NAMESPACES.items():
        ET.register_namespace(prefix, address)
    ET.indent(root)
    text: bytes = ET.tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"


def parameter_file_path(component: str) -> str:
    """Return the path of a component's parameter file inside the package."""
    return f"resources/{component}.ssv"


def connector_units(fmus: Mapping[str, Description], name: str) -> list[str]:
    """Return the units of a component's inputs and outputs, from its FMU."""
    ports = (*INPUTS[name], *OUTPUTS[name])
    return [str(fmus[name].variable(port).unit) for port in ports]


def add_units(root: ET.Element, fmus: Mapping[str, Description]) -> None:
    """Add the definitions of all used units to the XML document."""
    parent = ET.SubElement(root, qualified_tag("ssd", "Units"))
    used = {unit: fmus[name].units[unit] for name in MODELS for unit in connector_units(fmus, name)}
    for unit, powers in sorted(used.items()):
        element = ET.SubElement(parent, qualified_tag("ssc", "Unit"), name=unit)
        ET.SubElement(
            element, qualified_tag("ssc", "BaseUnit"), {k: str(v) for k, v in powers.items()}
        )


def add_component(elements: ET.Element, name: str, units: Sequence[str]) -> None:
    """Add one FMU with its connectors and parameter file to the XML document."""
    source, kind = f"resources/{MODELS[name]}.fmu", "application/x-fmu-sharedlibrary"
    component = ET.SubElement(
        elements, qualified_tag("ssd", "Component"), name=name, type=kind, source=source
    )
    connectors = ET.SubElement(component, qualified_tag("ssd", "Connectors"))
    ports = [("input", port) for port in INPUTS[name]] + [
        ("output", port) for port in OUTPUTS[name]
    ]
    for (kind, port), unit in zip(ports, units, strict=True):
        connector = ET.SubElement(
            connectors, qualified_tag("ssd", "Connector"), name=port, kind=kind
        )
        ET.SubElement(connector, qualified_tag("ssc", "Real"), unit=unit)
    bindings = ET.SubElement(component, qualified_tag("ssd", "ParameterBindings"))
    ET.SubElement(
        bindings, qualified_tag("ssd", "ParameterBinding"), source=parameter_file_path(name)
    )


def add_master(system: ET.Element, step: float) -> None:
    """Add OMSimulator's annotation with the fixed step of its master."""
    # its C interface reads oms:FixedStepMaster, its Python interface oms:SimulationInformation
    length = format(Decimal(repr(step)), "f")  # its schema takes no exponent
    annotations = ET.SubElement(system, qualified_tag("ssd", "Annotations"))
    annotation = ET.SubElement(
        annotations, qualified_tag("ssc", "Annotation"), type="org.openmodelica"
    )
    information = ET.SubElement(
        ET.SubElement(annotation, qualified_tag("oms", "Annotations")),
        qualified_tag("oms", "SimulationInformation"),
        {"name": "oms_ma_default", "method": "oms_ma", "fixedStepSize": length},
    )
    ET.SubElement(
        information,
        qualified_tag("oms", "FixedStepMaster"),
        {"description": "oms-ma", "stepSize": length, "relativeTolerance": "0.0001"},
    )


def system_description(
    description: str, stop_time: float, step: float, fmus: Mapping[str, Description]
) -> bytes:
    """Build the XML file that describes both FMUs and their connections."""
    root = ET.Element(
        qualified_tag("ssd", "SystemStructureDescription"), name="WeakDrive", version="1.0"
    )
    system = ET.SubElement(
        root, qualified_tag("ssd", "System"), name="WeakDrive", description=description
    )
    elements = ET.SubElement(system, qualified_tag("ssd", "Elements"))
    for name in MODELS:
        add_component(elements, name, connector_units(fmus, name))
    links = ET.SubElement(system, qualified_tag("ssd", "Connections"))
    for start, end, port in CONNECTIONS:
        places = {
            "startElement": start,
            "startConnector": port,
            "endElement": end,
            "endConnector": port,
        }
        ET.SubElement(links, qualified_tag("ssd", "Connection"), places)
    add_master(system, step)
    add_units(root, fmus)
    ET.SubElement(
        root, qualified_tag("ssd", "DefaultExperiment"), startTime="0.0", stopTime=repr(stop_time)
    )
    return xml_bytes(root)


def parameter_values(values: Values) -> bytes:
    """Build the XML file of a component's parameters; false ones are left out."""
    root = ET.Element(qualified_tag("ssv", "ParameterSet"), version="1.0", name=SET)
    group = ET.SubElement(root, qualified_tag("ssv", "Parameters"))
    for variable, value in values.items():
        if value is False:
            continue
        parameter = ET.SubElement(group, qualified_tag("ssv", "Parameter"), name=variable)
        if value is True:
            ET.SubElement(parameter, qualified_tag("ssv", "Boolean"), value="true")
        else:
            ET.SubElement(parameter, qualified_tag("ssv", "Real"), value=repr(float(value)))
    return xml_bytes(root)


def write_archive(path: Path, files: Mapping[str, bytes]) -> None:
    """Write files into a zip archive, reproducible to the byte."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)


def write_ssp(
    path: str | PathLike[str],
    structure: Structure,
    drive: Drive,
    *,
    voltage: float,
    speed_start: float | None = None,
    stop_time: float | None = None,
    step: float | None = None,
    fmus: Sequence[str | PathLike[str]] | None = None,
) -> Path:
    """Write the coupled system of a structure and a drive as an SSP package.

    Parameters
    ----------
    path : path-like
        Such as ``weak_drive.ssp``.
    structure : Structure
        Bonded or delaminated, as it is; the package says which.
    drive : Drive
    voltage : float
        V.
    speed_start : float, optional
        Of the motor, rad/s; by default its no-load speed.
    stop_time : float, optional
        Of the default experiment, s; 100/omega by default.
    step : float, optional
        Communication step that OMSimulator takes, s; 0.001/omega by default. Other tools have no
        place for one in a package.
    fmus : sequence of path-like, optional
        Of structure and shaker; by default those of FMI 2.0, which most tools read.

    Returns
    -------
    Path

    Raises
    ------
    InputError
    StoreError
        Where the file cannot be written.

    Examples
    --------
    >>> import tempfile, zipfile
    >>> from pathlib import Path
    >>> from orchestrate import Drive, Structure
    >>> from orchestrate.weak_drive.ssp import write_ssp
    >>> structure, drive = Structure.from_file("quick"), Drive.from_file("quick")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = write_ssp(Path(folder) / "quick.ssp", structure, drive, voltage=1.5)
    ...     names = zipfile.ZipFile(path).namelist()
    >>> names[:3]
    ['SystemStructure.ssd', 'resources/oscillator.ssv', 'resources/shaker.ssv']
    """
    from ..fmu.exported import find

    check("voltage", voltage, "V")
    speed = voltage / drive.motor_constant if speed_start is None else speed_start
    check("speed_start", speed, "rad/s")
    stop = 100.0 / structure.omega if stop_time is None else stop_time
    check("stop_time", stop, "s", low=0.0)
    length = 1e-3 / structure.omega if step is None else step
    check("step", length, "s", low=0.0, exclusive=True)
    state = "bonded (undamaged)" if structure.bonded else "delaminated"
    starts: dict[str, Values] = {
        "oscillator": oscillator_start(structure),
        "shaker": {**drive.parameters(), "speed_start": speed, "voltage": voltage},
    }
    text = f"Motor and box with a {state} structure, at {voltage:g} V"
    paths = [Path(fmu) for fmu in fmus or (find(model, "fmi2").path for model in MODELS.values())]
    known = {name: describe(fmu) for name, fmu in zip(MODELS, paths, strict=True)}
    system = system_description(text, float(stop), float(length), known)
    files = {"SystemStructure.ssd": system}
    files |= {
        parameter_file_path(name): parameter_values(values) for name, values in starts.items()
    }
    for model, fmu in zip(MODELS.values(), paths, strict=True):
        files[f"resources/{model}.fmu"] = fmu.read_bytes()
    return write_whole(path, lambda temporary: write_archive(temporary, files))
