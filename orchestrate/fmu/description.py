"""Description of an FMU: its modelDescription.xml, read and validated."""

from __future__ import annotations

import dataclasses
import hashlib
import io
import re
import stat
import time
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

from ..errors import InputError
from .unit_names import Unit, parse_unit

MAX_FILES = 10_000  # far above any real FMU: an archive with more is an attack or an accident
MAX_BYTES = 1 << 30  # unpacked; the same
QUIET = 2.0  # s after a change of a file in which its times may not tell of another one
SI_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True)
class Description:
    """Content of an FMU's ``modelDescription.xml`` as used here: names, GUID, variables."""

    path: Path
    # the name of the model, its GUID or instantiation token, and `"2.0"` or `"3.0"`
    name: str
    guid: str
    fmi_version: str
    variables: Mapping[str, Any]  # by name
    needs_tool: bool = False  # whether it needs a tool of its own, such as a Python
    identifier: str = ""  # name of its binary for co-simulation; empty where it has none
    # by name, those that are defined by base units, or follow from their names
    units: Mapping[str, Unit] = field(default_factory=dict)
    has_fixed_step: bool = False  # whether all communication steps have to be of one length
    internal_step: float = 0.0  # s, of which communication steps are multiples; 0: not stated
    has_states: bool = False  # whether it can go back to a state (canGetAndSetFMUstate)
    saves_states: bool = False  # and give one as bytes (canSerializeFMUstate)
    runs_here: bool = True  # whether it has a binary for this machine
    digest: str = ""  # of the file's bytes

    @property
    def is_fmi3(self) -> bool:
        return self.fmi_version.startswith("3")

    def variable(self, name: str) -> Any:
        try:
            return self.variables[name]
        except KeyError:
            text = f"variable {name}: the FMU {self.name} has none of that name"
            raise InputError(f"{text}; expected a variable of its modelDescription.xml") from None


def describe(path: str | PathLike[str], model: str | None = None) -> Description:
    """Return an FMU's description; raise unless readable, and of the model if one is named."""
    path = Path(path)
    if not path.is_file():
        own = "`python -m orchestrate build` writes the project's own"
        raise InputError(f"FMU {path}: no such file; expected an FMU ({own})")
    try:
        description = read_description(path)
    except Exception as error:
        reason = " ".join(str(error).split("\n")[:2]) or type(error).__name__
        text = f"FMU {path}: not readable as an FMU ({reason})"
        raise InputError(f"{text}; expected a valid FMU of FMI 2.0 or 3.0") from None
    if not description.identifier or (model and description.name != model):
        expected = f"{model or 'a model'} for co-simulation"
        raise InputError(f"FMU {path}: model {description.name}; expected {expected}")
    return description


def describe_runnable(path: str | PathLike[str], model: str | None = None) -> Description:
    """Return an FMU's description; raise unless it has a binary for this machine, too."""
    description = describe(path, model)
    if not description.runs_here:
        raise InputError(f"FMU {path}: it has no binary for this machine; export it with one")
    return description


def units_of(xml: Any) -> dict[str, Unit]:
    """Return the units of FMPy's description: those without a base unit, by their names."""
    named = ((name, parse_unit(name)) for name in {v.unit for v in xml.modelVariables} if name)
    units = {name: unit for name, unit in named if unit is not None}
    for name, base in ((u.name, u.baseUnit) for u in xml.unitDefinitions if u.baseUnit):
        powers = {unit: power for unit in SI_UNITS if (power := int(getattr(base, unit)))}
        units[name] = Unit(powers, float(base.factor))
    return units


_known: dict[str, Description] = {}  # by digest: validation takes long
_digests: dict[tuple[float, ...], str] = {}  # by what changes with a file


def digest_of(path: Path) -> str:
    """Return the digest of a file's bytes, which are read again if the file may have changed."""
    now = path.stat()
    key = now.st_dev, now.st_ino, now.st_size, now.st_mtime_ns, now.st_ctime_ns
    digest = _digests.get(key) or hashlib.sha256(path.read_bytes()).hexdigest()
    if time.time() - max(now.st_mtime, now.st_ctime) > QUIET:
        _digests[key] = digest
    return digest


def checked_archive_names(data: bytes) -> list[str]:
    """Return the paths in an FMU's zip; raise if one is outside, or it is too large."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        entries = archive.infolist()
    if len(entries) > MAX_FILES:
        raise ValueError(f"{len(entries)} files in it, at most {MAX_FILES} expected")
    total = sum(entry.file_size for entry in entries)
    if total > MAX_BYTES:
        raise ValueError(f"{total} bytes unpacked, at most {MAX_BYTES} expected")
    names = [entry.orig_filename for entry in entries]
    if len(set(names)) < len(names):
        raise ValueError("two files of one name in it")
    for entry in entries:
        name = entry.orig_filename
        parts = name.removesuffix("/").split("/")
        plain = name.isprintable() and not re.search(r"[\\:]", name)
        if not plain or {"", ".", ".."} & set(parts):
            raise ValueError(f"{name!r} in it, expected paths below the archive")
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise ValueError(f"{name!r} in it is a link, expected files")
    return names


def read_description(path: Path) -> Description:
    """Parse and validate an FMU's ``modelDescription.xml``; cached by the file's digest."""
    size = path.stat().st_size
    if size > MAX_BYTES:  # packed, it is smaller than unpacked
        raise ValueError(f"{size} bytes, at most {MAX_BYTES} expected")
    digest = digest_of(path)
    if digest not in _known:
        import fmpy

        data = path.read_bytes()
        digest = hashlib.sha256(data).hexdigest()
        names = checked_archive_names(data)
        xml = fmpy.read_model_description(io.BytesIO(data))
        co_simulation = xml.coSimulation  # None of an FMU for model exchange alone
        identifier = getattr(co_simulation, "modelIdentifier", "")
        library = f"{identifier}{fmpy.sharedLibraryExtension}"
        here = {f"binaries/{one}/{library}" for one in (fmpy.platform, fmpy.platform_tuple)}
        if co_simulation and not re.fullmatch(r"[A-Za-z_]\w*", identifier, re.ASCII):
            expected = "expected letters, digits and _"
            raise ValueError(f"modelIdentifier {identifier[:100]!r}, {expected}")
        _known[digest] = Description(
            path=path,
            name=xml.modelName,
            guid=str(xml.guid),
            fmi_version=xml.fmiVersion,
            variables={v.name: v for v in xml.modelVariables},
            needs_tool=bool(getattr(co_simulation, "needsExecutionTool", False)),
            identifier=identifier,
            units=units_of(xml),
            has_fixed_step=not getattr(
                co_simulation, "canHandleVariableCommunicationStepSize", True
            ),
            internal_step=float(getattr(co_simulation, "fixedInternalStepSize", None) or 0.0),
            has_states=bool(getattr(co_simulation, "canGetAndSetFMUstate", False)),
            saves_states=bool(getattr(co_simulation, "canSerializeFMUstate", False)),
            runs_here=not here.isdisjoint(names),
            digest=digest,
        )
    return dataclasses.replace(_known[digest], path=path)
