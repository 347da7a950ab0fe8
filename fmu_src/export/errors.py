"""The error raised where an FMU cannot be made on this machine."""

from __future__ import annotations

import importlib.util

EXTRA = 'pip install -e ".[build]" in a clone'


class CannotExport(Exception):
    """An FMU cannot be made on this machine; the message says why, as one line."""


def require(package: str, what: str) -> None:
    """Raise an error unless a package is installed.

    Parameters
    ----------
    package : str
        Of the extra ``build``.
    what : str
        What it is needed for, in a few words.

    Raises
    ------
    CannotExport
    """
    if importlib.util.find_spec(package) is None:
        raise CannotExport(f"{package}, which {what}, is not installed: expected {EXTRA}")
