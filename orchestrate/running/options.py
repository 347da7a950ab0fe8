"""Keywords of all public functions on how to compute: jobs, cluster, progress, store, force."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

from ..errors import InputError
from ..model.arguments import checked_integer, checked_path
from ..model.ranges import checked_flag
from ..model.spelling import closest_name, did_you_mean

if TYPE_CHECKING:
    from distributed import Client

MAX_JOBS = 1024  # workers of one machine
OF_COMMANDS = {  # what users of the command line write, and what it is in Python
    "hz": "frequency=2*pi*Hz, in rad/s",
    "rpm": "frequency=2*pi*rpm/60, in rad/s",
    "g": "amplitude=9.80665*g/frequency**2, in m",
}
FmuFiles = str | os.PathLike[str] | Mapping[str, str | os.PathLike[str]]


class Running(TypedDict, total=False):
    """Types of the keywords on how to compute (jobs, cluster, progress, store), for signatures.

    Attributes
    ----------
    jobs : int, optional
        Threads or processes at once; all cores by default. Small questions are computed in this
        process.
    cluster : str, distributed.Client or concurrent.futures.Executor, optional
        Address of a Dask scheduler whose workers compute instead, such as ``tcp://host:8786``. Or a
        client of it, or any executor of ``jobs`` workers.
    progress : bool
        Whether what takes longer than a second shows a progress bar; true by default. A function
        to be called is not taken: log messages and the bar are what there is.
    store : path, optional
        NetCDF file of the result. Results are stored there step by step: the same call resumes
        where it was interrupted, and reads the file when it is finished. Without it all is kept in
        memory.
    force : bool
        Recompute all, whatever is stored. An older result stays until the new one is complete;
        after an interruption, the same call without ``force`` resumes the new one.
    keep_stale : bool
        Take a stored result even where the code or the FMU has changed since.
    fmu : path or mapping, optional
        Own FMU file; by default the one of the present sources. A mapping has one by model name.
    build_folder : path, optional
        Where FMUs are looked for and exported to.
    """

    jobs: int | None
    cluster: str | Client | Executor | None
    progress: bool
    store: str | os.PathLike[str] | None
    force: bool
    keep_stale: bool
    fmu: FmuFiles | None
    build_folder: str | os.PathLike[str] | None


@dataclass(frozen=True)
class RunOptions:
    """Checked keywords on how to compute (jobs, cluster, progress, store), with their defaults."""

    jobs: int | None = None
    cluster: str | Client | Executor | None = None
    progress: bool = True
    store: str | os.PathLike[str] | None = None
    force: bool = False
    keep_stale: bool = False
    fmu: FmuFiles | None = None
    build_folder: str | os.PathLike[str] | None = None

    def __post_init__(self) -> None:
        if isinstance(self.force, float):
            text = "expected true or false, to recompute; a force on a half is force1= or force2="
            raise InputError(f"force = {self.force!r}: {text}")
        for name in ("progress", "force", "keep_stale"):
            object.__setattr__(self, name, checked_flag(name, getattr(self, name)))
        fmus = self.fmu.values() if isinstance(self.fmu, Mapping) else (self.fmu,)
        paths = ("store", self.store), *(("fmu", fmu) for fmu in fmus)
        for name, value in (*paths, ("build_folder", self.build_folder)):
            if value is not None:
                checked_path(name, value)
        if self.jobs is not None:
            object.__setattr__(self, "jobs", checked_integer("jobs", self.jobs, 1, MAX_JOBS))
        is_dask_client = hasattr(self.cluster, "get_executor")
        if not (is_dask_client or isinstance(self.cluster, (str, Executor, type(None)))):
            expected = "the address of a Dask scheduler, a client of it, or an executor of"
            text = f"cluster = {self.cluster!r}: expected {expected} concurrent.futures"
            raise InputError(text)

    @classmethod
    def from_keywords(cls, running: Mapping[str, object]) -> RunOptions:
        refuse_unknown_keywords(running)
        return cls(**running)  # type: ignore[arg-type]

    @property
    def worker_count(self) -> int:
        """Number of workers, threads or processes: ``jobs``, or all cores this process may use."""
        usable = getattr(os, "sched_getaffinity", None)
        return self.jobs or (len(usable(0)) if usable else os.cpu_count() or 1)

    def result_path(self, name: str) -> Path | None:
        """Return the NetCDF path of a named result below ``store``; None without ``store``."""
        if self.store is None:
            return None
        path = Path(self.store)
        return path if path.suffix == ".nc" else path / f"{name}.nc"


def refuse_unknown_keywords(names: Iterable[str], own: Iterable[str] = ()) -> None:
    running = [field.name for field in fields(RunOptions)]
    known = [*own, *running]
    for name in names:
        if name not in known:
            meant = did_you_mean(OF_COMMANDS.get(name) or closest_name(name, known))
            expected = f"expected the function's own or one of {', '.join(running)}"
            raise TypeError(f"unexpected keyword argument {name!r}: {expected}{meant}")
