"""Resonance curves, bonded and delaminated: ``resonance``, and ``resonance_levels`` of several."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from functools import cached_property
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import Count, Positive, Transient
from ..model.outcomes import IRREGULAR
from ..running.job import Table
from ..running.options import Running
from .labels import Variable, make_dataset, parameter_variable, variable, yes_or_no
from .maxima_and_jumps import in_irregular_range, jump_indices, prominent_maximum_indices
from .questions import (
    Point,
    Series,
    Values,
    checked_excitation_numbers,
    make_series,
    require_bonded_twin,
)
from .signatures import as_given, question
from .sweep import RESPONSE_QUANTITIES, Direction, SweepJob, response_variables
from .threshold import threshold_variables

KINDS = ("bonded", "delaminated")
DIMENSIONS = ("structure", "direction")
REPORTED = {**RESPONSE_QUANTITIES, "x_rel_max": ("m", "largest gap over the sampled periods")}
PEAK_QUANTITIES = ("x1_max", "x2_max", "a1_max", "a2_max", "x_rel_max", "impacts_per_period")
RAGGED = ("peak", "jump")  # of each level as many as it has


class ResonanceJob(SweepJob):
    """Job of :func:`orchestrate.resonance`: up and down sweeps, bonded and delaminated."""

    bulk: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        require_bonded_twin(self.structure)
        if self.direction == "given":
            raise InputError("direction = 'given': expected one of up, down, both")

    def parameters(self) -> dict[str, Any]:
        return {name: value for name, value in super().parameters().items() if name != "start"}

    def count_independent_series(self) -> int:
        return len(KINDS) * super().count_independent_series()

    def items(self) -> Sequence[Point]:
        both = self.structure.as_bonded(), self.structure.as_delaminated()
        points = super().items()
        return [Point(structure, point.excitation) for structure in both for point in points]

    def dataset(self, table: Table) -> xr.Dataset:
        ordered = {name: self.reorder_rows(values) for name, values in table.items()}
        title = f"Resonance curves: {self.structure.label()}"
        curves = make_dataset(self.variables(ordered), self.coordinates(), title)
        return curves.assign(self.peak_variables(curves) | self.jump_variables(curves))

    def reorder_rows(self, values: NDArray[np.generic]) -> NDArray[np.generic]:
        """Reorder rows to (structure, direction, value), the values as they were given."""
        rows = [super(ResonanceJob, self).reorder_rows(part) for part in np.split(values, 2)]
        return np.array(rows if self.direction == "both" else np.expand_dims(rows, 1))

    def variables(self, table: Table) -> dict[str, Variable]:
        series, structure = self.series, self.structure.as_delaminated()
        length = series.displacement_and_velocity_units[:, 0]
        responses = response_variables((*DIMENSIONS, series.name), table, length, REPORTED)
        if structure.gap_offset == 0.0 or structure.stroke or self.pushes:
            return responses  # the contact threshold is not known there
        return threshold_variables(structure, series.name, series.frequencies) | responses

    def coordinates(self) -> dict[str, Variable]:
        name = self.series.name
        turns = self.series.frequencies / (2.0 * np.pi)
        directions = ["up", "down"] if self.direction == "both" else [self.direction]
        text = "whether the masses are glued or can part"
        return {
            **self.series.coordinates(),
            "hertz": variable(name, turns, "Hz", "frequency of the box"),
            "structure": variable("structure", np.array(KINDS), "1", text),
            "direction": variable(
                "direction", np.array(directions), "1", "order in which frequencies were computed"
            ),
        }

    def split_curves(self, data: xr.Dataset) -> list[xr.Dataset]:
        """Return the distinct curves by frequency: bonded once, delaminated by direction."""
        ordered = data.sortby(self.series.name)
        bonded = [ordered.isel(structure=0, direction=0)]
        return bonded + [ordered.isel(structure=1, direction=i) for i in range(data.direction.size)]

    def peak_variables(self, data: xr.Dataset) -> dict[str, Variable]:
        rows, irregular = [], []
        for curve in self.split_curves(data):
            parts = str(curve.structure.values) != KINDS[0]  # bonded, no response is irregular
            inside = in_irregular_range(parts & (curve.multiplicity_decided.values == IRREGULAR))
            larger = np.maximum(curve.x1_max.values, curve.x2_max.values)
            for index in prominent_maximum_indices(larger, self.prominence):
                rows.append(curve.isel({self.series.name: index}))
                irregular.append(inside[index])
        sizes = {n: [float(row[n]) for row in rows] for n in PEAK_QUANTITIES}
        text = "whether it lies inside a range of irregular responses, where a maximum is chance"
        return {
            **self.location_variables("peak", rows),
            "peak_irregular": yes_or_no("peak", irregular, text),
            **{f"peak_{n}": variable("peak", sizes[n], *REPORTED[n]) for n in PEAK_QUANTITIES},
        }

    def jump_variables(self, data: xr.Dataset) -> dict[str, Variable]:
        rows, sizes, name = [], [], self.series.name
        for curve in self.split_curves(data):
            down = str(curve.direction.values) == "down"
            computed = curve.isel({name: np.s_[::-1]}) if down else curve
            gaps = computed.x_rel_max.values
            kind = {"structure": str(curve.structure.values)}
            differ = self.directions_differ(data.sel(kind | {name: computed[name].values}))
            for index in jump_indices(gaps, self.jump):
                if not (differ[index] or differ[index + 1]):
                    continue  # both directions alike: steep, or a gap between frequencies
                rows.append(computed.isel({self.series.name: index + 1}))
                sizes.append((gaps[index], gaps[index + 1]))
        text = "largest gap {} the jump"
        before, after = np.reshape(sizes, (-1, 2)).T
        return {
            **self.location_variables("jump", rows),
            "jump_before": variable("jump", before, "m", text.format("before")),
            "jump_after": variable("jump", after, "m", text.format("after")),
        }

    def directions_differ(self, data: xr.Dataset) -> NDArray[np.bool_]:
        """Return where the largest gaps up and down differ as by a jump; of one direction: all."""
        values = data.x_rel_max.transpose("direction", self.series.name).values
        high, low = values.max(axis=0), values.min(axis=0)
        return (high - low > self.jump * high) | (len(values) == 1)

    def location_variables(self, what: str, rows: Sequence[xr.Dataset]) -> dict[str, Variable]:
        """Return structure, direction and frequency of rows, which are all peaks or all jumps."""
        labels = {name: [str(row[name].values) for row in rows] for name in DIMENSIONS}
        words = {
            f"{what}_{name}": variable(what, np.array(texts, dtype="U11"), "1", name)
            for name, texts in labels.items()
        }
        name, text = self.series.name, {"peak": "of the maximum", "jump": "just after the jump"}
        return words | {
            f"{what}_{key}": variable(
                what,
                [float(row[key]) for row in rows],
                {"eta": "1", "hertz": "Hz"}.get(key, "rad/s"),
                f"{'frequency ratio' if key == 'eta' else 'frequency'} {text[what]}",
            )
            for key in dict.fromkeys((name, "hertz"))
        }


def checked_distinct_numbers(name: str, value: Any) -> tuple[float, ...]:
    values = checked_excitation_numbers(name, value)
    listed = values if isinstance(values, tuple) else (values,)
    if values is None or len(set(listed)) < len(listed):
        raise InputError(f"{name}: expected numbers, each once")
    return tuple(float(number) for number in listed if number is not None)


DistinctNumbers = Annotated[ArrayLike, checked_distinct_numbers]


class ResonanceLevelsJob(ResonanceJob):
    """Job of :func:`orchestrate.resonance_levels`: resonance curves at several levels."""

    @property
    def series(self) -> Series:
        return make_series(self.structure, None, self.frequency, self.amplitudes(self.level[0]))

    def amplitudes(self, level: float) -> tuple[float, ...]:
        """Return the box's amplitude, m, at each frequency for a peak acceleration in m/s2."""
        return tuple(level / f**2 for f in self.frequency)

    @cached_property
    def level_jobs(self) -> tuple[ResonanceJob, ...]:
        """Return the job of each level, for its items and its part of the dataset."""
        shared = {field.name: getattr(self, field.name) for field in fields(ResonanceJob)}
        changes = ({"amplitude": self.amplitudes(level)} for level in self.level)
        return tuple(ResonanceJob(**shared | change) for change in changes)

    def count_independent_series(self) -> int:
        return len(self.level) * super().count_independent_series()

    def items(self) -> Sequence[Point]:
        return [point for job in self.level_jobs for point in job.items()]

    def dataset(self, table: Table) -> xr.Dataset:
        parts = {name: np.split(values, len(self.level_jobs)) for name, values in table.items()}
        tables = [{name: parts[name][i] for name in parts} for i in range(len(self.level))]
        curves = [job.dataset(each) for job, each in zip(self.level_jobs, tables, strict=True)]
        levels = xr.Variable(*parameter_variable("level", "level", self.level))
        whole, *_ = regular = [curve.drop_dims(RAGGED) for curve in curves]
        kept = [str(name) for name, each in whole.data_vars.items() if "structure" in each.dims]
        dim = xr.DataArray(levels, dims="level", name="level")
        alike: Any = {"coords": ["amplitude"], "compat": "equals", "join": "exact"}
        joined = xr.concat(regular, dim, data_vars=kept, **alike)
        ragged = []
        for name in RAGGED:
            rows = [self.add_level(i, curve, name) for i, curve in enumerate(curves)]
            ragged.append(xr.concat(rows, dim=name))
        result = xr.merge([joined, *ragged], combine_attrs="drop_conflicts")
        result.attrs["title"] = f"Resonance curves over the level: {self.structure.label()}"
        return result

    def add_level(self, index: int, curve: xr.Dataset, dimension: str) -> xr.Dataset:
        """Return a curve's peaks or jumps alone, each with the level that has this index."""
        data = curve.data_vars.items()
        names = [str(name) for name, values in data if values.dims == (dimension,)]
        part = curve[names].reset_coords(drop=True)
        level = np.full(curve.sizes[dimension], self.level[index])
        text = f"level of the {dimension}: peak acceleration of the box"
        return part.assign({f"{dimension}_level": variable(dimension, level, "m/s2", text)})


