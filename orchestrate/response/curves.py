"""Phase and time curves with their jumps: equally spaced states, and both sides of each impact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..access import (
    OSCILLATOR,
    REST,
    STATE,
    EventInstance,
    Impacts,
    Instance,
    begin,
    finder,
    sampled,
)
from ..running.job import Inputs, Table
from ..running.runner import answer
from ..structures import Excitation, Structure
from .equations import in_touch
from .labels import flags, nondimensional_state, variable
from .questions import Point, Question, one_point, state, whole

if TYPE_CHECKING:
    import xarray as xr
    from typing_extensions import Unpack

    from ..running.options import Running

FLIGHT, SEQUENCE, CONTACT = 0, 1, 2  # the three states of Figure 5
KINDS = {FLIGHT: "separate motion", SEQUENCE: "sequence of impacts", CONTACT: "permanent contact"}


class Curve(NamedTuple):
    """A motion with its jumps: at an impact two points have the same time.

    Attributes
    ----------
    tau : ndarray, shape (n,)
        Time in units of 1/omega.
    state : ndarray, shape (n, 4)
        xi_1, xi_2, xi_1', xi_2'.
    kind : ndarray of int, shape (n,)
        Of ``KINDS``.
    """

    tau: NDArray[np.float64]
    state: NDArray[np.float64]
    kind: NDArray[np.int8]


def trace(
    fmu: Path,
    point: Point,
    start: ArrayLike,
    transient: int,
    periods: int,
    points: int,
) -> Curve:
    """A motion after ``transient`` periods, over ``periods`` periods.

    Parameters
    ----------
    fmu : Path
        Of the FMI 3.0 form.
    point : Point
    start : array_like of 4 floats
        State at phase 0: x1, x2 in m, v1, v2 in m/s.
    transient, periods : int
        Excitation periods dropped and kept.
    points : int
        Equally spaced states a period.

    Returns
    -------
    Curve
        ``tau`` counts from the first kept period on.
    """
    span = point.excitation.period
    first, last = transient * span, (transient + periods) * span
    with EventInstance(fmu) as instance:
        begin(instance, *point, start)
        instance.advance(0.0, first)
        impacts = instance.impacts(first, last)
    with Instance(fmu) as instance:
        begin(instance, *point, start)
        if transient:
            instance.step(0.0, first)
        here = np.array([instance.get(*STATE)])
        states = np.concatenate([here, sampled(instance, first, last, periods * points)])
    return put_together(np.linspace(first, last, len(states)), states, impacts, point)


def put_together(
    grid: NDArray[np.float64], states: NDArray[np.float64], impacts: Impacts, point: Point
) -> Curve:
    """States at equal times, before and after impacts, in the order of time."""
    count = len(impacts.time)
    time = np.concatenate([grid, impacts.time, impacts.time])
    place = np.repeat([0, 1, 2], [len(grid), count, count])
    order = np.lexsort((place, time))
    parts = [states, impacts.before(point.structure), impacts.state]
    state, time = np.concatenate(parts)[order], time[order]
    kind = kinds(time, state, impacts)
    omega = point.structure.omega
    return Curve(omega * time - omega * grid[0], state / point.scale, kind)


def kinds(
    time: NDArray[np.float64], state: NDArray[np.float64], impacts: Impacts
) -> NDArray[np.int8]:
    """Which of the three states of Figure 5 each point belongs to.

    A sequence of impacts is what leads to permanent contact: flights each shorter than the one
    before it.
    """
    kind = np.full(len(time), FLIGHT, dtype=np.int8)
    flights = np.diff(impacts.time)
    for stick in np.flatnonzero(impacts.sticks).tolist():
        first = stick
        while first > 1 and flights[first - 1] < flights[first - 2]:
            if impacts.sticks[first - 1]:
                break
            first -= 1
        begins = impacts.time[max(first - 1, 0)]
        kind[(time >= begins) & (time <= impacts.time[stick])] = SEQUENCE
    kind[in_touch(state)] = CONTACT
    return kind


@dataclass(frozen=True, kw_only=True)
class CurveJob(Question):
    """A phase curve.

    Attributes
    ----------
    excitation : Excitation
    transient, periods, points : int
        As in :func:`trace`.
    start : tuple of float
    """

    excitation: Excitation
    transient: int = 2000
    periods: int = 500
    points: int = 150
    start: tuple[float, ...] = REST
    asked: ClassVar[str] = "curve"

    def count(self) -> int:
        """One curve."""
        return 1

    def items(self, inputs: Inputs) -> Sequence[Point]:
        """What moves."""
        return [Point(self.structure, self.excitation)]

    def work(self, fmus: Mapping[str, Path], items: Sequence[Point], carry: Table | None) -> Table:
        """The curve."""
        settings = self.transient, self.periods, self.points
        return trace(fmus[OSCILLATOR], items[0], self.start, *settings)._asdict()

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Points in the order of time."""
        import xarray as xr

        state = table["state"]
        text = "time in units of 1/omega from the first point on (4)"
        gap = "gap xi_2 - xi_1 (21)"
        variables = {
            "state": variable(
                ("point", "coordinate"), state, "1", "state in units of a eta^2 and omega a eta^2"
            ),
            "xi_rel": variable("point", state[:, 1] - state[:, 0], "1", gap),
            "v_rel": variable("point", state[:, 3] - state[:, 2], "1", f"rate of the {gap}"),
            "kind": flags("point", table["kind"], "state of the motion (1)", KINDS),
        }
        coordinates = {
            "tau": variable("point", table["tau"], "1", text),
            **nondimensional_state(),
        }
        title = f"Phase curve: {self.structure.label()}"
        return xr.Dataset(variables, coordinates, {"title": title})


