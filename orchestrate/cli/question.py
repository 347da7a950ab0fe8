"""Steps of most commands: call the public function, print the result, write its files."""

from __future__ import annotations

import argparse
import json
import logging
import math
import warnings
from collections.abc import Callable, Collection, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..constants import TURN
from ..errors import InputError, StoreError
from ..outcomes import REPEATED, UNDECIDED
from ..units import (
    Units,
    as_shown,
    omega_of,
    shown_number,
    text_of,
    units_of,
    with_readable_lengths,
    with_units,
)
from .output import Files, importing_matplotlib, read_running_options, read_units, result_name

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Structure

HOW_DECIDED: dict[
    int, str
] = {  # of attractors; nothing is said where Newton's method confirms a stable orbit
    REPEATED: ", by repeated states alone",
    UNDECIDED: ", undecided: near an unstable orbit, or before impacts that have to come",
}
FAR_RATIO = 25.0  # frequency ratio from which, or from whose inverse, there is little to be seen
FAR_LEVEL = 200.0  # times the level from which a clearance is hardly meant
NEAR = 0.1  # of a frequency: so far beside its own ones a structure is still asked about
OTHER_UNIT = {  # of an option: its unit over the other one's, names of both
    "frequency": (1.0 / TURN, "rad/s", "--hz"),
    "hz": (TURN, "Hz", "--frequency"),
}
UNIT_OF_OPTION = {"hz": "Hz", "rpm": "rpm", "frequency": "rad/s", "eta": "eta"}
UNIT_OF_KEY = {
    "frequency_hz": "Hz",
    "frequency_rpm": "rpm",
    "frequency_rad_s": "rad/s",
    "eta": "eta",
}
COMPLETE = ({"eta"}, {"frequency", "amplitude"}, {"frequency", "level"})
log = logging.getLogger(__name__)
Question = Mapping[str, Any]
Draw = Callable[["xr.Dataset"], Any]


def answer_question(
    arguments: argparse.Namespace,
    structure: Structure,
    question: Question,
    print_result: Callable[[xr.Dataset], None],
    draw: Draw | None,
    ending: str = "",
    *,
    function: str = "",
    over: str = "",
) -> xr.Dataset:
    """Call a command's public function; print its result; write files; return the dataset."""
    import orchestrate

    command = function or arguments.command
    usual, units = asked_units(arguments, question)
    named = result_name(command, structure, question, usual.frequency)
    files = Files.from_options(arguments, "_".join(filter(None, [named, ending])), over)
    ask = getattr(orchestrate, command)
    print_frequency_notes(arguments, structure, question)
    with importing_matplotlib(draw is not None and files.lacks_pictures()):
        data: xr.Dataset = ask(
            structure, **question, **read_running_options(arguments, files.result)
        )
    asked = with_units(data, units)
    (shown,) = with_readable_lengths(asked)
    for line in trivial_notes(structure, question, shown):
        print(line)
    print_result(shown)
    files.write(asked, partial(draw, shown) if draw else None)
    return data


def asked_units(arguments: argparse.Namespace, question: Question) -> tuple[Units, Units]:
    """Return the units of the frequency options given, and the units to display, as ``Units``."""
    varied = str(getattr(arguments, "over", "")).replace(" ", "").split(",")  # two of a border
    over = next((UNIT_OF_OPTION[name] for name in varied if name in UNIT_OF_OPTION), "")
    given = [unit for name, unit in UNIT_OF_OPTION.items() if getattr(arguments, name, None)]
    keys = excitation_keys(arguments) if "frequency" in question and not given else ()
    given += [unit for key, unit in UNIT_OF_KEY.items() if key in keys]
    both = question.get("over", ())  # of a border
    by_ratio = "eta" in question or (not isinstance(both, str) and "eta" in both)
    frequency = over or next(iter(given), "eta" if by_ratio else "Hz")
    in_g = getattr(arguments, "g", None) is not None or "acceleration_g" in keys
    asked = Units(frequency, acceleration="g" if in_g else "")
    return asked, read_units(arguments).with_defaults(asked)


def excitation_keys(arguments: argparse.Namespace) -> Collection[str]:
    """Return the keys of the section ``[excitation]`` in the TOML file of ``--structure``."""
    from ..structures.files import parse, resolve

    if arguments.structure is None:  # but that of a stored result
        return ()
    excitation = parse(resolve(arguments.structure)).get("excitation", {})
    return tuple(excitation)


