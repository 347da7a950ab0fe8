"""Tables of periodic orbits and their dataset variables, for ``orbit``, ``branch``, ``border``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..access import EventInstance
from ..outcomes import UNDECIDED
from ..response.labels import (
    Variable,
    flags,
    nondimensional_state_coordinate,
    parameter_variable,
    variable,
    yes_or_no,
)
from ..response.questions import Point
from ..running.job import Table
from .closed_form import Floats
from .families import ACCELERATION, Family, Setting
from .orbit_search import FmuCheck, check_orbit_in_fmu
from .periodic_orbit import CLOSING, ON_CIRCLE, PHASE, POSITION, RELEASE, VELOCITY
from .turning_points import (
    Amplitudes,
    nearest_miss,
    rotate_to_phase_zero,
    stroboscopic_states,
    turning_points,
)

if TYPE_CHECKING:
    import xarray as xr

STABILITY = {0: "unstable", 1: "stable", UNDECIDED: "undecided"}
KINDS = {-1: "none", 0: "impact", 1: "impact_into_contact", 2: "release"}
PARTS = np.array(["real", "imaginary"])


@dataclass(frozen=True)
class OrbitRecord:
    """All stored numbers of one orbit: nodes, states, multipliers, amplitudes, FMU check."""

    values: Floats  # of the parameters that vary
    kinds: Floats
    nodes: Floats  # from phase 0 on
    zero: Floats  # states at phase 0
    multipliers: Floats
    product: float  # of the multipliers, as dampers and impacts dictate it
    amplitudes: Amplitudes
    # smallest gap at which the masses turn away from each other without an impact
    nearest_miss: float
    residual: float
    fmu: FmuCheck

    @classmethod
    def from_root(
        cls, family: Family, unknowns: Floats, residual: float, fmu: FmuCheck
    ) -> OrbitRecord:
        """Return the record of an orbit from Newton's root and its check by the FMU."""
        orbit = family.orbit(unknowns)
        turns = turning_points(orbit)
        nodes, first = rotate_to_phase_zero(orbit.nodes, orbit.sequence.periods)
        multipliers = orbit.multipliers()
        return cls(
            values=unknowns[family.size :],
            kinds=np.roll(np.array(orbit.sequence.kinds, dtype=int), -first),
            nodes=nodes,
            zero=stroboscopic_states(orbit),
            multipliers=np.stack([multipliers.real, multipliers.imag], axis=1),
            product=orbit.multiplier_product(),
            amplitudes=Amplitudes.from_orbit(orbit, turns),
            nearest_miss=nearest_miss(orbit, turns)[0],
            residual=residual,
            fmu=fmu,
        )


def record_with_check(
    instance: EventInstance, family: Family, unknowns: Floats, residual: float
) -> OrbitRecord:
    """Run the FMU through the orbit of a root; return its record with the FMU's check."""
    orbit, values = family.orbit(unknowns), unknowns[family.size :]
    check = check_orbit_in_fmu(instance, family.setting, values, orbit)
    return OrbitRecord.from_root(family, unknowns, residual, check)


def pad_rows(rows: Sequence[Floats], fill: float) -> Floats:
    """Stack arrays of different lengths into one, the shorter ones filled up with ``fill``."""
    most = max(len(row) for row in rows)
    table = np.full((len(rows), most, *rows[0].shape[1:]), fill)
    for index, row in enumerate(rows):
        table[index, : len(row)] = row
    return table


def orbit_table(records: Sequence[OrbitRecord]) -> Table:
    """Return the records of orbits as a dict of arrays, one row per orbit."""
    return {
        "values": np.array([r.values for r in records]),
        "kinds": pad_rows([r.kinds for r in records], -1).astype(int),
        "nodes": pad_rows([r.nodes for r in records], np.nan),
        "zero": np.array([r.zero for r in records]),
        "multipliers": np.array([r.multipliers for r in records]),
        "product": np.array([r.product for r in records]),
        "amplitudes": np.array(
            [(r.amplitudes.xi_1, r.amplitudes.xi_2, r.amplitudes.gap) for r in records]
        ),
        "nearest_miss": np.array([r.nearest_miss for r in records]),
        "residual": np.array([r.residual for r in records]),
        "same": np.array([r.fmu.same for r in records]),
        "away": np.array([r.fmu.away for r in records]),
    }


def located_table(prefix: str, records: Sequence[OrbitRecord], located: Sequence[Any]) -> Table:
    """Return points located on a branch as arrays: their orbits, kinds and positions."""
    rows = orbit_table(records) if records else {}
    rows["kind"] = np.array([each.kind for each in located], dtype=int)
    rows["place"] = np.array([each.position for each in located], dtype=float)
    return {f"{prefix}_{name}": column for name, column in rows.items()}


