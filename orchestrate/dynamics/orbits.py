"""One periodic orbit by Newton's method: the job and function ``orchestrate.orbit``."""

from __future__ import annotations

from abc import ABC
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ..constants import TURN
from ..errors import InputError
from ..fmu import OSCILLATOR, EventInstance
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import (
    Count,
    Number,
    Transient,
    checked_integer,
    checked_number,
    checked_numbers,
    whole,
)
from ..response import questions
from ..response.labels import make_dataset
from ..response.questions import Point
from ..response.signatures import as_given, question
from ..running.job import FAMILY, Fmus, Table
from ..running.options import Running
from .closed_form import ClosedForm, Floats
from .continuation import SOLVER_ERRORS
from .families import Setting, nonzero_pushes
from .orbit_records import orbit_coordinates, orbit_row, orbit_table, orbit_variables
from .orbit_search import (
    Guess,
    close_returns,
    first_possible_orbit,
    guess_from_phases,
    simulate_guess,
    single_impact_guesses,
)
from .periodic_orbit import AT_OUTER_END, IMPACT, PHASE, RELEASE, ImpactSequence

MAX_PERIODS = 1000  # of an orbit that can be asked for
NODE = ("node_phase", "node_position", "node_velocity", "node_closing")


@dataclass(frozen=True)
class FirstGuess:
    """The user's guess of an orbit in plain numbers: a state, or kinds and nodes of its impacts."""

    state: tuple[float, ...] = ()  # x1, x2 in m, v1, v2 in m/s at phase 0; empty where not given
    kinds: tuple[int, ...] = ()  # of the nodes
    # phase, position, velocity, closing speed of each; or only phases
    nodes: tuple[tuple[float, ...], ...] = ()

    def argument_text(self, frequency: float) -> str:
        """Return Python source of the ``guess=`` argument that repeats this guess."""
        if self.state:
            return f"{self.state!r}"
        rows = zip(self.kinds, self.nodes, strict=True)
        times = [row[PHASE] / frequency for kind, row in rows if kind % AT_OUTER_END != RELEASE]
        return f"{{'impact_time': {times!r}}}"

    def as_guess(self, periods: int) -> Guess:
        """Return the nodes of all impacts and releases as what Newton's method begins with."""
        return ImpactSequence(periods, self.kinds), np.array(self.nodes).reshape(-1, 4)


def call_text_from_start(job: Any, values: Floats, **keywords: Any) -> str:
    """Return Python source of a call that begins with an orbit, the orbit's call included."""
    setting, point = job.setting, job.setting.point(values)
    numbers = {**dict(setting.excitation), **dict(zip(setting.over, values.tolist(), strict=True))}
    shown = {name: numbers[name] for name in questions.QUANTITIES if name in numbers}
    of_orbit = [f"{name}={value!r}" for name, value in {**shown, "period": job.period}.items()]
    guess = f"guess={job.start.argument_text(point.excitation.frequency)}"
    start = f"orbit({', '.join([repr(point.structure), *of_orbit, guess])})"
    parts = [f"{name}={value!r}" for name, value in keywords.items()]
    return f"{job.asked}({', '.join([repr(job.structure), f'start={start}', *parts])})"


@dataclass(frozen=True, kw_only=True)
class SingleOrbitQuestion(questions.Question, ABC):
    """Base of questions about one orbit at a fixed excitation."""

    excitation: tuple[tuple[str, float], ...]  # as the user gave it
    replaced: ClassVar[tuple[str, ...]] = questions.OF_EXCITATION

    @property
    def setting(self) -> Setting:
        return Setting.fixed(self.structure, (*self.excitation, *nonzero_pushes(vars(self))))

    @property
    def values(self) -> Floats:
        """Return the value of the setting's only parameter, as an array of length 1."""
        return np.array([self.excitation[0][1]])


