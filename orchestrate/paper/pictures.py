"""Each part's picture, drawn from the files of its results."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..running.executors import Processes, running_workers
from ..running.store import load
from .cases import ORBITS
from .plan import Part

if TYPE_CHECKING:
    import xarray as xr

    from ..figures.style import Figure

FORMATS = ("png", "pdf")


def orbit(name: str, data: xr.Dataset) -> Figure:
    """Figures 6, 10 and 11."""
    from ..figures import orbit_diagram

    return orbit_diagram.draw(data)


def curves(name: str, data: xr.Dataset) -> Figure:
    """Figures 5, 7, 8, 9 and 12."""
    from ..figures import phase_curves, phase_grid, time_histories

    draw = {
        "5": phase_curves.draw_states,
        "7": time_histories.draw,
        "12": phase_curves.draw_masses,
    }
    return draw.get(name, phase_grid.draw)(data)


def exponents(name: str, *data: xr.Dataset) -> Figure:
    """Exponents of the three cases."""
    from ..figures import lyapunov

    return lyapunov.draw(*data)


def attractors(name: str, data: xr.Dataset) -> Figure:
    """Coexisting attractors."""
    from ..figures import attractors as figure

    return figure.draw(data)


def basin(name: str, data: xr.Dataset) -> Figure:
    """The plane of starts."""
    from ..figures import basin as figure
    from ..figures.labels import title_from_attributes
    from ..figures.style import XI_REL, XI_REL_RATE

    replaced = "frequency", "amplitude"  # by what the job has found
    title = rf"{title_from_attributes(data, replaced)}, $\eta$ = {float(data.eta):.3f}"
    return figure.draw(data, title, (f"{XI_REL}(0)", f"{XI_REL_RATE}(0)"))


def maps(name: str, *data: xr.Dataset) -> Figure:
    """The three maps."""
    from ..figures import maps as figure

    return figure.draw(*data)


def spectra(name: str, data: xr.Dataset) -> Figure:
    """Spectra at three frequencies."""
    from ..figures import spectra as figure

    return figure.draw(data)


DRAW: Mapping[str, Callable[..., Figure]] = {
    **dict.fromkeys(ORBITS, orbit),
    **dict.fromkeys(("5", "7", "8", "9", "12"), curves),
    "lyapunov": exponents,
    "attractors": attractors,
    "basin": basin,
    "maps": maps,
    "spectra": spectra,
}


def is_current(part: Part, output: Path) -> bool:
    """Whether a part's pictures are there, and no older than its data."""
    pictures = [output / f"{part.picture}.{ending}" for ending in FORMATS]
    if not all(picture.is_file() for picture in pictures):
        return False
    newest = max((output / f"{job}.nc").stat().st_mtime_ns for job in part.jobs)
    return all(picture.stat().st_mtime_ns >= newest for picture in pictures)


def draw_part(part: Part, output: Path) -> Path:
    """Draw a part from its data files, where it is not drawn yet; returns the path of its PNG."""
    from ..figures.files import save

    if is_current(part, output):
        return output / f"{part.picture}.{FORMATS[0]}"
    figure = DRAW[part.name](part.name, *[load(output / f"{job}.nc") for job in part.jobs])
    return save(figure, output / part.picture, FORMATS)[0]


def draw_all(parts: Sequence[Part], output: Path, processes: int) -> dict[str, Path]:
    """Draw parts side by side; the paths of their PNG files, by the parts' names."""
    waiting = [part for part in parts if not is_current(part, output)]
    if min(len(waiting), processes) < 2:
        return {part.name: draw_part(part, output) for part in parts}
    with running_workers(Processes(processes)) as workers, warnings.catch_warnings():
        restarted = "A worker was restarted"  # loky: a picture took memory, which is no leak
        warnings.filterwarnings("ignore", message=restarted)
        submit = workers.executor.submit
        futures = {part.name: submit(draw_part, part, output) for part in parts}
        return {name: future.result() for name, future in futures.items()}