def curve(
    structure: Structure,
    *,
    eta: float | None = None,
    frequency: float | None = None,
    amplitude: float | None = None,
    transient: int = 2000,
    periods: int = 500,
    points: int = 150,
    start: ArrayLike | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """A phase curve with its jumps: states at equal times and on both sides of each impact.

    Parameters
    ----------
    structure : Structure
    eta : float, optional
        Frequency ratio Omega/omega; the box's amplitude is 1/eta^2 m.
    frequency, amplitude : float, optional
        The physical form instead: rad/s and m.
    transient, periods : int
        Excitation periods dropped and kept, as in the paper's section 3.2.
    points : int
        Equally spaced states a period.
    start : array_like of 4 floats, optional
        State at phase 0: x1, x2 in m, v1, v2 in m/s; at rest by default.
    **running
        ``store``, ``progress`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over ``point``: ``state`` (xi_1, xi_2 and their rates), ``xi_rel`` and ``v_rel`` (21), all
        non-dimensional; ``kind``: separate motion, sequence of impacts or permanent contact; and
        the time ``tau``, the same at both points of an impact.

    Raises
    ------
    InputError
        Where the question is not whole, or a number is out of its range.

    Notes
    -----
    Figures 5, 7, 8, 9 and 12 of the paper.

    Examples
    --------
    >>> from orchestrate.structures import Structure
    >>> from orchestrate.response.curves import curve
    >>> found = curve(Structure.nondimensional(), eta=0.4, transient=50, periods=1, points=500)
    >>> found.sizes["point"], int((found.tau.diff("point") == 0.0).sum())
    (561, 30)
    """
    chosen, excitation = one_point(structure, eta, frequency, amplitude)
    job = CurveJob(
        name=f"curve_{structure.label()}",
        structure=chosen,
        excitation=excitation,
        transient=whole("transient", transient, 0),
        periods=whole("periods", periods, 1),
        points=whole("points", points, 1),
        start=state("start", start, structure),
    )
    return answer(job, running, finder(running))
