"""What an FMU says of itself."""

from __future__ import annotations

import dataclasses
import hashlib
import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

from ..errors import InputError
from .archive import check_archive, check_identifier

SI = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True)
class Description:
    """What ``modelDescription.xml`` says of an FMU.

    Attributes
    ----------
    path : Path
    name, guid, fmi_version : str
        The name of the model, its GUID or instantiation token, and ``"2.0"`` or ``"3.0"``.
    variables : mapping of str to fmpy.model_description.ScalarVariable
        By name.
    needs_tool : bool
        Whether it needs a tool of its own, such as a Python.
    identifier : str
        Name of its binary for co-simulation; empty where it has none.
    units : mapping of str to mapping of str to int
        Exponents of SI units, by name of the unit; those that are not 0.
    digest : str
        Of the file's bytes.
    """

    path: Path
    name: str
    guid: str
    fmi_version: str
    variables: Mapping[str, Any]
    needs_tool: bool = False
    identifier: str = ""
    units: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    digest: str = ""

    @property
    def is_fmi3(self) -> bool:
        """Whether it is FMI 3.0, not 2.0."""
        return self.fmi_version.startswith("3")

    def variable(self, name: str) -> Any:
        """FMPy's description of a variable.

        Raises
        ------
        InputError
            Where there is none of that name.
        """
        try:
            return self.variables[name]
        except KeyError:
            text = f"variable {name}: the FMU {self.name} has none of that name"
            raise InputError(f"{text}; expected a variable of its modelDescription.xml") from None


def describe(path: str | PathLike[str], model: str | None = None) -> Description:
    """Read an FMU's description.

    Parameters
    ----------
    path : path-like
    model : str, optional
        Name that the FMU's model must have.

    Returns
    -------
    Description

    Raises
    ------
    InputError
        Where there is no such file, or it is no FMU of that model for co-simulation.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"FMU {path}: no such file; expected one that `vibroimpact build` writes")
    try:
        found = read_description(path)
    except Exception as error:
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        text = f"FMU {path}: not readable as an FMU ({reason})"
        raise InputError(f"{text}; expected one that `vibroimpact build` writes") from None
    if not found.identifier or (model and found.name != model):
        expected = f"{model or 'a model'} for co-simulation"
        raise InputError(f"FMU {path}: model {found.name}; expected {expected}")
    return found


def exponents(base: Any) -> dict[str, int]:
    """Exponents of SI units in FMPy's base unit, those that are not 0."""
    found = {name: int(getattr(base, name)) for name in SI} if base else {}
    return {name: exponent for name, exponent in found.items() if exponent}


_known: dict[str, Description] = {}  # by digest: validation takes long


def read_description(path: Path) -> Description:
    """Read and validate ``modelDescription.xml``, once in a process for a file's bytes."""
    data = path.read_bytes()
    digest = hashlib.sha256(data).hexdigest()
    if digest not in _known:
        import fmpy

        check_archive(data)
        found = fmpy.read_model_description(io.BytesIO(data))
        slave = found.coSimulation
        if slave:
            check_identifier(slave.modelIdentifier)
        _known[digest] = Description(
            path=path,
            name=found.modelName,
            guid=str(found.guid),
            fmi_version=found.fmiVersion,
            variables={v.name: v for v in found.modelVariables},
            needs_tool=bool(slave and slave.needsExecutionTool),
            identifier=slave.modelIdentifier if slave else "",
            units={unit.name: exponents(unit.baseUnit) for unit in found.unitDefinitions},
            digest=digest,
        )
    return dataclasses.replace(_known[digest], path=path)
