"""What the structure may be: sound in several ways, or delaminated; each with its parameters."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from ..constants import TURN
from ..fmu import Player
from ..laboratory.pieces import Floats
from ..model import Structure
from .evidence import Evidence
from .opening_force import unit_opening_force
from .single_mass import SingleMass
from .undamaged import SoundStructure

REPORTED = {  # units and long names
    "f1": ("Hz", "natural frequency of half 1 alone"),
    "f2": ("Hz", "natural frequency of half 2 alone"),
    "zeta1": ("1", "effective damping ratio of half 1 alone"),
    "zeta2": ("1", "effective damping ratio of half 2 alone"),
    "e": ("1", "effective coefficient of restitution"),
    "clearance": ("m", "gap between the faces at rest; below 0: pressed together"),
    "f": ("Hz", "natural frequency of the sound structure"),
    "zeta": ("1", "damping ratio of the sound structure"),
    "square": ("1/m", "stiffness that goes with the square of the displacement"),
    "cube": ("1/m2", "stiffness that goes with the cube of the displacement"),
    "friction": ("m/s2", "dry friction over the mass"),
    "stop": ("1", "stiffness of a stop over that of the spring"),
    "position": ("m", "displacement in the stop's direction from which it pushes"),
    "apart": ("1", "logarithm of the second mode's frequency over the first one's"),
}
FREE = tuple(REPORTED)[:6]  # of a delaminated structure
Values = Mapping[str, float]
DAMPING_RANGE = (3e-4, 0.2)  # damping ratios that are looked for
STARTING_SPLITS = (0.08, -0.08, 0.18, -0.18, 0.3, -0.3, 0.45, -0.45)  # ln(f2/f1) of the scan


class Hypothesis(ABC):
    """A kind of structure, with the numbers that are fitted to a record."""

    name: ClassVar[str]  # in messages and results
    is_rugged: ClassVar[bool] = False  # whether single impacts make the misfit uneven

    @abstractmethod
    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        """Return the values at which the search starts."""

    @abstractmethod
    def bounds(self, evidence: Evidence) -> dict[str, tuple[float, float]]:
        """Return the smallest and largest value of each number that is fitted."""

    @abstractmethod
    def displacements(self, values: Values, evidence: Evidence, player: Player | None) -> Floats:
        """Compute the motion of one or two masses relative to the measured base, m."""

    @abstractmethod
    def reported_parameters(self, values: Values, evidence: Evidence) -> dict[str, float]:
        """Return the fitted numbers as physical parameters in SI, by the names of ``REPORTED``."""


# -- sound ----------------------------------------------------------------------------------------


class Bonded(Hypothesis):
    """A bonded structure: one mass, on a linear spring unless a derived class says otherwise.

    Numbers are ``f`` in Hz, ``log_zeta``, and those of ``extra``: of size 1 where what they stand
    for is as large as the linear spring's force at the largest displacement.
    """

    name = "bonded"
    extra: ClassVar[dict[str, tuple[float, float]]] = {}

    def bounds(self, evidence: Evidence) -> dict[str, tuple[float, float]]:
        f = evidence.resonance
        low, high = (math.log(zeta) for zeta in DAMPING_RANGE)
        return {"f": (0.5 * f, 2.0 * f), "log_zeta": (low, high), **self.extra}

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        f, rest = evidence.resonance, dict.fromkeys(self.extra, 0.0)
        return [
            {"f": shift * f, "log_zeta": math.log(zeta), **rest}
            for shift in (1.0, 0.97, 0.985, 1.015, 1.03)  # a sweep is late at the peak
            for zeta in (0.01, 0.003, 0.03)
        ]

    def single_mass(self, values: Values, evidence: Evidence) -> SingleMass:
        return SingleMass(f=values["f"], zeta=math.exp(values["log_zeta"]))

    def displacements(self, values: Values, evidence: Evidence, player: Player | None) -> Floats:
        cubics, bound = evidence.pieces.derivatives, 30.0 * evidence.largest_displacement
        mass = self.single_mass(values, evidence)
        return mass.displacements(cubics, 1.0 / evidence.sample_rate, bound)[np.newaxis]

    def reported_parameters(self, values: Values, evidence: Evidence) -> dict[str, float]:
        known = {**values, **vars(self.single_mass(values, evidence))}
        return {name: known[name] for name in ("f", "zeta", *self.extra)}


class NonlinearSpring(Bonded):
    """A bonded structure on a spring that hardens or softens, symmetrically or not."""

    name = "bonded, hardening or softening"
    extra = {"square": (-1.0, 1.0), "cube": (-0.9, 20.0)}

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        """Return starts with several cubic stiffnesses that keep the measured resonance."""
        found = []
        for cube in (-0.3, -0.1, 0.0, 0.1, 0.3, 0.7, 1.5):
            for share in (1.0, 0.5):
                f = evidence.resonance / math.sqrt(1.0 + 0.75 * cube * share)
                start = {"f": f, "square": 0.0, "cube": cube}
                found += [{**start, "log_zeta": math.log(zeta)} for zeta in (0.03, 0.01, 0.004)]
        return found

    def single_mass(self, values: Values, evidence: Evidence) -> SingleMass:
        x = evidence.largest_displacement
        linear = super().single_mass(values, evidence)
        return replace(linear, square=values["square"] / x, cube=values["cube"] / x**2)


class DryFriction(Bonded):
    """A bonded structure on a linear spring with dry friction."""

    name = "bonded, with dry friction"
    extra = {"friction": (0.0, 5.0)}  # above 1 it locks

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        """Return starts with little and much friction, and one that nearly locks the mass."""
        linear = super().starts(evidence)
        some = [{**one, "friction": size} for one in linear for size in (0.02, 0.2)]
        return [*some, {**linear[0], "friction": 1.5}]

    def single_mass(self, values: Values, evidence: Evidence) -> SingleMass:
        """Build the single mass; its friction is relative to the base's median acceleration."""
        friction = values["friction"] * float(np.median(evidence.level))
        slow = evidence.settings.slow * TURN * evidence.resonance * evidence.largest_displacement
        return replace(super().single_mass(values, evidence), friction=friction, slow=slow)


