"""``spectra``: acceleration spectra of a delamination, on a motor or shaken harmonically."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from ..units import text_of, with_units
from .drives import drive_units
from .grammar import changes_of, plain_float
from .options import (
    FREQUENCIES,
    Commands,
    add_drive,
    add_excitation,
    amplitude_of,
    excitation_of,
    options,
    structure_and_drive,
)
from .output import Files, add_results, add_units, digest, running_of
from .question import carry_out, format_parameter, picture_of

if TYPE_CHECKING:
    import xarray as xr

USUAL = {"quick": 1.53, "beam": 1.45}  # eta0 at which the motor hangs at the resonance
EXAMPLES = """\
  {program} spectra                      Figure 3: quick, the motor hangs at the resonance
  {program} spectra --drive beam --voltage 6.5
  {program} spectra --eta 0.4,1.047      shaken harmonically instead, at these frequency ratios
  {program} spectra --structure beam --hz 12.5 --g 0.02 --format nc,csv"""


def add_parser(commands: Commands) -> None:
    """Add the command's parser."""
    text = "acceleration spectra, bonded beside delaminated (Figure 3)"
    parser = commands.add("spectra", run, text, EXAMPLES)
    add_drive(parser)
    option = parser.add_argument_group("shaken by the motor").add_argument
    option(
        "--eta0",
        type=plain_float,
        help="voltage as no-load speed over omega (default: "
        + ", ".join(f"{eta0} for {name}" for name, eta0 in USUAL.items())
        + ", else between the jumps of the averaged theory)",
    )
    option("--voltage", type=plain_float, help="the same in V")
    add_excitation(parser, usual="none: shaken by the motor")
    commands.question(parser).declare("transient", "periods", "points")
    add_units(parser)
    add_results(parser, several=True)


def run(arguments: argparse.Namespace) -> None:
    """Compute acceleration spectra, on a motor or under harmonic excitation."""
    frequencies = [name for name in FREQUENCIES if getattr(arguments, name) is not None]
    if not frequencies and amplitude_of(arguments) is None:
        motor_spectra(arguments)
        return
    for name in ("eta0", "voltage"):
        if getattr(arguments, name) is not None:
            what = options(frequencies or ["amplitude or --g"], " and ")
            raise InputError(f"{what}: expected without --{name}, which is the motor's")
    harmonic_spectra(arguments)


def motor_spectra(arguments: argparse.Namespace) -> None:
    """Compute spectra with a motor (Figure 3)."""
    if arguments.eta0 is not None and arguments.voltage is not None:
        raise InputError("--eta0 and --voltage: expected one of them")
    structure, drive = structure_and_drive(arguments)
    eta0 = USUAL.get(arguments.drive) if arguments.eta0 is None else arguments.eta0
    voltage = arguments.voltage
    if voltage is None and eta0 is not None:
        voltage = eta0 * drive.volts(structure)
    digits = digest(structure.parameters(), drive.parameters(), voltage)
    files = Files.from_options(arguments, f"spectra_{Path(arguments.drive).stem}_{digits}")

    from ..figures import drive_spectra as figure
    from ..weak_drive.drive_spectra import drive_spectra

    data = drive_spectra(structure, drive, voltage=voltage, **running_of(arguments, files.result))
    data = with_units(data, drive_units(arguments))
    for kind in map(str, data.kind.values):
        part = data.sel(kind=kind, mass=1)
        speed = text_of(data, part.speed, "rad/s", ".5g")
        print_line_ratio(data, f"{kind} at {speed}", part.acceleration)
    words = str(data.attrs["title"])
    title = f"{Path(arguments.drive).stem}: {words[0].lower()}{words[1:]}, mass 1 in space"
    files.write(data, lambda: figure.draw(data, title=title))


def harmonic_spectra(arguments: argparse.Namespace) -> None:
    """Compute spectra under harmonic excitation."""
    from ..structures import Structure

    structure = Structure.from_file(arguments.structure or "paper")
    structure = structure.replace(**changes_of(arguments.set))
    excitation = excitation_of(arguments, structure, si=True)
    question = {**excitation, **arguments.question.keywords(arguments)}
    carry_out(arguments, structure, question, print_result, picture_of)


def print_result(data: xr.Dataset) -> None:
    """Print the largest lines, a line per kind and frequency."""
    name = str(data.acceleration.dims[0])
    for value in data[name].values:
        for kind in map(str, data.kind.values):
            part = data.acceleration.sel({"kind": kind, "mass": 1, name: value})
            where = format_parameter(data, name, float(value))
            print_line_ratio(data, f"{kind} at {where}", part)


def print_line_ratio(data: xr.Dataset, name: str, amplitude: xr.DataArray) -> None:
    """Print the largest line, and how much there is above the excitation."""
    largest = float(amplitude.max())
    above = float(amplitude.where(amplitude.order > 1.5, 0.0).max())
    share = above / largest if largest else 0.0
    line = text_of(data, largest, "m/s2", ".4g")
    print(f"{name}: largest line {line}, {share:.2g} of it above the excitation")
