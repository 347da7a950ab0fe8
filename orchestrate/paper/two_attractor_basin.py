"""Job of a basin of attraction where two periodic attractors share random starts most evenly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..dynamics.basins import BasinJob, Plane
from ..response.questions import Point
from ..running.job import Inputs
from ..structures import Excitation


@dataclass(frozen=True, kw_only=True)
class TwoAttractorBasinJob(BasinJob):
    """Basin job at the frequency where random starts have found two periodic attractors.

    Its sides ``x`` and ``y`` are in units of the largest gap of the sweep at that frequency; what
    they do not vary is the mean of states on the two attractors.
    """

    # names of the random starts, and of the sweep that sets the scale
    attractors: str
    sweep: str
    # range of eta that is looked at
    low: float = 1.07
    high: float = 1.37
    apart: float = 0.2  # impacts per period by which both attractors differ at least

    def needs(self) -> tuple[str, ...]:
        """Return the names of the jobs whose results it needs: attractors and sweep."""
        return self.attractors, self.sweep

    def frequency(self, inputs: Inputs) -> float:
        """Return the frequency ratio at which two attractors share the starts most evenly."""
        data = inputs[self.attractors].sel(eta=slice(self.low, self.high))
        frequent = np.argsort(-data.share.values, axis=1, kind="stable")[:, :2]

        def of_most_frequent(name: str) -> NDArray[np.float64]:
            """Return a variable of the two most frequent attractors at each frequency."""
            values: NDArray[np.float64] = np.take_along_axis(data[name].values, frequent, axis=1)
            return values

        share, impacts = of_most_frequent("share")[:, -1], of_most_frequent("impacts_per_period")
        apart = np.abs(impacts[:, 0] - impacts[:, -1]) > self.apart
        clear = np.where((of_most_frequent("multiplicity") > 0).all(axis=1) & apart, share, 0.0)
        return float(data.eta.values[(clear if clear.max() > 0.0 else share).argmax()])

    def plane(self, inputs: Inputs) -> Plane:
        """Return the plane of starts at that frequency, scaled to the sweep's largest gap there."""
        eta = self.frequency(inputs)
        scale = float(inputs[self.sweep].xi_rel_max.sel(eta=eta, method="nearest"))
        x, y = (
            side._replace(low=side.low * scale, high=side.high * scale) for side in (self.x, self.y)
        )
        point = Point(self.structure, Excitation.nondimensional(eta, self.structure))
        data = inputs[self.attractors].sel(eta=eta, method="nearest")
        frequent = np.argsort(-data.share.values, kind="stable")[:2]
        middle = np.nanmean(data.state.values[frequent], axis=0)
        return Plane(point, x, y, tuple(middle.tolist()))
