"""Verdicts on many records, in parallel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from ..errors import InputError
from ..fmu import finder
from ..lazy import Unpack, xr
from ..model import Structure
from ..running.options import Running
from ..running.runner import gather
from .detect import DetectJob, beam_job
from .evidence import Participation
from .fit import checked_free
from .hypotheses import FREE
from .settings import Changes, checked_settings


def detect_all(
    records: Mapping[str, xr.Dataset | Sequence[xr.Dataset]],
    guess: Structure | None = None,
    *,
    free: Sequence[str] = FREE,
    participation: Participation = None,
    settings: Changes = None,
    **running: Unpack[Running],
) -> dict[str, xr.Dataset]:
    """Decide for each of many beams whether its records are those of a delaminated structure.

    Parameters
    ----------
    records : mapping of str to xarray.Dataset, or to sequences of them
        By names of your own, which are the names of the files. One beam each, as for
        :func:`orchestrate.detect`.
    guess : Structure, optional
        Of all of them.
    free : sequence of str
        As for :func:`orchestrate.detect`.
    participation, settings
        As for :func:`orchestrate.detect`.
    **running
        ``jobs``, ``cluster``, ``store`` and others, see
        :class:`orchestrate.running.options.Running`; ``store`` is a folder, a file for each record.

    Returns
    -------
    dict of str to xarray.Dataset
        What :func:`orchestrate.detect` answers, by the records' names.

    Raises
    ------
    InputError
        It names the record that is wrong.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_halves(m1=1.5, m2=1.2, f1=42.0, f2=52.0, zeta1=0.01)
    >>> sweep = orchestrate.SweptSine(first=40.0, last=56.0, duration=6.0, acceleration=4.0)
    >>> history = orchestrate.shake(beam.as_bonded(), sweep, sample_rate=600.0)
    >>> answers = orchestrate.detect_all({"left": history}, beam.replace(f1=44.0))
    >>> str(answers["left"].verdict.values)
    'no opening seen'
    """
    if not isinstance(records, Mapping) or not records:
        raise InputError("records: expected one record or more, by names")
    rest = guess, checked_free(free), participation, checked_settings(settings)
    jobs = [named_job(name, record, *rest) for name, record in records.items()]
    return dict(zip(records, gather(jobs, running, finder(running)), strict=True))


def named_job(name: str, record: xr.Dataset | Sequence[xr.Dataset], *rest: Any) -> DetectJob:
    """Return the job of one beam; a message about its records names it."""
    try:
        return replace(beam_job(record, *rest), name=name)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
