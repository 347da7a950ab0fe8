"""Write the explorer's HTML page: JavaScript, kernel and a sweep's states in one file."""

from __future__ import annotations

import base64
import hashlib
import zlib
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from ..dynamics.lyapunov import BATCHES, BLOCKS, SIGMAS, WANDER
from ..dynamics.settling import AttractorSettings
from ..errors import InputError
from ..files import make_writable_folder, write_atomically
from ..fmu.channel import StepAnswer
from ..fmu.webassembly import (
    WebKernel,
    find_or_compile_web_kernel,
    nonzero_numbers,
    tables_for_web_page,
)
from ..lazy import xr
from ..model import Drive, Structure
from ..model.ranges import EXCITATION, PUSHES, STRUCTURE
from ..units import Units, display_units_of
from ..version import __version__
from ..weak_drive.connection import FORCE, MOTOR
from ..weak_drive.master import CUBIC, Links, Pair, Scheme
from ..weak_drive.run import oscillator_start_values
from ..weak_drive.step_record import BOX, LEADING, OscillatorOutputs
from .branches import branch_json
from .bundle import bundle_modules
from .measured import record_json
from .sweep_data import SweepData, check_units, first_sweep, read_sweep, shown_units
from .tour import TOUR, tour_in_units
from .words import WORDS

SOURCES = Path(__file__).parent / "page"
HEAD = b"<title>Explorer of a vibro-impacting structure</title>"  # by which a page is known
EXPONENT = {  # the usual rule of exponents; periods at first, periods and impacts at most
    **{"blocks": BLOCKS, "batches": BATCHES, "sigmas": SIGMAS, "wander": WANDER},
    **{"periods": 400, "longest": 12_800, "most": 100_000},
}
PAGES = STRUCTURE | {name: EXCITATION[name] for name in PUSHES}  # numbers of a page's structure
POLICY = (  # own script and workers, whose digests stand in it, no network
    "default-src 'none'; script-src 'sha256-{}' 'wasm-unsafe-eval' blob:; worker-src blob:; "
    "style-src 'sha256-{}'; img-src data: blob:; base-uri 'none'; form-action 'none'"
)
VOLTAGES = (0.8, 0.9, 2.0)  # least, first and largest of the motor's slider, as eta0
SHOWN_OF_SWEEP = ("settings", "directions", "count", "low", "high", "level")
STEP = 0.1  # of the coupled run, in 1/omega
FLAGS = {"bonded": [0.0, 1.0], "wall": [0.0, 1.0]}  # ranges too


def explore(
    data: xr.Dataset | Structure | None = None,
    *,
    output: str | PathLike[str] = "explorer.html",
    branches: xr.Dataset | None = None,
    record: xr.Dataset | None = None,
    units: str | Units = "",
    build_folder: str | PathLike[str] | None = None,
) -> Path:
    """Write the explorer, one HTML file that needs no other file and no network.

    A ``record``, as :func:`orchestrate.read_record` returns it, is drawn over the spectrum.
    """
    asked = units if isinstance(units, Units) else Units.from_text(units)
    if data is None or isinstance(data, Structure):
        chosen = first_sweep(data or Structure(), asked)
    else:
        chosen = read_sweep(data)
        check_units(asked, chosen.level)
        asked = asked.with_defaults(display_units_of(data))
    path = Path(output)
    if path.is_dir():
        raise InputError(f"output = {str(output)!r}: is a folder; expected a file to write")
    if path.exists() and HEAD not in first_bytes(path):
        raise InputError(
            f"output = {str(output)!r}: a file that is no page of the explorer; expected a name "
            "that is free, or such a page to be replaced"
        )
    make_writable_folder(path.parent)
    kernel = find_or_compile_web_kernel(build_folder)
    curves = branch_json(branches) | record_json(record)
    text = render_page(chosen, shown_units(asked, chosen.level), curves, kernel)
    return write_atomically(path, lambda place: place.write_text(text, encoding="utf-8"))


def first_bytes(path: Path) -> bytes:
    """Return the first bytes of a file; none if it is no regular file."""
    if not path.is_file():
        return b""
    with path.open("rb") as file:
        return file.read(4096)


