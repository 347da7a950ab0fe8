"""Count and measure impacts of responses: numbers, closing speeds, intervals, time in contact."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ..fmu import Impacts
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import Count, Transient
from ..response.labels import column_variables, make_dataset
from ..response.questions import Values
from ..response.signatures import as_given, question
from ..running.job import Table
from ..running.options import Running
from .impacts_after_transient import FollowedResponse, ImpactsQuestion
from .lyapunov import largest_exponent
from .variational import deviation_matrices_and_contacts, period_in_tau

FIELDS = {
    "impacts": "impacts per excitation period",
    "fewest": "fewest impacts in one excitation period",
    "most": "most impacts in one excitation period",
    "contacts": "permanent contacts begun per excitation period",
    "contact_share": "share of the time in permanent contact",
    "closing_max": "largest closing velocity over omega a eta^2",
    "closing_min": "least closing velocity over omega a eta^2",
    "closing_sum": "sum of closing velocities per excitation period, over omega a eta^2",
    "distance_min": "least time between successive impacts, over T",
    "distance_max": "largest time between successive impacts, over T",
    "exponent": "largest Lyapunov exponent, per unit of tau",
    "standard_error": "standard error of the exponent",
}


class ImpactStatisticsJob(ImpactsQuestion):
    """Job of :func:`orchestrate.impact_statistics`: impact statistics along a parameter."""

    result: ClassVar[str] = "impacts"
    chunk_size: ClassVar[int] = 40

    def row(self, impacts: Impacts, item: FollowedResponse) -> Sequence[float]:
        structure, excitation = item.point
        span, periods = period_in_tau(excitation.eta(structure)), self.periods
        exponent = largest_exponent(impacts, periods, item.point)
        which = np.minimum((impacts.time / span).astype(int), periods - 1)
        each = np.bincount(which, minlength=periods)
        distances, closing = np.diff(impacts.time) / span, impacts.closing
        numbers = {
            "impacts": len(impacts.time) / periods,
            "fewest": float(each.min()),
            "most": float(each.max()),
            "contacts": impacts.sticks.sum() / periods,
            "contact_share": contact_time(impacts, item, periods * span) / (periods * span),
            "closing_max": closing.max() if len(closing) else math.nan,
            "closing_min": closing.min() if len(closing) else math.nan,
            "closing_sum": closing.sum() / periods,
            "distance_min": distances.min() if len(distances) else math.nan,
            "distance_max": distances.max() if len(distances) else math.nan,
            "exponent": exponent.value,
            "standard_error": exponent.error,
        }
        return [numbers[name] for name in FIELDS]

    def dataset(self, table: Table) -> xr.Dataset:
        along = self.series.name
        variables = column_variables(along, FIELDS, table["rows"].T)
        title = f"Responses along {along}, impact by impact: {self.structure.label()}"
        return make_dataset(variables, self.series.coordinates(), title)


def contact_time(impacts: Impacts, item: FollowedResponse, end: float) -> float:
    """Return how long the masses are in permanent contact until ``end``, in units of tau."""
    # without impacts, masses that touch at the end have touched all the time
    first, last = item.touching
    if last and not len(impacts.time):
        return end
    if first:
        impacts = Impacts(
            np.append(0.0, impacts.time),
            np.vstack([item.point.faces_from_states(np.asarray(item.start)), impacts.state]),
            np.append(0.0, impacts.closing),
            np.append(True, impacts.sticks),
        )
    return float(deviation_matrices_and_contacts(impacts, end, item.point)[1].sum())


@question(ImpactStatisticsJob)
def impact_statistics(
    structure: Structure,
    *,
    eta: Values = None,
    frequency: Values = None,
    amplitude: Values = None,
    box_acceleration: Values = 0.0,
    force1: Values = 0.0,
    force2: Values = 0.0,
    over: str | None = None,
    values: ArrayLike | None = None,
    transient: Transient = 500,
    periods: Count = 100,
    start: ArrayLike | xr.Dataset | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Compute impact statistics of responses along a parameter: counts, speeds, contact.

    Parameters
    ----------
    structure : Structure
    eta, frequency, amplitude, box_acceleration, force1, force2, over, values
        As in :func:`orchestrate.sweep`.
    transient, periods, start
        As in :func:`orchestrate.lyapunov`.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Per excitation period: ``impacts`` on average, ``fewest``, ``most``; permanent ``contacts``
        begun, and ``contact_share``, the share of the time in permanent contact. Largest
        and least closing velocity, and their sum per period, over omega a eta^2: ``closing_max``,
        ``closing_min``, ``closing_sum``. Times between impacts over T: ``distance_min``,
        ``distance_max``. ``exponent`` and ``standard_error`` as in :func:`orchestrate.lyapunov`,
        NaN where there are too few impacts.

    Raises
    ------
    InputError
        Where an argument is missing, contradicts another one, or is out of its range.

    Notes
    -----
    The impacts of (13)-(17) that the FMU reports; an impulse over m1 omega a eta^2 is ``mu/(1 + mu)
    (1 + e)`` times its closing velocity (15).

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.dynamics.impact_statistics import impact_statistics
    >>> found = impact_statistics(Structure.nondimensional(), eta=[0.4, 1.047], periods=20)
    >>> found.impacts.values.tolist(), found.contacts.values.tolist()
    ([30.0, 2.0], [1.0, 0.0])
    """
    return as_given()
