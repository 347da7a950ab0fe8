"""The plan of the paper's reproduction: its jobs in order, and the report's parts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from ..dynamics.attractors import AttractorsJob
from ..dynamics.basins import PlaneAxis
from ..dynamics.clusters import AttractorSettings
from ..dynamics.following import StartStatesQuestion
from ..dynamics.impact_statistics import ImpactStatisticsJob
from ..dynamics.lyapunov import LyapunovJob
from ..dynamics.parameter_map import MapJob
from ..errors import InputError
from ..response.sweep import SweepJob
from ..running.job import Job
from ..structures import Drive, Excitation, Structure
from ..weak_drive import averaged
from ..weak_drive.couple import (
    CoupleJob,
    couple_job,
    schedule_from_arguments,
    scheme_from_arguments,
)
from .cases import CASES, MAP_ETAS, MAPS, ORBITS, RIG, map_values
from .chattering import ChatteringJob
from .contact_limits import ContactLimitJob
from .curves import CurvesAtFrequencies, CurvesAtPeaks, CurvesInWindows
from .largest_exponents import LargestExponentJob
from .later_responses import LaterJob
from .low_speed import LowSpeedJob
from .map_peaks import MapPeakJob
from .resolution import Resolution
from .settled_responses import SettledJob
from .spectra import PeakSpectraJob
from .stability_limits import LimitsJob
from .two_attractor_basin import TwoAttractorBasinJob

Followers = TypeVar("Followers", bound=StartStatesQuestion)
FIRST_REGION = (0.45, 0.49, 0.59, 0.63, 0.70, 0.80, 0.88, 1.047, 1.08, 1.13, 1.24, 1.31)
FEW = 100  # frequencies at which responses are run on for longest
SECOND_REGION = (2.60, 2.65, 2.69, 2.737, 2.83, 2.92, 3.05, 3.17, 3.30, 3.49, 3.56, 3.70)


@dataclass(frozen=True)
class Part:
    """A part of the report: its name, its picture, and the jobs whose results it shows."""

    name: str  # as it is asked for
    picture: str  # name of its files; empty for the table of claims
    jobs: tuple[str, ...]  # names of the results it shows


@dataclass(frozen=True)
class Plan:
    """All jobs of the paper's reproduction, in the order of their needs, and its report's parts."""

    jobs: dict[str, Job]
    parts: dict[str, Part]

    def jobs_for(self, parts: Iterable[Part]) -> list[Job]:
        """Return the jobs whose results the parts need, in order."""
        wanted = {job for part in parts for job in part.jobs}
        for job in reversed(self.jobs.values()):
            if job.name in wanted:
                wanted |= set(job.needs())
        return [job for job in self.jobs.values() if job.name in wanted]

    def choose(self, names: Sequence[str] | None) -> list[Part]:
        """Return the report's parts with these names, all by default; raise for unknown names."""
        if names is None:
            return list(self.parts.values())
        asked = [name.strip() for name in names]
        for name in asked:
            if name not in self.parts:
                known = ", ".join(self.parts)
                raise InputError(f"unknown figure {name!r}; choose from {known}")
        return [part for name, part in self.parts.items() if name in asked]


def sweep_job(structure: Structure, direction: str, resolution: Resolution) -> SweepJob:
    """Return the sweep job of a structure, ``up`` or ``down``, by the paper's protocol."""
    return SweepJob(
        name=f"orbit_{structure.label()}_{direction}",
        structure=structure,
        eta=resolution.etas(),
        direction="up" if direction == "up" else "down",
        transient=resolution.transient - 1,  # n = 500(1)700 has both ends
        samples=resolution.samples + 1,
    )


def make_onward_job(kind: type[Followers], sweep: SweepJob, name: str, **fields: Any) -> Followers:
    """Return a job of a class that continues a sweep's responses."""
    keywords: Any = {
        "structure": sweep.structure,
        "eta": sweep.eta,
        "follows": sweep.name,
        **fields,
    }
    return kind(name=sweep.name.replace("orbit", name), **keywords)


def settled_job(sweep: SweepJob, resolution: Resolution) -> SettledJob:
    """Return the job that runs every fifth up-sweep response from eta = 0.43 until it repeats."""
    etas = tuple(eta for eta in resolution.etas() if eta >= 0.43)[::5]
    settings = AttractorSettings(transient=0, settle=0.0, longest=resolution.longest)
    return make_onward_job(SettledJob, sweep, "settled", eta=etas, settings=settings)


def later_jobs(sweep: SweepJob, resolution: Resolution) -> list[LaterJob]:
    """Return jobs that run a sweep's responses on: all for some time, a few for longer."""
    done = sweep.transient + sweep.samples
    few = np.random.default_rng(500).choice(np.array(resolution.etas()), FEW, replace=False)
    asked = {
        "later": (resolution.etas(), resolution.later),
        "latest": (tuple(np.sort(few).tolist()), resolution.latest),
    }
    return [
        make_onward_job(
            LaterJob, sweep, name, eta=etas, transient=first - 1 - done, samples=sweep.samples
        )
        for name, (etas, first) in asked.items()
    ]


def exponent_job(settled: SettledJob, resolution: Resolution) -> LyapunovJob:
    """Return the job of Lyapunov exponents that starts from settled responses."""
    return LyapunovJob(
        name=f"exponent_{settled.structure.label()}",
        structure=settled.structure,
        eta=settled.eta,
        transient=0,
        periods=resolution.long_run,
        follows=settled.name,
    )


