"""The harmonic motion of the box that shakes a structure."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from os import PathLike

from .ranges import EXCITATION, NUMBERS, made_of, recover
from .structure import Structure


@dataclass(frozen=True, kw_only=True)
class Excitation:
    """The box moves by ``a sin(Omega t + phase)``.

    Parameters
    ----------
    frequency : float
        Angular frequency Omega, rad/s.
    amplitude : float
        a, m.
    phase : float
        Phase at time 0, rad.

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

    frequency: float
    amplitude: float
    phase: float = EXCITATION["phase"].default

    def __post_init__(self) -> None:
        for name, quantity in EXCITATION.items():
            object.__setattr__(self, name, quantity.check(getattr(self, name)))

    @classmethod
    def nondimensional(cls, eta: float, structure: Structure, phase: float = 0.0) -> Excitation:
        """Frequency ratio ``eta`` with the amplitude 1/eta^2 m, so that xi of (3) is x in metres.

        Examples
        --------
        >>> Excitation.nondimensional(0.5, Structure())
        Excitation(frequency=0.5, amplitude=4.0, phase=0.0)
        """
        eta = NUMBERS["eta"].check(eta)
        frequency, amplitude = eta * structure.omega, 1.0 / (eta * eta)
        return made_of(
            {"eta": eta}, lambda: cls(frequency=frequency, amplitude=amplitude, phase=phase)
        )

    @classmethod
    def from_file(cls, path: str | PathLike[str], structure: Structure | None = None) -> Excitation:
        """The ``[excitation]`` of a TOML file.

        Parameters
        ----------
        path : path-like
        structure : Structure, optional
            What ``eta`` refers to where the file has no ``[structure]``.
        """
        from .files import read_section

        found = read_section(path, "excitation", structure)
        assert isinstance(found, cls)
        return found

    @property
    def period(self) -> float:
        """One period of the box, s: (22) as it must read."""
        return 2.0 * math.pi / self.frequency

    def eta(self, structure: Structure) -> float:
        """The frequency ratio Omega/omega (6)."""
        omega = structure.omega
        return recover(self.frequency / omega, lambda eta: eta * omega, self.frequency)

    def length(self, structure: Structure) -> float:
        """The unit of xi of (3), a eta^2 in m; exactly 1 where it is 1 but for rounding."""
        eta = self.eta(structure)
        length = self.amplitude * (eta * eta)
        return 1.0 if math.isclose(length, 1.0, rel_tol=2e-15) else length

    def replace(self, **changes: float) -> Excitation:
        """An excitation that differs in some of its numbers."""
        return dataclasses.replace(self, **changes)

    def inputs(self) -> dict[str, float]:
        """The FMU's inputs and start values."""
        return {
            "box_amplitude": self.amplitude,
            "box_frequency": self.frequency,
            "phase_start": self.phase,
        }