def split_located(table: Table, prefix: str) -> tuple[Table, Table]:
    """Return the columns along a branch, and those of points located on it, by their own names."""
    located = {key: column for key, column in table.items() if key.startswith(prefix)}
    along = {key: column for key, column in table.items() if key not in located}
    return along, {key.removeprefix(f"{prefix}_"): column for key, column in located.items()}


def orbit_coordinates(setting: Setting, table: Table, row: str) -> dict[str, Variable]:
    """Return dataset coordinates of a table of orbits: parameters, state and sample names."""
    points = [setting.point(values) for values in table["values"]]
    excitations = [point.excitation for point in points]
    along: dict[str, Any] = {
        "eta": [point.excitation.eta(point.structure) for point in points],
        "frequency": [excitation.frequency for excitation in excitations],
        "amplitude": [excitation.amplitude for excitation in excitations],
    }
    along.update(
        {n: table["values"][:, i] for i, n in enumerate(setting.over) if n != ACCELERATION}
    )
    parameters = {name: parameter_variable(name, row, values) for name, values in along.items()}
    if ACCELERATION in setting.over:
        parameters[ACCELERATION] = variable(
            row,
            table["values"][:, setting.over.index(ACCELERATION)],
            "m/s2",
            "constant acceleration of the box beside the harmonic one",
        )
    periods = np.arange(table["zero"].shape[1])
    return {
        **parameters,
        **nondimensional_state_coordinate(),
        "part": variable("part", PARTS, "1", "of a complex number"),
        "sample": variable("sample", periods, "1", "excitation period of the orbit"),
    }


def orbit_variables(setting: Setting, table: Table, row: str) -> dict[str, Variable]:
    """Return all dataset variables of a table of orbits: states, impacts, stability, checks."""
    points = [setting.point(values) for values in table["values"]]
    scale = np.array([point.scale for point in points])
    frequency = np.array([point.excitation.frequency for point in points])
    omega = np.array([point.structure.omega for point in points])
    closed = np.array([setting.form(values).rests_in_contact for values in table["values"]])
    return {
        **state_variables(table, points, row),
        **impact_variables(table, scale, frequency, closed, row),
        **stability_variables(table, frequency / omega, row),
        **amplitude_variables(table, row),
        **check_variables(table, row),
        **node_variables(table, row),
    }


def located_variables(
    setting: Setting,
    rows: Table,
    prefix: str,
    kinds: tuple[str, Mapping[int, str]],
    parameters: Mapping[str, str],
    kept: Sequence[str],
) -> dict[str, Variable]:
    """Return dataset variables of points located on a branch: kind, place, parameters, orbit."""
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
    for name, (dims, column, attributes) in orbit_variables(setting, rows, prefix).items():
        if name in kept:
            each = (dims,) if isinstance(dims, str) else dims
            own = tuple(f"{prefix}_node" if dim == "node" else dim for dim in each)
            data[f"{prefix}_{name}"] = own, column, attributes
    return data


def branch_dataset(
    setting: Setting, table: Table, more: Mapping[str, Variable], attributes: Mapping[str, Any]
) -> xr.Dataset:
    """Return the dataset of orbits along a branch, with more variables."""
    import xarray as xr

    names = orbit_coordinates(setting, table, "point")
    data = {**orbit_variables(setting, table, "point"), **names, **more}
    return xr.Dataset(data, attrs=attributes).set_coords(list(names))


def state_variables(table: Table, points: Sequence[Point], row: str) -> dict[str, Variable]:
    """Return dataset variables of the orbits' stroboscopic states at phase 0, SI and xi."""
    zero, along = table["zero"], (row, "sample", "coordinate")
    text = "states at phase 0: x1, x2 in m, v1, v2 in m/s"
    gap, xi = zero[:, :, 1] - zero[:, :, 0], zero.copy()
    xi[:, :, 1] -= np.array([[p.structure.gap_offset / p.length] for p in points])
    state = [point.from_faces(faces) for point, faces in zip(points, zero, strict=True)]
    return {
        "state": variable(along, np.array(state), "SI", text),
        "xi": variable(along, xi, "1", "states at phase 0 (3)"),
        "xi_rel": variable((row, "sample"), gap, "1", "gap at phase 0 (21)"),
    }


