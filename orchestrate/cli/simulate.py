"""``simulate``: time histories of both masses, the gap and the contact force."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import Commands, add_structure, one_value, structure_of, title_of
from .output import add_running, check_output, draw_if_missing, running_of

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """  {program} simulate --eta 0.4 --transient 500 --periods 2      the paper's Figure 5
  {program} simulate --eta 1.047 --set bonded=true              the undamaged structure
  {program} simulate --structure beam --frequency 78.5 --amplitude 0.001
  {program} simulate --eta 1.2 --start 0,0.5,0,0                from a gap of 0.5 m"""


def add_parser(commands: Commands) -> None:
    """Declare the command."""
    text = "a motion in time: both masses, gap, contact force and impacts"
    parser = commands.add("simulate", run, text, EXAMPLES)
    add_structure(parser)
    option = parser.add_argument_group("question").add_argument
    option("--eta", metavar="VALUE", help="frequency ratio; the box's amplitude is 1/eta^2 m")
    option("--frequency", type=float, help="the physical form instead, rad/s, with --amplitude")
    option("--amplitude", type=float, help="amplitude of the box, m")
    option("--phase", type=float, default=0.0, help="phase of the box at the start, rad")
    option("--periods", type=int, default=20, help="periods kept (default: %(default)s)")
    option("--transient", type=int, default=0, help="periods dropped (default: %(default)s)")
    option("--points", type=int, default=200, help="points a period (default: %(default)s)")
    option("--start", metavar="X1,X2,V1,V2", help="state at the start, m and m/s (default: rest)")
    add_running(parser)


def excitation_of(arguments: argparse.Namespace) -> tuple[dict[str, float], str]:
    """The excitation as keywords of :func:`orchestrate.simulate`, and a name for files."""
    if arguments.eta is not None:
        if arguments.frequency is not None or arguments.amplitude is not None:
            raise InputError("--eta: expected alone, or --frequency with --amplitude instead")
        eta = one_value("--eta", arguments.eta)
        return {"eta": eta}, f"eta{eta!r}"
    asked = {"frequency": arguments.frequency, "amplitude": arguments.amplitude}
    if None in asked.values():
        raise InputError("excitation: expected --eta, or --frequency with --amplitude")
    return asked, "_".join(f"{name}{value!r}" for name, value in asked.items())


def start_of(text: str | None) -> tuple[float, ...] | None:
    """The state of ``--start``."""
    if text is None:
        return None
    try:
        found = tuple(float(part) for part in text.split(","))
    except ValueError:
        found = ()
    if len(found) != 4:
        raise InputError(f"--start {text}: expected X1,X2,V1,V2, four numbers in m and m/s")
    return found


def run(arguments: argparse.Namespace) -> None:
    """Carry it out."""
    excitation, ending = excitation_of(arguments)
    start = start_of(arguments.start)
    structure = structure_of(arguments)
    check_output(arguments.output)
    result = arguments.output / f"motion_{structure.label()}_{ending}.nc"
    fresh = arguments.force or not result.exists()

    from .. import simulate
    from ..figures.labels import parameters_text

    data = simulate(
        structure,
        **excitation,
        periods=arguments.periods,
        transient=arguments.transient,
        points=arguments.points,
        start=start,
        phase=arguments.phase,
        **running_of(arguments, result),
    )
    title = f"{title_of(structure)}, {parameters_text(excitation)}"
    picture = draw_if_missing(result.with_suffix(".png"), fresh, lambda: picture_of(data, title))
    report(data)
    print(f"{result}{'' if fresh else ': complete already'}")
    print(picture)


def picture_of(data: xr.Dataset, title: str) -> Any:
    """The histories."""
    from ..figures.motion import draw

    return draw(data, title)


def report(data: xr.Dataset) -> None:
    """What was found, in a few lines."""
    reach = [float(abs(data[name]).max()) for name in ("x1", "x2", "x_rel")]
    print("largest |x1| {:.6g} m, |x2| {:.6g} m, gap {:.6g} m".format(*reach))
    count = data.sizes["impact"]
    speed = f", the fastest at {float(data.impact_velocity.max()):.4g} m/s" if count else ""
    print(f"{count} impacts{speed}; {int(data.sticks.sum())} of them begin permanent contact")