class PositiveStop(Bonded):
    """A bonded structure with a stop in the positive direction of the sensor."""

    name = "bonded, with a stop in the positive direction"
    extra = {"stop": (-0.8, 5.0), "position": (-1.0, 1.0)}
    side: ClassVar[float] = 1.0

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        """Return starts with weak and stiff stops that the mass reaches early or late."""
        found = []
        for stop in (-0.3, 0.1, 0.5):
            for position in (0.0, 0.3):
                f = evidence.resonance / math.sqrt(1.0 + 0.5 * stop * (1.0 - position))
                rest = {"stop": stop, "position": position}
                found.append({"f": f, "log_zeta": math.log(0.01), **rest})
        return found

    def single_mass(self, values: Values, evidence: Evidence) -> SingleMass:
        linear = super().single_mass(values, evidence)
        position = values["position"] * evidence.largest_displacement
        return replace(linear, stop=values["stop"], position=position, side=self.side)


class NegativeStop(PositiveStop):
    """A bonded structure with a stop in the negative direction of the sensor."""

    name = "bonded, with a stop in the negative direction"
    side = -1.0


class TwoModes(Bonded):
    """A linear structure with a second mode in the sweep, such as torsion."""

    name = "bonded, with two modes"
    extra = {"apart": (-0.35, 0.35)}

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        every = super().starts(evidence)
        return [{**one, "apart": apart} for one in every for apart in (-0.12, -0.05, 0.05, 0.12)]

    def displacements(self, values: Values, evidence: Evidence, player: Player | None) -> Floats:
        second = {**values, "f": values["f"] * math.exp(values["apart"])}
        first = super().displacements(values, evidence, player)[0]
        other = super().displacements(second, evidence, player)[0]
        found = np.tile(first, (2, 1))
        for row, mass in enumerate(evidence.sensor_masses):
            found[mass] += self.mode_ratio(evidence, row, np.stack([first, other])) * other
        return found

    def mode_ratio(self, evidence: Evidence, row: int, motions: Floats) -> float:
        """Fit the second mode's amplitude over the first one's, at a sensor, to order 1."""
        base = evidence.base_orders[0]
        modes = np.stack([evidence.ideal_orders(one[np.newaxis])[row, 0] for one in motions])
        measured = evidence.order_1_to_match(row, modes[0]) - base
        columns = ((modes - base) / evidence.standard_deviation[row, 0]).T
        wanted = measured / evidence.standard_deviation[row, 0]
        both = np.concatenate([columns.real, columns.imag])
        parts = np.linalg.lstsq(both, np.concatenate([wanted.real, wanted.imag]), rcond=None)[0]
        return float(np.clip(parts[1] / parts[0], -1.0, 1.0)) if parts[0] else 0.0


