"""Command ``spectra``: acceleration spectra, on a motor or under harmonic excitation."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from ..units import text_of, with_units
from .drive_options import drive_units
from .grammar import parse_changes, plain_float
from .options import (
    FREQUENCIES,
    Commands,
    add_drive_options,
    add_excitation_options,
    join_option_names,
    read_amplitude,
    read_drive_options,
    read_excitation,
)
from .output import Files, add_result_options, add_units_option, digest, read_running_options
from .question import answer_question, draw_result, format_parameter

if TYPE_CHECKING:
    import xarray as xr

USUAL = {"quick": 1.53, "beam": 1.45}  # eta0 at which the motor hangs at the resonance
EXAMPLES = """\
  {program} spectra                      Figure 3: quick, the motor hangs at the resonance
  {program} spectra --drive beam --voltage 6.5
  {program} spectra --eta 0.4,1.047      shaken harmonically instead, at these frequency ratios
  {program} spectra --structure beam --hz 12.5 --g 0.02 --format nc,csv"""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``spectra`` with its options."""
    text = "acceleration spectra, bonded beside delaminated (Figure 3)"
    parser = commands.add("spectra", run, text, EXAMPLES)
    add_drive_options(parser)
    option = parser.add_argument_group("shaken by the motor").add_argument
    option(
        "--eta0",
        type=plain_float,
        help="voltage as no-load speed over omega (default: "
        + ", ".join(f"{eta0} for {name}" for name, eta0 in USUAL.items())
        + ", else between the jumps of the averaged theory)",
    )
    option("--voltage", type=plain_float, help="the same in V")
    add_excitation_options(parser, usual="none: shaken by the motor")
    commands.add_function_options(parser).declare("transient", "periods", "points")
    add_units_option(parser)
    add_result_options(parser, several=True)


def run(arguments: argparse.Namespace) -> None:
    """Run ``spectra``: compute spectra on a motor, or harmonic ones if a frequency is given."""
    frequencies = [name for name in FREQUENCIES if getattr(arguments, name) is not None]
    if not frequencies and read_amplitude(arguments) is None:
        run_motor_spectra(arguments)
        return
    for name in ("eta0", "voltage"):
        if getattr(arguments, name) is not None:
            what = join_option_names(frequencies or ["amplitude or --g"], " and ")
            raise InputError(f"{what}: expected without --{name}, which is the motor's")
    run_harmonic_spectra(arguments)


def run_motor_spectra(arguments: argparse.Namespace) -> None:
    """Compute spectra of a motor-driven structure (Figure 3); print, store and draw them."""
    if arguments.eta0 is not None and arguments.voltage is not None:
        raise InputError("--eta0 and --voltage: expected one of them")
    structure, drive = read_drive_options(arguments)
    eta0 = USUAL.get(arguments.drive) if arguments.eta0 is None else arguments.eta0
    voltage = arguments.voltage
    if voltage is None and eta0 is not None:
        voltage = eta0 * drive.volts(structure)
    digits = digest(structure.parameters(), drive.parameters(), voltage)
    files = Files.from_options(arguments, f"spectra_{Path(arguments.drive).stem}_{digits}")

    from ..figures.spectra import draw_motor_spectra
    from ..weak_drive.drive_spectra import drive_spectra

    data = drive_spectra(
        structure, drive, voltage=voltage, **read_running_options(arguments, files.result)
    )
    data = with_units(data, drive_units(arguments))
    for kind in map(str, data.kind.values):
        part = data.sel(kind=kind, mass=1)
        speed = text_of(data, part.speed, "rad/s", ".5g")
        print_line_ratio(data, f"{kind} at {speed}", part.acceleration)
    words = str(data.attrs["title"])
    question = f"{words[0].lower()}{words[1:]}, absolute acceleration of mass 1"
    title = f"{Path(arguments.drive).stem}: {question}"
    files.write(data, lambda: draw_motor_spectra(data, title=title))


def run_harmonic_spectra(arguments: argparse.Namespace) -> None:
    """Compute spectra under harmonic excitation; print, store and draw them."""
    from ..structures import Structure

    structure = Structure.from_file(arguments.structure or "paper")
    structure = structure.replace(**parse_changes(arguments.set))
    excitation = read_excitation(arguments, structure, si=True)
    question = {**excitation, **arguments.question.keywords(arguments)}
    answer_question(arguments, structure, question, print_result, draw_result)


def print_result(data: xr.Dataset) -> None:
    """Print each spectrum's largest line, by structure and frequency."""
    name = str(data.acceleration.dims[0])
    for value in data[name].values:
        for kind in map(str, data.kind.values):
            part = data.acceleration.sel({"kind": kind, "mass": 1, name: value})
            where = format_parameter(data, name, float(value))
            print_line_ratio(data, f"{kind} at {where}", part)


def print_line_ratio(data: xr.Dataset, name: str, amplitude: xr.DataArray) -> None:
    """Print a spectrum's largest line, and its largest one above the excitation over that."""
    largest = float(amplitude.max())
    above = float(amplitude.where(amplitude.order > 1.5, 0.0).max())
    share = above / largest if largest else 0.0
    line = text_of(data, largest, "m/s2", ".4g")
    print(f"{name}: largest line {line}, {share:.2g} of it above the excitation")
