"""Run many coupled systems side by side: several systems, ramp rates, bonded or not.

Each run is a job of its own: with a folder as store it is a file of its own there, resumes where it
was interrupted, and is not computed again by a later call with more sets or rates.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from ..errors import InputError
from ..fmu.exported import make_fmu_finder
from ..lazy import Unpack, xr
from ..model.drive import Drive
from ..model.ranges import checked_range
from ..model.structure import Structure
from ..response.labels import variable
from ..running.options import Running
from ..running.runner import compute_datasets
from . import averaged, couple, own_resonance
from .couple import KINDS


def default_eta0_range(structure: Structure, drive: Drive) -> tuple[float, float]:
    """Return the two ends of the voltage ramp, over K omega, from below to past resonance."""
    low, high = own_resonance.lower_and_higher_resonance(structure, drive)
    ends = (0.97 * low, 1.05 * high)
    first, last = (float(averaged.stationary_voltage(structure, drive, end)) for end in ends)
    folds = averaged.folds(structure, drive)
    return first, max([last, *(fold.eta0 + 0.05 for fold in folds)])


def make_couple_job_from_ratios(
    name: str,
    system: tuple[Structure, Drive],
    kind: str,
    rate: float,
    eta0: tuple[float, float] | None,
    back: bool,
    step: float | None,
) -> couple.CoupleJob:
    structure, drive = system
    couple.require_motor(structure, drive)
    structure = structure.as_bonded() if kind == "bonded" else structure.as_delaminated()
    volts, omega = drive.volts(structure), structure.omega
    first, last = default_eta0_range(structure.as_bonded(), drive) if eta0 is None else eta0
    ends, speed = (first * volts, last * volts), rate * volts * omega
    schedule = couple.schedule_from_arguments(structure, drive, ends, rate=speed, back=back)
    scheme = couple.scheme_from_arguments(structure, None if step is None else step / omega)
    job = couple.make_couple_job(structure, drive, schedule, scheme)
    return replace(job, name=f"couple_{name}_{kind}_{rate:g}")


def couple_all(
    systems: Mapping[str, tuple[Structure, Drive]],
    *,
    eta0: tuple[float, float] | None = None,
    rates: Sequence[float] = (1e-4,),
    kinds: Sequence[str] = KINDS,
    back: bool = True,
    step: float | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Couple many structures with their motors, at many ramp rates, side by side.

    Parameters
    ----------
    systems : mapping of str to (Structure, Drive)
        By names of your own, which are part of the files' names.
    eta0 : (float, float), optional
        Ends of the ramps, the voltage over K omega of each set. By default each set's own: from
        below the resonance to past the jump up, by the averaged theory.
    rates : sequence of float
        Of eta0 in a time 1/omega.
    kinds : sequence of str
        ``"bonded"``, ``"delaminated"``, or both.
    back : bool
        Whether the ramps come back.
    step : float, optional
        Communication step in 1/omega; controlled by its defect by default.
    **running
        ``jobs``, ``cluster``, ``store`` and others, see
        :class:`orchestrate.running.options.Running`; ``store`` is a folder, a file for each run.

    Returns
    -------
    xarray.Dataset
        What :func:`orchestrate.couple` gives, over ``run`` too, with the coordinates ``system``,
        ``structure`` and ``rate``; NaN where a run has fewer revolutions than another.

    Raises
    ------
    InputError
        Where an argument is not what is expected.

    Examples
    --------
    >>> from orchestrate import Drive, Structure, couple_all
    >>> sets = {name: (Structure.from_file(name), Drive.from_file(name)) for name in ("quick",)}
    >>> few = dict(eta0=(1.5, 1.7), rates=[4e-4, 8e-4], kinds=["bonded"], back=False, step=0.2)
    >>> found = couple_all(sets, **few, progress=False)
    >>> found.rate.values.tolist(), bool((found.jumps.sel(jump="up") > 7.0).any())
    ([0.0004, 0.0008], False)
    """
    if not isinstance(systems, Mapping) or not systems:
        raise InputError(f"systems = {systems!r}: expected {{name: (structure, drive), ...}}")
    for kind in kinds:
        if kind not in KINDS:
            raise InputError(f"kinds = {kind!r}: expected {' or '.join(KINDS)}")
    for rate in rates:
        checked_range("rate", rate, "of eta0 in a time 1/omega", low=0.0, open_low=True)
    runs = list(product(systems, kinds, dict.fromkeys(rates)))
    more = (eta0, back, step)
    jobs = [make_couple_job_from_ratios(n, systems[n], kind, rate, *more) for n, kind, rate in runs]
    if not jobs:
        raise InputError("kinds, rates: expected one of each, or more")
    datasets = [
        run.assign_coords(eta0=run.eta0.reset_coords(drop=True), Omega=run.Omega)
        for run in compute_datasets(jobs, running, make_fmu_finder(running))
    ]
    texts_of_jumps = {name: "" for name, values in datasets[0].items() if values.dtype.kind == "U"}
    missing = dict.fromkeys(datasets[0].data_vars, np.nan) | texts_of_jumps
    how: Any = {"join": "outer", "combine_attrs": "drop_conflicts", "data_vars": "all"}
    result = xr.concat(datasets, "run", fill_value=missing, **how)
    names, states, speeds = (np.array(column) for column in zip(*runs, strict=True))
    text = "change of the no-load speed over omega per 1/omega"
    result = result.assign_coords(
        system=("run", names, {"long_name": "name of the set"}),
        structure=("run", states, {"long_name": "structure"}),
        rate=variable("run", speeds, "1", text),
    )
    result.attrs["title"] = "Weak drive: many runs"
    return result
