"""Excitation level at which faces first open or touch, exact: ``orchestrate.contact_threshold``.

Below it the response is linear, (10) and (11) with i = 3 where a preload holds the masses together,
with i = 1 and 2 where a gap keeps them apart. There the contact force (18), or the gap (13), is a
constant and a harmonic in the amplitude of the shaking: the level at which both are equal is the
threshold.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..fmu import traits_for_loops
from ..lazy import xr
from ..model import Structure
from ..running.job import format_brief
from .labels import Variable, make_dataset, parameter_variable, variable
from .questions import checked_excitation_numbers, require_delaminated

Floats = NDArray[np.float64]
THRESHOLD = -2  # its place among the traits
GRID = 400  # frequencies between which minima of the threshold are bracketed
ACCURACY = 1e-12  # of a frequency at a minimum; the level there is flat, and exact far earlier


def threshold_amplitudes(structure: Structure, frequency: Floats) -> Floats:
    """Return box amplitudes, m, of the first touch or opening; infinite if halves move alike."""
    levels = [traits_for_loops(structure, each)[THRESHOLD] for each in np.ravel(frequency).tolist()]
    return np.reshape(levels, np.shape(frequency))


def threshold_variables(structure: Structure, along: str, frequency: Floats) -> dict[str, Variable]:
    """Return the threshold over frequencies, rad/s, and its minimum between the outer ones."""
    frequency = np.asarray(frequency, dtype=float)
    amplitudes = threshold_amplitudes(structure, frequency)
    event = threshold_event(structure)
    where, peak = f"at which the structure first {event}", "peak acceleration"
    accelerations = amplitudes * frequency**2
    columns: dict[str, tuple[Any, ...]] = {
        "threshold_amplitude": (along, amplitudes, "m", f"amplitude of the box {where}"),
        "threshold_acceleration": (along, accelerations, "m/s2", f"{peak} of the box {where}"),
    }
    low, high = float(frequency.min()), float(frequency.max())
    if low < high and np.isfinite(amplitudes).all() and (amplitudes > 0.0).all():
        at, level = lowest_threshold(structure, low, high)
        text = f"frequency of the lowest {peak} {where}"
        columns["lowest_threshold"] = (), level, "m/s2", f"lowest {peak} {where}"
        columns["lowest_threshold_frequency"] = (), at, "rad/s", text
    return {name: variable(*column, event=event) for name, column in columns.items()}


def lowest_threshold(structure: Structure, low: float, high: float) -> tuple[float, float]:
    """Minimise the threshold between two frequencies; return rad/s and box level, m/s2."""
    from scipy.optimize import minimize_scalar

    def level(frequency: float) -> float:
        speed = np.array([frequency])
        return float(threshold_amplitudes(structure, speed)[0]) * (frequency * frequency)

    springs, masses = structure.k1 + structure.k2, structure.m1 + structure.m2
    squares = structure.k1 / structure.m1, structure.k2 / structure.m2, springs / masses
    valleys = [omega for omega in map(math.sqrt, squares) if low < omega < high]
    grid = np.unique([*np.linspace(low, high, GRID), *valleys])
    values = np.array([level(frequency) for frequency in grid])
    best = (float(values.min()), float(grid[values.argmin()]))
    inside = np.flatnonzero((values[1:-1] <= values[:-2]) & (values[1:-1] <= values[2:])) + 1
    for middle, before, after in zip(grid[inside], grid[inside - 1], grid[inside + 1], strict=True):
        minimum = minimize_scalar(  # by the distance, whose rounding is that of a narrow valley
            lambda distance, middle=middle: level(middle + distance),
            bounds=(before - middle, after - middle),
            method="bounded",
            options={"xatol": ACCURACY * middle},
        )
        best = min(best, (float(minimum.fun), float(middle + minimum.x)))
    return best[1], best[0]


def threshold_event(structure: Structure) -> str:
    """Return "opens" for a pressed structure, "touches" for one with a gap."""
    return "opens" if structure.gap_offset < 0.0 else "touches"


def contact_threshold(
    structure: Structure, *, eta: ArrayLike | None = None, frequency: ArrayLike | None = None
) -> xr.Dataset:
    """Compute the excitation level at which a structure's faces first open or touch.

    Parameters
    ----------
    structure : Structure
        With a clearance: below zero it is pressed together, above zero open.
    eta : array_like, optional
        Frequency ratios Omega/omega.
    frequency : array_like, optional
        Frequencies of the box instead, rad/s.

    Returns
    -------
    xarray.Dataset
        Over the frequency, which is there in ``hertz`` too: ``threshold_amplitude`` of the box in m
        and ``threshold_acceleration``, its peak acceleration in m/s2. The attribute ``event`` says
        what happens there: "opens" or "touches". ``lowest_threshold`` and
        ``lowest_threshold_frequency`` are the true minimum of the acceleration between the lowest
        and the highest frequency, whatever lies between. The threshold is 0 where there is no
        clearance, and infinite where the halves move alike, so that no level parts or joins them.

    Raises
    ------
    InputError
        Where not just one of both frequencies is given, or the structure is bonded.

    Notes
    -----
    Below the threshold the response is the linear one: of both halves as one with a preload, of
    each half alone with a gap. With a preload F its contact force is F less the harmonic part of
    -f (18); with a gap its smallest is the clearance less the amplitude of x2 - x1. Both parts are
    known in closed form from (11), and the harmonic one grows with the amplitude.

    It is the threshold of the linear response, which is stable up to there. Other motions, in which
    the halves impact, may exist at lower levels already, and a strong enough push leads to them:
    see :func:`orchestrate.attractors`.

    Examples
    --------
    >>> import numpy as np
    >>> from orchestrate.model import Structure
    >>> from orchestrate.response.threshold import contact_threshold
    >>> beam = Structure.from_halves(m1=1.0, m2=0.8, f1=42.0, f2=55.0, zeta1=0.007, zeta2=0.007)
    >>> pressed = beam.replace(clearance=-20e-6)
    >>> level = contact_threshold(pressed, frequency=2.0 * np.pi * np.array([30.0, 48.0]))
    >>> level.event, (level.threshold_acceleration / 9.80665).values.round(3)
    ('opens', array([0.209, 0.006]))
    """
    require_delaminated(structure, "contact_threshold")
    both = {"eta": eta, "frequency": frequency}
    checked = {name: checked_excitation_numbers(name, values) for name, values in both.items()}
    arguments = {name: values for name, values in checked.items() if values is not None}
    if len(arguments) != 1:
        stated = " and ".join(arguments) or "nothing"
        raise InputError(f"{stated} given; expected eta= or frequency=")
    ((name, values),) = arguments.items()
    column = np.atleast_1d(np.asarray(values, dtype=float))
    speeds = column * structure.omega if name == "eta" else column
    other = {"eta": speeds / structure.omega, "frequency": speeds, name: column}
    event = threshold_event(structure)
    return make_dataset(
        threshold_variables(structure, name, speeds),
        {
            **{key: parameter_variable(key, name, each) for key, each in other.items()},
            "hertz": variable(name, speeds / (2.0 * np.pi), "Hz", "frequency of the box"),
        },
        f"Level at which the structure {event}: {structure.label()}",
        event=event,
        question="contact_threshold",
        call=f"contact_threshold({structure!r}, {name}={format_brief(values)})",
        **{key: float(value) for key, value in structure.parameters().items()},
    )
