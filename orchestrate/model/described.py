"""Base of classes with a section in a TOML file: checked numbers that can be read and replaced."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from os import PathLike
from typing import Any, ClassVar, TypeVar

from .ranges import Quantity

Kind = TypeVar("Kind", bound="Described")


class Described:
    """Base of such classes; the section's name is the class name in lower case."""

    quantities: ClassVar[Mapping[str, Quantity]]  # of its fields that are numbers
    # read_section of the module files, which knows all the classes
    _reader: ClassVar[Callable[..., Any]]

    def __post_init__(self) -> None:
        for name, quantity in self.quantities.items():
            object.__setattr__(self, name, quantity.check(getattr(self, name)))

    def replace(self: Kind, **changes: Any) -> Kind:
        """Return a copy with some values changed, given as keywords."""
        return dataclasses.replace(self, **changes)  # type: ignore[type-var]

    @classmethod
    def _read(
        cls: type[Kind], path: str | PathLike[str], structure: Any = None, tables: Any = None
    ) -> Kind:
        """Read an object of this class from a TOML file or from a set shipped with the package."""
        described = Described._reader(path, cls.__name__.lower(), structure, tables)
        assert isinstance(described, cls)
        return described
