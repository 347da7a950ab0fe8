"""What the structure may be: sound in several ways, or delaminated; each with its parameters."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..constants import TURN
from ..laboratory.pieces import Floats
from ..model import Structure
from .single_mass import SingleMass

if TYPE_CHECKING:
    from lmfit import Parameters

    from ..fmu import Player
    from .evidence import Evidence

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
}
FREE = tuple(REPORTED)[:6]  # of a delaminated structure
Values = Mapping[str, float]
DAMPING_RANGE = (3e-4, 0.2)  # damping ratios that are looked for
MAX_SPLIT = 0.9  # largest |ln(f2/f1)|
RESTITUTION_RANGE = (0.0, 0.95)
STARTING_SPLITS = (0.08, -0.08, 0.18, -0.18, 0.3, -0.3, 0.45, -0.45)  # ln(f2/f1) of the scan
SLOW_SHARE = 0.01  # of the largest speed: below it friction is viscous


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
    def reported(self, values: Values, evidence: Evidence) -> dict[str, float]:
        """Return the fitted numbers as physical parameters in SI, by the names of ``REPORTED``."""

    def parameters(self, start: Values, evidence: Evidence) -> Parameters:
        """Convert a start to lmfit's parameters, clipped to the bounds."""
        from lmfit import Parameters

        made = Parameters()
        for name, (low, high) in self.bounds(evidence).items():
            made.add(name, value=float(np.clip(start[name], low, high)), min=low, max=high)
        return made


# -- sound ----------------------------------------------------------------------------------------


class Sound(Hypothesis):
    """A bonded structure: one mass, whose spring may be of several kinds.

    Numbers are ``f`` in Hz, ``log_zeta``, and those of ``extra``: of size 1 where what they stand
    for is as large as the linear spring's force at the largest displacement.
    """

    extra: ClassVar[dict[str, tuple[float, float]]] = {}

    def bounds(self, evidence: Evidence) -> dict[str, tuple[float, float]]:
        """Return the bounds: half to twice the resonance, the damping, and those of ``extra``."""
        f = evidence.resonance
        low, high = (math.log(zeta) for zeta in DAMPING_RANGE)
        return {"f": (0.5 * f, 2.0 * f), "log_zeta": (low, high), **self.extra}

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        """Return starts around the resonance with several damping ratios."""
        f, rest = evidence.resonance, dict.fromkeys(self.extra, 0.0)
        return [
            {"f": shift * f, "log_zeta": math.log(zeta), **rest}
            for shift in (1.0, 0.97, 0.985, 1.015, 1.03)  # a sweep is late at the peak
            for zeta in (0.01, 0.003, 0.03)
        ]

    def single_mass(self, values: Values, evidence: Evidence) -> SingleMass:
        """Build the single mass that these values describe."""
        return SingleMass(f=values["f"], zeta=math.exp(values["log_zeta"]))

    def displacements(self, values: Values, evidence: Evidence, player: Player | None) -> Floats:
        """Compute the motion of the single mass; NaN from where it diverges."""
        cubics, bound = evidence.pieces.derivatives, 30.0 * evidence.displacement
        mass = self.single_mass(values, evidence)
        return mass.displacements(cubics, 1.0 / evidence.rate, bound)[np.newaxis]

    def reported(self, values: Values, evidence: Evidence) -> dict[str, float]:
        """Return the parameters of the single mass by name."""
        mass = self.single_mass(values, evidence)
        return {name: getattr(mass, name) for name in ("f", "zeta", *self.extra)}


class Bonded(Sound):
    """A bonded structure on a linear spring."""

    name = "bonded"


class NonlinearSpring(Sound):
    """A bonded structure on a spring that hardens or softens, symmetrically or not."""

    name = "bonded, hardening or softening"
    extra = {"square": (-1.0, 1.0), "cube": (-0.9, 20.0)}

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        """Return starts with several cubic stiffnesses that keep the measured resonance."""
        found = []
        for cube in (-0.3, -0.1, 0.0, 0.1, 0.3, 0.7, 1.5):
            f = evidence.resonance / math.sqrt(1.0 + 0.75 * cube)
            for share in (1.0, 0.5):
                f = evidence.resonance / math.sqrt(1.0 + 0.75 * cube * share)
                start = {"f": f, "square": 0.0, "cube": cube}
                found += [{**start, "log_zeta": math.log(zeta)} for zeta in (0.01, 0.004)]
        return found

    def single_mass(self, values: Values, evidence: Evidence) -> SingleMass:
        """Build the single mass with the square and cubic stiffness of these values."""
        x = evidence.displacement
        linear = super().single_mass(values, evidence)
        return replace(linear, square=values["square"] / x, cube=values["cube"] / x**2)


class DryFriction(Sound):
    """A bonded structure on a linear spring with dry friction."""

    name = "bonded, with dry friction"
    extra = {"friction": (0.0, 5.0)}  # above 1 it locks

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        """Return starts with little and much friction, and one that nearly locks the mass."""
        return [
            {**one, "friction": size} for one in super().starts(evidence) for size in (0.02, 0.2)
        ] + [{**super().starts(evidence)[0], "friction": 1.5}]

    def single_mass(self, values: Values, evidence: Evidence) -> SingleMass:
        """Build the single mass; its friction is relative to the base's median acceleration."""
        friction = values["friction"] * float(np.median(evidence.level))
        slow = SLOW_SHARE * TURN * evidence.resonance * evidence.displacement
        return replace(super().single_mass(values, evidence), friction=friction, slow=slow)


