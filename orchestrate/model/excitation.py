"""The harmonic motion of the box that shakes a structure.

Excitations of all other kinds (sines that sweep, random vibration, shocks, records) are in
:mod:`orchestrate.laboratory`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from os import PathLike

from ..errors import InputError
from ..units import largest_static_displacement
from .described import Described
from .ranges import EXCITATION, PUSHES, RATIO_QUANTITIES, construct_or_explain, invert_exactly
from .structure import Structure


@lru_cache(maxsize=4096)
def frequency_ratio(frequency: float, omega: float) -> float:
    """Return frequency over omega, which times omega is the frequency again."""
    return invert_exactly(frequency / omega, lambda eta: eta * omega, frequency)


@dataclass(frozen=True, kw_only=True)
class Excitation(Described):
    """Harmonic motion of the box, ``a sin(Omega t + phase)``, and other loads.

    Parameters
    ----------
    frequency : float
        Angular frequency Omega, rad/s.
    amplitude : float
        a, m.
    phase : float
        Phase at time 0, rad.
    box_acceleration : float
        Constant acceleration of the box, added to its own, m/s2: gravity.
    force1, force2 : float
        Amplitudes F of harmonic forces on the masses, N: ``F sin(Omega t + phase)``.

    Raises
    ------
    InputError
        Where a value is no number in its range.

    Examples
    --------
    >>> structure = Structure.nondimensional(omega=75.0)
    >>> excitation = Excitation(frequency=90.0, amplitude=0.002)
    >>> excitation.eta(structure), round(excitation.period, 6)
    (1.2, 0.069813)
    """

    quantities = EXCITATION
    frequency: float
    amplitude: float
    phase: float = EXCITATION["phase"].default
    box_acceleration: float = 0.0
    force1: float = 0.0
    force2: float = 0.0

    @classmethod
    def nondimensional(
        cls, eta: float, structure: Structure, phase: float = 0.0, **pushes: float
    ) -> Excitation:
        """Return the box motion of frequency eta*omega and amplitude 1/eta^2 m (x = xi).

        Examples
        --------
        >>> Excitation.nondimensional(0.5, Structure()).amplitude
        4.0
        """
        eta = RATIO_QUANTITIES["eta"].check(eta)
        frequency, amplitude = eta * structure.omega, 1.0 / (eta * eta)
        return construct_or_explain(
            {"eta": eta},
            lambda: cls(frequency=frequency, amplitude=amplitude, phase=phase, **pushes),
        )

    @classmethod
    def from_file(cls, path: str | PathLike[str], structure: Structure | None = None) -> Excitation:
        """Read an excitation from the section ``[excitation]`` of a TOML file.

        Parameters
        ----------
        path : path-like
        structure : Structure, optional
            What ``eta`` refers to where the file has no ``[structure]``.
        """
        return cls._read(path, structure)

    @property
    def period(self) -> float:
        """Period of the box's motion, s: 2 pi/Omega, as (22) must read."""
        return 2.0 * math.pi / self.frequency

    def eta(self, structure: Structure) -> float:
        """Return the frequency ratio Omega/omega (6)."""
        return frequency_ratio(self.frequency, structure.omega)

    def length(self, structure: Structure) -> float:
        """Return the unit of length of xi (3), a eta^2, m; 1 where only rounding differs.

        Without box motion it is the largest static displacement by what pushes.
        """
        if self.amplitude == 0.0:
            softness = 1.0 / structure.omega**2, 1.0 / structure.k1, 1.0 / structure.k2
            return float(largest_static_displacement(self.pushes, softness))
        eta = self.eta(structure)
        length = self.amplitude * (eta * eta)
        return 1.0 if math.isclose(length, 1.0, rel_tol=2e-15) else length

    @property
    def pushes(self) -> tuple[float, ...]:
        """Return the box's constant acceleration, m/s2, and both forces, N."""
        return tuple(getattr(self, name) for name in PUSHES)

    def check(self, structure: Structure, least: float = 1e-12) -> None:
        """Raise ``InputError`` if an oscillator would be driven at its resonance almost undamped.

        Parameters
        ----------
        structure : Structure
        least : float
            Of the square of the relative detuning plus that of the damping over the critical one.

        Raises
        ------
        InputError
            Where the structure, or one of its masses alone, is driven on its natural frequency with
            no damping, or next to none.

        Examples
        --------
        >>> Excitation(frequency=1.0, amplitude=1.0).check(Structure.nondimensional(D=1e-3))
        """
        if not (self.amplitude or self.force1 or self.force2):
            return
        frequency = self.frequency
        for name, stiffness, mass, dampers in oscillators(structure):
            ratio = frequency * frequency * mass / stiffness
            loss = sum(dampers.values()) * frequency / stiffness
            if (1.0 - ratio) ** 2 + loss**2 <= 4.0 * least:
                texts = (f"{damper} = {value!r} N s/m" for damper, value in dampers.items())
                natural = math.sqrt(stiffness / mass)
                raise InputError(
                    f"frequency = {frequency!r} rad/s (eta = {self.eta(structure)!r}): the natural "
                    f"frequency of {name}, {natural!r} rad/s, with {' and '.join(texts)}; expected "
                    f"{' + '.join(dampers)} > 0, or a frequency further than 1e-6 of it away"
                )

    def inputs(self) -> dict[str, float]:
        """Return the FMU's input and start values by name."""
        return {
            "box_amplitude": self.amplitude,
            "box_frequency": self.frequency,
            "phase_start": self.phase,
            **dict(zip(PUSHES.values(), self.pushes, strict=True)),
        }


def oscillators(structure: Structure) -> Iterator[tuple[str, float, float, dict[str, float]]]:
    """Yield name, stiffness, mass and dampers of mass 1, mass 2 and both masses as one."""
    s = structure
    if not s.bonded:
        yield "mass 1", s.k1, s.m1, {"d1": s.d1}
    if s.wall:
        return
    if not s.bonded:
        yield "mass 2", s.k2, s.m2, {"d2": s.d2}
    yield "both masses together", s.k1 + s.k2, s.m1 + s.m2, {"d1": s.d1, "d2": s.d2}