@question(ResonanceJob)
def resonance(
    structure: Structure,
    *,
    eta: Values = None,
    frequency: Values = None,
    amplitude: Values = None,
    box_acceleration: Values = 0.0,
    force1: Values = 0.0,
    force2: Values = 0.0,
    direction: Direction = "both",
    transient: Transient = 500,
    samples: Count = 60,
    tolerance: Positive = 1e-2,
    peak_periods: Count = 8,
    prominence: Positive = 0.1,
    jump: Positive = 0.15,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Compute resonance curves, bonded and delaminated, with their peaks and jumps.

    Parameters
    ----------
    structure : Structure
        ``bonded`` is ignored: results are returned for both, bonded and delaminated.
    eta, frequency, amplitude, box_acceleration, force1, force2
        As in :func:`orchestrate.sweep`.
    direction : {"up", "down", "both"}
        Order of the frequencies, each started from the end of the last.
    transient, samples, tolerance, peak_periods
        As in :func:`orchestrate.sweep`.
    prominence : float
        By what part of itself a peak of the larger one of both displacements stands out at least.
    jump : float
        By what part of itself the largest gap jumps at least, from one frequency to the next.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over ``structure`` (bonded, delaminated), ``direction`` and the frequency, which is there in
        ``hertz`` too: largest distances of both masses from the box's middle ``x1_max``, ``x2_max``
        in m and over a eta^2 as ``xi1_max``, ``xi2_max``; largest absolute accelerations between
        impacts ``a1_max``, ``a2_max`` in m/s2; the largest gap ``x_rel_max`` and ``xi_rel_max``;
        ``impacts_per_period``, ``multiplicity`` and ``multiplicity_decided``,
        ``permanent_contact``. Over ``peak`` and ``jump``: structure, direction and frequency of
        each, and how large it is. What peaks is the larger one of both displacements; what jumps is
        the largest gap, in which a change from one motion to another shows best. Where both
        directions are computed, a step at which they are alike is steep, and no jump.
        With a clearance, ``threshold_amplitude`` and ``threshold_acceleration`` of the box, at
        which the linear response of the delaminated structure first opens or touches, see
        :func:`orchestrate.contact_threshold`.
        ``peak_irregular`` marks peaks inside a range of irregular responses: amplitudes of these
        are the largest of a few periods, and differ by chance from one frequency to the next.

    Raises
    ------
    InputError
        Where a required argument is missing, arguments contradict each other, or a number is
        out of its range.

    Notes
    -----
    A sweep of (6), (10) and (15) as in section 3.1 of the paper, see :func:`orchestrate.sweep`;
    peaks lie on the frequencies asked for.

    Examples
    --------
    >>> import numpy as np
    >>> from orchestrate.model import Structure
    >>> from orchestrate.response.resonance import resonance
    >>> found = resonance(Structure(), eta=np.arange(0.9, 1.3, 0.005), transient=300)
    >>> found.peak_structure.values[0].item(), float(found.peak_eta[0].round(3))
    ('bonded', 1.05)
    """
    return as_given()


@question(ResonanceLevelsJob)
def resonance_levels(
    structure: Structure,
    *,
    frequency: DistinctNumbers,
    level: DistinctNumbers,
    direction: Direction = "both",
    transient: Transient = 500,
    samples: Count = 60,
    tolerance: Positive = 1e-2,
    peak_periods: Count = 8,
    prominence: Positive = 0.1,
    jump: Positive = 0.15,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Compute resonance curves at several excitation levels, bonded and delaminated.

    Parameters
    ----------
    structure : Structure
        With a clearance, or a restitution that depends on the speed; without both the curves at
        two levels are in proportion.
    frequency : array_like
        rad/s.
    level : array_like
        Peak accelerations of the box, m/s2: each is held at all frequencies.
    direction, transient, samples, tolerance, peak_periods, prominence, jump
        As in :func:`orchestrate.resonance`.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        What :func:`orchestrate.resonance` answers, with ``level`` as first dimension; of each peak
        and jump its ``peak_level``, ``jump_level``. The threshold of a structure with a clearance,
        ``threshold_acceleration`` over the frequency, is one curve for all levels.

    Raises
    ------
    InputError
        Where a number is out of its range.

    Examples
    --------
    >>> import numpy as np
    >>> from orchestrate.model import Structure
    >>> from orchestrate.response.resonance import resonance_levels
    >>> pressed = Structure.from_halves(m1=1.0, m2=1.0, f1=42.0, f2=55.0, clearance=-20e-6)
    >>> shaken = {"frequency": 2.0 * np.pi * np.array([40.0, 44.0]), "level": [0.05, 5.0]}
    >>> found = resonance_levels(pressed, **shaken, transient=20, samples=4, direction="up")
    >>> found.x_rel_max.sel(structure="delaminated", direction="up").values.max(axis=1) > 0.0
    array([False,  True])
    """
    return as_given()
