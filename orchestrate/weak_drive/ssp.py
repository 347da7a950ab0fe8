"""Write the coupled system as an SSP package, for simulation in other tools.

What all tools read alike was found by trying: parameter bindings of the components, none of the
system; connections between components only; no connector for the voltage, which some tools would
set to 0 where nothing is connected to it; a Boolean only where it is true, since FMPy takes any
other for true as well. Importers of SSP 1.0 need not read 2.0, whose types are those of FMI 3.0.
Neither has terminals: those stand only in the FMUs.

A sign and a unit are a connection's linear transformation, in place of the tool's own conversion.

What a tool makes of it depends on its master. Most hold inputs constant over a fixed step
(Jacobi): negative damping, and the step has to be very short. OMSimulator reads the step
from an annotation of its own, without which its C interface cannot load a package.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from os import PathLike
from pathlib import Path
from typing import Literal
from xml.etree import ElementTree as ET

from ..errors import InputError
from ..files import write_atomically
from ..fmu.description import Description, describe
from ..fmu.models import ELECTRODYNAMIC_SHAKER, MOTOR_SHAKER, OSCILLATOR
from ..model.arguments import checked_mapping
from ..model.drive import Drive
from ..model.ranges import checked_range
from ..model.shaker import Shaker
from ..model.structure import Structure
from ..response.questions import checked_structure
from .connection import FORCE, MOTION, PUSHES, Link, checked_links, checked_units
from .cosimulate import checked_parameters
from .run import oscillator_start_values

NAMESPACES = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
}
OSCILLATES = ("box_force", "x1", "x2", "x_rel", "impact_energy")  # outputs
MOTOR_GIVES = ("box_acceleration", "box_jerk", "box_position", "speed", "angle", "motor_energy")
SET = "initialValues"  # some tools apply sets by their name: the same for both components
Values = Mapping[str, float | bool]


@dataclass(frozen=True)
class Component:
    """One FMU of the package: its file, what is connected or shown of it, its start values."""

    path: Path
    fmu: Description
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    values: Values

    def unit(self, port: str) -> str:
        """Return the unit of an input or output that the FMU defines; empty without one."""
        name = str(self.fmu.variable(port).unit or "")
        return name if name in self.fmu.units else ""


Components = Mapping[str, Component]  # "oscillator" and "shaker"
Names = Mapping[str, str]  # the shaker's variables by the oscillator's
Links = Mapping[str, Link]
REAL = {"1.0": "Real", "2.0": "Float64"}  # types, by the version of SSP


def add_element(parent: ET.Element, tag: str, **attributes: str) -> ET.Element:
    return ET.SubElement(parent, qualified_tag(tag), attributes)


def qualified_tag(tag: str) -> str:
    prefix, _, name = tag.partition(":")
    return f"{{{NAMESPACES[prefix]}}}{name}"


def xml_bytes(root: ET.Element) -> bytes:
    for prefix, address in NAMESPACES.items():
        ET.register_namespace(prefix, address)
    ET.indent(root)
    text: bytes = ET.tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"


def add_units(root: ET.Element, components: Components) -> None:
    parent = add_element(root, "ssd:Units")
    each = [(c, c.unit(p)) for c in components.values() for p in (*c.inputs, *c.outputs)]
    used = {unit: one.fmu.units[unit] for one, unit in each if unit}
    for name, unit in sorted(used.items()):
        powers = {base: str(power) for base, power in unit.exponents.items()}
        if unit.factor != 1.0:
            powers["factor"] = repr(unit.factor)
        add_element(add_element(parent, "ssc:Unit", name=name), "ssc:BaseUnit", **powers)


def add_component(elements: ET.Element, name: str, one: Component, version: str) -> None:
    file = {"type": "application/x-fmu-sharedlibrary", "source": f"resources/{one.path.name}"}
    component = add_element(elements, "ssd:Component", name=name, **file)
    connectors = add_element(component, "ssd:Connectors")
    for kind, ports in (("input", one.inputs), ("output", one.outputs)):
        for port in ports:
            connector = add_element(connectors, "ssd:Connector", name=port, kind=kind)
            unit = {"unit": one.unit(port)} if one.unit(port) else {}
            add_element(connector, f"ssc:{REAL[version]}", **unit)
    bindings = add_element(component, "ssd:ParameterBindings")
    add_element(bindings, "ssd:ParameterBinding", source=parameter_file_path(name))


def parameter_file_path(component: str) -> str:
    return f"resources/{component}.ssv"


def add_master_annotation(system: ET.Element, step: float) -> None:
    """Add OMSimulator's annotation with the fixed step of its master."""
    # its C interface reads oms:FixedStepMaster, its Python interface oms:SimulationInformation
    length = format(Decimal(repr(step)), "f")  # its schema takes no exponent
    annotations = add_element(system, "ssd:Annotations")
    annotation = add_element(annotations, "ssc:Annotation", type="org.openmodelica")
    method = {"name": "oms_ma_default", "method": "oms_ma", "fixedStepSize": length}
    information = add_element(
        add_element(annotation, "oms:Annotations"), "oms:SimulationInformation", **method
    )
    master = {"description": "oms-ma", "stepSize": length, "relativeTolerance": "0.0001"}
    add_element(information, "oms:FixedStepMaster", **master)


