"""Write docs/bifurcations.md: each bifurcation checked by direct simulation.

    python -m tools.bifurcation_table

follows the branches, asks the FMU on both sides of each bifurcation, and writes the table and the
pictures.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from orchestrate import plot
from orchestrate.dynamics.borders import border
from orchestrate.dynamics.branches import branch
from orchestrate.dynamics.orbits import orbit
from orchestrate.dynamics.stable_windows import kind_names
from orchestrate.errors import InputError
from orchestrate.files import write_whole
from orchestrate.fmu import OSCILLATOR, EventInstance, begin, find
from orchestrate.model import Excitation, Structure
from orchestrate.response.sweep import sweep
from tools.marked import replace_part
from tools.pictures.small import save_small

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAPER = Structure.nondimensional(e=0.7, D=0.005)
STARTS = {  # label: eta and periods of an orbit on each branch, and how far it is followed
    "T, contact": (0.38, 1, (0.2, 1.0)),
    "T/3": (0.69, 1, (0.42, 1.37)),
    "T/2": (1.0, 1, (0.42, 1.37)),
    "T/1": (1.37, 1, (0.9, 8.0)),
    "2T/1": (4.0, 2, (1.37, 8.0)),
    "3T/1": (6.0, 3, (1.37, 8.0)),
    "4T/1": (8.0, 4, (1.37, 9.5)),
}
FIGURE_6 = np.arange(100, 8001, 2) / 1000.0
PERIODS = 20_000
NEIGHBOURS = 6  # of a bifurcation, among the branch's points
NUDGE = 1e-7  # of a state, over a eta^2
FARTHEST = 2e-3  # from a bifurcation, in eta,
NEAREST = 1e-5  # and from the loss of contact
GROWTH = 5.0  # a deviation that is this much larger or smaller has grown or died
NODES = ("node_kind", "node_phase", "node_position", "node_velocity", "node_closing")


def advance(instance: EventInstance, eta: float, state: np.ndarray, periods: int) -> np.ndarray:
    """Simulate the FMU over some periods from a state; return the state at the end."""
    excitation = Excitation.nondimensional(eta, PAPER)
    begin(instance, PAPER, excitation, state)
    instance.advance(0.0, periods * excitation.period)
    return instance.read("x1", "x2", "v1", "v2").copy()


def deviation_growth(instance: EventInstance, answer: xr.Dataset) -> float:
    """Return by which factor a small deviation from an orbit has grown after ``PERIODS``."""
    states = answer.state.values
    nudged = states[0] + NUDGE * np.array([-1.0, 1.0, 1.0, -1.0])
    ended = advance(instance, float(answer.eta), nudged, PERIODS // len(states) * len(states))
    return float(np.abs(states - ended).max(axis=1).min() / NUDGE)


def count_unstable_multipliers(instance: EventInstance, answer: xr.Dataset) -> int:
    """Return the number of multipliers outside the unit circle, from the FMU's own map."""
    state, periods, eta = answer.state.values[0], answer.sizes["sample"], float(answer.eta)
    slowest = float(np.nanmin(answer.node_closing.where(answer.node_kind == 0)))
    step = min(1e-7, max(1e-9, 1e-4 * slowest**2))  # the map bends the more the slower an impact
    moved = [
        advance(instance, eta, state + s * step * a, periods) for a in np.eye(4) for s in (1, -1)
    ]
    matrix = (np.array(moved[0::2]) - np.array(moved[1::2])).T / (2.0 * step)
    return int((np.abs(np.linalg.eigvals(matrix)) > 1.0).sum())


def orbits_near(answer: xr.Dataset, at: xr.Dataset, eta: float) -> list[xr.Dataset]:
    """Return a branch's orbits at an eta beside a bifurcation: one, none, or two at a fold."""
    place, value = float(at.bifurcation_place), float(at.bifurcation_value)
    count = answer.sizes["point"]
    orbits = []
    for step in (-1, 1):
        first = int(np.floor(place) if step < 0 else np.ceil(place))
        numbers = [i for i in range(first, first + NEIGHBOURS * step, step) if 0 <= i < count]
        near = [i for i in numbers if (answer.eta.values[i] - value) * (eta - value) > 0.0]
        for i in sorted(near, key=lambda i: abs(float(answer.eta[i]) - eta)):
            one = correct_orbit(answer.isel(point=i), eta)
            if one is not None:
                orbits.append(one)
                break
    return orbits


