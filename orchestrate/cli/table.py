"""A command is a row of a table: its function, options, examples and summary.

Options are lines of text, as a help shows them: ``--flag VALUE = default  help``. The name of the
value decides how it is read; ``...`` stands for an option that may be repeated, ``+`` for several
values, ``?`` for a positional argument that may be left out, ``!`` for an option that is needed. An
option that is an argument of a public function takes type, default and help from that function's
source, which is parsed, not imported: so the help of a command loads no numerical package.
"""

from __future__ import annotations

import argparse
import ast
import functools
import inspect
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import PLACES
from .grammar import (
    Reader,
    parse_breakpoints,
    parse_columns,
    parse_ends,
    parse_orders,
    parse_plane_side,
    parse_state,
    parse_values,
    plain_float,
    plain_int,
)

LINK = re.compile(r"As in :func:`orchestrate\.(\w+)`")
MARKUP = re.compile(r":\w+:`(?:orchestrate\.)?([^`]*)`|``([^`]*)``")
ENTRY = re.compile(
    r"(?P<flag>[-\w]+)(?: (?P<value>[^\s=]\S*))?(?: (?P<count>\.\.\.|\+|\?|!))?"
    r"(?: = (?P<default>\S+))? {2,}(?P<help>.*)",
    re.DOTALL,
)
TYPES: dict[str, Callable[[str], Any]] = {  # of values, by what they are called in the help
    **dict.fromkeys(("N",), plain_int),
    **dict.fromkeys(("X", "S", "HZ", "V", "RPM", "N.M", "SPEED", "PART", "TIME"), plain_float),
    **dict.fromkeys(("FILE", "FILE.nc", "FMU", "FOLDER", "RESULT"), Path),
}
READERS: dict[str, Reader[Any]] = {  # of values whose mistakes are told in one line
    "A=X,B=Y": parse_columns,
    "FIRST:LAST": parse_ends,
    "FIRST:LAST:STEP": parse_values,
    "NAME,FIRST,LAST,COUNT": parse_plane_side,
    "ORDERS": parse_orders,
    "PSD": parse_breakpoints,
    "X1,X2,V1,V2": parse_state,
}
if TYPE_CHECKING:
    from ..model import Structure
else:
    Structure = None  # a name in annotations alone: help loads nothing numerical

DEBUG = "--debug  show where in the program an error occurred"
Question = dict[str, Any]


@dataclass(frozen=True)
class Option:
    """One option: its flag, what ``add_argument`` takes, and what reads its text afterwards."""

    flag: str  # without dashes: a positional argument
    details: Mapping[str, Any]
    read: Callable[[str, Any], Any] | None = None  # from the flag and its text

    @property
    def name(self) -> str:
        """Name of the option's value among the parsed arguments."""
        return self.flag.lstrip("-").replace("-", "_")

    def value(self, chosen: argparse.Namespace) -> Any:
        """Return the option's value among the parsed arguments; None if it is not given."""
        value = getattr(chosen, self.name)
        return value if value is None or self.read is None else self.read(self.flag, value)


Lines = str | tuple[str, ...]


@functools.cache
def parse_options(lines: Lines) -> tuple[Option, ...]:
    """Return the options that lines of one or more texts describe."""
    texts = (lines,) if isinstance(lines, str) else lines
    blocks = (re.split(r"\n(?=\S)", inspect.cleandoc(text)) for text in texts if text.strip())
    return tuple(parse_option(entry) for block in blocks for entry in block)


def values_of(chosen: argparse.Namespace, options: Lines) -> dict[str, Any]:
    """Return the values of those options that are given, by name."""
    values = {one.name: one.value(chosen) for one in parse_options(options)}
    return {name: value for name, value in values.items() if value is not None}


def parse_option(entry: str) -> Option:
    """Return the option that an entry describes."""
    match = ENTRY.fullmatch(entry)
    if match is None:
        raise ValueError(entry)
    flag, value, count, default, words = match.groups()
    details: dict[str, Any] = {"help": " ".join(words.split())}
    kind = TYPES.get(value or "", str)
    if value is None:
        details["action"] = "store_true"
    elif value.startswith("{"):
        choices = value.strip("{}").split(",")
        kind = plain_int if choices[0].isdecimal() else str
        details |= {"choices": [kind(choice) for choice in choices], "type": kind}
    else:
        details |= {"metavar": value, "type": kind}
    if default is not None:
        details["default"] = kind(default)
        details["help"] += " (default: %(default)s)" * ("(default: " not in words)
    several = {"action": "extend", "default": []} if flag.startswith("-") else {}
    many: dict[str | None, dict[str, Any]] = {
        "...": {"action": "append", "default": []},
        "+": {"nargs": "+", **several},
        "?": {"nargs": "?"},
        "!": {"required": True},
    }
    return Option(flag, details | many.get(count, {}), READERS.get(value or ""))


@dataclass(frozen=True)
class Group:
    """Options under one title of the help."""

    title: str = ""
    options: Lines = ""  # that the command reads itself
    arguments: Lines = ""  # that are arguments of the public function
    declared: str = ""  # names of arguments whose options come from the function's source
    description: str | None = None
    # beside those of values
    readers: Mapping[str, Callable[[str, Any], Any]] = field(default_factory=dict)

    def keyword_options(self, function: str) -> Iterator[Option]:
        """Yield the options that are arguments of the public function."""
        for one in parse_options(self.arguments):
            yield Option(one.flag, one.details, self.readers.get(one.name, one.read))
        yield from (declared_option(function, name) for name in self.declared.split())

    def add_to(self, parser: argparse.ArgumentParser, function: str) -> None:
        """Add the options to a parser."""
        titled = parser.add_argument_group(self.title, self.description) if self.title else parser
        for one in (*parse_options(self.options), *self.keyword_options(function)):
            titled.add_argument(one.flag, **one.details)


