"""Resonance curves, bonded and delaminated, peaks and jumps: ``orchestrate.resonance``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..access import finder
from ..checks import checked_integer
from ..errors import InputError
from ..running.job import Inputs, Table
from ..running.runner import answer
from ..structures import Structure
from .labels import Variable, variable, yes_or_no
from .multiplicity import IRREGULAR
from .peaks import PEAKS
from .questions import Point, checked_positive, series_arguments
from .sweep import RESPONSE_QUANTITIES, Direction, SweepJob, multiplicity_variables
from .threshold import threshold_variables
from .turns_and_jumps import inside_irregular, jump_indices, prominent_maxima

if TYPE_CHECKING:
    import xarray as xr
    from typing_extensions import Unpack

    from ..running.options import Running

KINDS = ("bonded", "delaminated")
DIMENSIONS = ("structure", "direction")
REPORTED = {**RESPONSE_QUANTITIES, "x_rel_max": ("m", "largest gap over the sampled periods")}
PEAK_QUANTITIES = ("x1_max", "x2_max", "a1_max", "a2_max", "x_rel_max", "impacts_per_period")


@dataclass(frozen=True, kw_only=True)
class ResonanceJob(SweepJob):
    """Job of :func:`orchestrate.resonance`: up and down sweeps, bonded and delaminated."""

    # as in resonance
    prominence: float = 0.1
    jump: float = 0.15
    asked: ClassVar[str] = "resonance"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.direction == "given":
            raise InputError("direction = 'given': expected one of up, down, both")

    def independent_series(self) -> int:
        """Return how many sweeps are independent: each direction, for both structures."""
        return len(KINDS) * super().independent_series()

    def items(self, inputs: Inputs) -> Sequence[Point]:
        """Return the operating points of all responses, the bonded structure's first."""
        both = self.structure.as_bonded(), self.structure.as_delaminated()
        points = super().items(inputs)
        return [Point(structure, point.excitation) for structure in both for point in points]

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return the dataset of the resonance curves with their peaks and jumps."""
        import xarray as xr

        curves = xr.Dataset(
            self.variables({name: self.in_order(values) for name, values in table.items()}),
            self.coordinates(),
            {"title": f"Resonance curves: {self.structure.label()}"},
        )
        return curves.assign(self.peaks(curves) | self.jumps(curves))

    def in_order(self, values: NDArray[np.generic]) -> NDArray[np.generic]:
        """Reorder rows to (structure, direction, value), the values as they were given."""
        ordered = []
        for part in np.split(values, len(KINDS)):
            rows = super().in_order(part)
            ordered.append(rows if self.direction == "both" else rows[None])
        return np.array(ordered)

    def variables(self, table: Table) -> dict[str, Variable]:
        """Return dataset variables of the curves: amplitudes, accelerations, multiplicity."""
        along = (*DIMENSIONS, self.series.name)
        length = self.series.scales()[:, 0]
        numbers = {
            **{name: table[name] for name in (*PEAKS, "x_rel_max", "impacts_per_period")},
            "xi_rel_max": table["x_rel_max"] / length,
            **{f"xi{i}_max": table[f"x{i}_max"] / length for i in (1, 2)},
        }
        contact = "whether permanent contact occurs in the sampled periods"
        return {
            **self.threshold(),
            **{name: variable(along, numbers[name], *REPORTED[name]) for name in REPORTED},
            "permanent_contact": yes_or_no(along, table["permanent_contact"], contact),
            **multiplicity_variables(along, table),
        }

    def threshold(self) -> dict[str, Variable]:
        """Return dataset variables of the contact threshold; empty without a clearance."""
        structure = self.structure.as_delaminated()
        if structure.gap_offset == 0.0:
            return {}
        speeds = np.array([point.excitation.frequency for point in self.series.points])
        return threshold_variables(structure, self.series.name, speeds)

    def coordinates(self) -> dict[str, Variable]:
        """Return dataset coordinates: structure, direction, excitation, frequency in Hz."""
        name = self.series.name
        turns = [point.excitation.frequency / (2.0 * np.pi) for point in self.series.points]
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

    def curves(self, data: xr.Dataset) -> list[xr.Dataset]:
        """Return the distinct curves by frequency: bonded once, delaminated by direction."""
        ordered = data.sortby(self.series.name)
        glued = [ordered.isel(structure=0, direction=0)]
        return glued + [ordered.isel(structure=1, direction=i) for i in range(data.direction.size)]

    def peaks(self, data: xr.Dataset) -> dict[str, Variable]:
        """Return dataset variables of the peaks: maxima of the larger displacement."""
        rows, noise = [], []
        for curve in self.curves(data):
            parts = str(curve.structure.values) != KINDS[0]  # glued, no response is irregular
            inside = inside_irregular(parts & (curve.multiplicity_decided.values == IRREGULAR))
            larger = np.maximum(curve.x1_max.values, curve.x2_max.values)
            for index in prominent_maxima(larger, self.prominence):
                rows.append(curve.isel({self.series.name: index}))
                noise.append(inside[index])
        text = "whether it lies inside a range of irregular responses, where a maximum is chance"
        return {
            **self.locations("peak", rows),
            "peak_irregular": yes_or_no("peak", noise, text),
            **{
                f"peak_{name}": variable(
                    "peak", [float(row[name]) for row in rows], *REPORTED[name]
                )
                for name in PEAK_QUANTITIES
            },
        }

    def jumps(self, data: xr.Dataset) -> dict[str, Variable]:
        """Return dataset variables of the jumps of the largest gap, by direction."""
        rows, sizes = [], []
        for curve in self.curves(data):
            down = str(curve.direction.values) == "down"
            passed = curve.isel({self.series.name: np.s_[::-1]}) if down else curve
            gaps = passed.x_rel_max.values
            for index in jump_indices(gaps, self.jump):
                rows.append(passed.isel({self.series.name: index + 1}))
                sizes.append((gaps[index], gaps[index + 1]))
        text = "largest gap {} the jump"
        before, after = np.reshape(sizes, (-1, 2)).T
        return {
            **self.locations("jump", rows),
            "jump_before": variable("jump", before, "m", text.format("before")),
            "jump_after": variable("jump", after, "m", text.format("after")),
        }

    def locations(self, what: str, rows: Sequence[xr.Dataset]) -> dict[str, Variable]:
        """Return variables of structure, direction and frequency for peaks or jumps."""
        words = {
            f"{what}_{name}": variable(
                what, np.array([str(row[name].values) for row in rows], dtype="U11"), "1", name
            )
            for name in DIMENSIONS
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


def resonance(
    structure: Structure,
    *,
    eta: ArrayLike | None = None,
    frequency: ArrayLike | None = None,
    amplitude: ArrayLike | None = None,
    direction: Direction = "both",
    transient: int = 500,
    samples: int = 60,
    tolerance: float = 1e-2,
    peak_periods: int = 8,
    prominence: float = 0.1,
    jump: float = 0.15,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Compute resonance curves, bonded and delaminated, with their peaks and jumps.

    Parameters
    ----------
    structure : Structure
        Whether it is bonded does not matter: both kinds are answered.
    eta, frequency, amplitude
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
        the largest gap, in which a change from one motion to another shows best.
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
    >>> from orchestrate.structures import Structure
    >>> from orchestrate.response.resonance import resonance
    >>> found = resonance(Structure(), eta=np.arange(0.9, 1.3, 0.005), transient=300)
    >>> found.peak_structure.values[0].item(), float(found.peak_eta[0].round(3))
    ('bonded', 1.05)
    """
    job = ResonanceJob(
        **series_arguments(structure, eta, frequency, amplitude),
        name=f"resonance_{structure.label()}",
        direction=direction,
        transient=checked_integer("transient", transient, 0),
        samples=checked_integer("samples", samples, 1),
        tolerance=checked_positive("tolerance", tolerance),
        peak_periods=checked_integer("peak_periods", peak_periods, 1),
        prominence=checked_positive("prominence", prominence),
        jump=checked_positive("jump", jump),
    )
    return answer(job, running, finder(running))