# -- delaminated ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Onset:
    """Hold where a record's order 2 begins, and the bonded structure of what is silent."""

    frequency: float  # Hz
    level: float  # of the base, m/s2
    common: float  # natural frequency, Hz
    log_zeta: float


@dataclass(frozen=True)
class Delaminated(Hypothesis):
    """Two masses that touch: the model of the paper, computed by its FMU.

    Numbers are ``common``, the frequency of both glued together in Hz; ``split``, ln(f2/f1);
    ``log_zeta1``, ``log_zeta2``; ``e``; and ``clearance`` over the largest displacement.
    """

    guess: Structure  # of which the masses are taken, and all that is not free
    free: tuple[str, ...] = ("f1", "f2", "zeta1", "zeta2", "e")  # names of a structure's parameters
    name: ClassVar[str] = "delaminated"
    is_rugged: ClassVar[bool] = True

    def values_from_structure(self, structure: Structure, evidence: Evidence) -> dict[str, float]:
        """Convert a structure to the numbers that are fitted."""
        zeta = [max(getattr(structure, f"zeta{half}"), DAMPING_RANGE[0]) for half in (1, 2)]
        return {
            "common": SoundStructure.from_structure(structure).f,
            "split": math.log(structure.f2 / structure.f1),
            "log_zeta1": math.log(zeta[0]),
            "log_zeta2": math.log(zeta[1]),
            "e": structure.e,
            "clearance": getattr(structure, "clearance", 0.0) / evidence.largest_displacement,
        }

    def structure_from_values(self, values: Values, evidence: Evidence) -> Structure:
        """Convert fitted numbers to a structure; what is not free is taken from the guess."""
        m1, m2 = self.guess.m1, self.guess.m2
        values = {**self.values_from_structure(self.guess, evidence), **values}
        split = math.exp(values["split"])
        f1 = values["common"] * math.sqrt((m1 + m2) / (m1 + m2 * split**2))
        numbers = {
            "f1": f1,
            "f2": f1 * split,
            "zeta1": math.exp(values["log_zeta1"]),
            "zeta2": math.exp(values["log_zeta2"]),
            "e": min(max(values["e"], 0.0), 1.0),  # differences reach beyond the bounds
            "clearance": values["clearance"] * evidence.largest_displacement,
        }
        return self.guess.replace(bonded=False, **{name: numbers[name] for name in self.free})

    def bounds(self, evidence: Evidence) -> dict[str, tuple[float, float]]:
        f, (low, high) = evidence.resonance, [math.log(zeta) for zeta in DAMPING_RANGE]
        every = {
            "common": ((0.6 * f, 1.6 * f), {"f1", "f2"}),
            "split": ((-0.9, 0.9), {"f1", "f2"}),
            "log_zeta1": ((low, high), {"zeta1"}),
            "log_zeta2": ((low, high), {"zeta2"}),
            "e": ((0.0, 0.95), {"e"}),
            "clearance": ((-2.0, 2.0), {"clearance"}),
        }
        return {name: ends for name, (ends, of) in every.items() if of & set(self.free)}

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        guess = self.values_from_structure(self.guess, evidence)
        return [
            {**guess, "common": shift * common_frequency(split, evidence), "split": split, "e": e}
            for split in STARTING_SPLITS
            for shift in (0.96, 1.0, 1.04)
            for e in (0.35, 0.7)
        ]

    def reported_parameters(self, values: Values, evidence: Evidence) -> dict[str, float]:
        structure = self.structure_from_values(values, evidence)
        return {name: float(structure.get(name)) for name in self.free}

    def displacements(self, values: Values, evidence: Evidence, player: Player | None) -> Floats:
        assert player is not None
        player.start(self.structure_from_values(values, evidence))
        nodes, cubics = evidence.pieces.nodes, evidence.pieces.derivatives
        if friction := values.get("friction", 0.0) * float(np.median(evidence.level)):
            # on both masses alike, as inertia acts
            cubics = cubics + friction * evidence.velocity_sign_cubics
        return player.play(nodes, cubics, nodes, ("x1", "x2")).rows.T