def add_connection(connections: ET.Element, ours: str, link: Link, from_oscillator: bool) -> None:
    """Add a connection from the oscillator, or to it."""
    ends = [("oscillator", ours), ("shaker", link.theirs)]
    (start, output), (end, taken) = ends if from_oscillator else reversed(ends)
    places = {"startElement": start, "startConnector": output}
    places |= {"endElement": end, "endConnector": taken}
    factor = 1.0 / link.scale if from_oscillator else link.scale
    if factor != 1.0:
        places["suppressUnitConversion"] = "true"
    connection = add_element(connections, "ssd:Connection", **places)
    if factor != 1.0:
        add_element(connection, "ssc:LinearTransformation", factor=repr(factor), offset="0.0")


def system_description_xml(
    description: str, times: tuple[float, float], components: Components, links: Links, version: str
) -> bytes:
    stop_time, step = times
    named = {"name": "WeakDrive", "version": version}
    root = ET.Element(qualified_tag("ssd:SystemStructureDescription"), named)
    system = add_element(root, "ssd:System", name="WeakDrive", description=description)
    elements = add_element(system, "ssd:Elements")
    for name, one in components.items():
        add_component(elements, name, one, version)
    connections = add_element(system, "ssd:Connections")
    for ours, link in links.items():
        add_connection(connections, ours, link, ours in OSCILLATES)
    add_master_annotation(system, step)
    add_units(root, components)
    add_element(root, "ssd:DefaultExperiment", startTime="0.0", stopTime=repr(stop_time))
    return xml_bytes(root)


def parameter_set_xml(values: Values, version: str) -> bytes:
    """Build the XML file of a component's parameters; false ones are left out."""
    root = ET.Element(qualified_tag("ssv:ParameterSet"), version=version, name=SET)
    group = add_element(root, "ssv:Parameters")
    for variable, value in values.items():
        if value is not False:
            kind = "Boolean" if value is True else REAL[version]
            text = "true" if value is True else repr(float(value))
            add_element(
                add_element(group, "ssv:Parameter", name=variable), f"ssv:{kind}", value=text
            )
    return xml_bytes(root)


def write_archive(path: Path, files: Mapping[str, bytes]) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)


