"""From a record to a verdict: delaminated, no opening seen, not described, or undecided."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from ..fmu import finder
from ..laboratory.record_checks import clipped_share
from ..lazy import Unpack, xr
from ..model import Structure
from ..response.labels import Variable, variable
from ..response.questions import checked_structure
from ..running.job import Table
from ..running.options import Running
from ..running.runner import answer
from .bursts import burst_excess
from .decision_rule import DELAMINATED, NOT_SEEN, Findings, resampled_share
from .even_orders import smallest_openings, thresholds
from .evidence import Participation
from .fit import Results, checked_data, checked_free, delaminated_guess
from .hypotheses import FREE
from .impact_timing import strikes
from .orders import RecordOrders
from .search_job import SearchJob, cached_orders
from .settings import Changes, checked_settings
from .wiring import WiringSettings, wiring_notes

STATED = {  # numbers of the rule: their names there, units and long names
    "share": ("share", "1", "share of records put together of blocks in which the ratio decides"),
    "ratio": ("ratio", "1", "misfit of sound over that of delaminated"),
    "faces_apart": ("apart", "1", "difference of two sensors over its threshold"),
    "bursts": ("bursts", "1", "power of bursts once a period over its threshold"),
    "smallest_opening": ("smallest", "m", "smallest opening at a sensor that would be detected"),
    "level_low": ("low", "m/s2", "lowest level of the base"),
    "level_high": ("high", "m/s2", "highest level of the base"),
    "frequency_low": ("first", "Hz", "lowest frequency"),
    "frequency_high": ("last", "Hz", "highest frequency"),
}
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
    record: xr.Dataset,
    guess: Structure | None = None,
    *,
    free: Sequence[str] = FREE,
    participation: Participation = None,
    settings: Changes = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Decide whether a record is that of a delaminated structure.

    Parameters
    ----------
    record : xarray.Dataset
        Of a swept or stepped sine, with ``box_acceleration`` and one or both of ``acceleration1``
        and ``acceleration2``, as :func:`orchestrate.record` or :func:`orchestrate.read_record` make
        it.
    guess : Structure, optional
        Estimate of the delaminated structure. Frequencies may be off by 10 %; of the masses only
        the ratio matters. By default halves of equal mass at both sides of the record's resonance.
    free : sequence of str
        What is fitted of the delaminated structure, as for :func:`fit`.
    participation : float or mapping of str to float, optional
        Participation factors of the sensors that are known, as for :func:`fit`.
    settings : mapping of str to float, optional
        Thresholds that differ from those of :class:`orchestrate.diagnosis.settings.Settings`, such
        as ``{"ratio": 2.0}``.
    **running
        ``jobs``, ``progress``, ``store`` and others, see
        :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        ``verdict``: ``"delaminated"``, ``"no opening seen"``, ``"not described"`` or
        ``"undecided"``; ``share`` of the records put together of blocks of this one in which the
        ratio of misfits decides for a delamination; ``ratio`` (misfit of the best sound
        hypothesis over that of the delaminated one), ``faces_apart`` (difference of two sensors
        over the threshold from which it counts; 0 with one), ``bursts`` (power at high frequencies
        once a period, over the threshold from which impacts count as heard; NaN below some 11
        samples in the shortest
        period), ``smallest_opening`` of faces at a sensor that would be seen at every frequency,
        in m; the range in which the structure moves enough (``level_low``, ``level_high`` in m/s2,
        ``frequency_low``, ``frequency_high`` in Hz); of the whole record ``sample_rate``,
        ``record_duration``, ``sweep_low`` and ``sweep_high``; ``order2`` and its
        ``order2_threshold`` over ``window``. Over ``hypothesis``: ``misfit``, ``evaluations``,
        ``minima``, ``value`` and ``standard_error`` of its parameters, ``participation`` and
        ``participation_error`` over ``channel`` (NaN but of the hypotheses that the verdict is
        about and that describe the record), ``misfit_at`` and the ``fitted`` orders over
        ``window``, beside what is ``measured``. Attributes ``reason``, ``settle``,
        ``seen_up_to``, ``assumed``, ``direction`` of the sweep and ``wiring``, the doubts about the
        channels (:func:`orchestrate.diagnosis.wiring.wiring_notes`); and ``strikes``, what strikes
        by its timing (:meth:`orchestrate.diagnosis.impact_timing.Strikes.word`), which does not
        act on the verdict.

    Raises
    ------
    InputError
        Where the record is none of a swept or stepped sine, or sampled too slowly for order 2.

    Warns
    -----
    UserWarning
        Where the resonance is a factor of 2 or more from the guess's frequencies.

    Notes
    -----
    Sound hypotheses are one mass on a linear spring, on one that hardens or softens, with dry
    friction, or with a stop on one side (a breathing crack, a clamp with play), and two linear
    modes. The rule is that of :meth:`orchestrate.diagnosis.decision_rule.Findings.verdict`;
    what stopped a verdict is in ``reason``.
    There is no verdict "intact": a structure that is pressed together moves as a bonded one below
    the level that opens it. See :doc:`/diagnosis`.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_halves(m1=1.5, m2=1.2, f1=42.0, f2=52.0, zeta1=0.01)
    >>> sweep = orchestrate.SweptSine(first=40.0, last=56.0, duration=4.0, acceleration=4.0)
    >>> history = orchestrate.shake(beam.as_bonded(), sweep, sample_rate=600.0)
    >>> answer = orchestrate.detect(history, beam.replace(f1=44.0))
    >>> str(answer.verdict.values)
    'no opening seen'
    """
    chosen, changed = checked_free(free), checked_settings(settings)
    structure = None if guess is None else delaminated_guess(guess)
    data = checked_data(record, structure, participation, changed)
    made = structure or halves_around(cached_orders(data).resonance)
    job = DetectJob(
        name=f"detect_{checked_structure(guess or made).label()}",
        data=data,
        guess=made,
        free=chosen,
        is_guessed=guess is not None,
    )
    return answer(job, running, finder(running))


