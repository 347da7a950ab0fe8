"""What the paper consists of: jobs after those they need, and what the report shows of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..errors import InputError
from ..response.sweep import SweepJob
from ..running.job import Job
from ..structures import Structure
from .cases import CASES
from .curves import CurvesAtFrequencies, CurvesAtPeaks, CurvesInWindows
from .gamma import GammaJob
from .pictures import ORBITS
from .resolution import Resolution
from .spectra import PeakSpectraJob

FIRST_REGION = (0.45, 0.49, 0.59, 0.63, 0.70, 0.80, 0.88, 1.047, 1.08, 1.13, 1.24, 1.31)
SECOND_REGION = (2.60, 2.65, 2.69, 2.737, 2.83, 2.92, 3.05, 3.17, 3.30, 3.49, 3.56, 3.70)


@dataclass(frozen=True)
class Part:
    """A part of the report.

    Attributes
    ----------
    name : str
        As it is asked for.
    picture : str
        Name of its files; empty for the table of claims.
    jobs : tuple of str
        Names of the results it shows.
    """

    name: str
    picture: str
    jobs: tuple[str, ...]


@dataclass(frozen=True)
class Plan:
    """Jobs by name in an order that respects their needs, and parts by name."""

    jobs: dict[str, Job]
    parts: dict[str, Part]

    def needed(self, parts: Iterable[Part]) -> list[Job]:
        """Jobs that parts need, in order."""
        wanted = {job for part in parts for job in part.jobs}
        for job in reversed(self.jobs.values()):
            if job.name in wanted:
                wanted |= set(job.needs())
        return [job for job in self.jobs.values() if job.name in wanted]

    def choose(self, names: Sequence[str] | None) -> list[Part]:
        """Parts by their names, all by default.

        Raises
        ------
        InputError
            Where there is none of a name.
        """
        if names is None:
            return list(self.parts.values())
        asked = [name.strip() for name in names]
        for name in asked:
            if name not in self.parts:
                known = ", ".join(self.parts)
                raise InputError(f"figures: {name or 'nothing'} is none; expected some of {known}")
        return [part for name, part in self.parts.items() if name in asked]


def sweep_job(structure: Structure, direction: str, resolution: Resolution) -> SweepJob:
    """The sweep of a structure, ``up`` or ``down``."""
    return SweepJob(
        name=f"orbit_{structure.label()}_{direction}",
        structure=structure,
        eta=resolution.etas(),
        direction="up" if direction == "up" else "down",
        transient=resolution.transient,
        samples=resolution.samples,
    )


def curve_jobs(ups: Sequence[SweepJob], resolution: Resolution) -> dict[str, Job]:
    """The curves of Figures 5, 7, 8, 9 and 12, by number."""
    skip, keep = resolution.skip, resolution.keep
    first = {"sweeps": (ups[0].name,), "structures": (ups[0].structure,), "skip": skip}
    every = {
        "sweeps": tuple(job.name for job in ups),
        "structures": tuple(job.structure for job in ups),
        "skip": skip,
    }
    at, peaks, windows = CurvesAtFrequencies, CurvesAtPeaks, CurvesInWindows
    return {
        "5": at(name="figure5", keep=1, points=4000, etas=(0.4,), **first),
        "7": windows(name="figure7", keep=20, points=200, **first),
        "8": at(name="figure8", keep=keep, points=150, etas=FIRST_REGION, **first),
        "9": at(name="figure9", keep=keep, points=60, etas=SECOND_REGION, **first),
        "12": peaks(name="figure12", keep=1, points=2000, **every),
    }


def names_of(jobs: Iterable[Job]) -> tuple[str, ...]:
    """Their names."""
    return tuple(job.name for job in jobs)


def make(resolution: Resolution) -> Plan:
    """The plan at a resolution."""
    ups = [sweep_job(structure, "up", resolution) for structure in CASES.values()]
    downs = [sweep_job(structure, "down", resolution) for structure in CASES.values()]
    curves = curve_jobs(ups, resolution)
    shown: dict[str, list[Job]] = {
        **{number: [ups[list(CASES).index(case)]] for number, case in ORBITS.items()},
        **{number: [job] for number, job in curves.items()},
    }
    further: dict[str, list[Job]] = {
        "spectra": [PeakSpectraJob(name="spectra", sweep=ups[0].name, structure=ups[0].structure)],
    }
    gamma = GammaJob(name="gamma")
    evidence = [*ups, *downs, *(curves[number] for number in ("5", "7", "12")), gamma]
    evidence += [job for some in further.values() for job in some]
    jobs = {job.name: job for job in (*ups, *downs, *curves.values(), *evidence)}
    parts = [Part("claims", "", names_of(evidence))]
    parts += [Part(n, f"figure{n}", names_of(shown[n])) for n in sorted(shown, key=int)]
    parts += [Part(name, name, names_of(some)) for name, some in further.items()]
    return Plan(jobs, {part.name: part for part in parts})
