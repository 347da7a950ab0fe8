"""A command is a class whose options are its attributes; groups of options are its bases.

cyclopts reads the options by their types. Options that are arguments of the command's public
function have type, default, choices and help from its signature and docstring: a new argument of
the function is an option of the command.
"""

from __future__ import annotations

import functools
import inspect
import re
import typing
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import cyclopts
from cyclopts import exceptions

import orchestrate

from ..errors import InputError
from ..model.ranges import RATIO_QUANTITIES, STRUCTURE
from ..model.spelling import closest_name, did_you_mean
from . import grammar

LINK = re.compile(r"As (?:in|for) :\w+:`orchestrate\.(\w+)`")
MARKUP = re.compile(r":\w+:`(?:orchestrate\.)?([^`]*)`|``([^`]*)``")
MAPPING = re.compile(r'\{"(\w+)": "?([^"}]*)"?\}')  # on the command line NAME=VALUE
DOCUMENTED: dict[str, tuple[Any, str]] = {  # types of docstrings: how texts are read, and named
    "array_like or xarray.Dataset": (grammar.State, "X1,X2,V1,V2|FILE.nc"),
    "array_like of 4 floats, or mapping": (grammar.State, "X1,X2,V1,V2|FILE.nc"),
    "array_like of 4 floats": (Annotated[Any, grammar.parse_state], "X1,X2,V1,V2"),
    "(str, float, float, int)": (grammar.PlaneSide, "NAME,FIRST,LAST,COUNT"),
    "(float, float)": (grammar.Ends, "FIRST:LAST"),
    "int or sequence of float": (grammar.Orders, "N|A,B,..."),
    "int": (int, "N"),
    "float or mapping": (str, "X|CHANNEL=X,..."),
    "float": (float, "X"),
    "bool": (bool, ""),
    "str or mapping": (str, "WORD|CHANNEL=WORD,..."),
    "str": (str, "WORD"),
    "path": (Path, "PATH"),
    "xarray.Dataset": (Path, "FILE.nc"),
    "array_like": (float, "X"),
}
RUNNING = "Running"  # in place of a function: the keywords of all on how to compute
NEEDED = " (needed)"
MEANT = {  # for options of ours
    **{"--gravity": "--box-acceleration -1g", "--level": "--g", "--g-rms": "--g", "--rms": "--g"},
    **{"--freq": "--hz", "--force": "--force1", "--csv": "--format csv", "--out": "--output"},
    **{"--levels": "--g", "--guess": "--structure", "--time": "--periods", "--beam": "--structure"},
    **{"--duration": "--periods", "--sine": "--swept-sine", "--sweep": "--swept-sine"},
}
OF_BOX = ("eta", "frequency", "amplitude", "level")
READERS: dict[Any, Callable[[str, str], Any]] = {int: grammar.read_int, float: grammar.parse_number}
STRUCTURE_NAMES = (*STRUCTURE, *RATIO_QUANTITIES, *grammar.SET_NAMES)
Keywords = dict[str, Any]


@dataclass(frozen=True)
class Option:
    """One option of a command; its type is the annotation of the attribute."""

    help: str
    default: Any = None
    value: str = ""  # what the help calls it, where its type does not tell
    name: str = ""  # where it is not the attribute's
    also: str = ""  # a name of before
    position: bool = False  # no flag: the value stands by itself
    needed: bool = False
    many: bool = False  # several values after one flag
    usual: Any = None  # what is taken where it is not given, where that is not the default

    @property
    def help_with_default(self) -> str:
        """The help, with the default where it does not say so."""
        usual = self.default if self.usual is None else self.usual
        said = usual in (None, False, (), "") or "default" in self.help
        return self.help if said else f"{self.help} (default: {usual})"

    def to_parameter(self, attribute: str, kind: Any, group: cyclopts.Group) -> inspect.Parameter:
        read, called = reader_and_metavar(kind)
        flag = self.name or option_names([attribute])
        details = cyclopts.Parameter(
            name=None if self.position else (flag, self.also) if self.also else flag,
            help=self.help_with_default,
            metavar=self.value or called,
            group=group,
            negative=(),
            show_default=False,
            show_choices=False,
            required=self.needed,
            consume_multiple=self.many or None,
            allow_repeating=True,  # the last one counts
            converter=cyclopts_converter(read) if read else None,
            n_tokens=1 if read else None,
        )
        return inspect.Parameter(
            attribute,
            inspect.Parameter.POSITIONAL_ONLY if self.position else inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if self.needed else self.default,
            annotation=Annotated[kind, details],
        )


