"""Tables of periodic orbits and their dataset variables, for ``orbit``, ``branch``, ``border``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..fmu import EventInstance
from ..lazy import xr
from ..model.outcomes import UNDECIDED
from ..model.ranges import PUSHES
from ..response.labels import (
    Variable,
    flags,
    nondimensional_state_coordinate,
    parameter_variable,
    variable,
)
from ..response.questions import Point
from ..running.job import Table
from .closed_form import Floats
from .families import Family, Setting
from .orbit_search import compare_with_fmu
from .periodic_orbit import AT_OUTER_END, CLOSING, ON_CIRCLE, PHASE, POSITION, RELEASE, VELOCITY
from .turning_points import (
    amplitudes,
    nearest_miss,
    rotate_to_phase_zero,
    stroboscopic_states,
    turning_points,
)

NO_YES = {0: "no", 1: "yes"}
INSIDE = {0: "impact", 1: "impact_into_contact", 2: "release"}
OUTSIDE = {AT_OUTER_END + kind: f"{name}_outside" for kind, name in INSIDE.items()}
PARTS = np.array(["real", "imaginary"])
TURNS_AWAY = "smallest gap at which the masses turn away from each other without an impact"
LONG_NAMES = {  # of each orbit's variables
    "state": "states at phase 0: x1, x2 in m, v1, v2 in m/s",
    "xi": "states at phase 0 (3)",
    "xi_rel": "gap at phase 0 (21)",
    "impact_time": "impacts after the first phase 0",
    "impact_velocity": "their closing speeds",
    "impacts_per_period": "impacts per excitation period",
    "permanent_contact": "whether permanent contact occurs",
    "multipliers": "Floquet multipliers, the largest first",
    "multiplier_product": "their product as dampers and impacts dictate it",
    "stable": "whether all multipliers lie in the unit circle, with the FMU's own impacts",
    "stability": "stability, undecided where stable by its multipliers with other impacts",
    "exponent": "largest Lyapunov exponent, per unit of tau, from the multipliers",
    "xi1_max": "largest distance of mass 1 from the box's middle over a eta^2",
    "xi2_max": "largest distance of mass 2 from the box's middle over a eta^2",
    "xi_rel_max": "largest gap over a eta^2",
    "nearest_miss": f"{TURNS_AWAY}; infinite: none",
    "residual": "what Newton's method leaves of the equations",
    "fmu_same_impacts": "whether the FMU runs through the same impacts and contacts",
    "fmu_return": "how far from its first state the FMU returns, over a eta^2",
    "node_kind": "what happens",
    "node_phase": "phase of the box, where it happens",
    "node_position": "displacement of mass 1 there over a eta^2",
    "node_velocity": "velocity of their centre over omega a eta^2",
    "node_closing": "closing speed before the impact over omega a eta^2",
}
UNITS = {"state": "SI", "impact_time": "s", "impact_velocity": "m/s", "node_phase": "rad"}  # else 1
DIMENSIONS = {  # beside that along the orbits
    **dict.fromkeys(("state", "xi"), ("sample", "coordinate")),
    **{name: ("node",) for name in LONG_NAMES if name.startswith("node_")},
    **dict.fromkeys(("impact_time", "impact_velocity"), ("node",)),
    **{"xi_rel": ("sample",), "multipliers": ("multiplier", "part")},
}
MEANINGS = {  # of flags
    **dict.fromkeys(("permanent_contact", "stable", "fmu_same_impacts"), NO_YES),
    "stability": {0: "unstable", 1: "stable", UNDECIDED: "undecided"},
    "node_kind": {-1: "none", **INSIDE, **OUTSIDE},
}


def orbit_row(instance: EventInstance, family: Family, unknowns: Floats, residual: float) -> Table:
    """Return all stored numbers of a root's orbit, checked by a run in the FMU."""
    nodes_end = family.node_unknowns
    unknowns = unknowns[: nodes_end + len(family.setting.over)]  # others are those of a bifurcation
    orbit, values = family.orbit(unknowns), unknowns[nodes_end:]
    same, away = compare_with_fmu(instance, family.setting, values, orbit)
    turns, multipliers = turning_points(orbit), orbit.multipliers()
    sequence, nodes = rotate_to_phase_zero(orbit.sequence, orbit.nodes)
    row = {
        "values": values,
        "kinds": np.array(sequence.kinds, dtype=int),
        "nodes": nodes,  # from phase 0 on
        "zero": stroboscopic_states(orbit),
        "multipliers": np.stack([multipliers.real, multipliers.imag], axis=1),
        "product": orbit.multiplier_product(),
        "amplitudes": amplitudes(orbit, turns),
        "nearest_miss": nearest_miss(orbit, turns)[0],
        "residual": residual,
        "same": same,
        "away": away,
    }
    return {name: np.asarray(number) for name, number in row.items()}


