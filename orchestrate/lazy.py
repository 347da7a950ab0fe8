"""xarray and NumPy, imported when they are first used; typing's ``Unpack`` beside them."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any, Unpack

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
else:

    class Lazy:
        """A package that takes long to import, in place of which its name may stand already."""

        def __init__(self, load: Callable[[], Any]) -> None:
            self.load = load

        def __getattr__(self, name: str) -> Any:
            return getattr(self.load(), name)

    np, xr = Lazy(lambda: import_module("numpy")), Lazy(lambda: import_module("xarray"))

__all__ = ["Unpack", "np", "xr"]
