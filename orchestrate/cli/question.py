"""Shared steps of all questions: ask, print the result, write the files."""

from __future__ import annotations

import argparse
import json
import logging
import math
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..constants import GRAVITY, TURN
from ..errors import InputError, StoreError
from .output import Files, name_of, preparing_a_picture, running_of

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Structure

HOW_DECIDED = {  # of attractors; nothing is said where Newton's method confirms a stable orbit
    2: ", by repeated states alone",
    4: ", undecided: near an unstable orbit",
}
FAR_RATIO = 25.0  # frequency ratio from which, or from whose inverse, there is little to be seen
log = logging.getLogger(__name__)
Question = Mapping[str, Any]
Draw = Callable[["xr.Dataset"], Any]


def carry_out(
    arguments: argparse.Namespace,
    structure: Structure,
    question: Question,
    report: Callable[[xr.Dataset], None],
    draw: Draw | None,
    ending: str = "",
    *,
    function: str = "",
    over: str = "",
) -> xr.Dataset:
    """Ask a question of the public API; print the result, write the files.

    Parameters
    ----------
    arguments : argparse.Namespace
    structure : Structure
    question : mapping
        All other keywords of the function.
    report : callable
        Prints what came out.
    draw : callable, optional
        From the result to a picture; none where there is nothing to draw.
    ending : str
        Of the files' names, where their pictures show more than this result.
    function : str
        Its name in the public face; by default the command's.
    over : str
        Ending of the pictures' names alone.

    Returns
    -------
    xarray.Dataset
        The answer.
    """
    import orchestrate

    command = function or arguments.command
    name = "_".join(filter(None, [name_of(command, structure, question), ending]))
    files = Files.from_options(arguments, name, over)
    ask = getattr(orchestrate, command)
    print_frequency_notes(arguments, structure, question)
    with preparing_a_picture(draw is not None and files.lacks_pictures()):
        data: xr.Dataset = ask(structure, **question, **running_of(arguments, files.result))
    for line in trivial_notes(structure, question):
        print(line)
    report(data)
    files.write(data, partial(draw, data) if draw else None)
    return data


def carry_out_beside(
    arguments: argparse.Namespace,
    structure: Structure,
    question: Question,
    report: Callable[[xr.Dataset], None],
) -> None:
    """Ask and draw as :func:`carry_out`; with ``--beside`` of the bonded structure before."""
    if not arguments.beside:
        carry_out(arguments, structure, question, report, picture_of)
        return
    for name in ("store", "start"):
        if getattr(arguments, name) is not None:
            raise InputError(f"--beside: of two structures; expected it without --{name}")
    bonded = carry_out(arguments, structure.as_bonded(), question, report, None)
    print("delaminated:")
    beside = partial(picture_of, bonded=bonded)
    carry_out(arguments, structure.as_delaminated(), question, report, beside, "with_bonded")


def picture_of(data: xr.Dataset, **more: Any) -> Any:
    """Draw an answer; with one of the bonded structure beside it, or branches over it."""
    from ..figures.plot import DRAW

    command = data.attrs["call"].partition("(")[0]
    return DRAW[command](data, **more)


def is_curve(question: Question) -> bool:
    """Return whether an argument has several values, so that there is a curve to draw."""
    return any(len(value) > 1 for value in question.values() if isinstance(value, tuple))


def print_table(data: xr.Dataset, name: str) -> None:
    """Print a result at one value as a table: there is no curve to draw."""
    print(f"one value, {format_parameter(name, float(data[name][0]))}: a table and no picture")
    numbers = data.isel({name: 0})
    for key, array in numbers.data_vars.items():
        if not set(array.dims) - {"direction", "structure"}:
            values = ", ".join(f"{float(value):.6g}" for value in array.values.ravel())
            unit = str(array.attrs.get("units", "1")).removeprefix("1")
            print(f"  {key:20} {values} {unit}".rstrip())


def trivial_notes(structure: Structure, question: Question) -> list[str]:
    """Return remarks on what makes an answer trivial."""
    varied = isinstance(question.get("level"), tuple) or question.get("over") == "level"
    if varied and structure.clearance == 0.0:
        return [
            "clearance = 0: the model is homogeneous, at twice the level it moves twice as far; "
            "one level is enough"
        ]
    if structure.bonded:
        return ["bonded: both masses move as one, there are no impacts"]
    if structure.alike:
        return ["both oscillators are alike: masses that start together never part"]
    return []


