"""Command line's entry: parse the arguments, run one command, turn errors into exit codes.

A command is a class (:mod:`.command`); the classes stand in one module for each family of commands.

====================  ================================================================
module                idea
====================  ================================================================
:mod:`.command`       a command as a class, whose options are its attributes
:mod:`.grammar`       texts of options: numbers, lists, ranges, pairs, states
:mod:`.options`       options that several commands share: structure, the box's motion
:mod:`.output`        options of results: where they go, how they are computed
:mod:`.answer`        steps of most commands: call, summary, files
:mod:`.notes`         notes on trivial questions, warnings of unlikely numbers
:mod:`.printing`      what is printed of a result, by what its variables say; tables
:mod:`.responses`     simulate, resonance, spectra, sweep, map
:mod:`.dynamics`      exponents, sections, attractors, basins, orbits, branches
:mod:`.laboratory`    shake, analyse, channels, halves
:mod:`.diagnosis`     diagnose, plan
:mod:`.drive`         options that commands on the weak drive share
:mod:`.weak_drive`    couple, cosimulate, capture, passage, jump-voltages, drive-branch
:mod:`.pages`         build, explore, report, paper
:mod:`.safe_output`   standard streams that may be closed, full or not read
====================  ================================================================
"""

from __future__ import annotations

import itertools
import logging
import re
import shlex
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cyclopts
from cyclopts.exceptions import CycloptsError

from ..errors import InputError, StaleError, Terminated, VibroimpactError, printable_line
from ..model.spelling import closest_name, did_you_mean
from ..version import __version__
from . import diagnosis, dynamics, laboratory, pages, responses, weak_drive
from .command import Command, explain_parse_error
from .grammar import with_option_names
from .options import QUANTITIES, format_shipped_sets
from .safe_output import safe_outputs

COMMANDS: dict[str, type[Command]] = {
    kind.name(): kind
    for kind in (
        *(pages.Build, responses.Simulate, laboratory.Shake, laboratory.Analyse),
        *(laboratory.Channels, laboratory.Halves),
        *(diagnosis.Diagnose, diagnosis.Plan, responses.Resonance, responses.Spectra),
        *(responses.Sweep, responses.Map, dynamics.Lyapunov, dynamics.Poincare),
        *(dynamics.Attractors, dynamics.Basin, dynamics.Orbit, dynamics.Manifold),
        *(dynamics.Branch, dynamics.Border, weak_drive.Cosimulate, weak_drive.Couple),
        *(weak_drive.Capture, weak_drive.Passage, weak_drive.JumpVoltages),
        *(weak_drive.DriveBranch, pages.Explore, pages.Report, pages.Paper),
    )
}
SUCCESS, FAILURE, MISTAKE, INTERRUPTED, TERMINATED = 0, 1, 2, 130, 143
STORE = "orchestrate.running.store"
EXAMPLES = """examples:
  {program} build
  {program} sweep
  {program} sweep --set e=0.3 --eta 0.9:1.1:0.001
  {program} resonance --structure beam --hz 8:20:0.05 --g 0.02
  {program} simulate --set wall=true --set f1=12 --set clearance=0.3mm --hz 11 --g 0.1
  {program} channels record.csv
  {program} diagnose record.csv --structure beam.toml
  {program} COMMAND --help

sets of parameters that come with the package, for --structure and --drive:
{sets}"""

REMARKS = {  # below the help of commands that have an option
    "--eta0": """
eta0 = U/(K omega) is the voltage U as no-load speed over omega = sqrt(k1/m1): the speed, in omega,
at which the motor turns at this voltage without a load; K is motor_constant.""",
    "--force": "\nRepeat the command to resume an interrupted run; a finished result stays.",
}


def program_name() -> str:
    """Return the name to show in help texts: ``vibroimpact`` or ``python -m orchestrate``."""
    called = Path(sys.argv[0]).name if sys.argv and sys.argv[0] else ""
    return "vibroimpact" if called.startswith("vibroimpact") else "python -m orchestrate"


