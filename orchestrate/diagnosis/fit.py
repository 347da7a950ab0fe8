"""The numbers of a structure from a record: natural frequencies, damping, restitution, gap."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..fmu import make_fmu_finder
from ..laboratory.analysis.channels import BOX
from ..laboratory.pieces import Floats
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import checked_texts, checked_word
from ..response.labels import Variable, variable
from ..response.questions import checked_structure
from ..running.job import Table, refuse_unsupported_structure
from ..running.options import Running
from ..running.runner import compute_dataset
from .curve_evidence import CurveData
from .decision_rule import DELAMINATED, factor_outside_range
from .evidence import FITTED_ORDERS, Evidence, Participation, checked_participation
from .hypotheses import FREE, REPORTED, Hypothesis
from .opening_measures import OpeningMeasures, measure_opening
from .order_windows import checked_base_and_faces
from .search_job import RecordData, SearchJob, cached_orders
from .settings import SETTINGS, Changes, Settings, checked_settings
from .wiring import WiringSettings, wiring_notes

EQUAL = 2.0  # standard errors of their difference within which two frequencies are equal
# arguments for the hypotheses of `SOUND`, in their order
SHORT_NAMES = ("bonded", "curved", "friction", "stop", "stop on the other side", "two modes")


def fit(
    record: xr.Dataset,
    guess: Structure,
    *,
    free: Sequence[str] = FREE,
    hypothesis: str = DELAMINATED,
    participation: Participation = None,
    settings: Changes = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Fit a structure to a record of a swept or stepped sine, or to a resonance curve.

    Parameters
    ----------
    record : xarray.Dataset
        With ``box_acceleration`` and one or both of ``acceleration1`` and ``acceleration2``, as
        :func:`orchestrate.record` or :func:`orchestrate.read_record` make it; or a resonance curve
        of :func:`orchestrate.resonance_curve` or :func:`orchestrate.read_curve`.
    guess : Structure
        Its masses are kept (only their ratio acts), and all that is not free. Its frequencies may
        be 10 % off: the search begins at the record's resonance.
    free : sequence of str
        What is fitted: ``f1``, ``f2``, ``zeta1``, ``zeta2``, ``e``, ``clearance``. A gap that is
        not free is that of the guess, and what it does is taken for the frequencies.
    hypothesis : str
        ``"delaminated"``; or one mass, that is ``"bonded"``, ``"curved"`` (a spring that hardens or
        softens), ``"friction"`` (dry), ``"stop"`` or ``"stop on the other side"``; or ``"two
        modes"``, linear ones.
    participation : float or mapping of str to float, optional
        Participation factor of the sensors, or by sensor (``acceleration1``, ``acceleration2``): a
        sensor on a beam reads ``base + participation (mass - base)``, by its place. Those that are
        not given are fitted, from 0.2 to 1.7; at a single frequency they are taken as 1.
    settings : mapping of str to float, optional
        Errors of a model and of sensors, and the effort of the search, that differ from those of
        :class:`orchestrate.diagnosis.settings.Settings`.
    **running
        ``jobs``, ``progress``, ``store`` and others, see
        :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over ``parameter``: ``value`` and ``standard_error``, with ``unit``; NaN where the record
        does not hold it: the halves' numbers where no opening is seen, their frequencies where they
        are equal within their errors, a damping ratio whose error is above ``undetermined`` of it;
        errors and correlations also where the misfit is above ``delaminated`` of the settings. Over
        ``parameter`` and ``other_parameter``: ``correlation``. ``misfit``, 1 where the model misses
        3 % of order 1 or the noise, and ``evaluations``; ``minima`` over ``minimum``: misfits of
        those that differ;
        ``misfit_at`` over ``window``; ``participation`` and ``participation_error`` over
        ``channel``. Over ``channel``, ``order`` and ``window``: the amplitudes
        ``measured``, ``fitted`` and their ``floor`` in m/s2. The attribute ``reason`` says why
        numbers or errors are stated or not.

    Raises
    ------
    InputError
        If the record is neither a swept or stepped sine nor a resonance curve, if a single tone
        gives fewer numbers than are fitted, or if a name is invalid.

    Notes
    -----
    The measured acceleration of the base is the FMU's input, as the cubic spline through its
    samples. Compared are order 1 (as a complex number) and the sizes of orders 2 and 3 in windows
    of about 0.25 s, over errors that have a relative part: 3 % of order 1 and what is between the
    orders. A participation factor, a gain and a delay of each sensor against that of the base are
    found in closed form.
    The standard errors add what simulated noise does and what blocks of windows show; see
    :mod:`orchestrate.diagnosis.standard_errors`.

    Of a resonance curve each frequency is a window. A stepped sine of its levels is played until
    the motion has settled, in the curve's direction; phases and orders are compared where the curve
    has them, over 3 % of order 1 and its ``floor``. Its noise is what the residuals scatter from
    one frequency to the next. ``f1`` and ``f2`` cannot be identified from order 1 of one face.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_halves(m1=1.5, m2=1.2, f1=42.0, f2=52.0, zeta1=0.01)
    >>> sweep = orchestrate.SweptSine(first=40.0, last=56.0, duration=6.0, acceleration=4.0)
    >>> history = orchestrate.shake(beam.as_bonded(), sweep, sample_rate=600.0)
    >>> answer = orchestrate.fit(history, beam.replace(f1=44.0), hypothesis="bonded")
    >>> round(float(answer.value.sel(parameter="f")), 1)
    46.7

    Order 1 of a resonance curve, as transmissibility:

    >>> import numpy as np
    >>> hertz = np.linspace(42.0, 52.0, 21)
    >>> ratio = abs((1 + 0.02j * hertz / 47) / (1 - (hertz / 47) ** 2 + 0.02j * hertz / 47))
    >>> curve = orchestrate.resonance_curve(frequency=hertz, level=4.0, amplitude1=ratio, unit="1")
    >>> answer = orchestrate.fit(curve, beam, hypothesis="bonded")
    >>> answer.value.sel(parameter=["f", "zeta"]).values.round(2).tolist()
    [47.0, 0.01]
    """
    chosen = checked_free_parameters(free)
    kind = checked_word("hypothesis", hypothesis, (DELAMINATED, *SHORT_NAMES))
    structure, changed = checked_delaminated_guess(guess), checked_settings(settings)
    over = getattr(record, "dims", ())
    is_curve = "frequency" in over and "time" not in over
    read = CurveData.from_curve if is_curve else checked_record_data
    data = read(record, structure, participation, changed)
    job = FitJob(
        name=f"fit_{checked_structure(guess).label()}",
        data=data,
        guess=structure,
        free=chosen,
        sound=(0,) if kind in (DELAMINATED, "bonded") else (0, SHORT_NAMES.index(kind)),
        delaminated=kind == DELAMINATED,
        kind=kind,
    )
    evidence, fitted = job.evidence, job.hypotheses[-1].bounds(job.evidence)
    numbers = len(FITTED_ORDERS) * len(evidence.sensor_masses)  # that one tone has
    is_level = np.ptp(evidence.level) < 0.1 * evidence.level.max()
    if evidence.windows.is_tone and is_level and len(fitted) >= numbers:
        text = f"one tone of {evidence.frequency.mean():.4g} Hz has {numbers} numbers"
        expected = "expected a sweep, or fewer in free="
        raise InputError(f"record: {text}, {len(fitted)} are fitted; {expected}")
    return compute_dataset(job, running, make_fmu_finder(running))


