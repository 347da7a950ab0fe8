"""Files of an FMU by other standards than FMI's core: terminals and icon, licences, FMI-LS-REF.

Terminals and icons are FMI 3.0's, section 2.4.9, which FMI 2.0.5 takes over. FMI-LS-REF (a draft,
1.0.0-alpha.1) says which files are there to check a run against.
"""

from __future__ import annotations

from xml.etree import ElementTree as ET

from ..runtime.table import Model
from .description_common import xml_bytes
from .sources import ROOT, Files

MANIFEST = "http://fmi-standard.org/fmi-ls-manifest"
REFERENCES = "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml"
LS_REF = {
    "fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
    "fmi-ls-version": "1.0.0-alpha.1",
    "fmi-ls-description": "Layered Standard providing information on related files included in "
    "an FMU.",
}
RELATED = (  # file, type, role, description
    ("reference/{name}_in.csv", "text/csv", "testcase", "Inputs of the reference run"),
    ("reference/{name}_ref.csv", "text/csv", "result", "Outputs of the reference run"),
    ("reference/{name}_ref.opt", "text/plain", "testcase", "Times and steps of the reference run"),
    ("index.html", "text/html", "document", "Equations, variables, and how to use the FMU"),
)


def companion_files(model: Model) -> Files:
    licence = (ROOT / "models" / "license.txt").read_bytes()
    return {
        "terminalsAndIcons/terminalsAndIcons.xml": terminals_xml(model),
        "documentation/licenses/license.txt": licence,
        REFERENCES: references_manifest(model),
    }


def icon_path(version: str) -> str:
    return "terminalsAndIcons/icon.png" if version == "fmi3" else "model.png"


def terminals_xml(model: Model) -> bytes:
    root = ET.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    parent = ET.SubElement(root, "Terminals")
    for terminal in model.terminals:
        attributes = {"name": terminal.name, "matchingRule": "bus"}
        element = ET.SubElement(parent, "Terminal", attributes, description=terminal.description)
        for member, variable in terminal.members.items():
            named = {"variableName": variable, "memberName": member, "variableKind": "signal"}
            ET.SubElement(element, "TerminalMemberVariable", named)
    return xml_bytes(root)


def references_manifest(model: Model) -> bytes:
    ET.register_namespace("fmi-ls", MANIFEST)
    root = ET.Element("fmiReferences", {f"{{{MANIFEST}}}{k}": v for k, v in LS_REF.items()})
    for place, kind, role, description in RELATED:
        source = f"../../documentation/{place.format(name=model.name)}"
        attributes = {"type": kind, "source": source, "role": role, "description": description}
        ET.SubElement(root, "Related", attributes)
    return xml_bytes(root)
