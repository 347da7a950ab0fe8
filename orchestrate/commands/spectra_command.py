"""``python -m orchestrate spectra``: Figure 3, acceleration spectra at resonance, undamaged against delaminated."""

import argparse
from pathlib import Path

from ..setups import SETUPS
from .couple_command import number, one_of

DEFAULTS = {"quick": 1.53, "beam": 1.45}  # voltages at which the motor, started from rest, hangs at the resonance
EPILOG = "examples:\n  python -m orchestrate spectra\n  python -m orchestrate spectra --setup beam"


def add_parser(commands):
    """Declare the command."""
    text = "acceleration spectra at resonance, bonded and delaminated (Figure 3)"
    parser = commands.add_parser("spectra", help=text, description=text, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    option = parser.add_argument
    option("--setup", default="quick", help=f"parameter set, of {', '.join(SETUPS)} (default: %(default)s)")
    option("--eta0", type=float, help="voltage as no-load speed over omega (default: 1.53 for quick, 1.45 for beam)")
    option("--samples", type=int, default=32768, help="points of the velocity (default: %(default)s)")
    option("--step", type=float, default=0.05, help="time between them, in 1/omega (default: %(default)s)")
    option("--output", type=Path, default=Path("results"), help="folder of the result (default: %(default)s)")
    parser.set_defaults(run=run)


def run(arguments):
    """Carry it out."""
    one_of("setup", arguments.setup, tuple(SETUPS))
    eta0 = DEFAULTS[arguments.setup] if arguments.eta0 is None else arguments.eta0
    number("eta0", eta0, 0.0, 100.0)
    number("samples", arguments.samples, 64, 10_000_000)
    number("step", arguments.step, 1e-4, 1.0)
    from ..build import default_fmu
    from ..exchange import OSCILLATOR, SHAKER
    from ..figures.drive_spectra import draw
    from ..spectra import record, spectrum
    from .sweep_command import open_output

    fmus = [default_fmu(model, Path("build")) for model in (OSCILLATOR, SHAKER)]
    open_output(arguments.output)
    setup, found = SETUPS[arguments.setup], {}
    for name, case in (("bonded", setup.as_bonded()), ("delaminated", setup)):
        velocity, speed = record(case, fmus, eta0, arguments.samples, arguments.step)
        found[name] = (*spectrum(velocity, arguments.step), speed)
        print(f"{name}: mean speed {speed:.4f}, largest acceleration in the spectrum {found[name][1].max():.3f}")
    path = arguments.output / f"spectra_{arguments.setup}.png"
    draw(found, path)
    print(path)
