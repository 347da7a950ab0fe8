"""Exceptions of the package; each message names the thing, its value and what is expected."""

from __future__ import annotations


class VibroimpactError(Exception):
    """Base class of all exceptions that this package raises on purpose."""


class InputError(VibroimpactError, ValueError):
    """Raised for a parameter, file or option of the user that cannot be accepted."""


class StaleError(InputError):
    """Raised for a stored result made by other arguments, other code or another FMU."""


class StoreError(VibroimpactError, OSError):
    """Raised if a disk is full or not writable, or a stored file is damaged."""


class FmuError(VibroimpactError, RuntimeError):
    """Raised if an FMU refuses a call; the message is the FMU's own."""


class WorkerError(VibroimpactError, RuntimeError):
    """Raised if a worker process ended without a message."""


class Terminated(KeyboardInterrupt):
    """``KeyboardInterrupt`` for SIGTERM, to tell it from Ctrl-C."""