def checked_free_parameters(free: Sequence[str]) -> tuple[str, ...]:
    """Check the names of the parameters to be fitted, and return them as a tuple."""
    names = checked_texts("free", free)
    expected = f"expected some of {', '.join(FREE)}"
    for name in names:
        if name not in FREE:
            raise InputError(f"free = {name!r}: {expected}")
    if not names or len(set(names)) < len(names):
        raise InputError(f"free = {names!r}: {expected}, each once")
    return names


def checked_record_data(
    record: xr.Dataset,
    guess: Structure | None = None,
    participation: Participation = None,
    settings: Settings = SETTINGS,
) -> RecordData:
    """Return a record's data for a job; raise without a sine of the base, warn of another guess."""
    channels = checked_base_and_faces(record)
    factors = checked_participation(participation, [one for one in channels.names if one != BOX])
    data = RecordData.from_channels(channels, factors, settings)
    try:
        resonance = cached_orders(data).resonance
    except InputError as error:
        notes = wiring_notes(channels, WiringSettings(clipped=settings.clipped))
        raise InputError("; ".join([str(error), *(note.text for note in notes)])) from None
    if guess is not None:
        low, high = sorted((guess.f1, guess.f2))
        factor = factor_outside_range(resonance, low, high)
        if factor > settings.guess_factor:
            text = f"a factor of {factor:.3g} from the guess's {low:.3g} to {high:.3g} Hz"
            text = f"record: the response is largest at {resonance:.3g} Hz, {text}: are the times"
            warnings.warn(f"{text} in s, and is the guess one of this beam?", stacklevel=3)
    return data


