"""Phase and time curves of a motion with its jumps: equally spaced states, and the states on both sides of each impact between them."""

from dataclasses import dataclass

import numpy as np

from .fmu import Instance
from .sweep import Case
from .trace import STATE, EventInstance, begin, period, sampled

FLIGHT, SEQUENCE, CONTACT = 0, 1, 2  # the three states of Figure 5
KINDS = ("separate motion", "sequence of impacts", "permanent contact")


@dataclass(frozen=True)
class Panel:
    """What one curve shows.

    Attributes
    ----------
    case : Case
    eta : float
    start : tuple of float
        State at phase 0 that the motion starts from.
    multiplicity : int
        Found in the sweep, 0 where irregular.
    """

    case: Case
    eta: float
    start: tuple
    multiplicity: int = 0


def panel_at(sweep, case, eta):
    """The panel of a sweep's response at one of its frequencies, found to within half a step."""
    row = sweep.sel(eta=eta, method="nearest")
    return Panel(case, float(row.eta), tuple(map(float, row.end_state.values)), int(row.multiplicity))


def curve(fmu, panel, skip, keep, per_period):
    """A motion after ``skip`` periods, over ``keep`` periods.

    Parameters
    ----------
    fmu : Path
        Of the FMI 3.0 form.
    panel : Panel
    skip, keep, per_period : int
        Periods dropped and kept; equally spaced states a period.

    Returns
    -------
    dict of ndarray
        ``tau`` (n,) from the first kept period on, ``state`` (n, 4) and ``kind`` (n,); at an impact two points have the same tau.
    """
    span = period(panel.eta)
    first, last = skip * span, (skip + keep) * span
    with EventInstance(fmu) as instance:
        begin(instance, panel.case, panel.eta, panel.start)
        instance.advance(0.0, first)
        impacts = instance.impacts(first, last)
    with Instance(fmu) as instance:
        begin(instance, panel.case, panel.eta, panel.start)
        if skip:
            instance.step(0.0, first)
        here = np.array([instance.get(*STATE)])
        states = np.concatenate([here, sampled(instance, first, last, keep * per_period)])
    grid = np.linspace(first, last, len(states))
    tau = np.concatenate([grid, impacts.time, impacts.time])
    order = np.lexsort((np.repeat([0, 1, 2], [len(grid), len(impacts.time), len(impacts.time)]), tau))
    state = np.concatenate([states, impacts.before(panel.case), impacts.state])[order]
    tau = tau[order]
    return {"tau": tau - first, "state": state.astype(np.float32), "kind": kinds(tau, state, impacts)}


def kinds(tau, state, impacts):
    """Which of the three states of Figure 5 each point belongs to.

    A sequence of impacts is what leads to permanent contact: flights each shorter than the one before it.
    """
    kind = np.full(len(tau), FLIGHT, dtype=np.int8)
    flights = np.diff(impacts.time)
    for stick in np.flatnonzero(impacts.sticks):
        first = stick
        while first > 1 and flights[first - 1] < flights[first - 2] and not impacts.sticks[first - 1]:
            first -= 1
        kind[(tau >= impacts.time[max(first - 1, 0)]) & (tau <= impacts.time[stick])] = SEQUENCE
    kind[(state[:, 0] == state[:, 1]) & (state[:, 2] == state[:, 3])] = CONTACT
    return kind