def answer_with_bonded(
    arguments: argparse.Namespace,
    structure: Structure,
    question: Question,
    print_result: Callable[[xr.Dataset], None],
) -> None:
    """Call :func:`answer_question`; with ``--beside`` also for the bonded structure, drawn in."""
    if not arguments.beside:
        answer_question(arguments, structure, question, print_result, draw_result)
        return
    for name in ("store", "start"):
        if getattr(arguments, name) is not None:
            raise InputError(f"--beside: of two structures; expected it without --{name}")
    bonded = answer_question(arguments, structure.as_bonded(), question, print_result, None)
    print("delaminated:")
    beside = partial(draw_result, bonded=bonded)
    answer_question(
        arguments, structure.as_delaminated(), question, print_result, beside, "with_bonded"
    )


def draw_result(data: xr.Dataset, **more: Any) -> Any:
    """Draw a result by the function that its dataset names; return the figure."""
    from ..figures.plot import DRAW

    command = data.attrs["call"].partition("(")[0]
    return DRAW[command](data, **more)


def is_curve(question: Question) -> bool:
    """Return whether any argument has several values, so that a curve can be drawn."""
    return any(len(value) > 1 for value in question.values() if isinstance(value, tuple))


def print_table(data: xr.Dataset, name: str) -> None:
    """Print all variables of a result at one parameter value as a table."""
    where = format_parameter(data, name, float(data[name][0]))
    print(f"one value, {where}: a table and no picture")
    numbers = as_shown(data.isel({name: 0}))
    for key, array in numbers.data_vars.items():
        if not set(array.dims) - {"direction", "structure"}:
            values = ", ".join(f"{float(value):.6g}" for value in array.values.ravel())
            unit = str(array.attrs.get("units", "1")).removeprefix("1")
            print(f"  {key:20} {values} {unit}".rstrip())


def trivial_notes(structure: Structure, question: Question, shown: xr.Dataset) -> list[str]:
    """Return notes for the user on arguments that make the result trivial, such as bonded."""
    varied = isinstance(question.get("level"), tuple) or question.get("over") == "level"
    if varied and not structure.has_scale:
        from ..structures.ranges import OF_LENGTH

        nothing = ", ".join(f"{name} = 0" for name in OF_LENGTH)
        return [
            f"{nothing}: the model is homogeneous, at twice the level it moves twice as far; "
            "one level is enough"
        ]
    if structure.bonded:
        return ["bonded: both masses move as one, there are no impacts"]
    if structure.alike:
        return ["both oscillators are alike: masses that start together never part"]
    return clearance_notes(structure, question, shown)


def print_frequency_notes(
    arguments: argparse.Namespace, structure: Structure, question: Question
) -> None:
    """Print which structure is used by default; warn if frequencies are far from its own."""
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
    warn_of_other_unit(arguments, structure, values)
    low, high = (end(values) / structure.omega for end in (min, max))
    if high > FAR_RATIO or low < 1.0 / FAR_RATIO:
        ends = " to ".join(f"{ratio:.3g}" for ratio in dict.fromkeys((low, high)))
        log.warning(
            "frequencies of %s times the structure's %s are far from it: is it the structure that "
            "is meant (--structure)?",
            *(ends, own_frequency),
        )


def warn_of_other_unit(
    arguments: argparse.Namespace, structure: Structure, values: tuple[float, ...]
) -> None:
    """Warn if frequencies would fit the structure in the other unit: Hz for rad/s or reverse."""
    low, high = (1.0 - NEAR) * min(values), (1.0 + NEAR) * max(values)
    own = [TURN * f for f in (structure.f1, structure.f2)]
    if math.isclose(structure.omega, 1.0) or any(low <= omega <= high for omega in own):
        return
    for name, (factor, unit, other) in OTHER_UNIT.items():
        text = getattr(arguments, name, None)
        if text and any(low <= factor * omega <= high for omega in own):
            numbers = f"{structure.f1:.4g} and {structure.f2:.4g} Hz"
            warnings.warn(
                f"--{name} {text}: these are {unit}, and the structure's own frequencies are "
                f"{numbers}; is {other} meant?",
                stacklevel=2,
            )


def clearance_notes(structure: Structure, question: Question, shown: xr.Dataset) -> list[str]:
    """Return a note if the level is below the threshold at which the gap opens or closes."""
    import numpy as np

    names = {"eta", "frequency", "amplitude", "level"} & question.keys()
    if question.get("over") == "level":
        question, names = {**question, "level": question["values"]}, names | {"level"}
    elif question.get("over") is not None or "clearance" in question:
        return []
    if structure.bonded or not structure.clearance or names not in COMPLETE:
        return []
    ratio = threshold_over_level(structure, {name: np.ravel(question[name]) for name in names})
    if ratio <= 1.0:
        return []
    opens = structure.clearance < 0.0
    if ratio > FAR_LEVEL:
        warnings.warn(
            f"clearance = {structure.clearance:g} m: {ratio:.3g} times what this level moves; is "
            "it in m (20 um is 2e-5)?",
            stacklevel=2,
        )
    kind = "pressed together" if opens else "open"
    return [
        f"{kind} by {text_of(shown, abs(structure.clearance), 'm')}, it first "
        f"{'opens' if opens else 'touches'} at {ratio:.4g} times this level: from rest the "
        "response is linear"
    ]


