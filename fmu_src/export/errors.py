"""The error raised where an FMU cannot be made on this machine."""

from __future__ import annotations

import importlib.util

EXTRA = 'pip install -e ".[build]" in a clone'


class CannotExport(Exception):
    """An FMU cannot be made on this machine; the message says why, as one line."""


def require_package(package: str, purpose: str) -> None:
    """Raise ``CannotExport`` unless a package of the extra ``build`` is there; it ``purpose``."""
    if importlib.util.find_spec(package) is None:
        raise CannotExport(f"{package}, which {purpose}, is not installed: expected {EXTRA}")
