"""xarray, imported when it is first used, and ``Unpack`` for type checkers alone."""

from __future__ import annotations

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

    xr, Unpack = Lazy(), None

__all__ = ["Unpack", "xr"]
