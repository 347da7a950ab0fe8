"""Draw the pictures of the report's parts from their stored results."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..figures import (
    attractors,
    basin,
    lyapunov,
    maps,
    orbit_diagram,
    phase_curves,
    phase_grid,
    spectra,
    time_histories,
)
from ..figures.files import save
from ..figures.labels import title_from_attributes
from ..figures.style import XI_REL, XI_REL_RATE, Figure
from ..running.executors import Processes, running_workers
from ..running.store import load
from .cases import ORBITS
from .plan import Part

if TYPE_CHECKING:
    import xarray as xr

FORMATS = ("png", "pdf")


def draw_basin(data: xr.Dataset) -> Figure:
    """Draw the basin at the frequency that its job has chosen; return the figure."""
    replaced = "frequency", "amplitude"
    title = rf"{title_from_attributes(data, replaced)}, $\eta$ = {float(data.eta):.3f}"
    return basin.draw(data, title, (f"{XI_REL}(0)", f"{XI_REL_RATE}(0)"))


DRAW: Mapping[str, Callable[..., Figure]] = {  # from the results of a part to its picture
    **dict.fromkeys(ORBITS, orbit_diagram.draw),
    "5": phase_curves.draw_states,
    "7": time_histories.draw,
    **dict.fromkeys(("8", "9"), phase_grid.draw),
    "12": phase_curves.draw_masses,
    "lyapunov": lyapunov.draw,
    "attractors": attractors.draw,
    "basin": draw_basin,
    "maps": maps.draw,
    "spectra": spectra.draw,
}


def is_current(part: Part, output: Path) -> bool:
    """Return whether a part's pictures exist and are no older than its data."""
    pictures = [output / f"{part.picture}.{ending}" for ending in FORMATS]
    if not all(picture.is_file() for picture in pictures):
        return False
    newest = max((output / f"{job}.nc").stat().st_mtime_ns for job in part.jobs)
    return all(picture.stat().st_mtime_ns >= newest for picture in pictures)


def draw_part(part: Part, output: Path) -> Path:
    """Draw a part from its stored results unless it is current; return the path of its PNG."""
    if is_current(part, output):
        return output / f"{part.picture}.{FORMATS[0]}"
    figure = DRAW[part.name](*[load(output / f"{job}.nc") for job in part.jobs])
    return save(figure, output / part.picture, FORMATS)[0]


def draw_all(parts: Sequence[Part], output: Path, processes: int) -> dict[str, Path]:
    """Draw parts in parallel processes; return a dict from part to PNG path."""
    waiting = [part for part in parts if not is_current(part, output)]
    if min(len(waiting), processes) < 2:
        return {part.name: draw_part(part, output) for part in parts}
    with running_workers(Processes(processes)) as workers, warnings.catch_warnings():
        restarted = "A worker was restarted"  # loky: a picture took memory, which is no leak
        warnings.filterwarnings("ignore", message=restarted)
        submit = workers.executor.submit
        futures = {part.name: submit(draw_part, part, output) for part in parts}
        return {name: future.result() for name, future in futures.items()}
