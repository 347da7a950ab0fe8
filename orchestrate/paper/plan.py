"""What the paper consists of: the jobs in the order of their needs, and which of their results each part of the report shows."""

from dataclasses import dataclass

from ..errors import UserError
from .coexistence import coexistence_jobs
from .exponents import exponent_job
from .figure_job import NUMBERS, figure_job
from .gamma import gamma_job
from .maps import map_jobs
from .resolution import CASES
from .spectra import SpectrumJob
from .sweeps import steady_job, sweep_job

ORBITS = {"6": "elastic", "10": "damped", "11": "plastic"}  # figures that are sweeps


@dataclass(frozen=True)
class Part:
    """A part of the report.

    Attributes
    ----------
    name : str
        As ``--figures`` names it.
    module : str
        In ``orchestrate.figures``; empty for the table of claims.
    jobs : tuple of str
        Names of the results it shows.
    """

    name: str
    module: str
    jobs: tuple


@dataclass(frozen=True)
class Plan:
    """Jobs by name in an order that respects their needs, and parts by name."""

    jobs: dict
    parts: dict

    def needed(self, parts):
        """Jobs that parts need, in order."""
        wanted = {job for part in parts for job in part.jobs}
        for job in reversed(self.jobs.values()):
            if job.name in wanted:
                wanted |= set(job.needs())
        return [job for job in self.jobs.values() if job.name in wanted]

    def choose(self, text):
        """Parts of a list such as ``5,7``, all by default.

        Raises
        ------
        UserError
            With the offending name and the allowed ones.
        """
        if text is None:
            return list(self.parts.values())
        names = [name.strip() for name in text.split(",")]
        for name in names:
            if name not in self.parts:
                raise UserError(f"--figures {text}: {name or 'nothing'} is none; allowed are {', '.join(self.parts)}")
        return [part for name, part in self.parts.items() if name in names]


def make(resolution, guid):
    """The plan.

    Parameters
    ----------
    resolution : Resolution
    guid : str
        Of the FMU.
    """
    ups = {name: sweep_job(case, "up", resolution, guid) for name, case in CASES.items()}
    downs = [sweep_job(case, "down", resolution, guid) for case in CASES.values()]
    steadies = [steady_job(sweep, resolution) for sweep in ups.values()]
    curves = {str(number): figure_job(number, resolution, list(ups.values()), guid) for number in NUMBERS}
    exponents = [exponent_job(sweep, resolution) for sweep in ups.values()]
    attractors, basin = coexistence_jobs(ups["elastic"], resolution)
    maps = map_jobs(resolution, guid)
    spectra = SpectrumJob("spectra", guid, ups["elastic"].name)
    further = {"lyapunov": exponents, "attractors": [attractors], "basin": [basin], "maps": maps, "spectra": [spectra]}
    evidence = [
        attractors,
        basin,
        *maps,
        spectra,
        *exponents,
        *steadies,
        *(curves[name] for name in ("5", "7", "12")),
        *ups.values(),
        *downs,
        gamma_job(guid),
    ]
    jobs = [*ups.values(), *downs, *steadies, *curves.values(), gamma_job(guid), *exponents, attractors, basin, *maps, spectra]
    shown = {**{name: [ups[case]] for name, case in ORBITS.items()}, **{name: [job] for name, job in curves.items()}}
    parts = [Part("claims", "", tuple(job.name for job in evidence))]
    parts += [Part(name, f"figure{name}", tuple(job.name for job in shown[name])) for name in sorted(shown, key=int)]
    parts += [Part(name, name, tuple(job.name for job in some)) for name, some in further.items()]
    return Plan({job.name: job for job in jobs}, {part.name: part for part in parts})