@dataclass(frozen=True, kw_only=True)
class DetectJob(SearchJob):
    """Fit all hypotheses to a record and decide which verdict they give."""

    asked: ClassVar[str] = "detect"
    is_guessed: bool = True  # by the caller, not from the record's resonance

    def dataset(self, table: Table) -> xr.Dataset:
        results = Results.from_table(self, table)
        findings, even = findings_from_results(results), results.even
        whole = cached_orders(self.data)
        every, coordinates = results.comparison()
        same = WiringSettings(clipped=findings.settings.clipped)
        wiring = "; ".join(note.text for note in wiring_notes(whole.channels, same))
        scalars = {
            "verdict": ((), findings.verdict(), {"long_name": "verdict"}),
            **{
                name: variable((), getattr(findings, of), *at) for name, (of, *at) in STATED.items()
            },
            **record_variables(whole),
            "order2": variable("window", even.ratio, "1", "order 2 over order 1"),
            "order2_threshold": variable("window", even.threshold, "1", "size that counts as seen"),
        }
        stated = stated_hypotheses(results, findings)
        numbers = results.parameters(stated)
        best = int(np.argmin(np.where(stated, results.misfit, np.inf)))
        unclear = dict.fromkeys(results.undetermined(best).values()) if stated[best] else ()
        del numbers["asked"]
        return xr.Dataset({**scalars, **every, **numbers}, coordinates).assign_attrs(
            analysis="detect",
            title=f"Verdict: {findings.verdict()}",
            reason=" ".join([findings.reason(), *(f"{text}." for text in unclear)]),
            settle="Mend the wiring, and ask again." if wiring else findings.next_measurement(),
            seen_up_to=findings.seen_up_to(),
            assumed="; ".join(ASSUMED if self.is_guessed else (WITHOUT_GUESS, *ASSUMED[1:])),
            direction=sweep_direction(whole.windows.frequency),
            wiring=wiring,
            strikes=self.what_strikes(whole),
        )

    def what_strikes(self, orders: RecordOrders) -> str:
        """Return the word of the sensor that hears most by impact timing, with its numbers."""
        half = self.guess
        shut = math.sqrt((half.k1 + half.k2) / (half.m1 + half.m2)) / TURN
        known = shut if self.is_guessed else math.nan
        every = (strikes(orders.channels, row, known) for row in orders.rows)
        one = max(every, key=lambda strike: strike.heard)
        return f"{one.word()} ({one.numbers()})"