class OrbitJob(SingleOrbitQuestion):
    """Job of :func:`orchestrate.orbit`: one periodic orbit, checked by the FMU."""

    family: ClassVar[tuple[str, ...]] = FAMILY
    guess: FirstGuess | None

    def format_call(self) -> str:
        frequency = self.setting.point(self.values).excitation.frequency
        arguments = {**dict(self.setting.excitation), "period": self.period}
        parts = [f"{self.structure!r}", *(f"{name}={value!r}" for name, value in arguments.items())]
        if self.guess is None:
            parts += [f"{name}={getattr(self, name)}" for name in ("transient", "search", "tries")]
        else:
            parts.append(f"guess={self.guess.argument_text(frequency)}")
        return f"orbit({', '.join(parts)})"

    def work(self, fmus: Fmus, items: Sequence[int], previous: Table | None) -> Table:
        setting, values = self.setting, self.values
        with EventInstance(fmus[OSCILLATOR]) as instance:
            guesses = self.guesses(instance, setting.point(values), setting.closed_form(values))
            try:
                family, root = first_possible_orbit(
                    setting, guesses, values, prefer_stable=self.guess is None
                )
            except SOLVER_ERRORS as reason:
                expected = "another period, or a guess to orbit, whose result is a start for branch"
                expected = "another guess" if self.guess else expected
                raise InputError(
                    f"period = {self.period}: no orbit found ({reason}); expected {expected}"
                ) from None
            return orbit_table([orbit_row(instance, family, root.unknowns, root.residual)])

    def guesses(self, instance: EventInstance, point: Point, form: ClosedForm) -> Iterator[Guess]:
        """Yield guesses by the user's one, or from close returns, then with a single impact."""
        guess, period = self.guess, self.period
        if guess is None:
            returns = close_returns(instance, point, period, self.transient, self.search)
            for state, _ in islice(list(returns), self.tries):
                yield simulate_guess(instance, point, form, state, period)
            yield from single_impact_guesses(form, period)
        elif guess.state:
            yield simulate_guess(instance, point, form, np.array(guess.state), period)
        elif np.shape(guess.nodes)[1:] == (4,):
            yield guess.as_guess(period)
        else:
            sequence, phases = ImpactSequence(period, guess.kinds), np.array(guess.nodes)[:, 0]
            for shift in np.arange(12) * TURN / 12:
                yield guess_from_phases(form, sequence, phases + shift)

    def dataset(self, table: Table) -> xr.Dataset:
        setting = self.setting
        title = f"Periodic orbit of {self.period} periods: {self.structure.label()}"
        variables = orbit_variables(setting, table, "point")
        coordinates = orbit_coordinates(setting, table, "point")
        return make_dataset(variables, coordinates, title).isel(point=0)


def checked_guess(
    guess: Any, structure: Structure, frequency: float, period: int
) -> FirstGuess | None:
    expected = "expected a state, impact times, or a result of orbit or branch"
    if guess is None:
        return None
    if not isinstance(guess, Mapping):
        return FirstGuess(state=questions.checked_state("guess", guess, structure))
    if "node_kind" in guess:
        return guess_from_result(guess)
    if "impact_time" not in guess:
        raise InputError(f"guess: without impact_time; {expected}")
    numbers = np.asarray(checked_numbers("impact_time", guess["impact_time"]), dtype=float)
    times = np.sort(numbers.ravel())
    phases = frequency * times
    if not (phases[0] >= 0.0 and phases[-1] - phases[0] < 2.0 * np.pi * period):
        raise InputError(f"impact_time = {times.tolist()}: expected times within {period} periods")
    return FirstGuess(kinds=(IMPACT,) * len(phases), nodes=tuple((p,) for p in phases.tolist()))


def guess_from_result(result: Mapping[Any, Any]) -> FirstGuess:
    """Return the nodes of a result of ``orbit`` or of one point of a branch."""
    kinds = np.asarray(result["node_kind"])
    if kinds.ndim != 1:
        raise InputError("guess: several orbits; expected one (in Python branch.isel(point=0))")
    is_node = kinds >= 0
    columns = [np.asarray(result[name])[is_node] for name in NODE]
    rows = tuple(tuple(map(float, row)) for row in np.stack(columns, axis=1))
    return FirstGuess(kinds=tuple(map(int, kinds[is_node])), nodes=rows)


