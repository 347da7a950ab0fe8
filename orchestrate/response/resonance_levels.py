"""Resonance curves at several excitation levels: ``orchestrate.resonance_levels``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ..access import finder
from ..checks import checked_integer
from ..errors import InputError
from ..running.job import Inputs, Table
from ..running.runner import answer
from ..structures import Structure
from .labels import parameter_variable, variable
from .questions import Point, Question, checked_numbers, checked_positive, checked_structure
from .resonance import ResonanceJob
from .sweep import Direction

if TYPE_CHECKING:
    import xarray as xr
    from typing_extensions import Unpack

    from ..running.options import Running

RAGGED = ("peak", "jump")  # of each level as many as it has


@dataclass(frozen=True, kw_only=True)
class ResonanceLevelsJob(Question):
    """Job of :func:`orchestrate.resonance_levels`: resonance curves at several levels."""

    frequency: tuple[float, ...]  # rad/s
    level: tuple[float, ...]  # peak accelerations a Omega^2 of the box, m/s2
    direction: Direction = "both"
    transient: int = 500
    samples: int = 60
    tolerance: float = 1e-2
    peak_periods: int = 8
    prominence: float = 0.1
    jump: float = 0.15
    asked: ClassVar[str] = "resonance_levels"
    chunk_size: ClassVar[int] = ResonanceJob.chunk_size
    sequential: ClassVar[bool] = True
    warmup_items: ClassVar[int] = ResonanceJob.warmup_items

    def __post_init__(self) -> None:
        _ = self.level_jobs  # what is wrong is said before any work

    @cached_property
    def level_jobs(self) -> tuple[ResonanceJob, ...]:
        """Return one resonance job per level, in the order of the levels."""
        own = {field.name: getattr(self, field.name) for field in fields(self)}
        own.pop("level")
        return tuple(
            ResonanceJob(**own, amplitude=tuple(level / f**2 for f in self.frequency))
            for level in self.level
        )

    def independent_series(self) -> int:
        """Return how many sweeps are independent, over all levels."""
        return sum(job.independent_series() for job in self.level_jobs)

    def items(self, inputs: Inputs) -> Sequence[Point]:
        """Return the operating points of all responses, level by level."""
        return [point for job in self.level_jobs for point in job.items(inputs)]

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[Point], previous: Table | None
    ) -> Table:
        """Compute a chunk of responses; each starts from the end of the one before."""
        return self.level_jobs[0].work(fmus, items, previous)

    def boundary_state(self, table: Table) -> bytes:
        """Return, as bytes, the state that the next chunk's first response starts from."""
        return self.level_jobs[0].boundary_state(table)

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return the dataset of all curves, with ``level`` as first dimension."""
        import xarray as xr

        parts = {name: np.split(values, len(self.level_jobs)) for name, values in table.items()}
        curves = [
            job.dataset({name: parts[name][i] for name in parts}, inputs)
            for i, job in enumerate(self.level_jobs)
        ]
        levels = xr.Variable(*parameter_variable("level", "level", self.level))
        whole, *_ = regular = [curve.drop_dims(RAGGED) for curve in curves]
        joined = xr.concat(
            regular,
            dim=xr.DataArray(levels, dims="level", name="level"),
            data_vars=[
                str(name) for name, values in whole.data_vars.items() if "structure" in values.dims
            ],
            coords=["amplitude"],
            compat="equals",
            join="exact",
        )
        ragged = [
            xr.concat(
                [self.rows_of_level(i, curve, name) for i, curve in enumerate(curves)], dim=name
            )
            for name in RAGGED
        ]
        result = xr.merge([joined, *ragged], combine_attrs="drop_conflicts")
        result.attrs["title"] = f"Resonance curves over the level: {self.structure.label()}"
        return result

    def rows_of_level(self, index: int, curve: xr.Dataset, name: str) -> xr.Dataset:
        """Return the peaks or jumps of one level's curves, with a variable of the level."""
        of_kind = [str(key) for key, values in curve.data_vars.items() if values.dims == (name,)]
        part = curve[of_kind].reset_coords(drop=True)
        level = np.full(curve.sizes[name], self.level[index])
        text = f"level of the {name}: peak acceleration of the box"
        return part.assign({f"{name}_level": variable(name, level, "m/s2", text)})


def resonance_levels(
    structure: Structure,
    *,
    frequency: ArrayLike,
    level: ArrayLike,
    direction: Direction = "both",
    transient: int = 500,
    samples: int = 60,
    tolerance: float = 1e-2,
    peak_periods: int = 8,
    prominence: float = 0.1,
    jump: float = 0.15,
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
    >>> from orchestrate.structures import Structure
    >>> from orchestrate.response.resonance_levels import resonance_levels
    >>> pressed = Structure.from_halves(m1=1.0, m2=1.0, f1=42.0, f2=55.0, clearance=-20e-6)
    >>> shaken = {"frequency": 2.0 * np.pi * np.array([40.0, 44.0]), "level": [0.05, 5.0]}
    >>> found = resonance_levels(pressed, **shaken, transient=20, samples=4, direction="up")
    >>> found.x_rel_max.sel(structure="delaminated", direction="up").values.max(axis=1) > 0.0
    array([False,  True])
    """
    job = ResonanceLevelsJob(
        structure=checked_structure(structure),
        frequency=checked_distinct_numbers("frequency", frequency),
        level=checked_distinct_numbers("level", level),
        name=f"resonance_levels_{structure.label()}",
        direction=direction,
        transient=checked_integer("transient", transient, 0),
        samples=checked_integer("samples", samples, 1),
        tolerance=checked_positive("tolerance", tolerance),
        peak_periods=checked_integer("peak_periods", peak_periods, 1),
        prominence=checked_positive("prominence", prominence),
        jump=checked_positive("jump", jump),
    )
    return answer(job, running, finder(running))


def checked_distinct_numbers(name: str, argument: Any) -> tuple[float, ...]:
    """Return one or more numbers as a tuple; raise ``InputError`` if one is repeated."""
    values = checked_numbers(name, argument)
    listed = values if isinstance(values, tuple) else (values,)
    if values is None or len(set(listed)) < len(listed):
        raise InputError(f"{name}: expected numbers, each once")
    return tuple(float(value) for value in listed if value is not None)