def pad_rows(rows: Sequence[Floats], fill: float) -> Floats:
    """Stack arrays of different length in one, with a number filled in after the shorter ones."""
    most = max(len(row) for row in rows)
    table = np.full((len(rows), most, *rows[0].shape[1:]), fill)
    for index, row in enumerate(rows):
        table[index, : len(row)] = row
    return table


def orbit_table(rows: Sequence[Table]) -> Table:
    """Stack the rows of orbits to columns, padded where they have different numbers of nodes."""
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    padded = {"kinds": pad_rows(columns.pop("kinds"), -1).astype(int)}
    padded["nodes"] = pad_rows(columns.pop("nodes"), np.nan)
    return {**padded, **{name: np.array(column) for name, column in columns.items()}}


def branch_table(rows: Sequence[Table], prefix: str, located: Sequence[Any]) -> Table:
    """Stack the rows of points along a branch and then, by a prefix, of those located on it."""
    count = len(rows) - len(located)
    columns = orbit_table(rows[count:]) if located else {}
    columns["kind"] = np.array([each.kind for each in located], dtype=int)
    columns["place"] = np.array([each.position for each in located], dtype=float)
    of_located = {f"{prefix}_{name}": column for name, column in columns.items()}
    return {**orbit_table(rows[:count]), **of_located}


def orbit_coordinates(setting: Setting, table: Table, row: str) -> dict[str, Variable]:
    points = [setting.point(values) for values in table["values"]]
    pushed = (name for name in PUSHES if name in dict(setting.excitation))
    along: dict[str, Any] = {"eta": [each.excitation.eta(each.structure) for each in points]}
    for name in ("frequency", "amplitude", *pushed):
        along[name] = [getattr(point.excitation, name) for point in points]
    along |= {name: table["values"][:, i] for i, name in enumerate(setting.over)}
    parameters = {name: parameter_variable(name, row, values) for name, values in along.items()}
    periods = np.arange(table["zero"].shape[1])
    return {
        **parameters,
        **nondimensional_state_coordinate(),
        "part": variable("part", PARTS, "1", "of a complex number"),
        "sample": variable("sample", periods, "1", "excitation period of the orbit"),
    }


def orbit_variables(setting: Setting, table: Table, row: str) -> dict[str, Variable]:
    points = [setting.point(values) for values in table["values"]]
    nodes, zero = table["nodes"], table["zero"]
    xi = zero.copy()
    xi[:, :, 1] -= np.array([[p.structure.gap_offset / p.displacement_unit] for p in points])
    states = [point.states_from_faces(faces) for point, faces in zip(points, zero, strict=True)]
    columns = {
        **{"state": np.array(states), "xi": xi, "xi_rel": zero[:, :, 1] - zero[:, :, 0]},
        **impact_columns(setting, table, points),
        **stability_columns(table, points),
        **dict(zip(("xi1_max", "xi2_max", "xi_rel_max"), table["amplitudes"].T, strict=True)),
        **{"nearest_miss": table["nearest_miss"], "residual": table["residual"]},
        **{"fmu_same_impacts": table["same"], "fmu_return": table["away"]},
        **{"node_kind": table["kinds"], "node_phase": nodes[..., PHASE]},
        **{"node_position": nodes[..., POSITION], "node_velocity": nodes[..., VELOCITY]},
        "node_closing": nodes[..., CLOSING],
    }
    variables = {}
    for name, text in LONG_NAMES.items():
        dims = (row, *DIMENSIONS.get(name, ()))
        variables[name] = variable(dims, columns[name], UNITS.get(name, "1"), text)
        if name in MEANINGS:
            variables[name] = flags(dims, columns[name], text, MEANINGS[name])
    return variables


