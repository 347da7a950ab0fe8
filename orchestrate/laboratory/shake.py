"""Shake a structure as in the laboratory: time histories and impacts under any excitation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..fmu import OSCILLATOR, PLAYED, Player
from ..lazy import Unpack, xr
from ..model import Excitation, Shaker, Structure
from ..model.arguments import Number, checked_positive, checked_unmasked
from ..model.ranges import PUSHES
from ..response.equations import absolute_accelerations_by_forces
from ..response.labels import make_dataset, variable, yes_or_no
from ..response.questions import Question, checked_state, checked_structure
from ..response.signatures import as_given, question
from ..response.simulate import IN_TIME, impact_columns, impact_variables
from ..running.job import FAMILY, Table, refuse_unsupported
from ..running.options import Running
from .level_control import LevelControl, shake_on_shaker
from .pieces import Pieces
from .record import CHANNELS, FORCES, unit_of_channel
from .signals import ExcitationSignal, is_stated

BOX = "box_acceleration"
MOST_SAMPLES = 100_000_000
DECAYED = 1e-3  # what is left of the free vibration from the start where it counts as over


@lru_cache(maxsize=4)
def cached_pieces(excitation: ExcitationSignal, accuracy: float) -> Pieces:
    return excitation.pieces(accuracy)


def checked_accuracy(name: str, value: Any) -> float:
    """Return an accuracy of the pieces, relative to the peak; raise unless 1e-10 to 1e-2."""
    accuracy = checked_positive(name, value)
    if not 1e-10 <= accuracy <= 1e-2:
        raise InputError(f"{name} = {accuracy!r}: expected 1e-10 <= {name} <= 0.01")
    return accuracy


class ShakeJob(Question):
    """Job that computes a motion under any excitation, each part from the end of the one before."""

    chunk_size: ClassVar[int] = 20_000
    sequential: ClassVar[bool] = True
    item_columns: ClassVar[tuple[str, ...]] = ()  # samples, impacts, and a state
    item: ClassVar[str] = "piece"
    family: ClassVar[tuple[str, ...]] = FAMILY

    @property
    def pieces(self) -> Pieces:
        return cached_pieces(self.excitation, self.accuracy)

    def parameters(self) -> dict[str, Any]:
        parameters, kind = super().parameters(), type(self.excitation).__name__
        return parameters | {"excitation": {"kind": kind, **parameters["excitation"]}}

    def items(self) -> Sequence[int]:
        return range(len(self.pieces.derivatives))

    def sample_times(self, first: float = 0.0, end: float = math.inf) -> NDArray[np.float64]:
        """Return the sampling times from ``first`` up to, not including, ``end``, s."""
        rate, duration = self.sample_rate, self.pieces.duration
        last = math.floor(duration * rate * (1.0 + 1e-14))
        stop = last if end == math.inf else min(last, math.ceil(end * rate) + 1)
        samples = np.arange(max(0, math.floor(first * rate) - 1), stop + 1)
        times: NDArray[np.float64] = np.minimum(samples / rate, duration)  # but for rounding
        return times[(times >= first) & (times < end)]

    def work(self, fmus: Mapping[str, Path], items: Sequence[int], previous: Table | None) -> Table:
        pieces, first, last = self.pieces, items[0], items[-1] + 1
        cubics, drives = pieces.derivatives[first:last], self.excitation.drives
        if drives == BOX:
            cubics = cubics + [self.box_acceleration, 0.0, 0.0, 0.0]
        nodes = pieces.nodes[first : last + 1]
        samples = self.sample_times(nodes[0], math.inf if last == self.count() else nodes[-1])
        with Player(fmus[OSCILLATOR]) as player:
            player.start(self.structure, self.start, self.additional_excitation)
            if previous is not None:
                player.restore_state(previous["fmu_state"][-1].tobytes())
            played = player.play(nodes, cubics, samples, driven=(drives,))
            kept = np.frombuffer(player.save_state(), dtype=np.uint8)[np.newaxis]
        driven = self.excitation_channels(samples)
        forces = np.stack([driven[name] for name in FORCES], axis=1) if self.has_forces else None
        motion = played.rows[:, :4], self.structure, played.touching
        one, two = absolute_accelerations_by_forces(forces, *motion, driven[BOX]).T
        return {
            **dict(zip(PLAYED, played.rows.T, strict=True)),
            **{"in_contact": played.touching, "a1_abs": one, "a2_abs": two},
            **driven,
            **impact_columns(played.impacts, self.structure),
            "fmu_state": kept,
        }

    @property
    def additional_excitation(self) -> Excitation:
        pushes = {name: getattr(self, name) for name in PUSHES}
        frequency = self.frequency or self.structure.omega
        return Excitation(frequency=frequency, amplitude=0.0, **pushes)

    @property
    def has_forces(self) -> bool:
        return self.excitation.drives in FORCES or any(getattr(self, name) for name in FORCES)

    def excitation_channels(self, times: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Return the box's acceleration and both forces, excitation and what acts beside it."""
        channels = {BOX: np.full(len(times), self.box_acceleration)}
        harmonic = np.sin(self.frequency * times)
        channels |= {name: getattr(self, name) * harmonic for name in FORCES}
        channels[self.excitation.drives] = channels[self.excitation.drives] + self.pieces(times)
        return channels

    def dataset(self, table: Table) -> xr.Dataset:
        drives = self.excitation.drives
        acting = [name for name in CHANNELS if name in (BOX, drives) or getattr(self, name, False)]
        columns = [*PLAYED, "a1_abs", "a2_abs"]
        contact = "whether the masses are in permanent contact"
        unit, word = unit_of_channel(drives), CHANNELS[drives]
        error = f"largest distance of the {word} to the signal, by a bound"
        transient = f"time after which the start's free vibration is below {DECAYED:g} of it"
        return make_dataset(
            {
                **{name: variable("time", table[name], *IN_TIME[name]) for name in columns},
                **{n: variable("time", table[n], unit_of_channel(n), CHANNELS[n]) for n in acting},
                "in_contact": yes_or_no("time", table["in_contact"], contact),
                **impact_variables(table),
                "excitation_error": variable((), self.pieces.error, unit, error),
                "transient_time": variable((), transient_time(self.structure), "s", transient),
            },
            {"time": variable("time", self.sample_times(), "s", "time from the start")},
            f"Shaken by {self.excitation.description}: {self.structure.label()}",
            excitation=self.excitation.label,
            excitation_description=self.excitation.description,
        )