def write_ssp(
    path: str | PathLike[str],
    structure: Structure,
    drive: Drive | Shaker | str | PathLike[str],
    *,
    voltage: float | None = None,
    connect: Names | None = None,
    units: Names | None = None,
    parameters: Values | None = None,
    speed_start: float | None = None,
    stop_time: float | None = None,
    step: float | None = None,
    fmus: Sequence[str | PathLike[str]] | None = None,
    version: Literal["1.0", "2.0"] = "1.0",
) -> Path:
    """Write the coupled system of a structure and a drive as an SSP package.

    Parameters
    ----------
    path : path-like
        Such as ``weak_drive.ssp``.
    structure : Structure
        Bonded or delaminated, as it is; the package says which.
    drive : Drive, Shaker or path-like
        Or anybody's FMU, of FMI 2.0 for most tools.
    voltage : float
        Of a motor, V.
    connect, units : mapping of str to str, optional
        The drive's names by ``box_acceleration`` and ``box_force``, or ``force1`` and ``force2`` of
        the halves, and units, as for :func:`orchestrate.cosimulate`. Another sign or unit is a
        linear transformation of the connection, which FMPy and others do not apply. Velocity and
        position are shown, not connected.
    parameters : mapping of str to float, optional
        Start values of other drives, of their inputs too.
    speed_start : float, optional
        Of the motor, rad/s; by default its no-load speed.
    stop_time : float, optional
        Of the default experiment, s; 100/omega by default.
    step : float, optional
        Communication step that OMSimulator takes, s; 0.001/omega by default. Other tools have no
        place for one in a package.
    fmus : sequence of path-like, optional
        Of structure and drive; by default those of FMI 2.0, which most tools read.
    version : {"1.0", "2.0"}
        Of SSP; tools that read 1.0 need not read 2.0.

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
    if version not in REAL:
        raise InputError(f"version = {version!r}: expected {' or '.join(map(repr, REAL))}")
    checked_structure(structure)
    stop = 100.0 / structure.omega if stop_time is None else stop_time
    checked_range("stop_time", stop, "s", low=0.0)
    length = 1e-3 / structure.omega if step is None else step
    checked_range("step", length, "s", low=0.0, open_low=True)
    own, other = (Path(fmu) for fmu in fmus) if fmus else (None, None)
    if isinstance(drive, Drive):
        shaker, links, text = motor_component(drive, other, voltage, speed_start)
    else:
        shaker, links = drive_component(drive, other, connect, units, parameters)
        text = shaker.fmu.name
    state = "bonded (undamaged)" if structure.bonded else "delaminated"
    path_of_own = own or default_fmu_path(OSCILLATOR)
    inputs = tuple(name for name in links if name not in OSCILLATES)
    start = oscillator_start_values(structure)
    oscillator = Component(path_of_own, describe(path_of_own), inputs, OSCILLATES, start)
    components = {"oscillator": oscillator, "shaker": shaker}
    text = f"{text} with a {state} structure"
    times = float(stop), float(length)
    system = system_description_xml(text, times, components, links, version)
    files = {"SystemStructure.ssd": system}
    for name, one in components.items():
        files[parameter_file_path(name)] = parameter_set_xml(one.values, version)
    files |= {f"resources/{one.path.name}": one.path.read_bytes() for one in components.values()}
    return write_atomically(path, lambda temporary: write_archive(temporary, files))


def default_fmu_path(model: str) -> Path:
    from ..fmu.exported import find_or_export

    return find_or_export(model, "fmi2").path


def motor_component(
    drive: Drive, fmu: Path | None, voltage: float | None, speed: float | None
) -> tuple[Component, Links, str]:
    """Return the motor's component, its connections, and a text that describes it."""
    if voltage is None:
        raise InputError("voltage: expected with a motor, in V")
    checked_range("voltage", voltage, "V")
    speed = voltage / drive.motor_constant if speed is None else speed
    checked_range("speed_start", speed, "rad/s")
    path = fmu or default_fmu_path(MOTOR_SHAKER)
    values = {**drive.parameters(), "speed_start": speed, "voltage": voltage}
    links = {name: Link(name, 1.0) for name in ("box_force", "box_acceleration", "box_jerk")}
    component = Component(path, describe(path), ("box_force",), MOTOR_GIVES, values)
    return component, links, f"Motor and box at {voltage:g} V"


def drive_component(
    drive: Shaker | str | PathLike[str],
    fmu: Path | None,
    connect: Names | None,
    units: Names | None,
    parameters: Values | None,
) -> tuple[Component, Links]:
    """Return another drive's component and connections; raise where tools could not have them."""
    values = checked_mapping("parameters", parameters)
    connect = checked_mapping("connect", connect) if connect is not None else None
    units = checked_mapping("units", units)
    if isinstance(drive, Shaker):
        path = fmu or default_fmu_path(ELECTRODYNAMIC_SHAKER)
        values = {**drive.parameters(), **values}
    else:
        path = Path(drive)
    description, exchanged = describe(path), ("box_force", "box_acceleration")
    if connect is None and isinstance(drive, Shaker):
        connect = {name: name for name in exchanged}
    links = checked_links(connect or {}, description, checked_units(units, description))
    taken = [name for name in links if name in FORCE[1:]]
    if taken or ("box_force" in links and "box_acceleration" not in links):
        raise InputError(
            f"connect: {', '.join(links)}; expected box_force and box_acceleration, with or "
            "without velocity and position: what tools exchange is these two, and force1, force2"
        )
    start = dict(checked_parameters(values, description))
    shown = tuple(link.theirs for name, link in links.items() if name in (*MOTION, *PUSHES))
    taken = [link.theirs for name, link in links.items() if name in FORCE]
    component = Component(path.resolve(), description, (*taken,), shown, start)
    return component, {name: links[name] for name in (*exchanged, *PUSHES) if name in links}