def threshold_over_level(structure: Structure, box: Mapping[str, Any]) -> float:
    """Return the smallest ratio of contact threshold to excitation level, of all points asked."""
    import orchestrate

    frequency = box["eta"] * structure.omega if "eta" in box else box["frequency"]
    level = orchestrate.contact_threshold(structure, frequency=frequency)
    threshold = level.threshold_amplitude.values
    if "eta" in box:
        return float((threshold * box["eta"] ** 2).min())
    if "level" in box:
        return float((threshold * frequency**2).min() / box["level"].max())
    return float((threshold / box["amplitude"]).min())


def varied_parameter(data: xr.Dataset) -> str:
    """Return the name of the parameter along which a result lies."""
    others = {"direction", "structure", "attractor"}
    (name,) = {str(dim) for dim in data.impacts_per_period.dims} - others
    return name


def format_parameter(data: xr.Dataset, name: str, value: float) -> str:
    """Format a parameter's value in display units: ``12.5 Hz``, ``e = 0.7``."""
    before, number, unit = parameter_parts(data, name, value)
    return f"{before} = {number} {unit}".rstrip() if before else f"{number} {unit}"


def parameter_parts(
    data: xr.Dataset, name: str, value: float, form: str = ".6g"
) -> tuple[str, str, str]:
    """Return a parameter's name (may be empty), formatted value and unit for display."""
    units, omega = units_of(data), omega_of(data)
    if name == "eta" and units.frequency not in ("", "eta") and math.isfinite(omega):
        name, value = "frequency", value * omega
    if name == "frequency":
        shown = data if units.frequency else with_units(data, "Hz")
        number, unit = shown_number(shown, value, "rad/s", form)
        return ("eta", number, "") if unit == "eta" else ("", number, unit)
    if name == "level":
        shown = data if units.acceleration else with_units(data, "g")
        return ("", *shown_number(shown, value, "m/s2", form))
    return (name, *shown_number(data, value, unit_of(data, name), form))


def unit_of(data: xr.Dataset, name: str) -> str:
    """Return the SI unit of a dataset's parameter; empty where it has none."""
    unit = str(data[name].attrs.get("units", "")) if name in data.variables else ""
    return unit.removeprefix("1")


def has_flag(values: xr.DataArray, word: str) -> xr.DataArray:
    """Return a Boolean array: where a CF flag variable has the number of a word."""
    number = values.attrs["flag_meanings"].split().index(word)
    return values == values.attrs["flag_values"][number]


def format_ranges(data: xr.Dataset, name: str, values: Any, flags: Any, max_ranges: int = 8) -> str:
    """Format the parameter ranges in which flags are true: ``0.4 to 0.6, 0.8``."""
    runs: list[tuple[int, int]] = []
    for index, holds in enumerate(flags):
        if holds and runs and runs[-1][1] == index - 1:
            runs[-1] = (runs[-1][0], index)
        elif holds:
            runs.append((index, index))
    longest = sorted(sorted(runs, key=lambda run: run[0] - run[1])[:max_ranges])
    ends = [
        [parameter_parts(data, name, float(values[i])) for i in dict.fromkeys(run)]
        for run in longest
    ]
    before, _, unit = ends[0][0] if ends else ("", "", "")
    text = ", ".join(" to ".join(number for _, number, _ in run) for run in ends)
    left = len(runs) - len(longest)
    words = f"{before} = {text}" if before else text
    return f"{words} {unit}".rstrip() + (f" and {left} shorter ranges" if left else "")


def format_largest_gap(data: xr.Dataset, form: str = ".6g") -> str:
    """Format a response's largest gap over a eta^2 and, where the box's motion is known, as
    length.
    """
    from ..units import length_of_ratio, text_of

    ratio, length = float(data.xi_rel_max), length_of_ratio(data)
    parts = [f"xi_Rel = {ratio:{form}}"]
    if length is not None and math.isfinite(float(length)):
        parts.append(text_of(data, ratio * float(length), "m", ".4g"))
    return ", ".join(parts)


def print_attractors(data: xr.Dataset, whole: str) -> None:
    """Print attractors with share, period, impacts and a state, two lines each."""
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
            f"largest gap {format_largest_gap(attractor, '.5g')}{doubt}"
        )
        state = ",".join(f"{value:.6g}" for value in attractor.state.values)
        print(f"     a state on it at phase 0, x1, x2 in m, v1, v2 in m/s: {state}")


def read_earlier_result(option: str, path: Path) -> xr.Dataset:
    """Read the NetCDF result of an earlier command; raise naming the option if it is none."""
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
