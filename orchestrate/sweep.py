"""Frequency sweeps: one FMU instance carried along a list of eta, each started from the end of the last (section 3.1)."""

import math
from dataclasses import asdict, dataclass

import numpy as np

from .fmu import Instance
from .poincare import multiplicity

SERIES = ("x1_sample", "x2_sample", "v1_sample", "v2_sample")


def plain(value):
    """A number for a file name, to the last digit."""
    return repr(float(value)).removesuffix(".0")


@dataclass(frozen=True)
class Case:
    """Non-dimensional parameters of the oscillator, (2) and (8), with D1 = D2 = D."""

    e: float = 0.7
    D: float = 0.005
    mu: float = 1.0
    kappa: float = 1.2
    gamma: float = 1e-4

    def parameters(self):
        """The FMU's parameters for omega = 1 rad/s and m1 = 1 kg, where ``x = xi`` with ``box_amplitude = 1/eta^2``."""
        damping = 2.0 * self.D
        return {"m2": self.mu, "k2": self.kappa, "d1": damping, "d2": damping * self.mu, "e": self.e, "gamma": self.gamma}

    def label(self):
        """Short name for files and legends; what has its default value is left out, but for e and D."""
        parts = [f"e{plain(self.e)}", f"D{plain(self.D)}"]
        for name in ("mu", "kappa", "gamma"):
            value = getattr(self, name)
            if value != getattr(Case, name):
                parts.append(f"{name}{plain(value)}")
        return "_".join(parts)


@dataclass(frozen=True)
class Plan:
    """One sequential sweep.

    Attributes
    ----------
    case : Case
    etas : tuple of float
        In the order of the sweep.
    transient, samples : int
        Periods dropped, and stroboscopic samples kept after them.
    tolerance : float
        Of :func:`.poincare.multiplicity`.
    fmu_guid : str
        GUID of the FMU that computes it.
    """

    case: Case
    etas: tuple
    transient: int
    samples: int
    tolerance: float
    fmu_guid: str

    def identity(self):
        """All that decides the numbers, as plain data."""
        return asdict(self)


@dataclass(frozen=True)
class Response:
    """The response at one eta.

    Attributes
    ----------
    xi_rel : ndarray, shape (samples,)
        Stroboscopic samples of xi_Rel at phase 0.
    impacts_per_period : float
        Mean over the samples' periods.
    permanent_contact : bool
        Whether any occurred in them.
    xi_rel_max : float
        Largest xi_Rel in them, exact between the samples too.
    multiplicity : int
    end : tuple of float
        xi_1, xi_2, xi_1', xi_2' at the last sample.
    """

    xi_rel: np.ndarray
    impacts_per_period: float
    permanent_contact: bool
    xi_rel_max: float
    multiplicity: int
    end: tuple

    def row(self):
        """As a flat array of floats, for the journal."""
        head = [self.impacts_per_period, float(self.permanent_contact), self.xi_rel_max, float(self.multiplicity), *self.end]
        return np.concatenate([head, self.xi_rel])

    @classmethod
    def from_row(cls, row):
        """The inverse of :meth:`row`."""
        return cls(row[8:], float(row[0]), bool(row[1]), float(row[2]), int(row[3]), tuple(map(float, row[4:8])))


def respond(instance, plan, eta, start):
    """The response at one eta, from a state at phase 0.

    Parameters
    ----------
    instance : Instance
    plan : Plan
    eta : float
    start : tuple of float
        xi_1, xi_2, xi_1', xi_2'.

    Returns
    -------
    Response
    """
    period = 2.0 * math.pi / eta
    begin = dict(zip(("x1_start", "x2_start", "v1_start", "v2_start"), start, strict=True))
    drive = {"box_amplitude": 1.0 / (eta * eta), "box_frequency": eta, "x_rel_max_on": False}
    instance.reset()
    instance.initialize(**plan.case.parameters(), **begin, **drive)
    instance.step(0.0, plan.transient * period)
    impacts, contacts, touching = instance.get("impact_count", "contact_count", "in_contact")
    instance.set(x_rel_max_on=True)
    samples, peak = sample(instance, plan, period)
    impacts_after, contacts_after = instance.get("impact_count", "contact_count")
    return Response(
        xi_rel=samples[:, 1] - samples[:, 0],
        impacts_per_period=(impacts_after - impacts) / plan.samples,
        permanent_contact=bool(touching) or contacts_after > contacts,
        xi_rel_max=peak,
        multiplicity=multiplicity(samples, plan.tolerance),
        end=tuple(map(float, samples[-1])),
    )


def sample(instance, plan, period):
    """Stroboscopic samples after the transient, taken by the FMU inside as few steps as it has room for.

    Returns
    -------
    samples : ndarray, shape (plan.samples, 4)
        x1, x2, v1, v2.
    peak : float
        Largest gap on the way.
    """
    room = len(instance.read(*SERIES)) // len(SERIES)
    samples, peak = np.empty((plan.samples, len(SERIES))), 0.0
    for done in range(0, plan.samples, room):
        count = min(room, plan.samples - done)
        first = plan.transient + done
        instance.set(sample_count=count)
        instance.step(first * period, (first + count) * period)
        samples[done : done + count] = instance.read(*SERIES).reshape(len(SERIES), room)[:, :count].T
        peak = max(peak, *instance.get("x_rel_max"))
    return samples, peak


def run(plan, fmu, journal, stop=lambda: False):
    """Sweep, going on where the journal ends.

    Parameters
    ----------
    plan : Plan
    fmu : path-like
    journal : .store.Journal
        Each response is entered when it is known.
    stop : callable
        Asked before each eta; true ends the sweep there.
    """
    done = journal.length()
    start = Response.from_row(journal.row(done - 1)).end if done else (0.0, 0.0, 0.0, 0.0)
    with Instance(fmu, name=plan.case.label()) as instance:
        for index in range(done, len(plan.etas)):
            if stop():
                return
            response = respond(instance, plan, plan.etas[index], start)
            journal.append(index, response.row())
            start = response.end
