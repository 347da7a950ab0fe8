"""From a record to a verdict: delaminated, no opening seen, not described, or undecided."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..fmu import make_fmu_finder
from ..laboratory.analysis.channels import Channels
from ..laboratory.record_checks import clipped_share
from ..lazy import Unpack, xr
from ..model import Structure
from ..response.labels import Variable, variable
from ..response.questions import checked_structure
from ..running.job import Table
from ..running.options import Running
from ..running.runner import compute_dataset, compute_datasets
from .decision_rule import DELAMINATED, NOT_SEEN, Beam, Findings
from .evidence import Participation
from .fit import Results, checked_delaminated_guess, checked_free_parameters, checked_record_data
from .hypotheses import FREE
from .impact_timing import measure_strikes
from .opening_measures import order_2_thresholds, smallest_visible_opening_by_window
from .search_job import (
    RecordData,
    SearchJob,
    cached_channels,
    cached_evidence,
    cached_face_difference,
    cached_opening_measures,
    cached_orders,
)
from .settings import Changes, Settings, checked_settings
from .undamaged import SoundStructure
from .wiring import WiringSettings, wiring_notes

STATED = {  # numbers of the fitted record: their names there, units and long names
    "faces_apart": ("apart", "1", "difference of two sensors over its threshold"),
    "smallest_opening": ("smallest", "m", "smallest opening at a sensor that would be detected"),
    "level_low": ("low", "m/s2", "lowest level of the base"),
    "level_high": ("high", "m/s2", "highest level of the base"),
    "frequency_low": ("first", "Hz", "lowest frequency"),
    "frequency_high": ("last", "Hz", "highest frequency"),
}
UNSIZED = (
    "What decides is that faces strike: two masses describe this structure only so well, and their "
    "numbers are not stated."
)
UNFITTED = "Two masses were not fitted: the misfit is the guess's."
WITHOUT_GUESS = "both halves have the same mass: no guess was given"
ASSUMED = (
    "the masses of both halves have the ratio of the guess",
    "each half has one mode in the range of the sweep",
    "the accelerometer of the base measures all that excites the structure",
    "each sensor's participation factor is the one that was given, or from 0.2 to 1.7",
    "gains of the sensors agree within 12 % and their delays within 1 ms",
    "restitution does not depend on the speed",
)


def detect(
    record: xr.Dataset | Sequence[xr.Dataset],
    guess: Structure | None = None,
    *,
    free: Sequence[str] = FREE,
    participation: Participation = None,
    settings: Changes = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Decide whether a record, or several of one beam, are those of a delaminated structure.

    Parameters
    ----------
    record : xarray.Dataset or sequence of xarray.Dataset
        Of a swept or stepped sine, with ``box_acceleration`` and one or both of ``acceleration1``
        and ``acceleration2``, as :func:`orchestrate.record` or :func:`orchestrate.read_record` make
        it. Several are of one beam at other levels, in other directions, by other sensors.
    guess : Structure, optional
        Estimate of the delaminated structure. Frequencies may be off by 10 %; of the masses only
        the ratio matters. By default halves of equal mass at both sides of the record's resonance.
    free : sequence of str
        What is fitted of the delaminated structure, as for :func:`fit`.
    participation : float or mapping of str to float, optional
        Participation factors of the sensors that are known, as for :func:`fit`.
    settings : mapping of str to float, optional
        Thresholds that differ from those of :class:`orchestrate.diagnosis.settings.Settings`, such
        as ``{"hidden": 0.05}``.
    **running
        ``jobs``, ``progress``, ``store`` and others, see
        :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        ``verdict``: ``"delaminated"``, ``"no opening seen"``, ``"not described"`` or
        ``"undecided"``; ``opening_level`` of the base in m/s2, the
        lowest at which faces strike (NaN where none do). Over ``record``: ``record_level`` in m/s2
        and ``record_strikes``, what strikes in it. All else is of the one that was fitted, which
        hears most: ``ratio`` (misfit of the best sound hypothesis over that of the delaminated
        one), ``faces_apart`` (difference of two sensors over the threshold from which it counts; 0
        with one), ``smallest_opening`` of faces at a sensor that would be seen at every frequency,
        in m; the range in which the structure moves enough (``level_low``, ``level_high`` in m/s2,
        ``frequency_low``, ``frequency_high`` in Hz); of the whole record ``sample_rate``,
        ``record_duration``, ``sweep_low`` and ``sweep_high``; ``order2`` and its
        ``order2_threshold`` over ``window``. Over ``hypothesis``: ``misfit``, ``evaluations``,
        ``minima``, ``value`` and ``standard_error`` of its parameters, ``participation`` and
        ``participation_error`` over ``channel`` (NaN but of the hypotheses that the verdict is
        about and that describe the record), ``misfit_at`` and the ``fitted`` orders over
        ``window``, next to what is ``measured``. Attributes ``reason``, ``settle``,
        ``assumed``, ``direction`` of the sweep and ``wiring``, the doubts about the
        channels (:func:`orchestrate.diagnosis.wiring.wiring_notes`); and ``strikes``, what strikes
        with the numbers that decide it (:class:`orchestrate.diagnosis.impact_timing.Strikes`).

    Raises
    ------
    InputError
        If the record is not of a swept or stepped sine, or sampled too slowly for order 2.

    Warns
    -----
    UserWarning
        Where the resonance is a factor of 1.3 or more from the guess's frequencies.

    Notes
    -----
    The rule is that of :meth:`orchestrate.diagnosis.decision_rule.Beam.verdict`; what stopped a
    verdict is in ``reason``. Fits do not act on it: they size what is decided, with two masses or
    with sound hypotheses (one mass on a linear spring, on one that hardens or softens, with dry
    friction or a stop on one side, and two linear modes).
    There is no verdict "intact": a structure that is pressed together moves as a bonded one below
    the level that opens it. See :doc:`/diagnosis`.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_halves(m1=1.5, m2=1.2, f1=42.0, f2=52.0, zeta1=0.01)
    >>> sweep = orchestrate.SweptSine(first=40.0, last=56.0, duration=4.0, acceleration=4.0)
    >>> history = orchestrate.shake(beam.as_bonded(), sweep, sample_rate=1200.0)
    >>> answer = orchestrate.detect(history, beam.replace(f1=44.0))
    >>> str(answer.verdict.values)
    'no opening seen'
    """
    rest = checked_free_parameters(free), participation, checked_settings(settings)
    return compute_dataset(beam_job(record, guess, *rest), running, make_fmu_finder(running))


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
    free, participation, settings
        As for :func:`orchestrate.detect`.
    **running
        The same, but ``store`` is a folder, with a file for each record.

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
    >>> history = orchestrate.shake(beam.as_bonded(), sweep, sample_rate=1200.0)
    >>> answers = orchestrate.detect_all({"left": history}, beam.replace(f1=44.0))
    >>> str(answers["left"].verdict.values)
    'no opening seen'
    """
    if not isinstance(records, Mapping) or not records:
        raise InputError("records: expected one record or more, by names")
    rest = guess, checked_free_parameters(free), participation, checked_settings(settings)
    jobs = []
    for name, record in records.items():
        try:
            jobs.append(replace(beam_job(record, *rest), name=name))
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
    return dict(
        zip(records, compute_datasets(jobs, running, make_fmu_finder(running)), strict=True)
    )


def beam_job(
    record: xr.Dataset | Sequence[xr.Dataset],
    guess: Structure | None,
    free: tuple[str, ...],
    participation: Participation,
    settings: Settings,
) -> DetectJob:
    """Return the job that decides on the records of a beam, and fits the one that hears most."""
    structure = None if guess is None else checked_delaminated_guess(guess)
    is_list = isinstance(record, Sequence)
    records: Sequence[xr.Dataset] = record if isinstance(record, Sequence) else [record]
    if not records:
        raise InputError("record: an empty list; expected one record or more of one beam")
    every = []
    for number, one in enumerate(records, 1):
        try:
            every.append(checked_record_data(one, structure, participation, settings))
        except InputError as error:
            place = f"record {number} of {len(records)}: " if is_list else ""
            raise InputError(f"{place}{error}") from None
    made = structure or assumed_halves(cached_orders(every[0]).resonance, settings)
    shown = [record_findings(one, made, structure is not None) for one in every]
    verdict = Beam(tuple(shown)).verdict()
    fitted = int(np.argmax([one.strikes.heard * one.is_usable for one in shown]))
    return DetectJob(
        name=f"detect_{checked_structure(guess or made).label()}",
        data=every[fitted],
        others=(tuple(every[:fitted]), tuple(every[fitted + 1 :])),
        guess=made,
        free=free,
        is_guessed=guess is not None,
        is_delaminated=verdict == DELAMINATED,
    )


@dataclass(frozen=True, kw_only=True)
class DetectJob(SearchJob):
    """Decide on the records of a beam, and fit all hypotheses to the one that hears most."""

    asked: ClassVar[str] = "detect"
    others: tuple[tuple[RecordData, ...], tuple[RecordData, ...]] = ((), ())  # before it, after it
    is_guessed: bool = True  # by the caller, not from the record's resonance
    is_delaminated: bool = True  # by the rule

    @property
    def is_worth_a_search(self) -> bool:
        """Whether two masses are searched: their numbers are stated of delaminated beams only."""
        return self.is_delaminated and super().is_worth_a_search

    def beam(self) -> Beam:
        assert isinstance(self.data, RecordData)  # a resonance curve has no strikes
        every = (*self.others[0], self.data, *self.others[1])
        return Beam(tuple(record_findings(one, self.guess, self.is_guessed) for one in every))

    def dataset(self, table: Table) -> xr.Dataset:
        results, beam = Results.from_table(self, table), self.beam()
        findings, even = beam.records[len(self.others[0])], results.opening_measures
        whole, channels = cached_orders(self.data), cached_channels(self.data)
        every, coordinates = results.order_variables_and_coordinates()
        same = WiringSettings(clipped=findings.settings.clipped)
        wiring = "; ".join(note.text for note in wiring_notes(channels, same))
        ratio = results.misfit[: len(self.sound)].min() / results.misfit[len(self.sound) :].min()
        levels = [one.high for one in beam.records]
        words = [beam.strike_words[one] for one in beam.records]
        scalars = {
            "verdict": ((), beam.verdict(), {"long_name": "verdict"}),
            "ratio": variable((), ratio, "1", "misfit of sound over that of delaminated"),
            "opening_level": variable((), beam.opening_level, "m/s2", "level at which it opens"),
            "record_level": variable("record", levels, "m/s2", "highest level of a record"),
            "record_strikes": ("record", words, {"long_name": "what strikes in a record"}),
            **{
                name: variable((), getattr(findings, of), *at) for name, (of, *at) in STATED.items()
            },
            **sampling_variables(channels, whole.windows.frequency),
            "order2": variable("window", even.ratio, "1", "order 2 over order 1"),
            "order2_threshold": variable("window", even.threshold, "1", "size that counts as seen"),
        }
        stated = mask_of_stated_hypotheses(results, beam.verdict())
        numbers = results.parameter_variables(stated)
        best = int(np.argmin(np.where(stated, results.misfit, np.inf)))
        unclear = dict.fromkeys(results.why_undetermined(best).values()) if stated[best] else ()
        del numbers["asked"]
        unsized = beam.verdict() == DELAMINATED and not stated.any()
        said = [UNSIZED] * unsized + [UNFITTED] * (not self.is_worth_a_search)
        notes = [beam.reason(), *said, *(f"{one}." for one in unclear)]
        return xr.Dataset({**scalars, **every, **numbers}, coordinates).assign_attrs(
            analysis="detect",
            title=f"Verdict: {beam.verdict()}",
            reason=" ".join(notes),
            settle="Correct the wiring and diagnose again." if wiring else beam.next_measurement(),
            assumed="; ".join(ASSUMED if self.is_guessed else (WITHOUT_GUESS, *ASSUMED[1:])),
            direction=sweep_direction(whole.windows.frequency),
            wiring=wiring,
            strikes=f"{beam.strike_words[findings]} ({findings.strikes.format_quantities()})",
        )


def assumed_halves(resonance: float, settings: Settings) -> Structure:
    """Return halves of equal mass at both sides of a resonance in Hz, as a first guess."""
    f1, f2 = ((1.0 + sign * settings.assumed_apart) * resonance for sign in (-1.0, 1.0))
    zeta, e = settings.assumed_damping, settings.assumed_restitution
    return Structure.from_halves(m1=1.0, m2=1.0, f1=f1, f2=f2, zeta1=zeta, zeta2=zeta, e=e)


def sampling_variables(channels: Channels, frequency: NDArray[np.float64]) -> dict[str, Variable]:
    """Return sampling rate, duration, and the frequencies over which the base moves as a sine."""
    rate, count = channels.sample_rate, len(channels.time)
    low, high = float(frequency.min()), float(frequency.max())
    return {
        "sample_rate": variable((), rate, "Hz", "sampling rate of the record"),
        "record_duration": variable((), (count - 1) / rate, "s", "duration of the record"),
        "sweep_low": variable((), low, "Hz", "lowest frequency of the base's sine"),
        "sweep_high": variable((), high, "Hz", "highest frequency of the base's sine"),
    }


def sweep_direction(frequency: NDArray[np.float64]) -> str:
    """Return a word for the direction of a sweep: up, down, or up and down."""
    covered = (frequency[-1] - frequency[0]) / max(float(np.ptp(frequency)), 1e-9)
    if abs(covered) < 0.5:
        return "up and down"
    return "up" if covered > 0.0 else "down"


def mask_of_stated_hypotheses(results: Results, verdict: str) -> NDArray[np.bool_]:
    """Return a mask of the hypotheses whose numbers are stated: those of a decided record."""
    count, settings = len(results.job.sound), results.job.data.settings
    sound, parted = results.misfit[:count], results.misfit[count:]
    most = min(settings.delaminated, float(sound.min()) / settings.ratio)
    return np.concatenate(
        [
            (verdict == NOT_SEEN) & (sound <= settings.sound),
            (verdict == DELAMINATED) & (parted <= most),
        ]
    )


@lru_cache(maxsize=4)
def record_findings(data: RecordData, guess: Structure, is_guessed: bool) -> Findings:
    """Collect the quantities that the decision rule needs from a record."""
    evidence, channels = cached_evidence(data), cached_channels(data)
    even = cached_opening_measures(data)
    shut = SoundStructure.from_structure(guess).f
    opening = smallest_visible_opening_by_window(evidence, guess.m1, guess.m2)
    observed = evidence.frequency[np.isfinite(opening)]
    response = (np.abs(evidence.measured_orders[:, 0]) / evidence.level).max(axis=0)
    low, high = sorted((guess.f1, guess.f2))
    return Findings(
        excess=even.largest_excess,
        order2=even.ratio_at_largest_excess,
        apart=cached_face_difference(data),
        strikes=measure_strikes(channels, shut if is_guessed else math.nan),
        sensors=len(evidence.sensor_masses),
        low=float(evidence.level.min()),
        high=float(evidence.level.max()),
        first=float(observed.min()),
        last=float(observed.max()),
        smallest=float(np.nanmax(opening)),
        hidden=float(np.nanmax(np.fmin.reduce(order_2_thresholds(evidence), axis=0))),
        clipped=max(clipped_share(row) for row in channels.values),
        end_response=float(max(response[0], response[-1]) / response.max()),
        resonance=evidence.resonance,
        guessed=(low, high),
        whose="the guess's" if is_guessed else "the first record's",
        samples=channels.sample_rate / evidence.resonance,
        settings=data.settings,
    )
