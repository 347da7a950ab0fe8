"""Draw the pictures of README and manual: ``python -m tools.pictures [NAME ...]``.

All of them, or those that are named. They are kept in the repository, small, since some take
minutes; figures of the paper come from ``python -m orchestrate paper`` and get their palette here:
``python -m tools.pictures figure6``.
"""

from __future__ import annotations

import io
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from PIL import Image

import orchestrate
from orchestrate import cli
from orchestrate.files import write_atomically
from orchestrate.show.figure_files import png_bytes
from orchestrate.weak_drive.drive_spectra import drive_spectra
from tools.pictures import beam, cards, level, theory

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAPER = orchestrate.Structure.nondimensional(e=0.7, D=0.005)
BRANCHES = {  # eta and periods of an orbit on each branch, and how far it is followed
    "T, contact": (0.38, 1, (0.2, 1.0)),
    "T/3": (0.69, 1, (0.42, 1.37)),
    "T/2": (1.0, 1, (0.42, 1.37)),
    "T/1": (1.37, 1, (0.9, 8.0)),
    "2T/1": (4.0, 2, (1.37, 8.0)),
    "3T/1": (6.0, 3, (1.37, 8.0)),
    "4T/1": (8.0, 4, (1.37, 9.5)),
}
COMMANDS = {  # pictures that a command draws: name, its line, ending of the file that is taken
    "weak_drive": ("couple --eta0 0.3:1.65", ""),
    "weak_drive_jumps": ("couple --eta0 0.3:1.65", "_jumps"),
    "passage": ("passage --eta0 1.4:1.65 --one-way --around 250", ""),
    "capture": (
        "capture --over rotor_inertia --values 500,1000,1500,2000 --eta0 1.46:1.60 --count 8",
        "",
    ),
}
COLOURS = 128  # more are not seen in lines and letters
KEPT = ("figure6", "figure12", "lyapunov", "diagnosis")  # by other tools


def draw_verdict() -> Figure:
    guess = orchestrate.Structure.from_file(DOCS / "records" / "beam.toml")
    records = {}
    for name in ("b", "a"):
        record = orchestrate.read_record(DOCS / "records" / f"beam_{name}.csv")
        records[str(orchestrate.detect(record, guess).verdict.item())] = record
    return beam.draw_verdicts(records)


def draw_states_over_a_period() -> Figure:
    motion = orchestrate.simulate(PAPER, eta=0.4, transient=100, periods=1, points=1200)
    return theory.draw_states_over_a_period(motion)


def draw_engineer_card() -> Figure:
    halves: dict[str, Any] = {
        "m1": 1.5,
        "m2": 1.4,
        "f1": 11.9,
        "f2": 13.5,
        "zeta1": 0.005,
        "zeta2": 0.005,
    }
    structure = orchestrate.Structure.from_halves(**halves, e=0.6)
    turns = 2.0 * np.pi * np.arange(10.0, 15.0, 0.05)
    held: dict[str, Any] = {"frequency": turns, "amplitude": 0.02 * 9.80665 / turns**2}
    return cards.draw_resonance(orchestrate.resonance(structure, **held, progress=False))


def draw_researcher_card() -> Figure:
    eta = np.arange(0.9, 4.0, 0.004)
    return cards.draw_orbit_diagram(orchestrate.sweep(PAPER, eta=eta, samples=40, progress=False))


def compute_branches() -> dict[str, xr.Dataset]:
    found = {}
    for label, (eta, period, limits) in BRANCHES.items():
        start = orchestrate.orbit(PAPER, eta=eta, period=period)
        found[label] = orchestrate.branch(PAPER, start=start, limits=limits)
    return found


def draw_branches() -> Figure:
    responses = orchestrate.sweep(PAPER, eta=np.arange(100, 8001, 2) / 1000.0)
    return orchestrate.plot(responses, *compute_branches().values())


def draw_borders() -> Figure:
    """Draw the bifurcation curves of T/1 to 4T/1 over eta and e; return the figure."""
    every, limits = compute_branches(), [(0.9, 9.5), (0.05, 1.0)]
    curves = [
        orchestrate.border(PAPER, start=every[label], bifurcation=i, limits=limits)
        for label in ("T/1", "2T/1", "3T/1", "4T/1")
        for i in range(every[label].sizes["bifurcation"])
    ]
    return orchestrate.plot(*curves)


def draw_drive_spectra() -> Figure:
    structure = orchestrate.Structure.from_file("quick")
    drive = orchestrate.Drive.from_file("quick")
    return orchestrate.plot(drive_spectra(structure, drive, progress=False), title="quick")


PICTURES: dict[str, Callable[[], Figure]] = {
    "verdict": draw_verdict,
    "two_masses": beam.draw_two_masses,
    "engineer": draw_engineer_card,
    "researcher": draw_researcher_card,
    "fmu": cards.draw_block,
    "states": draw_states_over_a_period,
    "certificate": theory.draw_certified_root_search,
    "spectra": draw_drive_spectra,
    "level": level.draw_controlled_sweep,
    "branches": draw_branches,
    "borders": draw_borders,
}


def png_drawn_by_command(line: str, ending: str) -> bytes:
    with TemporaryDirectory() as folder:
        if cli.main([*line.split(), "--output", folder]):
            raise SystemExit(f"{line}: failed")
        pictures = sorted(Path(folder).glob("*.png"), key=lambda path: len(path.name))
        (chosen,) = [p for p in pictures if p.stem.endswith("_jumps") == bool(ending)]
        return chosen.read_bytes()


def write_png_with_few_colours(png: bytes, path: Path) -> None:
    with Image.open(io.BytesIO(png)) as picture:
        few = picture.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)

    write_atomically(path, lambda place: few.save(place, format="png", optimize=True))


def main(names: list[str]) -> None:
    for name in names or [*PICTURES, *COMMANDS]:
        path = DOCS / f"{name}.png"
        if name in PICTURES:
            write_png_with_few_colours(png_bytes(PICTURES[name]()), path)
        elif name in COMMANDS:
            write_png_with_few_colours(png_drawn_by_command(*COMMANDS[name]), path)
        elif name in KEPT:
            write_png_with_few_colours(path.read_bytes(), path)
        else:
            expected = ", ".join([*PICTURES, *COMMANDS, *KEPT])
            raise SystemExit(f"{name}: no picture of the manual; expected one of {expected}")
        print(path, path.stat().st_size)


if __name__ == "__main__":
    main(sys.argv[1:])
