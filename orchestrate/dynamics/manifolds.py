"""Unstable manifolds of saddles of the stroboscopic map: the job and ``orchestrate.manifold``."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..fmu import OSCILLATOR, Instance, start_motion
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import Positive, checked_number, whole
from ..response.labels import (
    column_variables,
    flags,
    make_dataset,
    nondimensional_state_coordinate,
    variable,
)
from ..response.questions import require_delaminated
from ..response.signatures import as_given, question
from ..running.job import Fmus, Table
from ..running.options import Running
from . import curve_growth
from .branches import (
    complete_excitation,
    compute_start_orbit,
    pushes_at_start,
    require_orbit_dataset,
)
from .closed_form import Floats, separating_sign
from .continuation import SOLVER_ERRORS, with_positive_leading_component
from .orbit_records import pad_rows
from .orbit_search import solve_orbit
from .orbits import (
    FirstGuess,
    SingleOrbitQuestion,
    call_text_from_start,
    excitation_arguments,
    guess_from_result,
)
from .periodic_orbit import ON_CIRCLE, PHASE, PeriodicOrbit
from .turning_points import stroboscopic_states

SIDES = ("+", "-")
ENDS = {0: curve_growth.LENGTH, 1: curve_growth.POINTS, 2: curve_growth.CONVERGED}
COUNTS = ("impact_count", "contact_count")
BREAKS = {
    "break_iterate": "number of the last point before the break",
    "break_arclength": "from the saddle to the break",
    "break_distance": "across the break, in xi (3)",
    "break_power": "with which that distance falls with that of the starts: 0 at a jump",
    "break_impacts": "impacts more behind the break",
    "break_contacts": "permanent contacts more behind the break",
}
ROUNDING = 16.0 * float(np.finfo(float).eps)  # of a state's largest number, with room
ROUNDED = 2.0**-44, 2.0**-36  # to that a saddle's numbers are rounded, and its eigenvector


@dataclass(frozen=True)
class Saddle:
    """A saddle orbit at phase 0: state, unstable direction, its multiplier outside the circle."""

    state: Floats  # units of xi, with the faces' places for displacements
    direction: Floats  # of the unstable manifold, of length 1; the gap grows along it
    multiplier: float
    periods: int
    size: float  # largest displacement or velocity of its nodes

    @classmethod
    def from_orbit(cls, orbit: PeriodicOrbit) -> Saddle:
        """Return an orbit as a saddle; raise unless just one multiplier lies outside the circle."""
        multipliers = orbit.multipliers()
        outside = multipliers[np.abs(multipliers) > 1.0 + ON_CIRCLE]
        if len(outside) != 1:
            raise InputError(
                f"start: an orbit with {len(outside)} multipliers outside the unit circle; "
                "expected a saddle with one, whose unstable manifold is a curve"
            )
        largest = float(np.abs(orbit.nodes[:, 1:]).max())
        size = float(round_off_last_bits(np.array([largest]), largest)[0])
        state = round_off_last_bits(stroboscopic_states(orbit)[0], size)
        direction = round_off_last_bits(unstable_direction(orbit), 1.0, ROUNDED[1])
        multiplier = float(round_off_last_bits(outside[:1].real, 1.0, ROUNDED[1])[0])
        return cls(state, direction, multiplier, orbit.sequence.periods, size)

    @property
    def growth_factor(self) -> float:
        """Factor by which a distance along the manifold grows until it is on the same side."""
        return self.multiplier if self.multiplier > 0.0 else self.multiplier**2

    @property
    def periods_per_return(self) -> int:
        """Excitation periods until a point is on the same side: doubled if the multiplier < 0."""
        return self.periods if self.multiplier > 0.0 else 2 * self.periods


def round_off_last_bits(numbers: Floats, size: float, unit: float = ROUNDED[0]) -> Floats:
    """Round to a multiple of ``unit`` times ``size``, a power of 2: equal on all processors."""
    # all that follows from them is the FMU's, and the same everywhere
    step = unit * 2.0 ** math.floor(math.log2(size))
    return np.asarray(np.round(numbers / step) * step)


def unstable_direction(orbit: PeriodicOrbit) -> Floats:
    """Return the unit eigenvector of the largest multiplier, for states at phase 0."""
    values, vectors = np.linalg.eig(orbit.monodromy())
    node = vectors[:, np.argmax(np.abs(values))].real
    form, phase = orbit.form, orbit.nodes[:1, PHASE]
    mode, closing = orbit.modes[-1:], separating_sign(orbit.sequence.outer[:1])
    # from the state before the first node to its gap, centre (x, v) and closing speed
    reduction = np.zeros((4, 4))
    reduction[0, :2], reduction[3, 2:] = [-1.0, 1.0], closing * [1.0, -1.0]
    reduction[1, :2] = reduction[2, 2:] = form.shares
    arrival = np.linalg.solve(reduction, np.append(0.0, node[1:]))
    rate = form.state_rates(orbit.end_states[-1:], orbit.end_phases[-1:], mode)[0]
    deviation = arrival - rate * node[PHASE] / form.eta
    vector = form.flow_matrices(-phase / form.eta, mode)[0] @ deviation
    if orbit.in_contact[-1]:
        vector = form.centre_matrix() @ vector
    vector = with_positive_leading_component(vector / np.linalg.norm(vector))
    gap = vector[1] - vector[0]
    return -vector if gap < 0.0 else vector


class ManifoldJob(SingleOrbitQuestion):
    """Job of :func:`orchestrate.manifold`: the unstable manifold of one saddle, both sides."""

    start: FirstGuess  # nodes of the saddle
    item_columns: ClassVar[tuple[str, ...]] = ()  # points of the curves

    def __post_init__(self) -> None:
        super().__post_init__()
        self.solve_saddle()  # fail early if there is no saddle

    def format_call(self) -> str:
        names = ("length", "spacing", "angle", "distance", "most")
        keywords = {name: getattr(self, name) for name in names}
        return call_text_from_start(self, self.values, **keywords)

    def solve_saddle(self) -> Saddle:
        """Solve for the saddle; raise unless both sides may begin at the distance asked for."""
        guess = self.start.as_guess(self.period)
        try:
            family, root = solve_orbit(self.setting, guess, self.values)
        except SOLVER_ERRORS as reason:
            expected = "expected an orbit of this structure"
            raise InputError(f"start: no orbit found from there ({reason}); {expected}") from None
        saddle = Saddle.from_orbit(family.orbit(root.unknowns))
        gap = float(saddle.state[1] - saddle.state[0]) / saddle.size  # at phase 0
        # starts lie between the distance and its image, where the first piece ends
        along = float(saddle.direction[1] - saddle.direction[0])
        change = abs(along * saddle.growth_factor)
        taken = self.distance * change
        if taken > max(gap, 0.0):  # starts would be beyond a closed gap
            limit = "an orbit whose gap is open at phase 0"
            if gap > 0.0:
                limit = f"a distance below {gap / change:.2g}"
            raise InputError(
                f"distance = {self.distance:g}: the gap at phase 0 is {gap:.2g} of the orbit's "
                f"size, and a start takes up to {taken:.2g} of it; expected {limit}"
            )
        return saddle

    def work(self, fmus: Fmus, items: Sequence[int], previous: Table | None) -> Table:
        saddle = self.solve_saddle()
        with Instance(fmus[OSCILLATOR]) as instance:
            growth, largest = math.log(saddle.growth_factor), float(np.abs(saddle.state).max())
            settings = curve_growth.GrowthSettings(
                length=self.length * saddle.size,
                spacing=self.spacing * saddle.size,
                angle=self.angle,
                max_points=self.most,
                size=saddle.size,
                max_step=curve_growth.GrowthSettings.max_step * max(1.0, math.log(2.0) / growth),
                resolution=ROUNDING * largest / (self.distance * saddle.size * growth),
            )
            images = [self.make_point_function(instance, saddle, sign) for sign in (1.0, -1.0)]
            curves = [curve_growth.CurveGrower(image, settings).grow() for image in images]
        numbers = {"multiplier": [saddle.multiplier], "size": [saddle.size]}
        of_saddle = {name: np.array(number) for name, number in numbers.items()}
        return {**curves_table(curves), **of_saddle, "saddle": saddle.state[np.newaxis]}

    def make_point_function(
        self, instance: Instance, saddle: Saddle, sign: float
    ) -> Callable[[float], curve_growth.CurvePoint]:
        """Return a function s -> point of one side, which iterates the stroboscopic map."""
        point = self.setting.point(self.values)
        time = saddle.periods_per_return * point.excitation.period

        def run(faces: Floats, returns: int) -> tuple[Floats, Floats]:
            start_motion(instance, *point, point.states_from_faces(faces.copy()))
            if returns:
                instance.step(0.0, returns * time)
            values = np.array(instance.get("x1", "x2", "v1", "v2", *COUNTS), dtype=float)
            return point.faces_from_states(values[:4]), values[4:]

        orbit_counts = run(saddle.state, 1)[1]  # what happens on the orbit itself is no change

        def image(s: float) -> curve_growth.CurvePoint:
            returns = math.floor(s)
            distance = self.distance * saddle.size * saddle.growth_factor ** (s - returns)
            state, counts = run(saddle.state + sign * distance * saddle.direction, returns)
            itinerary = tuple(int(n) for n in counts - returns * orbit_counts)
            return curve_growth.CurvePoint(s, state, itinerary)

        return image

    def dataset(self, table: Table) -> xr.Dataset:
        point, along = self.setting.point(self.values), ("side", "point")
        faces, arclength, iterate = np.split(table["rows"], [4, 5], axis=-1)
        xi, gap = faces.copy(), faces[..., 1] - faces[..., 0]
        xi[..., 1] -= point.structure.gap_offset / point.displacement_unit
        states = point.states_from_faces(faces.copy())
        saddle = point.states_from_faces(table["saddle"][0].copy())
        rate = point.velocity_unit * (faces[..., 3] - faces[..., 2])
        text = "states at phase 0: x1, x2 in m, v1, v2 in m/s; NaN where the curve is broken"
        of_size = "largest displacement or velocity in xi (3)"
        count = "excitation periods over those of a return, from the first piece on"
        broken = table["breaks"].T
        variables = {
            "state": variable((*along, "coordinate"), states, "SI", text),
            "xi": variable((*along, "coordinate"), xi, "1", "states at phase 0 (3)"),
            "x_rel": variable(along, point.displacement_unit * gap, "m", "gap at phase 0"),
            "v_rel": variable(along, rate, "m/s", "its rate"),
            "arclength": variable(along, arclength[..., 0], "1", "from the saddle, in xi (3)"),
            "iterate": variable(along, iterate[..., 0], "1", count),
            "end": flags("side", table["ends"], "why the curve ends", ENDS),
            "saddle": variable("coordinate", saddle, "SI", "the orbit itself"),
            "multiplier": variable((), table["multiplier"][0], "1", "the one outside the circle"),
            "orbit_size": variable((), table["size"][0], "1", of_size),
            "break_side": flags("break", broken[0], "side of the manifold", dict(enumerate(SIDES))),
            **column_variables("break", BREAKS, broken[1:]),
        }
        title = f"Unstable manifold of an orbit of {self.period} periods: {self.structure.label()}"
        sides = variable("side", np.array(SIDES), "1", "on which the gap grows, or falls")
        coordinates = {"side": sides, **nondimensional_state_coordinate()}
        return make_dataset(variables, coordinates, title, **dict(self.excitation))


def curves_table(curves: Sequence[curve_growth.GrownCurve]) -> Table:
    """Return both sides' points, breaks and ends as arrays, padded with NaN to equal length."""
    sides = []
    for curve in curves:  # state, arclength and s of each point, a row of NaN at each break
        states, numbers = zip(*((point.state, point.s) for point in curve.points), strict=True)
        rows = np.column_stack([np.array(states), curve.arclength, np.array(numbers)])
        sides.append(np.insert(rows, list(curve.breaks), np.nan, axis=0))
    breaks = [
        [side, change.low.s, curve.arclength[number], change.distance, change.power]
        + [float(b - a) for a, b in zip(change.low.itinerary, change.high.itinerary, strict=True)]
        for side, curve in enumerate(curves)
        for number, change in curve.breaks.items()
    ]
    words = {word: number for number, word in ENDS.items()}
    return {
        "rows": pad_rows(sides, np.nan),
        "ends": np.array([words[curve.end] for curve in curves]),
        "breaks": np.array(breaks, dtype=float).reshape(-1, 7),
    }