def impact_variables(
    table: Table, scale: Floats, frequency: Floats, closed: NDArray[np.bool_], row: str
) -> dict[str, Variable]:
    """Return dataset variables of the orbits' impacts: times, speeds, rate; NaN for releases.

    Without any node the masses are in contact all the time where they rest so (``closed``).
    """
    nodes, along, periods = table["nodes"], (row, "node"), table["zero"].shape[1]
    there = (table["kinds"] >= 0) & (table["kinds"] != RELEASE)
    times = np.where(there, nodes[:, :, PHASE] / frequency[:, None], np.nan)
    speeds = np.where(there, nodes[:, :, CLOSING] * scale[:, 2:3], np.nan)
    contact = (table["kinds"] == RELEASE).any(axis=1)
    contact |= closed & (table["kinds"] < 0).all(axis=1)
    rate = there.sum(axis=1) / periods
    return {
        "impact_time": variable(along, times, "s", "impacts after the first phase 0"),
        "impact_velocity": variable(along, speeds, "m/s", "their closing speeds"),
        "impacts_per_period": variable(row, rate, "1", "impacts per excitation period"),
        "permanent_contact": yes_or_no(row, contact, "whether permanent contact occurs"),
    }


def stability_variables(table: Table, eta: Floats, row: str) -> dict[str, Variable]:
    """Return dataset variables of multipliers, their product, stability and exponents.

    Multipliers inside the unit circle decide nothing where the FMU has other impacts.
    """
    multipliers, time = table["multipliers"], table["zero"].shape[1] * 2.0 * np.pi / eta
    size = np.hypot(*np.moveaxis(multipliers, -1, 0))
    with np.errstate(divide="ignore"):
        exponent = np.log(size[:, 0]) / time
    inside, same = size[:, 0] < 1.0 - ON_CIRCLE, table["same"]
    texts = {
        "multipliers": "Floquet multipliers, the largest first",
        "multiplier_product": "their product as dampers and impacts dictate it",
        "stable": "whether all multipliers lie in the unit circle, with the FMU's own impacts",
        "stability": "stability, undecided where stable by its multipliers with other impacts",
        "exponent": "largest Lyapunov exponent, per unit of tau, from the multipliers",
    }
    along = (row, "multiplier", "part")
    product = table["product"]
    return {
        "multipliers": variable(along, multipliers, "1", texts["multipliers"]),
        "multiplier_product": variable(row, product, "1", texts["multiplier_product"]),
        "stable": yes_or_no(row, inside & same, texts["stable"]),
        "stability": flags(
            row, np.where(inside & ~same, UNDECIDED, inside), texts["stability"], STABILITY
        ),
        "exponent": variable(row, exponent, "1", texts["exponent"]),
    }


def amplitude_variables(table: Table, row: str) -> dict[str, Variable]:
    """Return dataset variables of the largest displacements and gap, and the nearest miss."""
    texts = {
        "xi1_max": "largest distance of mass 1 from the box's middle over a eta^2",
        "xi2_max": "largest distance of mass 2 from the box's middle over a eta^2",
        "xi_rel_max": "largest gap over a eta^2",
    }
    data = {
        name: variable(row, table["amplitudes"][:, i], "1", text)
        for i, (name, text) in enumerate(texts.items())
    }
    text = "smallest gap at which the masses turn away from each other without an impact"
    data["nearest_miss"] = variable(row, table["nearest_miss"], "1", f"{text}; infinite: none")
    return data


def check_variables(table: Table, row: str) -> dict[str, Variable]:
    """Return dataset variables of Newton's residual and of the check by the FMU."""
    return {
        "residual": variable(
            row, table["residual"], "1", "what Newton's method leaves of the equations"
        ),
        "fmu_same_impacts": yes_or_no(
            row, table["same"], "whether the FMU runs through the same impacts and contacts"
        ),
        "fmu_return": variable(
            row, table["away"], "1", "how far from its first state the FMU returns, over a eta^2"
        ),
    }


def node_variables(table: Table, row: str) -> dict[str, Variable]:
    """Return dataset variables of the orbits' nodes: kind, phase, position, velocities."""
    nodes = table["nodes"]
    along = (row, "node")
    text = "closing speed before the impact over omega a eta^2"
    return {
        "node_kind": flags(along, table["kinds"], "what happens", KINDS),
        "node_phase": variable(
            along, nodes[:, :, PHASE], "rad", "phase of the box, where it happens"
        ),
        "node_position": variable(
            along, nodes[:, :, POSITION], "1", "displacement of mass 1 there over a eta^2"
        ),
        "node_velocity": variable(
            along, nodes[:, :, VELOCITY], "1", "velocity of their centre over omega a eta^2"
        ),
        "node_closing": variable(along, nodes[:, :, CLOSING], "1", text),
    }
