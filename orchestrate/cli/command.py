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
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
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
    "array_like or xarray.Dataset": (grammar.parse_state_or_file, "X1,X2,V1,V2|FILE.nc"),
    "array_like of 4 floats, or mapping": (grammar.parse_state_or_file, "X1,X2,V1,V2|FILE.nc"),
    "array_like of 4 floats": (grammar.parse_state, "X1,X2,V1,V2"),
    "(str, float, float, int)": (grammar.parse_plane_side, "NAME,FIRST,LAST,COUNT"),
    "(float, float)": (grammar.parse_ends, "FIRST:LAST"),
    "int or sequence of float": (grammar.parse_orders, "N|A,B,..."),
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
NEEDED, NONE = " (needed)", inspect.Parameter.empty
MEANT = {  # for options of ours
    **{"--gravity": "--box-acceleration -1g", "--level": "--g", "--g-rms": "--g", "--rms": "--g"},
    **{"--freq": "--hz", "--force": "--force1", "--csv": "--format csv", "--out": "--output"},
    **{"--levels": "--g", "--guess": "--structure", "--time": "--periods", "--beam": "--structure"},
    **{"--duration": "--periods", "--sine": "--swept-sine", "--sweep": "--swept-sine"},
}
READERS: dict[Any, tuple[Callable[[str, str], Any] | None, str]] = {  # and what values are called
    int: (grammar.read_int, "N"),
    float: (grammar.parse_number, "X"),
    Path: (None, "FILE"),
}
Keywords = dict[str, Any]


@dataclass(frozen=True)
class Option:
    """One option of a command; its type is the annotation of the attribute."""

    help: str  # with its default
    default: Any = None
    value: str = ""  # what the help calls it, where its type does not tell
    names: tuple[str, ...] = ()  # flags, where they are not the attribute's name
    position: bool = False  # no flag: the value stands by itself
    needed: bool = False
    many: bool = False  # several values after one flag
    read: Callable[[str, str], Any] | None = None  # from flag and text, where not by the type
    # known in the command's class: the annotation, and in whose help it stands
    kind: Any = None
    group: Any = None

    def to_parameter(self, attribute: str, group: cyclopts.Group) -> inspect.Parameter:
        read, called = (self.read, "X") if self.read else reader_and_metavar(self.kind)

        def convert(_: Any, texts: Any) -> Any:
            return read(texts[-1].keyword or "", texts[-1].value) if read else None

        details = cyclopts.Parameter(
            name=None if self.position else self.names,
            help=self.help,
            metavar=self.value or called,
            group=group,
            negative=(),
            show_default=False,
            show_choices=False,
            required=self.needed,
            consume_multiple=self.many or None,
            allow_repeating=True,  # the last one counts
            converter=convert if read else None,
            n_tokens=1 if read else None,
        )
        return inspect.Parameter(
            attribute,
            inspect.Parameter.POSITIONAL_ONLY if self.position else inspect.Parameter.KEYWORD_ONLY,
            default=NONE if self.needed else self.default,
            annotation=Annotated[Any if self.read else self.kind, details],
        )


def option(help: str, default: Any = None, value: str = "", **details: Any) -> Any:
    """Return an option, as ``Any``: as an attribute it has the value's type."""
    return Option(help_with_default(help, default), default, value, **details)


def help_with_default(help: str, usual: Any) -> str:
    said = usual in (None, False, (), "") or "default" in help
    return help if said else f"{help} (default: {usual})"


def option_names(names: Iterable[str], joint: str = ", ") -> str:
    """Join attributes as options in a text: ``--eta, --max-points``."""
    return joint.join(f"--{name.replace('_', '-')}" for name in names)


