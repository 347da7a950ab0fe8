"""Public API: describe a vibro-impacting structure, call a function, get a dataset.

>>> import orchestrate
>>> beam = orchestrate.Structure.nondimensional(e=0.7, D=0.005)
>>> response = orchestrate.sweep(beam, eta=[0.4, 1.047], transient=50, samples=20)
>>> response.impacts_per_period.dims
('eta',)

Structures, excitations, drives and shakers are described in SI or by the paper's numbers, in Python
or in TOML files; ``__init__.pyi`` lists the functions. Each returns an :class:`xarray.Dataset` with
units, long names, all parameters, and where it comes from; :func:`plot` draws it.

All is computed by FMPy through exported FMUs. Every function that computes takes the keywords of
:class:`orchestrate.running.options.Running`: ``jobs``, ``cluster``, ``store`` and more.
"""

from __future__ import annotations

import ast
from importlib import import_module
from pathlib import Path
from typing import Any

_stub = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
PLACES = {  # submodules by public name, which is imported when it is used: `import` takes no time
    alias.name: node.module or ""
    for node in _stub.body
    if isinstance(node, ast.ImportFrom)
    for alias in node.names
}
__all__ = sorted(PLACES)


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used, and return it."""
    if name not in PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"{__name__}.{PLACES[name]}"), name)
    return value


def __dir__() -> list[str]:
    return __all__