def option(help: str, default: Any = None, value: str = "", **details: Any) -> Any:
    """Return an option, as ``Any``: as an attribute it has the value's type."""
    return Option(help, default, value, **details)


def option_names(names: Iterable[str], joint: str = ", ") -> str:
    """Join attributes as options in a text: ``--eta, --max-points``."""
    return joint.join(f"--{name.replace('_', '-')}" for name in names)


def reader_and_metavar(kind: Any) -> tuple[Callable[[str, str], Any] | None, str]:
    known, parts = {int: "N", float: "X", Path: "FILE"}, (kind, *typing.get_args(kind))
    called = next((known[one] for one in parts if one in known), "TEXT")
    for one in parts:
        if typing.get_origin(one) is Annotated:
            return next(read for read in typing.get_args(one) if inspect.isfunction(read)), "X"
        if typing.get_origin(one) is Literal:
            choices = typing.get_args(one)
            read = functools.partial(grammar.parse_choice, choices)
            return read, "{" + ",".join(map(str, choices)) + "}"
        if one in READERS:
            return READERS[one], called
    return None, called


def cyclopts_converter(read: Callable[[str, str], Any]) -> Callable[..., Any]:
    return lambda _, tokens: read(tokens[-1].keyword or "", tokens[-1].value)


class Options:
    """A group of options.

    Of itself only, not of its bases: ``heading`` stands above its options in the help with a
    ``remark``, ``rank`` orders the groups. ``takes`` are options that are arguments of public
    functions, as ``"function: name name; other: name"``, by default of the one that the command
    calls, and of that ``"*"``: all whose types can be read, but those of other groups. With
    ``if_given`` they are None where they are not given.
    """

    takes = ""
    if_given = False

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Options that come from functions, or from other groups."""

    def given_option(self, *names: str) -> str | None:
        """Return which of some options is given, None if none is; raise if several are."""
        given = [name for name in names if getattr(self, name) not in (None, False)]
        if len(given) > 1:
            raise InputError(f"{option_names(given, ' and ')}: expected one of them")
        return given[0] if given else None

    def refuse_without(
        self, owners: Mapping[str, Sequence[str]], chosen: Collection[str], flag: str = ""
    ) -> None:
        """Raise for an option that is given without one of its owners: options, or words of one."""
        for name, own in owners.items():
            if getattr(self, name) not in (None, False) and not {*own} & {*chosen}:
                words = flag + " or ".join(own) if flag else option_names(own, " or ")
                raise InputError(f"{option_names([name])}: expected only with {words}")


class Command(Options, ABC):
    """A command; calling it runs it, and its docstring stands in the list of commands."""

    heading, rank = "mistakes of the program", 6
    debug: bool = option("show where in the program an error occurred")
    calls = ""  # the public function, whose keywords are the options of the class itself
    renamed: ClassVar[dict[str, str]] = {}  # options of other names, by the function's keywords
    examples = ""

    def __init__(self, **values: Any) -> None:
        self.command_line = ""
        for name, (one, _, _) in self.options().items():
            default = list(one.default) if isinstance(one.default, tuple) else one.default
            setattr(self, name, values.get(name, default))

    @abstractmethod
    def __call__(self) -> None:
        """Run the command."""

    @classmethod
    @functools.cache
    def options(cls) -> dict[str, tuple[Option, Any, type[Options]]]:
        """Return each option, its type and the group that it stands in, by the attribute."""
        hints = typing.get_type_hints(cls, include_extras=True)
        found: dict[str, tuple[Option, Any, type[Options]]] = {}
        for group in reversed(cls.__mro__):
            own = vars(group)
            for name, one in own.items():
                if isinstance(one, Option):
                    one = replace(one, default=False) if hints[name] is bool else one
                    found[name] = one, hints[name], found[name][2] if name in found else group
            takes = own.get("takes", "*" if own.get("calls") else "")
            others = [name for name in readable_arguments(cls.calls) if name not in found]
            taken = takes.replace("*", " ".join(others)), cls.calls, own.get("if_given")
            found |= {
                name: (one, kind, group) for name, one, kind in options_from_functions(*taken)
            }
        return dict(sorted(found.items(), key=lambda row: vars(row[1][2]).get("rank", 2)))

    @classmethod
    def flags(cls) -> list[str]:
        rows = cls.options().items()
        return [one.name or option_names([name]) for name, (one, _, _) in rows if not one.position]

    @classmethod
    def name(cls) -> str:
        return cyclopts.default_name_transform(cls.__name__)

    def given_options(self, *groups: type[Options]) -> Keywords:
        names = [name for name, (_, _, of) in self.options().items() if of in groups]
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    def require(self, name: str, expected: str) -> Any:
        if (value := getattr(self, name)) is None:
            raise InputError(f"{option_names([name])} is missing{expected}")
        return value

    def function_keywords(self) -> Keywords:
        arguments = required_by_argument(self.calls)
        found: Keywords = {}
        for name, (one, kind, of) in self.options().items():
            if of is type(self) and name in arguments:
                found[name] = getattr(self, name)
                if arguments[name]:
                    self.require(name, f" ({one.help.removesuffix(NEEDED)})")
                if kind is grammar.State and isinstance(found[name], Path):
                    found[name] = grammar.load_earlier_result(option_names([name]), found[name])
        return found

    @classmethod
    def cyclopts_app(cls) -> cyclopts.App:
        groups: dict[str, cyclopts.Group] = {}
        parameters = []
        for name, (one, kind, of) in cls.options().items():
            heading, remark = (vars(of).get(key, "") for key in ("heading", "remark"))
            group = cyclopts.Group(heading or "question", help=remark, sort_key=len(groups))
            parameters.append(one.to_parameter(name, kind, groups.setdefault(heading, group)))
        parameters.sort(key=lambda one: one.kind)

        def make_command(*positions: Any, **values: Any) -> Command:
            names = [one.name for one in parameters]
            return cls(**dict(zip(names, positions, strict=False)), **values)

        make_command.__annotations__ = {}  # only of the options' own names
        make_command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        return cyclopts.App(name=cls.name(), help=cls.__doc__, default_command=make_command)


# -- options from a public function ----------------------------------------------------------------


def required_by_argument(function: str) -> dict[str, bool]:
    """Return of each argument of a public function or class whether it has no default."""
    parameters = inspect.signature(getattr(orchestrate, function)).parameters.values()
    return {one.name: one.default is inspect.Parameter.empty for one in parameters}


@functools.cache
def types_and_meanings(function: str) -> dict[str, tuple[str, str]]:
    import docstring_parser

    from ..running.options import Running

    found = {}
    text = inspect.getdoc(Running if function == RUNNING else getattr(orchestrate, function)) or ""
    for one in docstring_parser.parse(text, docstring_parser.DocstringStyle.NUMPYDOC).params:
        for name in one.arg_name.split(", "):
            meaning = " ".join((one.description or "").split())
            linked = LINK.match(meaning)
            there = types_and_meanings(linked[1]) if linked else {}
            found[name] = there.get(name, (one.type_name or "", meaning))
    return found


@functools.cache
def readable_arguments(function: str) -> list[str]:
    if not function:
        return []
    typed = types_and_meanings(function)
    arguments = inspect.signature(getattr(orchestrate, function)).parameters.values()
    return [
        one.name
        for one in arguments
        if one.kind == one.KEYWORD_ONLY
        and one.name not in (*OF_BOX, "over", "values")
        and one.default is not True
        and typed[one.name][0].startswith(("{", *DOCUMENTED))
        and typed[one.name][0].partition(",")[0] != "array_like"  # of one number, where named
    ]


def options_from_functions(
    takes: str, usual_function: str, if_given: bool | None
) -> Iterator[tuple[str, Option, Any]]:
    for part in filter(None, takes.split("; ")):
        function, _, names = part.rpartition(": ")
        function = function or usual_function
        of = None if function == RUNNING else inspect.signature(getattr(orchestrate, function))
        for name in names.split():
            typed, meaning = types_and_meanings(function)[name]
            known = (DOCUMENTED[one] for one in DOCUMENTED if typed.startswith(one))
            kind, value = next(known, (None, ""))
            if typed.startswith("{"):
                kind = Literal[tuple(re.findall(r'"(\w+)"', typed))]
            usual: Any = False if kind is bool else None
            if of and name in of.parameters:
                usual = of.parameters[name].default
            words = help_text(meaning)
            if usual is inspect.Parameter.empty:
                usual, words = None, words if if_given else f"{words}{NEEDED}"
            if ";" in takes:
                words = f"{cyclopts.default_name_transform(function)}: {words}"
            yield name, Option(words, None if if_given else usual, value, usual=usual), kind


def help_text(meaning: str) -> str:
    """Return the first sentence of an argument's description, and the default, as help."""
    plain = MARKUP.sub(lambda match: match[1] or match[2], meaning)
    plain = MAPPING.sub(r"\1=\2", plain.removeprefix("Whether ").removeprefix("to "))
    first, *others = plain.rstrip(".").split(". ")
    usual = "".join(f"; b{one[1:]}" for one in others if one.startswith("By default"))
    begins = first[:1] if first.startswith(("Hz", "V ")) else first[:1].lower()
    return f"{begins}{first[1:]}{usual}"