def repeat_jobs(
    sweep: SweepJob, settled: Sequence[SettledJob], resolution: Resolution
) -> list[Job]:
    """Return jobs that compute maxima again by longer runs: exponents and map impulses."""
    jobs: list[Job] = [
        LargestExponentJob(
            name=job.name.replace("settled", "largest").removesuffix("_up"),
            case=case,
            structure=job.structure,
            exponents=exponent_job(job, resolution).name,
            settled=job.name,
            limits="limits",
            periods=resolution.part,
        )
        for case, job in zip(CASES, settled, strict=True)
    ]
    jobs += [
        MapPeakJob(
            name=f"peak_{name}",
            map=f"map_{name}",
            parameter=name,
            structure=sweep.structure,
            periods=resolution.part,
        )
        for name in MAPS
    ]
    return jobs


def ramp_jobs(resolution: Resolution) -> list[CoupleJob]:
    """Return the jobs of slow voltage ramps of the set ``rig``, bonded and delaminated."""
    structure, drive = Structure.from_file(RIG), Drive.from_file(RIG)
    volts = drive.volts(structure)
    ends = tuple(share * averaged.folds(structure, drive)[0].eta0 * volts for share in (0.55, 1.02))
    rate = resolution.ramp_rate * volts * structure.omega
    schedule = schedule_from_arguments(structure, drive, (ends[0], ends[1]), rate=rate, back=False)
    kinds = {"bonded": structure.as_bonded(), "delaminated": structure.as_delaminated()}
    return [
        replace(
            couple_job(one, drive, schedule, scheme_from_arguments(one, None)), name=f"ramp_{kind}"
        )
        for kind, one in kinds.items()
    ]


def basin_job(
    attractors: AttractorsJob, sweep: SweepJob, resolution: Resolution
) -> TwoAttractorBasinJob:
    """Return the basin job in gap and gap velocity around the two attractors."""
    side = resolution.basin
    return TwoAttractorBasinJob(
        name="basin",
        structure=sweep.structure,
        excitation=Excitation.nondimensional(1.0, sweep.structure),  # replaced by what is found
        x=PlaneAxis("x_rel", 0.0, 3.0, side),
        y=PlaneAxis("v_rel", -3.0, 3.0, side),
        settings=attractors.settings,
        attractors=attractors.name,
        sweep=sweep.name,
    )


def curve_jobs(ups: Sequence[SweepJob], resolution: Resolution) -> dict[str, Job]:
    """Return the jobs of the curves in Figures 5, 7, 8, 9 and 12, by figure number."""
    skip, keep = resolution.skip, resolution.keep
    first: Any = {"sweeps": (ups[0].name,), "structures": (ups[0].structure,), "skip": skip}
    every: Any = {
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


def job_names(jobs: Iterable[Job]) -> tuple[str, ...]:
    """Return the names of jobs, in their order."""
    return tuple(job.name for job in jobs)


def make_plan(resolution: Resolution) -> Plan:
    """Return the plan of all jobs and parts at a resolution."""
    ups = [sweep_job(structure, "up", resolution) for structure in CASES.values()]
    downs = [sweep_job(structure, "down", resolution) for structure in CASES.values()]
    counted: Any = {"transient": 0, "periods": resolution.steady}
    statistics = [make_onward_job(ImpactStatisticsJob, sweep, "steady", **counted) for sweep in ups]
    curves = curve_jobs(ups, resolution)
    limits = LimitsJob(name="limits", sweeps=job_names(ups))
    own: list[Job] = [ContactLimitJob(name="gamma"), limits, LowSpeedJob(name="low_speed")]
    own += [ChatteringJob(name="chattering"), *later_jobs(ups[0], resolution)]
    own += ramp_jobs(resolution)
    settled = [settled_job(sweep, resolution) for sweep in ups]
    further = further_jobs(ups, settled, resolution)
    shown: dict[str, list[Job]] = {
        **{number: [ups[list(CASES).index(case)]] for number, case in ORBITS.items()},
        **{number: [job] for number, job in curves.items()},
    }
    beyond = [job for some in further.values() for job in some]
    beyond += repeat_jobs(ups[0], settled, resolution)
    evidence = [*ups, *downs, *statistics, *own, *settled, *beyond]
    evidence += [curves[number] for number in ("5", "7", "12")]
    parts = [Part("claims", "", job_names(evidence))]
    parts += [Part(n, f"figure{n}", job_names(shown[n])) for n in sorted(shown, key=int)]
    parts += [Part(name, name, job_names(some)) for name, some in further.items()]
    jobs = [*ups, *downs, *statistics, *curves.values(), *own, *settled, *beyond]
    return Plan({job.name: job for job in jobs}, {part.name: part for part in parts})


def further_jobs(
    ups: Sequence[SweepJob], settled: Sequence[SettledJob], resolution: Resolution
) -> dict[str, list[Job]]:
    """Return the jobs beyond the paper's figures, by part of the report."""
    first = ups[0]
    attractors = AttractorsJob(
        name="attractors",
        structure=first.structure,
        eta=resolution.attractor_etas(),
        follows=first.name,
        settings=AttractorSettings(transient=resolution.settle, longest=resolution.settle_most),
        starts=resolution.starts,
        seed=2026,
        width=3.0,
    )
    etas = tuple(np.linspace(*MAP_ETAS, resolution.map_etas).tolist())
    values = {name: tuple(map_values(name, resolution.map_rows).tolist()) for name in MAPS}
    kept: Any = {"transient": resolution.map_settle, "samples": resolution.map_keep}
    spectra = PeakSpectraJob(name="spectra", sweep=first.name, structure=first.structure)
    return {
        "lyapunov": [exponent_job(job, resolution) for job in settled],
        "attractors": [attractors],
        "basin": [basin_job(attractors, first, resolution)],
        "maps": [
            MapJob(
                name=f"map_{name}",
                structure=first.structure,
                given=((name, values[name]), ("eta", etas)),
                **kept,
            )
            for name in MAPS
        ],
        "spectra": [spectra],
    }