def halves_around(resonance: float) -> Structure:
    """Return halves of equal mass, 5 % at both sides of a resonance in Hz, as a first guess."""
    f1, f2 = 0.95 * resonance, 1.05 * resonance
    return Structure.from_halves(m1=1.0, m2=1.0, f1=f1, f2=f2, zeta1=0.01, zeta2=0.01, e=0.6)


def record_variables(orders: RecordOrders) -> dict[str, Variable]:
    """Return sampling rate, duration, and the frequencies over which the base moves as a sine."""
    channels, windows = orders.channels, orders.windows
    rate, count = channels.sample_rate, len(channels.time)
    low, high = float(windows.frequency.min()), float(windows.frequency.max())
    return {
        "sample_rate": variable((), rate, "Hz", "sampling rate of the record"),
        "record_duration": variable((), (count - 1) / rate, "s", "duration of the record"),
        "sweep_low": variable((), low, "Hz", "lowest frequency of the base's sine"),
        "sweep_high": variable((), high, "Hz", "highest frequency of the base's sine"),
    }


def sweep_direction(frequency: NDArray[np.float64]) -> str:
    """Return in which direction the frequency of a sweep goes: up, down, or up and down."""
    covered = (frequency[-1] - frequency[0]) / max(float(np.ptp(frequency)), 1e-9)
    if abs(covered) < 0.5:
        return "up and down"
    return "up" if covered > 0.0 else "down"


def stated_hypotheses(results: Results, findings: Findings) -> NDArray[np.bool_]:
    """Return of each hypothesis whether its numbers are stated: it describes a decided record."""
    word, count = findings.verdict(), len(results.job.sound)
    sound = word == NOT_SEEN and results.misfit[:count] <= findings.settings.sound
    is_parted = word == DELAMINATED and findings.is_described
    parted = is_parted & (results.misfit[count:] <= findings.settings.delaminated)
    return np.concatenate([np.full(count, sound), parted])


def findings_from_results(results: Results) -> Findings:
    """Collect the quantities that the decision rule needs from the results of the fits."""
    job, even = results.job, results.even
    count, evidence = len(job.sound), job.evidence
    sound = int(np.argmin(results.misfit[:count]))
    other = count + int(np.argmin(results.misfit[count:]))
    opening = smallest_openings(evidence, job.guess.m1, job.guess.m2)
    observed = evidence.frequency[np.isfinite(opening)]
    whole = cached_orders(job.data)
    highest = float(whole.windows.frequency.max())
    response = (np.abs(evidence.measured[:, 0]) / evidence.level).max(axis=0)
    low, high = sorted((job.guess.f1, job.guess.f2))
    findings = Findings(
        excess=even.excess,
        order2=even.largest,
        apart=even.moved_apart,
        bursts=burst_excess(whole.channels, highest, evidence.settings),
        sound=job.hypotheses[sound].name,
        sound_misfit=float(results.misfit[sound]),
        delaminated=job.hypotheses[other].name,
        delaminated_misfit=float(results.misfit[other]),
        share=math.nan,
        sensors=len(evidence.masses),
        low=float(evidence.level.min()),
        high=float(evidence.level.max()),
        first=float(observed.min()),
        last=float(observed.max()),
        smallest=float(np.nanmax(opening)),
        hidden=float(np.nanmax(np.fmin.reduce(thresholds(evidence), axis=0))),
        clipped=max(clipped_share(row) for row in whole.channels.values),
        end_response=float(max(response[0], response[-1]) / response.max()),
        resonance=evidence.resonance,
        guessed=(low, high),
        settings=evidence.settings,
        alike=job.hypotheses[sound].alike,
    )
    residuals = results.residuals[sound], results.residuals[other]
    return replace(findings, share=resampled_share(*residuals, findings.deciding_ratio))
