"""Coexisting attractors: random starts at many frequencies, and a picture of basins at one of them."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import xarray

from ..attractors import FEATURES, clusters, features, settling
from ..fmu import Instance
from ..jobs import Job
from .resolution import ELASTIC

MOST = 6  # attractors kept at a frequency, the most frequent first
BOX = 3.0  # half width of the box of starts, in units of the up-sweep's largest gap at that frequency
APART = 0.2  # impacts per period by which two periodic attractors of the basin picture differ at least
BASIN_RANGE = (1.07, 1.37)


@dataclass(frozen=True)
class AttractorJob(Job):
    """Random starts at many frequencies.

    Attributes
    ----------
    sweep : str
        Whose largest gaps set the box of starts.
    etas : tuple of float
    starts, settle : int
        Starts at each frequency, and periods dropped at least.
    """

    sweep: str = ""
    etas: tuple = ()
    starts: int = 60
    settle: int = 400
    NEEDS: ClassVar[tuple] = ("sweep",)
    CHUNK: ClassVar[int] = 8

    def count(self):
        """Number of frequencies."""
        return len(self.etas)

    def items(self, inputs):
        """Frequency, scale of its starts, and the seed of its random numbers."""
        gaps = inputs[self.sweep].xi_rel_max
        return [(eta, BOX * float(gaps.sel(eta=eta, method="nearest")), index) for index, eta in enumerate(self.etas)]

    def work(self, fmu, items, carry):
        """All starts at some frequencies."""
        found = []
        with Instance(fmu) as instance:
            for eta, scale, seed in items:
                settle = settling(self.settle, eta)
                found.append([features(instance, ELASTIC, eta, start, settle) for start in random_starts(self.starts, scale, seed)])
        return {"features": np.array(found)}

    def dataset(self, table, inputs):
        """The attractors of each frequency with their shares of starts."""
        shape = (len(self.etas), MOST)
        share, values = np.zeros(shape), np.full((*shape, 3), np.nan)
        number = np.zeros(len(self.etas), dtype="i4")
        for i, rows in enumerate(table["features"]):
            labels = clusters(rows)
            number[i] = labels.max() + 1
            for k in range(min(MOST, number[i])):
                share[i, k] = np.mean(labels == k)
                values[i, k] = np.median(rows[labels == k][:, :3], axis=0)
        one = {"units": "1"}
        kept = ("eta", "attractor")
        variables = {
            "number": ("eta", number, {**one, "long_name": "attractors found"}),
            "share": (kept, share, {**one, "long_name": "share of starts"}),
            **{name: (kept, values[:, :, j], one) for j, name in enumerate(FEATURES[:3])},
            "features": (("eta", "start", "feature"), table["features"], one),
        }
        return xarray.Dataset(variables, {"eta": ("eta", np.array(self.etas)), "feature": list(FEATURES)}, {"title": "Coexisting attractors"})


def random_starts(count, scale, seed):
    """Starts in a box: displacements and velocities of mass 1 in +-scale, gap in [0, scale], its velocity in +-scale."""
    draws = np.random.default_rng([2026, seed]).uniform(-scale, scale, (count, 4))
    x1, gap, v1, rate = draws[:, 0], np.abs(draws[:, 1]), draws[:, 2], draws[:, 3]
    return list(map(tuple, np.column_stack([x1, x1 + gap, v1, v1 + rate])))


@dataclass(frozen=True)
class BasinJob(Job):
    """A plane of starts at the frequency of 1.07-1.37 whose two most frequent attractors are periodic and share the starts most evenly.

    Attributes
    ----------
    attractors, sweep : str
        Names of the random starts and of the sweep that sets the scale.
    side, settle : int
        Starts along a side, and periods dropped.
    """

    attractors: str = ""
    sweep: str = ""
    side: int = 160
    settle: int = 400
    NEEDS: ClassVar[tuple] = ("attractors", "sweep")
    CHUNK: ClassVar[int] = 4

    def count(self):
        """Number of rows of the plane."""
        return self.side

    def frequency(self, inputs):
        """The frequency, and half the width of the plane."""
        data = inputs[self.attractors].sel(eta=slice(*BASIN_RANGE))
        shares, impacts = data.share.isel(attractor=1), data.impacts_per_period
        periodic = (data.multiplicity.isel(attractor=slice(0, 2)) > 0).all("attractor")
        apart = np.abs(impacts.isel(attractor=0) - impacts.isel(attractor=1)) > APART
        clear = shares.where(periodic & apart, 0.0)
        eta = float((clear if float(clear.max()) > 0.0 else shares).idxmax())
        return eta, BOX * float(inputs[self.sweep].xi_rel_max.sel(eta=eta, method="nearest"))

    def axes(self, scale):
        """Gaps and their velocities along the sides."""
        return np.linspace(0.0, scale, self.side), np.linspace(-scale, scale, self.side)

    def items(self, inputs):
        """Frequency, scale and velocity of each row."""
        eta, scale = self.frequency(inputs)
        return [(eta, scale, float(rate)) for rate in self.axes(scale)[1]]

    def work(self, fmu, items, carry):
        """Some rows."""
        found = []
        with Instance(fmu) as instance:
            for eta, scale, rate in items:
                starts = [(0.0, float(gap), 0.0, rate) for gap in self.axes(scale)[0]]
                found.append([features(instance, ELASTIC, eta, start, settling(self.settle, eta)) for start in starts])
        return {"features": np.array(found)}

    def dataset(self, table, inputs):
        """The attractor that each start leads to."""
        eta, scale = self.frequency(inputs)
        rows = table["features"].reshape(-1, len(FEATURES))
        labels = clusters(rows)
        number = labels.max() + 1
        about = np.array([np.median(rows[labels == k][:, :3], axis=0) for k in range(number)])
        gaps, rates = self.axes(scale)
        one = {"units": "1"}
        variables = {
            "attractor_of": (("rate", "gap"), labels.reshape(self.side, self.side).astype("i2"), {"long_name": "attractor reached"}),
            "share": ("attractor", np.bincount(labels) / len(labels), {**one, "long_name": "share of the plane"}),
            **{name: ("attractor", about[:, j], one) for j, name in enumerate(FEATURES[:3])},
        }
        coordinates = {"gap": ("gap", gaps, {**one, "long_name": "xi_Rel(0)"}), "rate": ("rate", rates, {**one, "long_name": "xi'_Rel(0)"})}
        return xarray.Dataset(variables, coordinates, {"title": "Basins of attraction, xi_1 = xi_1' = 0 at phase 0", "eta": eta})


def coexistence_jobs(sweep, resolution):
    """Both jobs."""
    first = AttractorJob("attractors", sweep.fmu_guid, sweep.name, resolution.attractor_etas(), resolution.starts, resolution.settle)
    return first, BasinJob("basin", sweep.fmu_guid, first.name, sweep.name, resolution.basin, resolution.settle)