def reader_and_metavar(kind: Any) -> tuple[Callable[[str, str], Any] | None, str]:
    for part in (kind, *typing.get_args(kind)):
        origin, arguments = typing.get_origin(part), typing.get_args(part)
        if origin is Literal:
            choices = "{" + ",".join(map(str, arguments)) + "}"
            return functools.partial(grammar.parse_choice, arguments), choices
        if part in READERS:
            return READERS[part]
    return None, "TEXT"


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
        for name, one in self.options().items():
            default = list(one.default) if isinstance(one.default, tuple) else one.default
            setattr(self, name, values.get(name, default))

    @abstractmethod
    def __call__(self) -> None:
        """Run the command."""

    @classmethod
    @functools.cache
    def options(cls) -> dict[str, Option]:
        hints = typing.get_type_hints(cls, include_extras=True)
        found: dict[str, Option] = {}
        for group in reversed(cls.__mro__):
            own = vars(group)
            written = [name for name, one in own.items() if isinstance(one, Option)]
            new = {name: replace(own[name], kind=hints[name]) for name in written}
            takes = own.get("takes", "*" if own.get("calls") else "")
            if "*" in takes:
                known = found.keys() | new.keys()
                every = [name for name in readable_arguments(cls.calls) if name not in known]
                takes = takes.replace("*", " ".join(every))
            new |= options_from_functions(takes, cls.calls, own.get("if_given"))
            for name, one in new.items():
                first = found[name].group if name in found and name in written else group
                names = one.names or (option_names([name]),)
                flag = name in written and one.kind is bool  # as annotated, never None
                default = False if flag else one.default
                found[name] = replace(one, default=default, names=names, group=first)
        return dict(sorted(found.items(), key=lambda row: vars(row[1].group).get("rank", 2)))

    @classmethod
    def flags(cls) -> list[str]:
        return [one.names[0] for one in cls.options().values() if not one.position]

    @classmethod
    def name(cls) -> str:
        return cyclopts.default_name_transform(cls.__name__)

    def given_options(self, *groups: type[Options]) -> Keywords:
        names = [name for name, one in self.options().items() if one.group in groups]
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    def require(self, name: str, expected: str) -> Any:
        if (value := getattr(self, name)) is None:
            raise InputError(f"{option_names([name])} is missing{expected}")
        return value

    def function_keywords(self) -> Keywords:
        defaults = default_by_argument(self.calls)
        found: Keywords = {}
        for name, one in self.options().items():
            if one.group is type(self) and name in defaults:
                found[name] = getattr(self, name)
                if defaults[name] is NONE:
                    self.require(name, f" ({one.help.removesuffix(NEEDED)})")
                if one.read is grammar.parse_state_or_file and isinstance(found[name], Path):
                    found[name] = grammar.load_earlier_result(option_names([name]), found[name])
        return found

    @classmethod
    def cyclopts_app(cls) -> cyclopts.App:
        groups: dict[str, cyclopts.Group] = {}
        parameters = []
        for name, one in cls.options().items():
            heading, remark = (vars(one.group).get(key, "") for key in ("heading", "remark"))
            group = cyclopts.Group(heading or "question", help=remark, sort_key=len(groups))
            parameters.append(one.to_parameter(name, groups.setdefault(heading, group)))
        parameters.sort(key=lambda one: one.kind)

        def make_command(*positions: Any, **values: Any) -> Command:
            names = [one.name for one in parameters]
            return cls(**dict(zip(names, positions, strict=False)), **values)

        make_command.__annotations__ = {}  # only of the options' own names
        make_command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        return cyclopts.App(name=cls.name(), help=cls.__doc__, default_command=make_command)


# -- options from a public function ----------------------------------------------------------------


def default_by_argument(function: str) -> dict[str, Any]:
    """Return the default of each argument of a public function or class, ``NONE`` without."""
    parameters = inspect.signature(getattr(orchestrate, function)).parameters
    return {name: one.default for name, one in parameters.items()}


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
    typed = types_and_meanings(function)
    return [
        one.name
        for one in inspect.signature(getattr(orchestrate, function)).parameters.values()
        if one.kind == one.KEYWORD_ONLY
        and one.name not in ("eta", "frequency", "amplitude", "level", "over", "values")
        and one.default is not True
        and typed[one.name][0].startswith(("{", *DOCUMENTED))
        and typed[one.name][0].partition(",")[0] != "array_like"  # of one number, where named
    ]


def options_from_functions(takes: str, usual: str, if_given: bool | None) -> dict[str, Option]:
    """Return options that are arguments of functions; types and help are those of docstrings."""
    found = {}
    for part in filter(None, takes.split("; ")):
        function, _, names = part.rpartition(": ")
        function = function or usual
        defaults = {} if function == RUNNING else default_by_argument(function)
        for name in names.split():
            typed, meaning = types_and_meanings(function)[name]
            known = (DOCUMENTED[one] for one in DOCUMENTED if typed.startswith(one))
            kind, value = next(known, (Literal[tuple(re.findall(r'"(\w+)"', typed))], ""))
            default, words = defaults.get(name), help_text(meaning)
            if default is NONE:
                default, words = None, words if if_given else f"{words}{NEEDED}"
            if ";" in takes:
                words = f"{cyclopts.default_name_transform(function)}: {words}"
            words = help_with_default(words, default)
            one = Option(words, None if if_given else default, value, kind=kind)
            found[name] = replace(one, read=kind) if inspect.isfunction(kind) else one
    return found


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
    name = grammar.quantity_of_option(flag)
    if (
        name in {**STRUCTURE, **RATIO_QUANTITIES, **grammar.SET_NAMES}
        and "--set" in command.flags()
    ):
        words = " ".join(error.root_input_tokens or []).replace(f"{flag}=", f"{flag} ").split(" ")
        value = "".join(words[words.index(flag) + 1 :][:1]) if flag in words else ""
        several = set(value) & set(":,") and "--over" in command.flags()
        meant = f"--over {name} --values {value}" if several else f"--set {name}={value or 'VALUE'}"
        return did_you_mean(meant)
    said = MEANT.get(flag, "")
    if said.partition(" ")[0] in command.flags():
        return did_you_mean(said)
    return did_you_mean(closest_name(flag, command.flags()) if flag.startswith("--") else "")
