"""Amplitude spectra of the masses' absolute accelerations: ``orchestrate.spectra``.

An impulse is no part of sampled accelerations, whatever the rate. It is in the displacement, which
is continuous and has a kink there: the spectrum of the acceleration as a distribution is the square
of the frequency times that of the displacement.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from ctypes import c_double, c_size_t, c_void_p
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..constants import TURN
from ..errors import InputError
from ..fmu import OSCILLATOR, REST, Instance, sample_evenly, start_motion
from ..fmu.c_library import load_loop
from ..lazy import Unpack, xr
from ..model import Excitation, Structure
from ..model.arguments import Count, Positive, Transient, whole
from ..running.job import FAMILY, Table
from ..running.options import Running
from .equations import absolute_accelerations_at
from .labels import make_dataset, variable
from .questions import Point, SeriesQuestion, Values, require_bonded_twin
from .signatures import as_given, question

KINDS = ("bonded", "delaminated", "sampled")
Floats = NDArray[np.float64]


@functools.cache
def spectrum_library() -> Any:
    loaded = load_loop("spectrum")
    loaded.spectrum_size.restype, loaded.spectrum_size.argtypes = c_size_t, [c_size_t]
    loaded.amplitude_spectrum.argtypes = [c_void_p, c_size_t, c_void_p, c_void_p]
    loaded.acceleration_spectrum.argtypes = [
        *(c_void_p, c_size_t, c_size_t, c_size_t),
        *(c_double, c_double, c_void_p, c_void_p),
    ]
    loaded.amplitude_spectrum.restype = loaded.acceleration_spectrum.restype = None
    return loaded


def amplitude_spectrum(signal: ArrayLike, interval: float) -> tuple[Floats, Floats]:
    """Return frequencies, rad/s, and amplitudes of a sampled signal (Hann window)."""
    rows = np.ascontiguousarray(signal, dtype=float)
    count = rows.shape[-1]
    memory, lines = np.empty(spectrum_library().spectrum_size(count)), np.arange(count // 2 + 1)
    amplitudes = np.empty((*rows.shape[:-1], len(lines)))
    for index in np.ndindex(rows.shape[:-1]):
        addresses = memory.ctypes.data, amplitudes[index].ctypes.data
        spectrum_library().amplitude_spectrum(rows[index].ctypes.data, count, *addresses)
    return 2.0 * np.pi * lines / (count * interval), amplitudes


def acceleration_spectrum(states: Floats, periods: int, excitation: Excitation) -> Floats:
    """Return both masses' spectra, impulses included, from states at equal parts of periods."""
    rows, count = np.ascontiguousarray(states, dtype=float), len(states)
    memory = np.empty(spectrum_library().spectrum_size(count))
    amplitudes = np.empty((2, count // 2 + 1))
    for column, row in enumerate(amplitudes):
        spectrum_library().acceleration_spectrum(
            *(rows[:, column:].ctypes.data, rows.shape[1], count, periods),
            *(excitation.frequency, excitation.amplitude, memory.ctypes.data, row.ctypes.data),
        )
    return amplitudes


class SpectraJob(SeriesQuestion):
    """Job of :func:`orchestrate.spectra`: spectra of responses, bonded and delaminated."""

    family: ClassVar[tuple[str, ...]] = FAMILY

    def __post_init__(self) -> None:
        super().__post_init__()
        require_bonded_twin(self.structure)
        if self.highest > self.points / 2:
            text = f"expected at most points/2 = {self.points / 2:g}"
            raise InputError(f"highest = {self.highest:g}: {text}")

    def orders(self) -> Floats:
        """Return the lines' frequencies as multiples of the excitation's, up to the highest."""
        orders = np.arange(self.periods * self.points // 2 + 1) / self.periods
        return orders[orders <= self.highest]

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[Point], previous: Table | None
    ) -> Table:
        amplitudes = []
        with Instance(fmus[OSCILLATOR]) as instance:
            for structure, excitation in items:
                bonded, delaminated = structure.as_bonded(), structure.as_delaminated()
                with_impulses, _ = self.simulate_spectra(instance, Point(bonded, excitation))
                both = self.simulate_spectra(instance, Point(delaminated, excitation))
                amplitudes.append([with_impulses, *both])
        return {"acceleration": np.array(amplitudes)}

    def simulate_spectra(self, instance: Instance, point: Point) -> tuple[Floats, Floats]:
        """Run a response from rest; return its spectra with impulses, and between impacts."""
        span, count = point.excitation.period, self.periods * self.points
        first, last = self.transient * span, (self.transient + self.periods) * span
        start_motion(instance, *point, REST)
        if self.transient:
            instance.step(0.0, first)
        states = sample_evenly(instance, first, last, count)
        phase = TURN * np.arange(1, count + 1) / self.points
        accelerations = absolute_accelerations_at(states, point, phase)
        shown, interval = len(self.orders()), span / self.points
        with_impulses = acceleration_spectrum(states, self.periods, point.excitation)
        _, between = amplitude_spectrum(accelerations.T, interval)
        return with_impulses[:, :shown], between[:, :shown]

    def dataset(self, table: Table) -> xr.Dataset:
        along, orders = self.series.name, self.orders()
        lines = np.outer(self.series.frequencies, orders)
        text = "amplitude of the absolute acceleration"
        kinds = "bonded and delaminated with impulses; delaminated as sampled between impulses"
        dims = along, "kind", "mass", "order"
        variables = {"acceleration": variable(dims, table["acceleration"], "m/s2", text)}
        coordinates = {
            **self.series.coordinates(),
            "kind": variable("kind", np.array(KINDS), "1", kinds),
            "mass": variable("mass", np.array([1, 2]), "1", "mass"),
            "order": variable("order", orders, "1", "multiple of the excitation frequency"),
            "line": variable((along, "order"), lines, "rad/s", "frequency of the line"),
        }
        title = f"Spectra, bonded and delaminated: {self.structure.label()}"
        return make_dataset(variables, coordinates, title)


@question(SpectraJob)
def spectra(
    structure: Structure,
    *,
    eta: Values = None,
    frequency: Values = None,
    amplitude: Values = None,
    box_acceleration: Values = 0.0,
    force1: Values = 0.0,
    force2: Values = 0.0,
    periods: Count = 64,
    points: Annotated[int, whole(2)] = 1024,
    transient: Transient = 2000,
    highest: Positive = 40.0,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Compute amplitude spectra of the masses' absolute accelerations, bonded and delaminated.

    Parameters
    ----------
    structure : Structure
        ``bonded`` is ignored: results are returned for both, bonded and delaminated.
    eta, frequency, amplitude, box_acceleration, force1, force2
        As in :func:`orchestrate.sweep`.
    periods : int
        Excitation periods in the record, which make the lines' distance.
    points : int
        Samples a period.
    transient : int
        Periods dropped before, from rest.
    highest : float
        Highest line, as a multiple of the excitation frequency.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        ``acceleration``, amplitudes in m/s2, over the excitation, ``kind``, ``mass`` (1, 2) and
        ``order``, multiples of the excitation frequency; ``line`` has the frequencies in rad/s.
        Kinds: ``bonded`` and ``delaminated`` with the impacts' impulses; ``sampled``: delaminated
        without them, as a sampled accelerometer shows it.

    Raises
    ------
    InputError
        Where a required argument is missing, arguments contradict each other, or a number is
        out of its range.

    Notes
    -----
    The paper's Figure 3. With impulses: the square of the frequency times the spectrum of the
    absolute displacement, through a Hann window; states sampled ``points`` times a period fold
    what lies above half that rate, which for a kink falls with the square of the frequency.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.response.spectra import spectra
    >>> found = spectra(Structure(), eta=1.047, transient=300, periods=8, points=256)
    >>> found.acceleration.sel(mass=1, order=20.0)[0].values.round(1)
    array([0. , 9.3, 0. ])
    """
    return as_given()