def impact_columns(
    setting: Setting, table: Table, points: Sequence[Point]
) -> dict[str, NDArray[Any]]:
    """Return the orbits' impacts: times, speeds, rate; NaN for releases."""
    nodes, kinds, values = table["nodes"], table["kinds"], table["values"]
    frequency = np.array([[point.excitation.frequency] for point in points])
    speed = np.array([[point.velocity_unit] for point in points])
    rests_closed = np.array([setting.closed_form(row).rest_mode > 0 for row in values])
    released = (kinds >= 0) & (kinds % AT_OUTER_END == RELEASE)
    is_impact = (kinds >= 0) & ~released
    return {
        "impact_time": np.where(is_impact, nodes[:, :, PHASE] / frequency, np.nan),
        "impact_velocity": np.where(is_impact, nodes[:, :, CLOSING] * speed, np.nan),
        "impacts_per_period": is_impact.sum(axis=1) / table["zero"].shape[1],
        "permanent_contact": released.any(axis=1) | (rests_closed & (kinds < 0).all(axis=1)),
    }


def stability_columns(table: Table, points: Sequence[Point]) -> dict[str, NDArray[Any]]:
    # inside the unit circle they decide nothing where the FMU has other impacts
    eta = np.array([each.excitation.frequency / each.structure.omega for each in points])
    multipliers, time = table["multipliers"], table["zero"].shape[1] * 2.0 * np.pi / eta
    size = np.hypot(*np.moveaxis(multipliers, -1, 0))
    with np.errstate(divide="ignore"):
        exponent = np.log(size[:, 0]) / time
    inside, same = size[:, 0] < 1.0 - ON_CIRCLE, table["same"]
    return {
        **{"multipliers": multipliers, "multiplier_product": table["product"]},
        **{"stable": inside & same, "stability": np.where(inside & ~same, UNDECIDED, inside)},
        "exponent": exponent,
    }


def located_variables(
    setting: Setting,
    table: Table,
    prefix: str,
    kinds: tuple[str, Mapping[int, str]],
    parameters: Mapping[str, str],
    kept: Sequence[str],
) -> dict[str, Variable]:
    """Return variables of points located on a branch, by a prefix: their kinds, ``kept`` ones.

    ``kinds`` has the long name and meanings of the kinds, ``parameters`` labels by parameter.
    """
    own = (key for key in table if key.startswith(f"{prefix}_"))
    rows = {key.removeprefix(f"{prefix}_"): table[key] for key in own}
    line = "branch" if len(setting.over) == 1 else "curve"
    place = f"position along the {line}'s points: between two where not whole"
    data = {
        f"{prefix}_kind": flags(prefix, rows["kind"], *kinds),
        f"{prefix}_place": variable(prefix, rows["place"], "1", place),
    }
    if not len(rows["kind"]):
        empty = {name: variable(prefix, np.zeros(0), "1", name) for name in parameters}
        return data | {f"{prefix}_{label}": empty[name] for name, label in parameters.items()}
    values = orbit_coordinates(setting, rows, prefix)
    data |= {f"{prefix}_{label}": values[name] for name, label in parameters.items()}
    variables = orbit_variables(setting, rows, prefix)
    for name in (name for name in variables if name in kept):
        dims, column, attributes = variables[name]
        prefixed = tuple(f"{prefix}_node" if dim == "node" else dim for dim in dims)
        data[f"{prefix}_{name}"] = prefixed, column, attributes
    return data


def branch_dataset(
    setting: Setting, table: Table, more: Mapping[str, Variable], **attributes: Any
) -> xr.Dataset:
    """Return the dataset of points along a branch, with the reasons why it ends; ``more`` in it."""
    first, last = map(str, table["ends"])
    names = orbit_coordinates(setting, table, "point")
    data = {**orbit_variables(setting, table, "point"), **names, **more}
    attributes |= {"first_end": first, "last_end": last}
    return xr.Dataset(data, attrs=attributes).set_coords(list(names))
