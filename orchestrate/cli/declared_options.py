"""Make options from the signature and the numpydoc docstring of a public function."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from typing import Any

from .grammar import plain_float, plain_int

LINK = re.compile(r"As in :func:`orchestrate\.(\w+)`")
MARKUP = re.compile(r":\w+:`(?:orchestrate\.)?([^`]*)`|``([^`]*)``")


def argument_documentation(function: Callable[..., Any], name: str) -> tuple[str, str]:
    """Return an argument's type and description from the function's numpydoc docstring.

    Examples
    --------
    >>> import orchestrate
    >>> argument_documentation(orchestrate.poincare, "transient")
    ('int', 'Excitation periods dropped.')
    """
    import orchestrate

    text = inspect.getdoc(function)
    if text is None:  # python -OO leaves docstrings out
        default = inspect.signature(function).parameters[name].default
        return type(default).__name__, name.replace("_", " ")
    section = text.partition("\nParameters\n----------\n")[2].partition("\n\n")[0]
    for entry in re.split(r"\n(?=\S)", section):
        head, _, body = entry.partition("\n")
        names, _, kind = head.partition(" : ")
        if name in names.split(", "):
            meaning = " ".join(body.split())
            linked = LINK.match(meaning)
            return (
                argument_documentation(getattr(orchestrate, linked[1]), name)
                if linked
                else (kind, meaning)
            )
    raise LookupError(f"{function.__name__}: no {name} in its docstring")


def help_text(meaning: str) -> str:
    """Return the first sentence of an argument's description as help text for ``argparse``.

    Examples
    --------
    >>> help_text("Whether to compute :func:`orchestrate.lyapunov` too. More.")
    'compute lyapunov too'
    """
    plain = MARKUP.sub(lambda match: match[1] or match[2], meaning).partition(". ")[0].rstrip(".")
    plain = plain.removeprefix("Whether to ")
    return (plain[:1].lower() + plain[1:]).replace("%", "%%")


def option_keywords(function: Callable[..., Any], name: str) -> dict[str, Any]:
    """Return ``add_argument``'s keywords (type, default, choices, help) of an argument."""
    default = inspect.signature(function).parameters[name].default
    kind, meaning = argument_documentation(function, name)
    text = help_text(meaning)
    if default is False:
        return {"action": "store_true", "help": text}
    if default is not None:
        text += " (default: %(default)s)"
    if kind.startswith("{"):
        return {"choices": re.findall(r'"(\w+)"', kind), "default": default, "help": text}
    readers = {"int": (plain_int, "N"), "str": (str, "WORD")}
    reader, metavar = readers.get(kind.partition(",")[0], (plain_float, "X"))
    return {"type": reader, "default": default, "metavar": metavar, "help": text}