def excitation_arguments(
    eta: ArrayLike | None, frequency: ArrayLike | None, amplitude: ArrayLike | None
) -> tuple[tuple[str, float], ...]:
    """Return those arguments that are not None as (name, number); raise unless numbers."""
    arguments = {"eta": eta, "frequency": frequency, "amplitude": amplitude}
    stated = ((name, value) for name, value in arguments.items() if value is not None)
    return tuple((name, checked_number(name, value)) for name, value in stated)


@question(OrbitJob)
def orbit(
    structure: Structure,
    *,
    eta: ArrayLike | None = None,
    frequency: ArrayLike | None = None,
    amplitude: ArrayLike | None = None,
    period: Annotated[int, whole(1, MAX_PERIODS)] = 1,
    guess: ArrayLike | Mapping[Any, Any] | None = None,
    box_acceleration: Number = 0.0,
    force1: Number = 0.0,
    force2: Number = 0.0,
    transient: Transient = 500,
    search: int = 200,
    tries: Count = 20,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Compute a periodic orbit by Newton's method, stable or unstable, and its multipliers.

    Parameters
    ----------
    structure : Structure
    eta, frequency, amplitude
        As in :func:`orchestrate.simulate`.
    period : int
        Excitation periods after which the orbit closes.
    guess : array_like of 4 floats, or mapping, optional
        What Newton's method begins with: a state x1, x2 in m, v1, v2 in m/s at phase 0, or a result
        that this function has found at another parameter. Or, in Python, a mapping with
        ``impact_time``, times of all impacts in s, of which the distances matter most. By default
        the closest returns of the response from rest, then orbits with a single impact: the first
        stable orbit among what is found, or the first.
    box_acceleration, force1, force2 : float
        As in :func:`orchestrate.simulate`: a constant acceleration of the box in m/s2, amplitudes
        of forces on the masses in N, in phase with the box.
    transient : int
        Periods of the response that are dropped where there is no guess.
    search : int
        Periods after these that are searched for close returns.
    tries : int
        Close returns that are tried.
    **running
        ``store``, ``fmu`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        ``state`` (SI) and ``xi`` at each phase 0; ``impact_time`` and ``impact_velocity``;
        ``multipliers``, with real and imaginary parts; ``stable``, and ``stability``, which is
        *undecided* where the multipliers lie inside the unit circle but the FMU runs through other
        impacts; ``exponent``, the largest
        Lyapunov exponent that follows; ``permanent_contact``; amplitudes ``xi1_max``, ``xi2_max``,
        ``xi_rel_max``; ``residual`` of Newton's method; ``fmu_same_impacts`` and ``fmu_return``,
        how the FMU runs through it; and its nodes, what Newton's method
        solved for: ``node_kind``, ``node_phase`` and so on.

    Raises
    ------
    InputError
        Where arguments are missing or contradict each other, or no orbit is found.

    Notes
    -----
    See :mod:`orchestrate.dynamics.periodic_orbit` for the equations. Where chattering ends in
    permanent contact the deviation of the gap dies there: two multipliers are zero. The other two
    decide the stability; the sequence of the last impacts is that of the structure's ``gamma``.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.dynamics.orbits import orbit
    >>> found = orbit(Structure.nondimensional(), eta=3.0)
    >>> found.impact_time.values.round(6), bool(found.stable)
    (array([0.480678]), False)
    >>> found.multipliers.sel(part="real").values.round(4)
    array([-3.3595, -0.5903, -0.5903, -0.1421])
    """
    pushes = {"box_acceleration": box_acceleration, "force1": force1, "force2": force2}
    point = questions.checked_point(structure, eta, frequency, amplitude, **pushes)
    questions.require_delaminated(structure)
    point.excitation.check(structure)
    count = checked_integer("period", period, 1, MAX_PERIODS)
    excitation = excitation_arguments(eta, frequency, amplitude)
    first = checked_guess(guess, structure, point.excitation.frequency, count)
    search = checked_integer("search", search, count + 1)
    return as_given(f"_{count}T", excitation=excitation, guess=first, search=search)
