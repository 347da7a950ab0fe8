"""``sweep``: orbit diagrams; without options the paper's Figure 6."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import Commands, add_structure, one_value, structure_of, title_of, values_of
from .output import add_running, check_output, draw_if_missing, running_of

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """  {program} sweep                                           the paper's Figure 6
  {program} sweep --set e=0.3                               Figure 11
  {program} sweep --eta 1.0:1.5:0.0005 --direction both     up and down: non-unique responses
  {program} sweep --over D --values 0.005:0.1:0.001 --eta 1.2
  {program} sweep --structure beam --eta 0.4,1.047,2.9 --samples 2000
Interrupted, the same command goes on where it was. A finished result is left as it is."""
PAPER = "0.1:8.0:0.001"  # frequency ratios of Figure 6


def add_parser(commands: Commands) -> None:
    """Declare the command."""
    text = "follow responses along the frequency ratio or another parameter: an orbit diagram"
    parser = commands.add("sweep", run, text, EXAMPLES)
    add_structure(parser)
    option = parser.add_argument_group("question").add_argument
    option(
        "--eta",
        metavar="VALUES",
        help="frequency ratios Omega/omega, FIRST:LAST:STEP with both ends, or a list A,B,... "
        f"(default: {PAPER})",
    )
    option("--over", metavar="NAME", help="parameter that takes --values, at one --eta")
    option("--values", metavar="VALUES", help="its values, in the form of --eta")
    option(
        "--direction",
        choices=("up", "down", "both"),
        help="order of the values, each started from the end of the last (default: up for a "
        "range, a list as it stands)",
    )
    option("--transient", type=int, default=500, help="periods dropped (default: %(default)s)")
    option("--samples", type=int, default=200, help="periods kept (default: %(default)s)")
    tolerance = "relative deviation within which a state repeats (default: %(default)s)"
    option("--tolerance", type=float, default=1e-2, help=tolerance)
    add_running(parser)


def question(arguments: argparse.Namespace) -> tuple[dict[str, Any], str]:
    """What is asked as keywords of :func:`orchestrate.sweep`, and a name for files."""
    if (arguments.over is None) != (arguments.values is None):
        raise InputError("--over and --values: expected both, or none of them")
    if arguments.over is None:
        etas, is_range = values_of("--eta", arguments.eta or PAPER)
        direction = arguments.direction or ("up" if is_range else "given")
        return {"eta": etas, "direction": direction}, direction if is_range else "list"
    if arguments.eta is None:
        raise InputError(f"--over {arguments.over}: expected --eta with it, one frequency ratio")
    values, is_range = values_of("--values", arguments.values, zero=True)
    eta = one_value("--eta", arguments.eta)
    direction = arguments.direction or ("up" if is_range else "given")
    asked = {"over": arguments.over, "values": values, "eta": eta, "direction": direction}
    ending = direction if is_range else "list"
    return asked, f"eta{eta!r}_over_{arguments.over}_{ending}"


def run(arguments: argparse.Namespace) -> None:
    """Carry it out."""
    asked, ending = question(arguments)
    structure = structure_of(arguments)
    check_output(arguments.output)
    result = arguments.output / f"orbit_{structure.label()}_{ending}.nc"
    fresh = arguments.force or not result.exists()

    from .. import sweep

    data = sweep(
        structure,
        **asked,
        transient=arguments.transient,
        samples=arguments.samples,
        tolerance=arguments.tolerance,
        **running_of(arguments, result),
    )
    title = title_of(structure)
    picture = draw_if_missing(result.with_suffix(".png"), fresh, lambda: picture_of(data, title))
    report(data)
    print(f"{result}{'' if fresh else ': complete already'}")
    print(picture)


def picture_of(data: xr.Dataset, title: str) -> Any:
    """The orbit diagram."""
    from ..figures.orbit_diagram import draw

    return draw(data, title)


def report(data: xr.Dataset) -> None:
    """What was found, in a few lines."""
    (parameter,) = map(str, set(data.impacts_per_period.dims) - {"direction"})
    top = data.xi_rel_max.where(data.xi_rel_max == data.xi_rel_max.max(), drop=True)
    place = float(top[parameter][0])
    print(f"largest xi_Rel: {float(data.xi_rel_max.max()):.6g} at {parameter} = {place:g}")
    count = data.multiplicity.size
    periodic, contact = int((data.multiplicity > 0).sum()), int(data.permanent_contact.sum())
    print(f"periodic: {periodic} of {count} responses; with permanent contact: {contact}")
    if "direction" in data.dims:
        up, down = (data.sel(direction=name) for name in ("up", "down"))
        differ = abs(up.xi_rel_max / down.xi_rel_max - 1.0) > 0.01
        print(f"up and down differ by more than 1 % in xi_Rel at {int(differ.sum())} values")