# -- mistakes --------------------------------------------------------------------------------------


def explain_parse_error(error: exceptions.CycloptsError, command: type[Command]) -> str:
    lists = f"({command.name()} --help lists them)"
    if isinstance(error.__cause__, InputError):
        return str(error.__cause__)
    if isinstance(error, exceptions.UnknownOptionError):
        flag = (error.token.keyword or error.token.value).partition("=")[0]
        return (
            f"{flag}: no option of {command.name()}{suggest_option(flag, error, command)} {lists}"
        )
    if isinstance(error, exceptions.UnusedCliTokensError):
        from ..model.toml_files import SETS

        words = " ".join(error.unused_tokens or ())
        known = words.endswith(".toml") or words in SETS
        meant = did_you_mean(f"--structure {words}") if known else ""
        return f"{words}: no option of {command.name()}{meant} {lists}"
    if isinstance(error, exceptions.MissingArgumentError):
        name = error.argument.name if error.argument else ""
        return f"{error.keyword}: expected one value" if error.keyword else f"{name} is missing"
    return " ".join(str(error).split())


def suggest_option(flag: str, error: exceptions.UnknownOptionError, command: type[Command]) -> str:
    name = flag.lstrip("-").replace("-", "_")
    if name in STRUCTURE_NAMES and "--set" in command.flags():
        words = " ".join(error.root_input_tokens or []).replace(f"{flag}=", f"{flag} ").split(" ")
        value = "".join(words[words.index(flag) + 1 :][:1]) if flag in words else ""
        several = set(value) & set(":,") and "--over" in command.flags()
        meant = f"--over {name} --values {value}" if several else f"--set {name}={value or 'VALUE'}"
        return did_you_mean(meant)
    said = MEANT.get(flag, "")
    if said.partition(" ")[0] in command.flags():
        return did_you_mean(said)
    return did_you_mean(closest_name(flag, command.flags()) if flag.startswith("--") else "")
