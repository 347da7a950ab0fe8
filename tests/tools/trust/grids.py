"""Adversarial parameter sets over several communication grids, by the kernel inside the FMU.

Every set ends on all its grids with the same bits, or is refused at its start with the same code;
a step gives up only where it has more impacts than anyone waits for.
"""

from __future__ import annotations

import time
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fmu_src.kernels.oscillator import memory as at
from fmu_src.models.oscillator.variables import VARIABLES
from fmu_src.runtime.compiled import load_compiled
from tools.trust.parameter_sets import ParameterSet

Entry = Callable[[int, float], int]
MANY = 1e6  # impacts in a step, from which on it may give up
# what belongs to a point of time, not to the step before it
POINT = (
    *range(at.X1, at.BOX_IMPULSE),
    *range(at.CONTACT_FORCE, at.X_REL_MAX),
    *(at.CONTACT_COUNT, at.TIME),
)


@dataclass(frozen=True)
class Run:
    """A parameter set on one grid.

    Attributes
    ----------
    code : int
        The kernel's last: 0 where the end was reached.
    point : bytes
        The outputs there; empty where it was not.
    begun : bool
        Whether initialisation went well.
    impacts : float
        The most that a step had.
    seconds : float
        Of the processor, for the longest step.
    """

    code: int
    point: bytes
    begun: bool
    impacts: float
    seconds: float


def entry_points(fmu: Path, folder: Path) -> tuple[Entry, Entry]:
    """``initialize`` and ``advance`` of the kernel compiled into the FMU by pythonfmu, unpacked to
    ``folder``.
    """
    with zipfile.ZipFile(fmu) as archive:
        (name,) = (n for n in archive.namelist() if n.endswith("kernel-x86_64-linux.so"))
        path = Path(archive.extract(name, folder))
    loaded = load_compiled(str(path.parent), path.parent.name, ("initialize", "advance"))
    assert loaded is not None
    return loaded[0], loaded[1]


def run(entries: tuple[Entry, Entry], chosen: ParameterSet, points: Sequence[float]) -> Run:
    """A set on one grid."""
    initialize, advance = entries
    memory = np.zeros(at.SIZE)
    for slot, variable in enumerate(VARIABLES):
        if not variable.calculated:
            memory[slot] = chosen.values.get(variable.name, variable.start)
    address = memory.ctypes.data
    if code := initialize(address, chosen.start_time):
        return Run(code, b"", False, 0.0, 0.0)
    impacts = seconds = 0.0
    for point in points:
        before, begun = memory[at.IMPACT_COUNT], time.process_time()
        code = advance(address, point)
        seconds = max(seconds, time.process_time() - begun)
        impacts = max(impacts, memory[at.IMPACT_COUNT] - before)
        if code:
            return Run(code, b"", True, impacts, seconds)
    return Run(0, memory[list(POINT)].tobytes(), True, impacts, seconds)


def complaint(runs: Sequence[Run]) -> str:
    """What is wrong with a set's runs on its grids; empty where nothing is."""
    if any(one.code == at.UNFINISHED and one.impacts < MANY for one in runs):
        return "a step with few impacts does not finish"
    judged = [one for one in runs if one.code != at.UNFINISHED]
    if len({one.code for one in judged}) > 1:
        return "refused on one grid, not on another"
    if len({one.point for one in judged}) > 1:
        return "other bits on another grid"
    if any(one.code and one.begun and one.code != at.UNFINISHED for one in runs):
        return "refused on the way"
    if any(one.code and one.seconds > 2.0 for one in runs):
        return "gives up after more than 2 s"
    return ""
