"""Base of classes that are read from their section of a TOML file."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from typing import Any, ClassVar, TypeVar

Kind = TypeVar("Kind", bound="Described")


class Described:
    """Base of such classes; the section's name is the class name in lower case."""

    # read_section of the module files, which knows all the classes
    _reader: ClassVar[Callable[..., Any]]

    @classmethod
    def _read(
        cls: type[Kind], path: str | PathLike[str], structure: Any = None, tables: Any = None
    ) -> Kind:
        """Read an object of this class from a TOML file or from a set shipped with the package."""
        described = Described._reader(path, cls.__name__.lower(), structure, tables)
        assert isinstance(described, cls)
        return described