def make_app(chosen: str) -> cyclopts.App:
    """Return the program as cyclopts knows it: one command, or the list of all without options."""
    app = cyclopts.App(
        name=program_name(),
        help="Simulate and analyse a vibro-impacting structure through its FMUs: its responses, "
        "where they are irregular, and how a motor of limited power drives it.",
        help_format="plaintext",
        version=__version__,
        print_error=False,
        exit_on_error=False,
    )
    if chosen in COMMANDS:
        app.command(COMMANDS[chosen].cyclopts_app())
        return app
    for number, (name, kind) in enumerate(COMMANDS.items()):
        app.command(cyclopts.App(name=name, help=kind.__doc__, sort_key=number))
    return app


def help_epilogue(name: str) -> str:
    program = program_name()
    if name not in COMMANDS:
        return EXAMPLES.format(program=program, sets=format_shipped_sets())
    flags = COMMANDS[name].flags()
    examples = COMMANDS[name].examples.replace("{program}", program)
    quantities = QUANTITIES if "--structure" in flags else ""
    more = "".join(text for flag, text in REMARKS.items() if flag in flags)
    return f"{quantities}examples:{examples}{more}"


def join_negative_values(arguments: Sequence[str]) -> list[str]:
    """Join ``--at -1,2`` to ``--at=-1,2``, which cyclopts would read as an option."""
    joined: list[str] = []
    for text in arguments:
        takes_value = joined and joined[-1].startswith("--") and "=" not in joined[-1]
        if takes_value and re.match(r"-[\d.]", text):
            joined[-1] += f"={text}"
        else:
            joined.append(text)
    return joined


def parse_arguments(arguments: Sequence[str]) -> Command | None:
    """Return the command with its options; print a help, and return None, where that is asked.

    Raise ``InputError`` for a mistake, with the command or option that is probably meant.
    """
    words = join_negative_values(arguments)
    before = [*itertools.takewhile(lambda word: word in ("--debug", "--help"), words)]
    words = [*words[len(before) :], *before]
    name = words[0] if words else "COMMAND is missing"
    help_is_at = f"({program_name()} --help lists them)"
    if name not in COMMANDS and not name.startswith("-"):
        meant = did_you_mean(closest_name(name, COMMANDS))
        raise InputError(f"{name}: no command{meant} {help_is_at}")
    try:
        call, bound, _ = make_app(name).parse_args(words)
    except CycloptsError as error:
        if name not in COMMANDS:
            raise InputError(f"{name}: no option before a COMMAND {help_is_at}") from None
        raise InputError(explain_parse_error(error, COMMANDS[name])) from None
    chosen = call(*bound.args, **bound.kwargs)
    if isinstance(chosen, Command):
        return chosen
    if "--version" not in words:
        print(help_epilogue(name))
    return None


def main(arguments: Sequence[str] | None = None) -> int:
    try:
        with safe_outputs() as output:
            code = run_command(sys.argv[1:] if arguments is None else arguments)
            output.flush()
            if reason := output.failure_reason():
                print_error(f"error: standard output: {reason}; what was computed is stored")
                return code or FAILURE
            return code
    except KeyboardInterrupt as ended:  # before the command has begun, or as it goes
        return report_interruption(ended)


def run_command(arguments: Sequence[str]) -> int:
    logging.basicConfig(format="%(message)s")
    logging.getLogger(__package__.partition(".")[0]).setLevel(logging.INFO)
    if store := sys.modules.get(STORE):  # of a command before, in this process
        store.STARTED.clear()
        store.FINISHED.clear()
    try:
        chosen = parse_arguments(arguments)
    except InputError as error:
        print_error(f"error: {error}")
        return MISTAKE
    if chosen is None:
        return SUCCESS
    chosen.command_line = f"{program_name()} {shlex.join(arguments)}"
    try:
        with print_warnings_in_one_line(chosen):
            chosen()
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
def print_warnings_in_one_line(chosen: Command) -> Iterator[None]:
    usual = warnings.showwarning

    def show_in_one_line(message: Any, category: Any, *place: Any, **more: Any) -> None:
        if category is UserWarning:
            print_error(f"warning: {with_option_names(str(message), chosen)}")
        else:
            usual(message, category, *place, **more)

    with warnings.catch_warnings():
        warnings.showwarning = show_in_one_line
        yield


def print_error(line: str) -> None:
    print(printable_line(line), file=sys.stderr)
