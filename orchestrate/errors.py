"""Exceptions of the package; each message names the thing, its value and what is expected."""

from __future__ import annotations

import unicodedata


class VibroimpactError(Exception):
    """Base class of all exceptions that this package raises on purpose."""


class InputError(VibroimpactError, ValueError):
    """Raised for a parameter, file or option of the user that cannot be accepted, in one line."""

    def __init__(self, text: str) -> None:
        super().__init__(printable_line(text))


NOT_NUMBERS = TypeError, ValueError, OverflowError  # of float() and NumPy, for a user's value


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


def printable_line(text: str, max_length: int = 1000) -> str:
    r"""Return a text as one line with control characters escaped; cut a long one in its middle."""
    if not text.isprintable():
        text = "".join(letter if letter.isprintable() else escape_letter(letter) for letter in text)
    half = max_length // 2
    return text if len(text) <= max_length else f"{text[:half]} ... {text[-half:]}"


def escape_letter(letter: str) -> str:
    """Return a blank for a kind of blank, and another letter as Python writes it."""
    return " " if unicodedata.category(letter) == "Zs" else repr(letter)[1:-1]


def first_line(error: BaseException) -> str:
    """Return the first line of an exception's text, or its type's name without any text."""
    return (str(error).splitlines() or [type(error).__name__])[0]