def checked_delaminated_guess(guess: Structure) -> Structure:
    """Return the guess as delaminated; raise unless both halves have a spring."""
    structure = checked_structure(guess)
    refuse_unsupported_structure("the diagnosis", structure)
    if not (structure.k1 > 0.0 and structure.k2 > 0.0):
        text = "expected k1 > 0 and k2 > 0"
        raise InputError(f"guess: k1 = {structure.k1!r} N/m, k2 = {structure.k2!r} N/m; {text}")
    return structure.replace(bonded=False)


# -- results --------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class FitJob(SearchJob):
    """Fit one hypothesis to a record."""

    asked: ClassVar[str] = "fit"
    kind: str

    def dataset(self, table: Table) -> xr.Dataset:
        results = Results.from_table(self, table)
        position = len(self.hypotheses) - 1
        every, coordinates = results.order_variables_and_coordinates()
        every |= results.parameter_variables(np.full(len(self.hypotheses), True))
        made = xr.Dataset(every, coordinates).isel(hypothesis=position)
        name = self.hypotheses[position].name
        named = made.drop_vars("hypothesis").dropna("parameter", how="all", subset=["asked"])
        if isinstance(self.data, CurveData):
            named = named.drop_vars("time")  # of the stepped sine that is played for it
        made = named.drop_vars("asked").assign(
            correlation=results.correlation_variable(position, list(named.parameter.values))
        )
        whys = results.why_no_errors(position), *results.why_undetermined(position).values()
        reason = "; ".join(filter(None, (results.reason(), *dict.fromkeys(whys))))
        return made.assign_attrs(
            analysis="fit", title=f"Fit: {name}", hypothesis=name, reason=reason
        )


