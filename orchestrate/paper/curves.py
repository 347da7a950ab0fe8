"""The paper's curves: a motion's samples with both sides of each impact, as phase planes show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import orchestrate

from ..model import Structure
from ..response.labels import flags, variable

FLIGHT, SEQUENCE, CONTACT = 0, 1, 2  # the three states of Figure 5
KINDS = {FLIGHT: "separate motion", SEQUENCE: "sequence of impacts", CONTACT: "permanent contact"}
COORDINATES = ("xi_1", "xi_2", "xi_1'", "xi_2'")


class Panel(NamedTuple):
    """A response to trace: structure, frequency ratio, state at phase 0, multiplicity."""

    structure: Structure
    eta: float
    start: np.ndarray
    multiplicity: int


def trace_curve(
    panel: Panel, periods: int, points: int, running: Mapping[str, Any]
) -> dict[str, Any]:
    """Return times tau, states and kinds of a motion: samples, and two points at each impact."""
    structure, eta, start, _ = panel
    common: dict[str, Any] = {"eta": eta, "start": start, "periods": periods, **running}
    motion = orchestrate.simulate(structure, points=points, **common)
    section = orchestrate.poincare(structure, at="impacts", transient=0, **common)
    names, mu = ("x1", "x2", "v1", "v2"), structure.mu
    samples, after = (np.column_stack([data[x] for x in names]) for data in (motion, section))
    closing = section.impact_velocity.values / (1.0 + mu)
    mean = (after[:, 2] + mu * after[:, 3]) / (1.0 + mu)
    before = np.column_stack([after[:, :2], mean + mu * closing, mean - closing])  # (15) backwards
    pieces = (samples, motion.time.values), (before, section.time.values), (after, section.time)
    state, time = (np.concatenate(column) for column in zip(*pieces, strict=True))
    sticks = section.sticks.values.astype(bool)
    contact = np.concatenate([motion.in_contact.values, np.zeros(len(closing)), sticks])
    order = np.lexsort((np.repeat([0, 1, 2], [len(rows) for rows, _ in pieces]), time))
    kind = np.where(lies_in_chattering(time, section.time.values, sticks), SEQUENCE, FLIGHT)
    kind[contact.astype(bool)] = CONTACT
    return {"tau": time[order] * structure.omega, "state": state[order], "kind": kind[order]}


def lies_in_chattering(time: np.ndarray, impact_time: np.ndarray, sticks: np.ndarray) -> np.ndarray:
    """Return whether times lie in flights, each shorter than the one before, that end sticking."""
    within, flights = np.zeros(len(time), dtype=bool), np.diff(impact_time)
    for stick in np.flatnonzero(sticks).tolist():
        first = stick
        while first > 1 and flights[first - 1] < flights[first - 2] and not sticks[first - 1]:
            first -= 1
        within |= (time >= impact_time[max(first - 1, 0)]) & (time <= impact_time[stick])
    return within


def curves_dataset(panels: Sequence[Panel], curves: Sequence[Mapping[str, Any]]) -> xr.Dataset:
    joined = {name: np.concatenate([curve[name] for curve in curves]) for name in curves[0]}
    of = np.repeat(np.arange(len(curves)), [len(curve["tau"]) for curve in curves])
    time = "non-dimensional time from the first period shown"
    settled = "excitation periods after which the settled response repeats; 0: irregular"
    damping = [panel.structure.get("D") for panel in panels]
    columns = {
        "e": ([panel.structure.e for panel in panels], "1", "coefficient of restitution"),
        "D": (damping, "1", "damping ratio of both masses (8)"),
        "eta": ([panel.eta for panel in panels], "1", "frequency ratio Omega/omega"),
        "multiplicity": ([panel.multiplicity for panel in panels], "1", settled),
    }
    state = joined["state"].astype(np.float32)
    return xr.Dataset(
        {
            "tau": variable("point", joined["tau"], "1", time),
            "state": variable(("point", "coordinate"), state, "1", "non-dimensional state"),
            "kind": flags("point", joined["kind"], "state of the motion (1)", KINDS),
            "panel_of": variable("point", of, "1", "panel of the point"),
            **{name: variable("panel", *column) for name, column in columns.items()},
        },
        {"coordinate": variable("coordinate", np.array(COORDINATES), "1", "co-ordinate")},
    )