def render_page(
    sweep: SweepData, shown: dict[str, str], curves: dict[str, Any], kernel: WebKernel
) -> str:
    scripts = {path.stem: path.read_text(encoding="utf-8") for path in SOURCES.glob("*.js")}
    style = (SOURCES / "style.css").read_text(encoding="utf-8")
    script = bundle_modules(scripts, "main")
    digests = [hashlib.sha256(content.encode()).digest() for content in (script, style)]
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(SOURCES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
    )
    unit = Drive.from_file("quick").motor_constant * Structure.from_file("quick").omega
    return environment.get_template("page.html.j2").render(
        policy=POLICY.format(*(base64.b64encode(digest).decode() for digest in digests)),
        style=Markup(style),  # own sources, in elements whose content HTML takes as it stands
        script=Markup(script),
        worker=Markup(bundle_modules(scripts, "worker")),
        tour=tour_in_units(shown),
        words=WORDS,
        **curves,
        source=f"vibroimpact {__version__}, kernel {kernel.guid}",
        swept=f"sweep by {sweep.source}" if sweep.source else "",
        table={
            **page_data(sweep),
            "shown": shown,
            **curves,
            "variables": kernel.variables,
            "loops": {**tables_for_web_page(Pair, StepAnswer), "exponent": EXPONENT},
            "drive": drive_data(),
        },
        data=compress_to_base64(sweep.numbers.astype("<f8").tobytes()),
        kernel=compress_to_base64(kernel.module),
        voltages=[f"{eta0 * unit:.6g}" for eta0 in VOLTAGES],
    )


def page_data(sweep: SweepData) -> dict[str, Any]:
    still = dict.fromkeys(PUSHES, 0.0)
    return {
        "structure": floats(sweep.structure.parameters()) | still | sweep.pushes,
        "usual": floats(Structure().parameters()) | still,
        "ranges": {name: [q.minimum, q.maximum] for name, q in PAGES.items()} | FLAGS,
        "units": {
            name: {"label": quantity.unit.replace(".", " "), **quantity.dimension}
            for name, quantity in PAGES.items()
            if quantity.unit != "1"
        },
        "alike": AttractorSettings().alike,
        **{name: getattr(sweep, name) for name in SHOWN_OF_SWEEP},
        "tour": {stop.name: stop.link_query for step in TOUR for stop in step.stops},
    }


def drive_data() -> dict[str, Any]:
    """Return what the page's coupled run is (set ``quick``): the loop's structure, its variables,
    start values, and its communication step.
    """
    structure, drive = Structure.from_file("quick"), Drive.from_file("quick")
    scheme, inputs = Scheme(STEP / structure.omega), (*FORCE, *MOTOR.inputs)
    names = {
        "oscillator": {"inputs": CUBIC, "outputs": OscillatorOutputs._fields},
        "drive": {"inputs": inputs, "outputs": (*BOX, *MOTOR.outputs)},
    }
    force, motion = (
        Links.from_numbered([(i, MOTOR.links[n]) for i, n in enumerate(o)]) for o in (FORCE, BOX)
    )
    pair = Pair(force=force, motion=motion, cubic=MOTOR.first_cubic, stride=len(MOTOR.inputs))
    for name in ("tolerance", "easy", "halvings", "first_passes"):
        setattr(pair, name, getattr(scheme, name))
    for side, known in names.items():
        instance = getattr(pair, side)
        instance.input_count, instance.output_count = len(known["inputs"]), len(known["outputs"])
    return {
        "pair": nonzero_numbers(pair),
        "names": names,
        "columns": (*LEADING, *MOTOR.outputs, *MOTOR.inputs),
        "oscillator": floats(oscillator_start_values(structure)),
        "drive": floats(drive.parameters()),
        "h": scheme.h,
        "omega": structure.omega,
    }


def floats(numbers: Mapping[str, Any]) -> dict[str, float]:
    return {name: float(value) for name, value in numbers.items()}


def compress_to_base64(content: bytes) -> str:
    return base64.b64encode(zlib.compress(content, 9)).decode()