@dataclass(frozen=True)
class Command:
    """One row of the table of commands."""

    name: str
    text: str  # of the list of commands
    examples: str
    groups: tuple[Group, ...]
    run: Callable[[argparse.Namespace], None]
    # structure, drive where it has one, and keywords of the public function
    ask: Callable[[argparse.Namespace], tuple[Any, ...]] | None = None
    summary: Callable[[Any], Iterable[str]] | None = None  # lines that are printed of the result
    draw: Callable[..., Any] | None = None  # by default the picture of the public function
    title: Callable[..., str] | None = None  # of the picture, on the weak drive
    calls: str = ""  # the public function, where its name is another
    # whether a question has a picture: by default each has
    has_picture: Callable[[Question], bool] = lambda _: True

    @property
    def function(self) -> str:
        """Name of the command's public function."""
        return self.calls or self.name.replace("-", "_")

    @property
    def flags(self) -> list[str]:
        """Flags of all options."""
        own = (one for group in self.groups for one in parse_options(group.options))
        return [one.flag for one in (*own, *self.keyword_options())]

    def keyword_options(self) -> Iterator[Option]:
        """Yield the options that are arguments of the public function."""
        for group in self.groups:
            yield from group.keyword_options(self.function)

    def keywords(self, chosen: argparse.Namespace) -> Question:
        """Return the options that are arguments of the public function, as its keywords."""
        return {one.name: one.value(chosen) for one in self.keyword_options()}

    def add_parser(self, commands: Any, program: str, above: str, complete: bool) -> None:
        """Add the command's parser; with all of its options if it is to be ``complete``."""
        above = above if complete and "--structure" in self.flags else ""
        parser = commands.add_parser(
            self.name,
            help=self.text,
            description=f"{self.text[0].upper()}{self.text[1:]}.",
            epilog=f"{above}examples:\n{self.examples.replace('{program}', program)}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )
        parser.set_defaults(run=self.run, command=self.name, row=self)
        if complete:
            (debug,) = parse_options(DEBUG)
            parser.add_argument(debug.flag, **{**debug.details, "default": argparse.SUPPRESS})
            for group in self.groups:
                group.add_to(parser, self.function)


# -- options from a function's source -------------------------------------------------------------


@functools.cache
def source_of(function: str) -> tuple[ast.FunctionDef, dict[str, ast.expr]]:
    """Return a public function's syntax tree, and its module's constants by name."""
    place = Path(__file__).parents[1].joinpath(*PLACES[function].split("."))
    tree = ast.parse(place.with_suffix(".py").read_text(encoding="utf-8"))
    constants = {
        node.targets[0].id: node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    }
    definitions = (node for node in tree.body if isinstance(node, ast.FunctionDef))
    return next(node for node in definitions if node.name == function), constants


def default_of(function: str, name: str) -> Any:
    """Return an argument's default value."""
    definition, constants = source_of(function)
    arguments = definition.args
    pairs = zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
    (value,) = (value for argument, value in pairs if argument.arg == name)
    if isinstance(value, ast.Name):
        value = constants.get(value.id)
        if value is None:  # of another module
            import orchestrate

            called = getattr(orchestrate, function)
            return inspect.signature(called).parameters[name].default
    return None if value is None else ast.literal_eval(value)


def documentation_of(function: str, name: str) -> tuple[str, str]:
    """Return an argument's type and description from the function's numpydoc docstring."""
    text = ast.get_docstring(source_of(function)[0]) or ""
    section = text.partition("\nParameters\n----------\n")[2].partition("\n\n")[0]
    for entry in re.split(r"\n(?=\S)", section):
        head, _, body = entry.partition("\n")
        names, _, kind = head.partition(" : ")
        if name in names.split(", "):
            meaning = " ".join(body.split())
            linked = LINK.match(meaning)
            return documentation_of(linked[1], name) if linked else (kind, meaning)
    raise LookupError(f"{function}: no {name} in its docstring")


def help_text(meaning: str) -> str:
    """Return the first sentence of an argument's description as help text for ``argparse``."""
    plain = MARKUP.sub(lambda match: match[1] or match[2], meaning).partition(". ")[0].rstrip(".")
    plain = plain.removeprefix("Whether to ")
    return (plain[:1].lower() + plain[1:]).replace("%", "%%")


@functools.cache
def declared_option(function: str, name: str) -> Option:
    """Return the option of a public function's argument: type, default, choices and help."""
    default = default_of(function, name)
    kind, meaning = documentation_of(function, name)
    if default is False:
        value = ""
    elif kind.startswith("{"):
        value = "{" + ",".join(re.findall(r'"(\w+)"', kind)) + "}"
    else:
        value = {"int": "N", "str": "WORD"}.get(kind.partition(",")[0], "X")
    usual = "" if default is None or default is False else f"= {default}"
    head = " ".join(filter(None, [f"--{name.replace('_', '-')}", value, usual]))
    return parse_option(f"{head}  {help_text(meaning)}")