@question(ManifoldJob)
def manifold(
    structure: Structure,
    *,
    start: xr.Dataset | None = None,
    eta: ArrayLike | None = None,
    frequency: ArrayLike | None = None,
    amplitude: ArrayLike | None = None,
    period: int = 1,
    box_acceleration: Annotated[float | None, checked_number] = None,
    force1: Annotated[float | None, checked_number] = None,
    force2: Annotated[float | None, checked_number] = None,
    length: Positive = 5.0,
    spacing: Positive = 0.005,
    angle: Positive = 0.2,
    distance: Positive = 1e-5,
    most: Annotated[int, whole(2)] = 10000,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Compute the unstable manifold of a saddle of the stroboscopic map, as two curves.

    Parameters
    ----------
    structure : Structure
    start : xarray.Dataset, optional
        The saddle: an orbit of :func:`orchestrate.orbit`, or a point of a branch. By default the
        orbit that :func:`orchestrate.orbit` finds.
    eta, frequency, amplitude : float, optional
        The excitation; by default that of ``start``.
    period : int
        Excitation periods of the orbit, without ``start``.
    box_acceleration, force1, force2 : float, optional
        As in :func:`orchestrate.orbit`; by default that of ``start``, else 0.
    length : float
        Arclength of each side, over the orbit's size.
    spacing : float
        Largest distance of neighbouring points, over the orbit's size.
    angle : float
        Largest angle between successive chords, rad.
    distance : float
        From the saddle, over the orbit's size, at which the curve begins on its tangent.
    most : int
        Most points to a side.
    **running
        ``store``, ``fmu`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over ``side`` (``"+"``: the gap at phase 0 grows from the saddle on) and ``point``:
        ``state`` in SI, ``xi``, ``x_rel`` and ``v_rel``, ``arclength`` in units of xi, and
        ``iterate``. A row of NaN is a break, and fills up the shorter side. ``end`` of each side;
        ``multiplier``, ``orbit_size`` and ``saddle``; over ``break``: where the curve is broken, by
        what distance, how that was decided, and what happens more often behind it.

    Raises
    ------
    InputError
        Where arguments contradict each other, there is no such orbit, or not just one of its
        multipliers lies outside the unit circle.

    Notes
    -----
    States at phase 0 are four numbers. With one multiplier outside the unit circle the unstable
    manifold is a curve, and the stable one has three dimensions: no curve shows it. Its trace in a
    plane of starts is the boundary of basins, which :func:`orchestrate.basin` draws.

    Each point is the image of a start of its own on the tangent, ``distance`` away, so it misses
    the manifold by the square of that distance, and less with each image. See
    :mod:`orchestrate.dynamics.curve_growth`. The map is not continuous where an impact passes phase
    0 (the gap is closed there, and its rate jumps), nor where chattering ends in contact with one
    impact more or less (17). There the curve is broken. It is decided by bisection, as
    far as rounding allows: the distance of two points falls with a power of that of their starts,
    1/2 at a grazing impact and 0 at a jump, which is ``break_power``.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.dynamics.manifolds import manifold
    >>> curve = manifold(Structure.nondimensional(), eta=3.0, length=0.5)
    >>> float(curve.multiplier.round(4)), curve.sizes["side"]
    (-3.3595, 2)
    """
    require_delaminated(structure, "manifold")
    arguments = excitation_arguments(eta, frequency, amplitude)
    if start is not None:
        require_orbit_dataset(start, allow_several=False)
    pushes = pushes_at_start(start, box_acceleration=box_acceleration, force1=force1, force2=force2)
    if start is None:
        start = compute_start_orbit(structure, {**dict(arguments), **pushes}, period, running)
    complete = complete_excitation(start, ("e",), arguments, (0.0, 0.0), structure, pushes)
    excitation = tuple(pair for pair in complete if pair[0] not in pushes)
    fields = {**pushes, "excitation": excitation, "period": start.sizes["sample"]}
    return as_given(start=guess_from_result(start), **fields)
