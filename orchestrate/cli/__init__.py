"""Command line's entry: parse the arguments, run one command, turn errors into exit codes.

A command is a row of a :mod:`.table`; the rows stand in one module for each family of commands.
"""

from __future__ import annotations

import argparse
import logging
import re
import shlex
import sys
import warnings
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..errors import InputError, StaleError, Terminated, VibroimpactError, printable
from ..model.ranges import RATIO_QUANTITIES, STRUCTURE, closest
from ..version import __version__
from . import diagnosis, dynamics, laboratory, pages, responses, weak_drive
from .grammar import SET_NAMES, with_option_names
from .options import QUANTITIES, list_shipped_sets
from .safe_output import safe_outputs
from .table import DEBUG, parse_options

COMMANDS = (
    *(pages.BUILD, responses.SIMULATE, *laboratory.COMMANDS, *diagnosis.COMMANDS),
    *(responses.RESONANCE, responses.SPECTRA, responses.SWEEP, responses.MAP),
    *(*dynamics.COMMANDS, *weak_drive.COMMANDS, pages.EXPLORE, pages.REPORT, pages.PAPER),
)
SUCCESS, FAILURE, MISTAKE, INTERRUPTED, TERMINATED = 0, 1, 2, 130, 143
STORE = "orchestrate.running.store"
STRUCTURE_NAMES = (*STRUCTURE, *RATIO_QUANTITIES, *SET_NAMES)
EXAMPLES = """examples:
  {program} build
  {program} sweep
  {program} sweep --set e=0.3 --eta 0.9:1.1:0.001
  {program} resonance --structure beam --hz 8:20:0.05 --g 0.02
  {program} COMMAND --help

sets of parameters that come with the package, for --structure and --drive:
{sets}"""


def program_name() -> str:
    """Return the name to show in help texts: ``vibroimpact`` or ``python -m orchestrate``."""
    called = Path(sys.argv[0]).name if sys.argv and sys.argv[0] else ""
    return "vibroimpact" if called.startswith("vibroimpact") else "python -m orchestrate"


def make_parser(words: Collection[str] | None = None) -> argparse.ArgumentParser:
    """Return the command line's parser; options of those commands alone that are among words."""
    program = program_name()
    parser = argparse.ArgumentParser(
        prog=program,
        description="Simulate and analyse a vibro-impacting structure through its FMUs: its "
        "responses, where they are irregular, and how a motor of limited power drives it.",
        epilog=EXAMPLES.format(program=program, sets=list_shipped_sets()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=__version__)
    (debug,) = parse_options(DEBUG)
    parser.add_argument(debug.flag, **debug.details)
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")
    for command in COMMANDS:
        complete = words is None or command.name in words
        command.add_parser(commands, program, QUANTITIES, complete)
    return parser


def join_negative_values(arguments: Sequence[str]) -> list[str]:
    """Join ``--eta -1:2:0.5`` to ``--eta=-1:2:0.5``, which argparse would read as an option."""
    joined: list[str] = []
    for text in arguments:
        needs_value = joined and joined[-1].startswith("--") and "=" not in joined[-1]
        if needs_value and re.match(r"-[\d.]", text):
            joined[-1] += f"={text}"
        else:
            joined.append(text)
    return joined


def parse_arguments(arguments: Sequence[str]) -> argparse.Namespace:
    """Parse the arguments; raise for an unknown command or option, with the one most alike."""
    command = next((word for word in arguments if word != "--debug"), "-")
    names = [row.name for row in COMMANDS]
    if not command.startswith("-") and command not in names:
        near = closest(command, names)
        meant = f"; did you mean {near}?" if near else ""
        raise InputError(f"{command}: no command{meant} ({program_name()} --help lists them)")
    parser = make_parser(arguments)
    chosen, unknown = parser.parse_known_args(join_negative_values(arguments))
    if unknown:
        flag, _, value = " ".join(unknown[:2]).replace("=", " ").partition(" ")
        name = flag.lstrip("-").replace("-", "_")
        set_by = f"--set {name}={value}" if name in STRUCTURE_NAMES else ""
        near = set_by if "--set" in chosen.row.flags else ""
        if not near and flag.startswith("--"):
            near = closest(flag, [one for one in chosen.row.flags if one.startswith("--")])
        meant = f"; did you mean {near}?" if near else ""
        raise InputError(f"{flag}: no option of {command}{meant} ({command} --help lists them)")
    return chosen


def set_up_logging() -> None:
    """Send the library's log messages of level INFO and above to standard error."""
    logging.basicConfig(format="%(message)s")
    logging.getLogger(__package__.partition(".")[0]).setLevel(logging.INFO)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line on a list of arguments; print errors; return the exit code."""
    try:
        with safe_outputs() as output:
            code = run_command(sys.argv[1:] if arguments is None else arguments)
            output.flush()
            if output.failure():
                print_error(
                    f"error: standard output: {output.failure()}; what was computed is stored"
                )
                return code or FAILURE
            return code
    except KeyboardInterrupt as ended:  # before the command has begun, or as it goes
        return report_interruption(ended)


def run_command(arguments: Sequence[str]) -> int:
    """Parse the arguments and run the command they name; return the exit code."""
    set_up_logging()
    if store := sys.modules.get(STORE):  # of a command before, in this process
        store.STARTED.clear()
        store.FINISHED.clear()
    try:
        chosen = parse_arguments(arguments)
    except InputError as error:
        print_error(f"error: {error}")
        return MISTAKE
    chosen.command_line = f"{program_name()} {shlex.join(arguments)}"
    try:
        with print_warnings_in_one_line():
            chosen.run(chosen)
        return SUCCESS
    except KeyboardInterrupt as ended:
        return report_interruption(ended)
    except (MemoryError, ImportError) as error:
        if chosen.debug:
            raise
        reason = (str(error).strip().splitlines() or [type(error).__name__])[0]
        text = "out of memory, or the installation is incomplete"
        print_error(f"error: {reason}: {text}; {describe_progress_kept()}")
        return FAILURE
    except (VibroimpactError, RuntimeError, OSError) as error:
        if chosen.debug:
            raise
        hint = " (--force or --keep-stale)" if isinstance(error, StaleError) else ""
        print_error(f"error: {with_option_names(str(error), chosen)}{hint}")
        return MISTAKE if isinstance(error, InputError) else FAILURE


def report_interruption(ended: KeyboardInterrupt) -> int:
    """Print that SIGINT or SIGTERM has ended the command; return the exit code, 130 or 143."""
    terminated = isinstance(ended, Terminated)
    print_error(f"{'terminated' if terminated else 'interrupted'}: {describe_progress_kept()}")
    return TERMINATED if terminated else INTERRUPTED


def describe_progress_kept() -> str:
    """Return what an interrupted command tells: what of it is stored, and how to resume."""
    store = sys.modules.get(STORE)  # not imported only to say that nothing is in it
    if store and (store.STARTED or store.FINISHED):
        kept = "what was stored is kept" if store.STARTED else "the result is stored"
        return f"{kept}; repeat the command (without --force) to resume"
    return "nothing was stored; repeat the command to start again"


@contextmanager
def print_warnings_in_one_line() -> Iterator[None]:
    """Print a ``UserWarning`` in the ``with`` block as one line, without its place in the code."""
    usual = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
        if category is UserWarning:
            print_error(f"warning: {message}")
        else:
            usual(message, category, *place, **more)

    with warnings.catch_warnings():
        warnings.showwarning = show
        yield


def print_error(line: str) -> None:
    """Print a line on standard error, with control characters escaped."""
    print(printable(line), file=sys.stderr)
