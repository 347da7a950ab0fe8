"""``spectra``: what an accelerometer hears of a delamination, on a motor or shaken harmonically."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import Commands, add_drive, changes_of, described, values_of
from .output import add_running, check_output, draw_if_missing, own_fmus, running_of

if TYPE_CHECKING:
    import xarray as xr

USUAL = {"quick": 1.53, "beam": 1.45}  # eta0 at which the motor hangs at the resonance
EXAMPLES = """\
  {program} spectra                      Figure 3: quick, the motor hangs at the resonance
  {program} spectra --drive beam --voltage 6.5
  {program} spectra --eta 0.4,1.047      shaken harmonically instead, at these frequency ratios
  {program} spectra --structure beam --eta 1.047"""


def add_parser(commands: Commands) -> None:
    """Declare the command."""
    text = "acceleration spectra, bonded beside delaminated (Figure 3)"
    parser = commands.add("spectra", run, text, EXAMPLES)
    add_drive(parser)
    option = parser.add_argument_group("shaken by the motor").add_argument
    option(
        "--eta0",
        type=float,
        help="voltage as no-load speed over omega (default: "
        + ", ".join(f"{eta0} for {name}" for name, eta0 in USUAL.items())
        + ", else between the jumps of the averaged theory)",
    )
    option("--voltage", type=float, help="the same in V")
    option = parser.add_argument_group("shaken harmonically").add_argument
    option("--eta", metavar="VALUES", help="frequency ratios, FIRST:LAST:STEP or A,B,...")
    option("--transient", type=int, default=2000, help="periods dropped (default: %(default)s)")
    option("--periods", type=int, default=64, help="periods of the record (default: %(default)s)")
    option("--points", type=int, default=1024, help="samples a period (default: %(default)s)")
    add_running(parser, several=True)


def run(arguments: argparse.Namespace) -> None:
    """Carry it out."""
    harmonic = arguments.eta is not None
    if harmonic and not (arguments.eta0 is arguments.voltage is None):
        raise InputError("--eta: expected without --eta0 and --voltage, which are the motor's")
    check_output(arguments.output)
    (shaken_harmonically if harmonic else shaken_by_the_motor)(arguments)


def shaken_by_the_motor(arguments: argparse.Namespace) -> None:
    """Figure 3."""
    if arguments.eta0 is not None and arguments.voltage is not None:
        raise InputError("--eta0 and --voltage: expected one of them")
    structure, drive = described(arguments)
    eta0 = USUAL.get(arguments.drive) if arguments.eta0 is None else arguments.eta0
    voltage = arguments.voltage
    if voltage is None and eta0 is not None:
        voltage = eta0 * drive.volts(structure)
    result = arguments.output / f"spectra_{Path(arguments.drive).stem}.nc"
    fresh = arguments.force or not result.exists()

    from ..figures import drive_spectra as figure
    from ..weak_drive.drive_spectra import drive_spectra

    running: Any = {**running_of(arguments, result), "fmu": own_fmus(arguments.fmu)}
    data = drive_spectra(structure, drive, voltage=voltage, **running)
    for kind in map(str, data.kind.values):
        part = data.sel(kind=kind, mass=1)
        heard(f"{kind} at {float(part.speed):.4f} rad/s", part.acceleration)
    finish(result, fresh, lambda: figure.draw(data))


def shaken_harmonically(arguments: argparse.Namespace) -> None:
    """Spectra at frequency ratios."""
    etas, _ = values_of("--eta", arguments.eta)

    from .. import spectra
    from ..figures import spectra as figure
    from ..structures import Structure

    structure = Structure.from_file(arguments.structure or "paper")
    structure = structure.replace(**changes_of(arguments.set))
    result = arguments.output / f"spectra_{structure.label()}_eta{arguments.eta}.nc"
    fresh = arguments.force or not result.exists()
    running: Any = {**running_of(arguments, result), "fmu": own_fmus(arguments.fmu)}
    data = spectra(
        structure,
        eta=etas,
        transient=arguments.transient,
        periods=arguments.periods,
        points=arguments.points,
        **running,
    )
    for kind in map(str, data.kind.values):
        for eta in etas:
            part = data.acceleration.sel(kind=kind, mass=1, eta=eta)
            heard(f"{kind} at eta = {eta:g}", part)
    finish(result, fresh, lambda: figure.draw(data))


def heard(name: str, amplitude: xr.DataArray) -> None:
    """The largest line, and how much there is above the excitation, in a line."""
    largest = float(amplitude.max())
    above = float(amplitude.where(amplitude.order > 1.5, 0.0).max())
    share = above / largest if largest else 0.0
    print(f"{name}: largest line {largest:.4g} m/s2, {share:.2g} of it above the excitation")


def finish(result: Path, fresh: bool, draw: Callable[[], Any]) -> None:
    """The picture, and the files."""
    picture = draw_if_missing(result.with_suffix(".png"), fresh, draw)
    print(f"{result}{'' if fresh else ': complete already'}")
    print(picture)
