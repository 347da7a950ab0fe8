"""xarray, imported when it is first used, and ``Unpack`` of older Pythons."""

from __future__ import annotations

import typing
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr
    from typing_extensions import Unpack
else:

    class Lazy:
        """A package that takes long to import, in place of which its name may stand already."""

        def __getattr__(self, name: str) -> Any:
            return getattr(import_module("xarray"), name)

    xr = Lazy()
    Unpack = getattr(typing, "Unpack", typing.Optional)  # before 3.11 any generic type will do

__all__ = ["Unpack", "xr"]