def transient_time(structure: Structure) -> float:
    """Return how long the slowest free vibration takes to decay to a thousandth, s."""
    both = (structure.m1 + structure.m2, structure.k1 + structure.k2, structure.d1 + structure.d2)
    alone = ((structure.m1, structure.k1, structure.d1), (structure.m2, structure.k2, structure.d2))
    free = alone[:1] if structure.wall else (*alone, both)
    oscillators = (both,) if structure.bonded else free
    slowest = min(float(-np.roots((m, d, k)).real.max()) for m, k, d in oscillators)
    return -math.log(DECAYED) / slowest if slowest > 0.0 else math.inf


@question(ShakeJob)
def shake(
    structure: Structure,
    excitation: ExcitationSignal | LevelControl,
    *,
    sample_rate: float | None = None,
    box_acceleration: Number = 0.0,
    force1: Number = 0.0,
    force2: Number = 0.0,
    frequency: Number = 0.0,
    shaker: Shaker | None = None,
    start: ArrayLike | None = None,
    accuracy: Annotated[float, checked_accuracy] = 1e-6,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Shake a structure and record its motion.

    Parameters
    ----------
    structure : Structure
        Delaminated or bonded; against a wall or in a play.
    excitation : SweptSine, SteppedSine, Random, Shock, Sampled or Hammer
        The box's acceleration, or knocks on a half with the box at rest; ``one + other`` is both
        together.
    sample_rate : float, optional
        Of the record, Hz; by default what the excitation needs. The motion does not depend on it.
    box_acceleration : float
        Constant acceleration of the box beside the excitation, m/s2: gravity.
    force1 : float
        Amplitude of a harmonic force F sin(frequency t) on mass 1 besides, N.
    force2 : float
        The same on mass 2.
    frequency : float
        Of these forces, rad/s.
    shaker : Shaker, optional
        What moves the box. Its table has the level of a swept or stepped sine by a
        :class:`orchestrate.LevelControl`, which may be given as ``excitation``, and the shaker's
        faults: harmonics from impacts, drops, limits.
    start : array_like of 4 floats, optional
        x1, x2 in m, v1, v2 in m/s at time 0, relative to the box; at rest by default.
    accuracy : float
        Largest error of the cubic pieces that the FMU is given, relative to the peak: 1e-10 to
        1e-2. The bound reached is in the result.
    **running
        ``store``, ``progress`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over ``time`` in s: ``box_acceleration``, and of a hammer or a harmonic force ``force1`` or
        ``force2`` in N; ``a1_abs``, ``a2_abs``, accelerations of the masses in space between
        impacts; ``x1``, ``x2``, ``v1``, ``v2``, ``x_rel``, ``v_rel``
        relative to the box; ``contact_force`` in N and ``in_contact``. Over ``impact``:
        ``impact_time``, ``impact_velocity``, ``impulse`` in N s and ``sticks``. Scalars:
        ``excitation_error`` in m/s2 or N and ``transient_time`` in s, after which the start is
        forgotten where the motion is linear. On a shaker ``current`` in A, ``voltage``, ``power``
        in W and ``control_aborted`` in s, in place of both scalars.

    Raises
    ------
    InputError
        Where a number is out of its range.

    Notes
    -----
    The FMU takes the acceleration as cubics (Chebyshev interpolation) and is exact
    for these: states and impacts are those of the pieces whatever the sampling rate, to the last
    bit.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam")
    >>> sweep = orchestrate.SweptSine(first=10.0, last=14.0, duration=4.0, acceleration=0.2)
    >>> history = orchestrate.shake(beam, sweep, sample_rate=500.0)
    >>> history.sizes["time"], history.sizes["impact"]
    (2001, 94)
    """
    pushes = {"box_acceleration": box_acceleration, "force1": force1, "force2": force2}
    if shaker is not None:
        refuse_unsupported("a shaker", pushes)
        return shake_on_shaker(structure, excitation, shaker, sample_rate, start, running)
    if not isinstance(excitation, ExcitationSignal):
        kinds = "expected a SweptSine, SteppedSine, Random, Shock, Sampled or Hammer, or a sum"
        raise InputError(f"excitation = {excitation!r}: {kinds}")
    rate = excitation.usual_rate if sample_rate is None else sample_rate
    rate = checked_positive("sample_rate", rate)
    if rate * excitation.duration > MOST_SAMPLES:
        text = f"expected at most {MOST_SAMPLES / excitation.duration:.3g} for that duration"
        raise InputError(f"sample_rate = {rate!r} Hz: {text}")
    start = checked_state("start", start, checked_structure(structure))
    frequency = checked_unmasked("frequency", frequency)
    own = frequency if is_stated(frequency) else structure.omega
    beside = Excitation(frequency=own, amplitude=0.0, **pushes)
    for force in FORCES:
        if (value := getattr(beside, force)) and not is_stated(frequency):
            text = "without its frequency; expected frequency= too"
            raise InputError(f"{force} = {value!r}: {text}")
    if beside.force2 or excitation.drives == "force2":
        structure.require_mass_2("force2")
    beside.check(structure)
    name = f"shake_{type(excitation).__name__}_{structure.label()}"
    return as_given(name=name, sample_rate=rate, start=start)