@dataclass(frozen=True)
class Results:
    """Hold the results of a search job as arrays, one row a hypothesis."""

    job: SearchJob
    values: Floats
    covariance: Floats
    minima: Floats
    misfit: Floats
    residuals: Floats
    fitted: NDArray[np.complex128]
    participation: Floats  # and standard error of each sensor, shape (hypotheses, 2, sensors)
    evaluations: Floats

    @classmethod
    def from_table(cls, job: SearchJob, table: Table) -> Results:
        ends = (name for name in table if name.startswith("end_"))
        part = {name.removeprefix("end_"): table[name][0] for name in ends}
        real, imaginary = np.moveaxis(part.pop("fitted"), 1, 0)
        return cls(job, fitted=real + 1j * imaginary, **part)

    @property
    def opening_measures(self) -> OpeningMeasures:
        """Order 2 of the record beyond that of the fitted bonded structure."""
        return measure_opening(self.job.evidence, self.fitted[0])

    def reason(self) -> str:
        """Return a sentence that says why the halves' numbers are stated or not."""
        even = self.opening_measures
        size = f"order 2 is up to {100 * even.ratio_at_largest_excess:.2g} % of order 1"
        if not np.isfinite(self.job.evidence.measured_orders[:, 1]).any():
            if even.is_opening_seen:
                return "the two faces move differently; order 2 is not in the curve"
            return "order 2 is not in the curve: order 1 of one face does not determine f1 and f2"
        if even.is_opening_seen:
            return f"{size}, {even.largest_excess:.2g} times the size from which it counts as seen"
        return f"no opening is seen ({size}): f1 and f2 cannot be identified from this record"

    @property
    def is_described(self) -> NDArray[np.bool_]:
        """Whether each hypothesis describes the record, so that its errors are known."""
        return self.misfit <= self.job.data.settings.delaminated

    def why_no_errors(self, position: int) -> str:
        """Return why a hypothesis has no standard errors, empty where it has them."""
        if self.is_described[position]:
            return ""
        misfit, limit = self.misfit[position], self.job.data.settings.delaminated
        text = f"the misfit {misfit:.3g} is above {limit:g}, the record is not described"
        return f"no standard errors: {text}"

    def reported_values_and_covariance(self, position: int) -> tuple[dict[str, float], Floats]:
        """Return the reported parameters of a hypothesis by name, and their covariance."""
        hypothesis, evidence = self.job.hypotheses[position], self.job.evidence
        names = list(hypothesis.bounds(evidence))
        here = dict(zip(names, self.values[position].tolist(), strict=False))
        slopes = reported_derivatives(hypothesis, here, evidence)
        covariance = self.covariance[position][: len(names), : len(names)]
        return hypothesis.reported_parameters(here, evidence), slopes @ covariance @ slopes.T

    def why_undetermined(self, position: int) -> dict[str, str]:
        """Return which reported numbers of a hypothesis the record does not determine, and why."""
        reported, covariance = self.reported_values_and_covariance(position)
        at = {name: number for number, name in enumerate(reported)}
        error = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        found: dict[str, str] = {}
        limit = self.job.data.settings.undetermined
        for name in ("zeta", "zeta1", "zeta2") if self.is_described[position] else ():
            if name in at and error[at[name]] > limit * reported[name]:
                number = f"{reported[name]:.2g}, standard error {error[at[name]]:.2g}"
                found[name] = f"{name} is not determined ({number})"
        if {"f1", "f2"} <= at.keys():
            across = np.array([(name == "f1") - (name == "f2") for name in at], dtype=float)
            apart = abs(reported["f1"] - reported["f2"])
            if apart <= EQUAL * np.sqrt(max(float(across @ covariance @ across), 0.0)):
                both = f"f1 and f2 ({reported['f1']:.4g} and {reported['f2']:.4g} Hz)"
                text = f"{both} are equal within their errors: halves of equal frequency never open"
                found |= dict.fromkeys(("f1", "f2"), f"{text}, and their numbers say nothing")
        return found

    def parameter_variables(self, stated: NDArray[np.bool_]) -> dict[str, Variable]:
        """Return values and errors of the hypotheses that are ``stated``, NaN of the others."""
        shape = (len(self.values), len(REPORTED))
        value, error, asked = np.full((3, *shape), np.nan)
        for row in range(len(self.values)):
            known, covariance = self.reported_values_and_covariance(row)
            errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
            unclear, is_open = self.why_undetermined(row), self.opening_measures.is_opening_seen
            for (name, number), deviation in zip(known.items(), errors, strict=True):
                column = list(REPORTED).index(name)
                asked[row, column] = 1.0
                is_known = name not in unclear and (is_open or name not in FREE)
                if stated[row] and is_known:
                    value[row, column] = number
                    error[row, column] = deviation if self.is_described[row] else np.nan
        over = ("hypothesis", "parameter")
        factor, doubt = np.where(stated[:, None, None], self.participation, np.nan).swapaxes(0, 1)
        doubt = np.where(self.is_described[:, None] | (doubt == 0.0), doubt, np.nan)  # 0: given
        place, words = ("hypothesis", "channel"), "participation factor of the sensor"
        return {
            "participation": variable(place, factor, "1", words),
            "participation_error": variable(place, doubt, "1", f"standard error of the {words}"),
            "value": variable(over, value, "", "fitted value, in the parameter's unit"),
            "standard_error": variable(over, error, "", "standard error, in the parameter's unit"),
            "asked": variable(over, asked, "1", "1 where the hypothesis has the parameter"),
        }

    def correlation_variable(self, position: int, names: list[str]) -> tuple[Any, ...]:
        """Return the correlation matrix of the errors of a hypothesis's reported parameters."""
        reported, covariance = self.reported_values_and_covariance(position)
        size = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        order = [list(reported).index(name) for name in names]
        known = (covariance / np.outer(size, size))[np.ix_(order, order)]
        if not self.is_described[position]:
            known = np.full_like(known, np.nan)
        return variable(("parameter", "other_parameter"), known, "1", "correlation of errors")

    def order_variables_and_coordinates(self) -> tuple[dict[str, Variable], dict[str, Variable]]:
        """Return measured and fitted orders with the misfits, and their coordinates."""
        evidence = self.job.evidence
        floor = evidence.floor[:, None].repeat(len(FITTED_ORDERS), axis=1)
        by_window = np.sqrt(np.mean(self.residuals**2, axis=(1, 2)))
        over, windows = ("channel", "order", "window"), ("hypothesis", "window")
        minima, fitted = ("hypothesis", "minimum"), ("hypothesis", *over)
        variables: dict[str, tuple[Any, ...]] = {
            "misfit": ("hypothesis", self.misfit, "1", "misfit over what is expected"),
            "evaluations": ("hypothesis", self.evaluations, "1", "motions that were computed"),
            "minima": (minima, self.minima, "1", "misfits of the minima that differ"),
            "misfit_at": (windows, by_window, "1", "misfit in each window"),
            "measured": (over, np.abs(evidence.measured_orders), "m/s2", "amplitude of orders"),
            "floor": (over, floor, "m/s2", "amplitude between the orders"),
            "fitted": (fitted, np.abs(self.fitted), "m/s2", "amplitude of fitted orders"),
        }
        units, words = zip(*REPORTED.values(), strict=True)
        names = [one.name for one in self.job.hypotheses]
        excited, over_excitation = "frequency of the excitation", "frequency over the excitation's"
        coordinates = {
            "hypothesis": text_coordinate("hypothesis", names, "hypothesis"),
            "parameter": text_coordinate("parameter", list(REPORTED), "parameter"),
            "unit": text_coordinate("parameter", units, "unit of the parameter"),
            "meaning": text_coordinate("parameter", words, "meaning of the parameter"),
            "channel": text_coordinate("channel", evidence.orders.sensors, "channel of the record"),
            "order": variable("order", np.array(FITTED_ORDERS), "1", over_excitation),
            "time": variable("window", evidence.windows.time, "s", "middle of the window"),
            "frequency": variable("window", evidence.frequency, "Hz", excited),
            "level": variable("window", evidence.level, "m/s2", "amplitude of the base"),
        }
        return {name: variable(*of) for name, of in variables.items()}, coordinates


def reported_derivatives(
    hypothesis: Hypothesis, here: Mapping[str, float], evidence: Evidence
) -> Floats:
    """Differentiate the reported parameters by the fitted ones (central differences)."""
    columns = []
    for name, value in here.items():
        step = 1e-5 * max(abs(value), 0.1)
        moved = [{**here, name: value + sign * step} for sign in (1.0, -1.0)]
        ends = [list(hypothesis.reported_parameters(one, evidence).values()) for one in moved]
        columns.append((np.array(ends[0]) - np.array(ends[1])) / (2.0 * step))
    return np.stack(columns, axis=1)


def text_coordinate(dimension: str, values: Sequence[str], words: str) -> Variable:
    return (dimension, list(values), {"long_name": words})