class PositiveStop(Sound):
    """A bonded structure with a stop in the positive direction of the sensor.

    Such as a clamp that rattles, or a cable that slackens.
    """

    name = "bonded, with a stop in the positive direction"
    extra = {"stop": (-0.8, 5.0), "position": (-1.0, 1.0)}
    side: ClassVar[float] = 1.0

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        """Return starts with weak and stiff stops that the mass meets early or late."""
        found = []
        for stop in (-0.3, 0.1, 0.5):
            for position in (0.0, 0.3):
                f = evidence.resonance / math.sqrt(1.0 + 0.5 * stop * (1.0 - position))
                rest = {"stop": stop, "position": position}
                found.append({"f": f, "log_zeta": math.log(0.01), **rest})
        return found

    def single_mass(self, values: Values, evidence: Evidence) -> SingleMass:
        """Build the single mass with the stop of these values."""
        linear = super().single_mass(values, evidence)
        position = values["position"] * evidence.displacement
        return replace(linear, stop=values["stop"], position=position, side=self.side)


class NegativeStop(PositiveStop):
    """A bonded structure with a stop in the negative direction of the sensor."""

    name = "bonded, with a stop in the negative direction"
    side = -1.0


# -- delaminated ----------------------------------------------------------------------------------


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
        common = math.sqrt((structure.k1 + structure.k2) / (structure.m1 + structure.m2)) / TURN
        return {
            "common": common,
            "split": math.log(structure.f2 / structure.f1),
            "log_zeta1": math.log(zeta[0]),
            "log_zeta2": math.log(zeta[1]),
            "e": structure.e,
            "clearance": getattr(structure, "clearance", 0.0) / evidence.displacement,
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
            "clearance": values["clearance"] * evidence.displacement,
        }
        return self.guess.replace(bonded=False, **{name: numbers[name] for name in self.free})

    def bounds(self, evidence: Evidence) -> dict[str, tuple[float, float]]:
        """Return the bounds of the numbers that are free."""
        f, (low, high) = evidence.resonance, [math.log(zeta) for zeta in DAMPING_RANGE]
        every = {
            "common": (0.6 * f, 1.6 * f),
            "split": (-MAX_SPLIT, MAX_SPLIT),
            "log_zeta1": (low, high),
            "log_zeta2": (low, high),
            "e": RESTITUTION_RANGE,
            "clearance": (-2.0, 2.0),
        }
        names = {
            **{"common": {"f1", "f2"}, "split": {"f1", "f2"}, "log_zeta1": {"zeta1"}},
            **{"log_zeta2": {"zeta2"}, "e": {"e"}, "clearance": {"clearance"}},
        }
        return {name: every[name] for name, of in names.items() if of & set(self.free)}

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        """Return a grid of starts over split, common frequency and restitution."""
        guess, found = self.values_from_structure(self.guess, evidence), []
        for split in STARTING_SPLITS:
            for shift in (0.96, 1.0, 1.04):
                for e in (0.35, 0.7):
                    common = shift * evidence.resonance * math.sqrt(1.0 + 0.25 * split**2)
                    found.append({**guess, "common": common, "split": split, "e": e})
        return found

    def reported(self, values: Values, evidence: Evidence) -> dict[str, float]:
        """Return the structure's parameters that are free, by name."""
        structure = self.structure_from_values(values, evidence)
        return {name: float(structure.get(name)) for name in self.free}

    def displacements(self, values: Values, evidence: Evidence, player: Player | None) -> Floats:
        """Compute the motion of both masses by the FMU."""
        assert player is not None
        player.start(self.structure_from_values(values, evidence))
        nodes = evidence.pieces.nodes
        return player.play(nodes, evidence.pieces.derivatives, nodes, ("x1", "x2")).rows.T


class DelaminatedWithClearance(Delaminated):
    """Two masses with a gap between the faces at rest, or pressed together by a preload."""

    name: ClassVar[str] = "delaminated, with clearance"

    def starts(self, evidence: Evidence) -> Sequence[dict[str, float]]:
        """Return starts with halves that strike each other, and with halves that move alone.

        Those move alone up to a gap: then the resonance is that of the half with the sensor.
        """
        guess, found = self.values_from_structure(self.guess, evidence), []
        m1, m2 = self.guess.m1, self.guess.m2
        for split in STARTING_SPLITS:
            for gap in (0.05, 0.1, 0.2, 0.4, 0.7):
                common = evidence.resonance * math.sqrt(1.0 + 0.25 * split**2)
                found.append({**guess, "common": common, "split": split, "clearance": gap})
        peaks = evidence.peaks
        splits = [math.log(peaks[1] / peaks[0])] if len(peaks) == 2 else list(STARTING_SPLITS)
        for split in splits:
            f1 = peaks[0] if evidence.masses[0] == 0 else peaks[0] * math.exp(-split)
            common = f1 * math.sqrt((m1 + m2 * math.exp(2.0 * split)) / (m1 + m2))
            for share in (1.0, 0.96, 0.92):
                for gap in (0.05, 0.1, 0.2, 0.4, 0.7, 1.0, 1.4):
                    moved = {"common": share * common, "split": split, "clearance": gap}
                    found.append({**guess, **moved})
        return found


SOUND = (Bonded(), NonlinearSpring(), DryFriction(), PositiveStop(), NegativeStop())