def print_frequency_notes(
    arguments: argparse.Namespace, structure: Structure, question: Question
) -> None:
    """Print whose frequencies they are if nobody chose the structure; warn if they are far from its
    own.
    """
    frequency = question.get("frequency")
    values = (
        frequency if isinstance(frequency, tuple) else () if frequency is None else (frequency,)
    )
    if not values:
        return
    own_frequency = f"{structure.omega / TURN:.4g} Hz"
    if getattr(arguments, "structure", "") == "paper" and not arguments.set:
        omega = f"omega = {structure.omega:.6g} rad/s, {own_frequency}"
        print(f"structure: the paper's, {omega} (--structure names another)")
    low, high = (end(values) / structure.omega for end in (min, max))
    if high > FAR_RATIO or low < 1.0 / FAR_RATIO:
        ends = " to ".join(f"{ratio:.3g}" for ratio in dict.fromkeys((low, high)))
        log.warning(
            "frequencies of %s times the structure's %s are far from it: is it the structure that "
            "is meant (--structure)?",
            *(ends, own_frequency),
        )


def parameter_of(data: xr.Dataset) -> str:
    """Return the parameter along which a result lies."""
    others = {"direction", "structure", "attractor"}
    (name,) = {str(dim) for dim in data.impacts_per_period.dims} - others
    return name


def format_parameter(name: str, value: float) -> str:
    """Format a value of a parameter: frequencies in Hz."""
    if name == "frequency":
        return f"{value / TURN:.6g} Hz"
    if name == "level":
        return f"{value / GRAVITY:.6g} g"
    return f"{name} = {value:.6g}"


def is_flag(values: xr.DataArray, word: str) -> xr.DataArray:
    """Return where a flag variable has the number that a word stands for."""
    number = values.attrs["flag_meanings"].split().index(word)
    return values == values.attrs["flag_values"][number]


def format_ranges(name: str, values: Any, flags: Any, max_ranges: int = 8) -> str:
    """Format the runs of values for which something holds.

    Parameters
    ----------
    name : str
        Of the parameter.
    values : array_like
        In increasing order.
    flags : array_like of bool
    max_ranges : int
        Runs that are listed; the longest ones.
    """
    runs: list[tuple[int, int]] = []
    for index, holds in enumerate(flags):
        if holds and runs and runs[-1][1] == index - 1:
            runs[-1] = (runs[-1][0], index)
        elif holds:
            runs.append((index, index))
    longest = sorted(sorted(runs, key=lambda run: run[0] - run[1])[:max_ranges])
    scale, unit = (1.0 / TURN, " Hz") if name == "frequency" else (1.0, "")
    ends = [[f"{scale * float(values[i]):.6g}" for i in dict.fromkeys(run)] for run in longest]
    text = ", ".join(" to ".join(pair) for pair in ends)
    left = len(runs) - len(longest)
    return f"{text}{unit}" + (f" and {left} shorter ranges" if left else "")


def print_attractors(data: xr.Dataset, whole: str) -> None:
    """Print attractors and their shares, a line each.

    Parameters
    ----------
    data : xarray.Dataset
        With variables over ``attractor`` alone.
    whole : str
        What the shares are of.
    """
    for number in range(data.sizes["attractor"]):
        attractor = data.isel(attractor=number)
        if math.isnan(float(attractor.multiplicity)):
            continue  # there at other values alone
        kind = int(attractor.multiplicity)
        word = f"repeats after {kind} period{'s' * (kind > 1)}" if kind else "not periodic"
        doubt = HOW_DECIDED.get(int(attractor.decided_by), "")
        print(
            f"  {number}: {float(attractor.share):6.1%} of {whole}, {word}, "
            f"{float(attractor.impacts_per_period):.4g} impacts per period, "
            f"largest gap xi_Rel = {float(attractor.xi_rel_max):.5g}{doubt}"
        )
        state = ",".join(f"{value:.6g}" for value in attractor.state.values)
        print(f"     a state on it at phase 0, x1, x2 in m, v1, v2 in m/s: {state}")


def read_stored(option: str, path: Path) -> xr.Dataset:
    """Read a result of an earlier command.

    Raises
    ------
    InputError
        Where the file is none.
    """
    from ..running.store import load

    if not path.is_file():
        raise InputError(f"{option} {path}: no such file; expected a result of an earlier command")
    try:
        data = load(path)
    except StoreError as error:
        expected = "" if "expected" in str(error) else "; expected a NetCDF file"
        raise InputError(f"{option} {error}{expected}") from None
    try:
        json.loads(data.attrs.get("identity", '{"question": ""}'))["question"]
    except (ValueError, TypeError, KeyError, RecursionError):
        expected = "expected a result of an earlier command"
        raise InputError(f"{option} {path}: its identity is damaged; {expected}") from None
    return data
