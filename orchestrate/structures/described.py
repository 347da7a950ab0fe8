"""Base class of what a TOML file describes: ``from_file`` by a reader that `.files` registers."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from typing import Any, ClassVar, TypeVar

Kind = TypeVar("Kind", bound="Described")


class Described:
    """Base of what sections of a TOML file describe; a class's name is what it is called there."""

    # read_section of the module files, which knows all the classes
    _reader: ClassVar[Callable[..., Any]]

    @classmethod
    def _read(cls: type[Kind], path: str | PathLike[str], structure: Any = None) -> Kind:
        """Read it from a file, or from a set that comes with the package."""
        described = Described._reader(path, cls.__name__.lower(), structure)
        assert isinstance(described, cls)
        return described