@dataclass(frozen=True)
class DelaminatedWithClearance(Delaminated):
    """Two masses with a gap between the faces at rest, or pressed together by a preload.

    Pressed faces slide when the beam bends: ``friction`` brakes both masses, over the base's median
    acceleration, against the velocity that was measured.
    """

    name: ClassVar[str] = "delaminated, with clearance"
    onset: Onset | None = None  # where the faces begin to open

    def bounds(self, evidence: Evidence) -> dict[str, tuple[float, float]]:
        """Return the bounds of the numbers that are free; a resonance curve has no velocity."""
        friction = {"friction": (0.0, 2.0)} if evidence.has_floor else {}
        return {**super().bounds(evidence), **friction}

    def values_from_structure(self, structure: Structure, evidence: Evidence) -> dict[str, float]:
        return {**super().values_from_structure(structure, evidence), "friction": 0.0}

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        """Return starts with pressed faces, gaps, and halves that move alone up to one."""
        guess = self.values_from_structure(self.guess, evidence)
        moved = [{"common": common_frequency(s, evidence), "split": s} for s in STARTING_SPLITS]
        moved += self.starts_with_halves_alone(evidence)
        gaps = (0.05, 0.1, 0.2, 0.4, 0.7, 1.0, 1.4)
        found = [{**guess, **one, "clearance": gap} for gap in gaps for one in moved]
        if self.onset:
            for split in STARTING_SPLITS:
                found += self.starts_with_pressed_faces(evidence, {**guess, "split": split})
        return found

    def starts_with_halves_alone(self, evidence: Evidence) -> list[dict[str, float]]:
        """Return parts of starts at which a sensor's resonance is that of the half it is on."""
        m1, m2, peaks, found = self.guess.m1, self.guess.m2, evidence.peak_frequencies, []
        both = len(peaks) == 2
        for split in [math.log(peaks[1] / peaks[0])] if both else STARTING_SPLITS:
            f1 = peaks[0] if evidence.sensor_masses[0] == 0 else peaks[0] * math.exp(-split)
            common = f1 * math.sqrt((m1 + m2 * math.exp(2.0 * split)) / (m1 + m2))
            found += [{"common": part * common, "split": split} for part in (1.0, 0.94)]
        return found

    def starts_with_pressed_faces(
        self, evidence: Evidence, guess: Values
    ) -> list[dict[str, float]]:
        """Return starts whose preload, in closed form, opens where order 2 begins."""
        assert self.onset is not None
        zeta = self.onset.log_zeta
        alike = {"common": self.onset.common, "log_zeta1": zeta, "log_zeta2": zeta}
        shut = self.structure_from_values({**guess, **alike}, evidence)
        force = self.onset.level * float(unit_opening_force(shut, self.onset.frequency))
        closed = -force * (1.0 / shut.k1 + 1.0 / shut.k2) / evidence.largest_displacement
        return [
            {**guess, **alike, "clearance": part * closed, "friction": friction}
            for part in (1.0, 0.8, 0.6)
            for friction in (0.0, 0.1, 0.3)
        ]


def common_frequency(split: float, evidence: Evidence) -> float:
    """Return the frequency of both halves glued together, Hz, from the resonance; ln(f2/f1)."""
    return evidence.resonance * math.sqrt(1.0 + 0.25 * split**2)


SOUND = (*(Bonded(), NonlinearSpring(), DryFriction(), PositiveStop(), NegativeStop(), TwoModes()),)
