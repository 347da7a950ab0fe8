"""What can go wrong; each exception says in one line the thing, its value and what is expected."""

from __future__ import annotations


class VibroimpactError(Exception):
    """The base of all exceptions that this package raises on purpose."""


class InputError(VibroimpactError, ValueError):
    """What was given cannot be taken: a parameter, a file, an option."""


class StaleError(InputError):
    """A stored result that was made for another question, by other code or by another FMU."""


class StoreError(VibroimpactError, OSError):
    """A disk that is full or not writable, or a stored file that is damaged."""


class FmuError(VibroimpactError, RuntimeError):
    """An FMU refused a call; the text is the FMU's own message."""


class WorkerError(VibroimpactError, RuntimeError):
    """A worker process ended without a word."""
