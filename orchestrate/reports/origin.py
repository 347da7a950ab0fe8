"""Report section on the results' origin: calls, FMUs, versions and identities."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

from .page import Section, Table

if TYPE_CHECKING:
    import xarray as xr

PACKAGES = ("numpy", "scipy", "xarray", "fmpy", "lmfit", "matplotlib")
BY_RECORD = ("detect", "fit")  # their question is the record, which has a digest
LONGEST = 160  # letters of an attribute


def origin_section(answers: Sequence[xr.Dataset]) -> Section:
    """Return a section with versions and identities of all results of a page."""
    rows: list[tuple[str, str]] = []
    for number, answer in enumerate(answers, 1):
        begin = f"{number}. " if len(answers) > 1 else ""
        rows += [(begin + name, text) for name, text in describe_origin(answer)]
    versions = ", ".join(
        f"{name} {found}" for name in PACKAGES if (found := installed_version(name))
    )
    rows.append(("versions", f"Python {platform.python_version()}, {versions}"))
    return Section("Where it comes from", tables=[Table(("what", "value"), rows)])


def describe_origin(answer: xr.Dataset) -> list[tuple[str, str]]:
    """Return pairs of a name and a text on a result's origin, from its attributes."""
    attributes = {str(name): str(text) for name, text in answer.attrs.items()}
    shown = [
        ("title", "title"),
        ("record_file", "record"),
        ("record_sha256", "SHA-256 of the record"),
        ("guess_file", "guess"),
        ("sensors", "sensors"),
        ("source", "computed by"),
    ]
    rows = [(label, shorten(attributes[name])) for name, label in shown if attributes.get(name)]
    if "history" in attributes:
        rows.append(("computed on", attributes["history"].partition(": ")[0]))
    if "call" in attributes and attributes.get("analysis") not in BY_RECORD:
        rows.append(("what was asked", shorten(attributes["call"])))
    for name in sorted(attributes):
        if name.startswith("fmu_guid"):
            model = attributes.get(name.replace("guid", "model"), "")
            rows.append((f"FMU {model}".rstrip(), attributes[name]))
    if "identity" in attributes:
        digest = hashlib.sha256(attributes["identity"].encode()).hexdigest()[:16]
        rows.append(("identity of question, FMU and code", digest))
    return rows


def shorten(text: str) -> str:
    """Return a text shortened to a length that fits the page."""
    return text if len(text) <= LONGEST else f"{text[:LONGEST]} ..."


def installed_version(name: str) -> str:
    """Return a package's installed version; empty if it is not installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