def correct_orbit(guess: xr.Dataset, eta: float) -> xr.Dataset | None:
    """Return the orbit at an eta from a near one; None if the FMU follows none there."""
    periods = guess.sizes["sample"]
    try:
        answer = orbit(PAPER, eta=eta, period=periods, guess=guess, progress=False)
    except InputError:
        return None
    return answer if answer.fmu_same_impacts else None


def format_orbit(instance: EventInstance, answer: xr.Dataset) -> str:
    """Return a table cell on an orbit: unstable multipliers, and whether the FMU agrees."""
    grown = deviation_growth(instance, answer)
    as_said = grown < 1.0 / GROWTH if answer.stable else grown > GROWTH
    count = count_unstable_multipliers(instance, answer)
    by_formula = int((np.hypot(*answer.multipliers.values.T) > 1.0).sum())
    agrees = as_said and count == by_formula
    return f"{count}{'' if agrees else ' (!)'}"


def format_no_orbit(instance: EventInstance, at: xr.Dataset, eta: float) -> str:
    """Return a table cell for an eta without such an orbit: the FMU's impacts per period."""
    advance(instance, eta, at.bifurcation_state.values[0], PERIODS)
    impacts = instance.get("impact_count")[0] / PERIODS
    return f"none ({impacts:.3f})"


def format_contacts(instance: EventInstance, at: xr.Dataset, eta: float) -> str:
    """Return a table cell with the FMU's number of permanent contacts in ``PERIODS``."""
    advance(instance, eta, at.bifurcation_state.values[0], PERIODS)
    return f"{int(instance.get('contact_count')[0])} contacts"


def branch_rows(instance: EventInstance, label: str, answer: xr.Dataset) -> Iterator[str]:
    """Yield a branch's bifurcations as Markdown table rows, by rising eta."""
    values, names = answer.bifurcation_value.values, kind_names(answer)
    for i in np.argsort(values):
        at = answer.isel(bifurcation=int(i))
        kind = names[int(at.bifurcation_kind)]
        lost = "contact" in kind
        gaps = np.abs(np.delete(values, i) - values[i]) / 3.0
        away = NEAREST if lost else min([FARTHEST, *gaps])
        cells = []
        for eta in (values[i] - away, values[i] + away):
            if lost:
                cells.append(format_contacts(instance, at, eta))
                continue
            orbits = [format_orbit(instance, one) for one in orbits_near(answer, at, eta)]
            cells.append("; ".join(orbits) or format_no_orbit(instance, at, eta))
        yield f"| {label} | {values[i]:.8f} | {kind} | {cells[0]} | {cells[1]} |"


def branch_table(answer: dict[str, xr.Dataset]) -> list[str]:
    """Return the Markdown table of all branches' bifurcations."""
    lines = ["| branch | eta | kind | below | above |", "|---|---|---|---|---|"]
    with EventInstance(find(OSCILLATOR).path) as instance:
        for label, one in answer.items():
            lines += branch_rows(instance, label, one)
    return lines


def border_curves(answer: dict[str, xr.Dataset]) -> list[xr.Dataset]:
    """Return the bifurcation curves of T/1 to 4T/1 over eta and e."""
    curves = []
    for label in ("T/1", "2T/1", "3T/1", "4T/1"):
        for i in range(answer[label].sizes["bifurcation"]):
            limits = [(0.9, 9.5), (0.05, 1.0)]
            curves.append(border(PAPER, start=answer[label], bifurcation=i, limits=limits))
    return curves


def main() -> None:
    """Compute the branches; write the tables and pictures of their bifurcations."""
    answer = {
        label: branch(PAPER, start=orbit(PAPER, eta=eta, period=period), limits=limits)
        for label, (eta, period, limits) in STARTS.items()
    }
    page = DOCS / "bifurcations.md"
    text = replace_part(page.read_text("utf-8"), "table", branch_table(answer))
    write_whole(page, lambda path: path.write_text(text, "utf-8"))
    responses = sweep(PAPER, eta=FIGURE_6)
    save_small(plot(responses, *answer.values()), DOCS / "branches.png")
    save_small(plot(*border_curves(answer)), DOCS / "borders.png")


if __name__ == "__main__":
    main()
