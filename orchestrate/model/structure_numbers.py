"""What follows from a structure's parameters: the paper's numbers, frequencies, the state at rest.

And back: the SI values that change where one of these numbers is set.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, TypeVar

from ..errors import InputError
from .conversions import (
    damping_from_ratio,
    damping_ratio,
    natural_frequency,
    stiffness_from_frequency,
)
from .ranges import OF_LENGTH, STRUCTURE, invert_exactly
from .spelling import expected_one_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

RATIO_PARAMETERS = ("mu", "kappa", "D", "D1", "D2", "omega")
MODAL_PARAMETERS = ("f1", "f2", "zeta1", "zeta2")
OF_MASS_2 = ("m2", "k2", "d2", "mu", "kappa", "D2", "f2", "zeta2")
FLAGS = ("bonded", "wall")
PARAMETERS = (*STRUCTURE, *RATIO_PARAMETERS, *MODAL_PARAMETERS)
Values = TypeVar("Values", float, "NDArray[np.float64]")


class StructureNumbers:
    """Base of :class:`Structure` with all that follows from its parameters."""

    m1: float
    m2: float
    k1: float
    k2: float
    d1: float
    d2: float
    e: float
    e_slope: float
    clearance: float
    bonded: bool
    wall: bool

    def require_mass_2(self, name: str) -> None:
        """Raise ``InputError`` if mass 2, of which a parameter is made, is a wall."""
        if self.wall:
            raise InputError(f"{name}: mass 2 is a wall (wall = True); expected a mass")

    @property
    def omega(self) -> float:
        """Unit of frequency sqrt(k1/m1), rad/s (2)."""
        return math.sqrt(self.k1 / self.m1)

    @property
    def mu(self) -> float:
        """Mass ratio m2/m1 (2)."""
        self.require_mass_2("mu")
        return invert_exactly(self.m2 / self.m1, lambda mu: mu * self.m1, self.m2)

    @property
    def kappa(self) -> float:
        """Stiffness ratio k2/k1 (2)."""
        self.require_mass_2("kappa")
        return invert_exactly(self.k2 / self.k1, lambda kappa: kappa * self.k1, self.k2)

    @property
    def D1(self) -> float:
        """Damping ratio d1/(2 omega m1) of mass 1 (8)."""
        omega, m1 = self.omega, self.m1
        ratio = self.d1 / (2.0 * omega * m1)
        return invert_exactly(ratio, lambda D: damping_from_ratio(D, omega, m1), self.d1)

    @property
    def D2(self) -> float:
        """Damping ratio d2/(2 omega m2) of mass 2 (8)."""
        self.require_mass_2("D2")
        omega, m1, mu = self.omega, self.m1, self.mu
        ratio = self.d2 / (2.0 * omega * self.m2)
        return invert_exactly(ratio, lambda D: damping_from_ratio(D, omega, m1) * mu, self.d2)

    @property
    def f1(self) -> float:
        """Natural frequency of mass 1 alone, Hz."""
        return natural_frequency(self.k1, self.m1)

    @property
    def f2(self) -> float:
        """Natural frequency of mass 2 alone, Hz."""
        self.require_mass_2("f2")
        return natural_frequency(self.k2, self.m2)

    @property
    def zeta1(self) -> float:
        """Damping ratio of mass 1 alone at its own frequency, d1/(2 sqrt(k1 m1))."""
        return damping_ratio(self.d1, self.f1, self.m1)

    @property
    def zeta2(self) -> float:
        """Damping ratio of mass 2 alone at its own frequency, d2/(2 sqrt(k2 m2))."""
        return damping_ratio(self.d2, self.f2, self.m2)

    @property
    def D3(self) -> float:
        """Damping ratio of both masses together, in contact (8)."""
        self.require_mass_2("D3")
        return (self.d1 + self.d2) / (2.0 * self.omega * (self.m1 + self.m2))

    @property
    def omega_1(self) -> float:
        """Natural frequency of mass 1 over omega: 1 (7)."""
        return 1.0

    @property
    def omega_2(self) -> float:
        """Natural frequency of mass 2 over omega, sqrt(kappa/mu) (7)."""
        return math.sqrt(self.kappa / self.mu)

    @property
    def omega_3(self) -> float:
        """Natural frequency of both masses together over omega, in contact (7)."""
        return math.sqrt((1.0 + self.kappa) / (1.0 + self.mu))

    @property
    def alike(self) -> bool:
        """Return whether both masses have equal frequency and damping: together they stay so."""
        return self.kappa == self.mu and self.D1 == self.D2

    @property
    def gap_offset(self) -> float:
        """Gap between the masses at unloaded springs, m: the clearance, 0 where bonded."""
        return 0.0 if self.bonded else self.clearance

    @property
    def preload(self) -> float:
        """Force pressing the masses together at rest, N: -clearance k1 k2/(k1 + k2), or 0."""
        if self.wall:
            return max(0.0, -self.clearance) * self.k1
        return max(0.0, -self.gap_offset) * self.k2 / (1.0 + self.kappa)

    @property
    def at_rest(self) -> tuple[float, float]:
        """Return displacements x1, x2 at rest, m: -F/k1 and F/k2 with the preload F."""
        return 0.0 - self.preload / self.k1, 0.0 if self.wall else self.preload / self.k2

    @property
    def has_scale(self) -> bool:
        """Return whether the response is nonlinear in amplitude: with a clearance or e(v)."""
        return any(getattr(self, name) != 0.0 for name in OF_LENGTH)

    def restitution(self, closing: Values) -> Values:
        """Return the restitution coefficient at closing speeds, m/s: e/(1 + e_slope v).

        It is the limit for slow impacts, ``e``, times the Pade approximant [0/1] of the law of Hunt
        and Crossley (Journal of Applied Mechanics 42, 1975, 440-445), whose contact force
        k d^n (1 + 3/2 e_slope d') has the restitution 1 - e_slope v + (e_slope v)^2 - ... at a
        speed v. The separation e(v) v grows with v.

        Parameters
        ----------
        closing : float or ndarray

        Examples
        --------
        >>> from orchestrate import Structure
        >>> Structure(e=0.8, e_slope=0.5).restitution(2.0)
        0.4
        """
        return self.e / (1.0 + self.e_slope * closing)

    def get(self, name: str) -> float:
        """Return a parameter's value by its name, SI or non-dimensional, any of ``PARAMETERS``.

        Raises
        ------
        InputError
            Where there is none of that name; for ``D`` too where D1 and D2 differ.
        """
        if name not in PARAMETERS:
            text = f"{name}: no parameter of a structure"
            raise InputError(f"{text}; {expected_one_of(name, PARAMETERS)}")
        if name in OF_MASS_2:
            self.require_mass_2(name)
        if name != "D":
            return float(getattr(self, name))
        if not self.wall and self.D1 != self.D2:
            raise InputError(f"D: D1 = {self.D1!r} and D2 = {self.D2!r}; expected D1 or D2")
        return self.D1

    def _si_from_halves(self, changes: dict[str, float]) -> dict[str, float]:
        """Return the SI values k and d that change if f1, f2, zeta1 or zeta2 are set."""
        new = {}
        for half, mass in (("1", self.m1), ("2", self.m2)):
            f, zeta = f"f{half}", f"zeta{half}"
            if f in changes:
                new[f"k{half}"] = stiffness_from_frequency(changes[f], mass)
            if f in changes or zeta in changes:
                ratio = changes.get(zeta, getattr(self, zeta))
                omega = 2.0 * math.pi * changes.get(f, getattr(self, f))
                new[f"d{half}"] = damping_from_ratio(ratio, omega, mass)
        return new

    def _si_from_ratios(self, ratios: dict[str, float]) -> dict[str, Any]:
        """Return the SI values that change if ratios of the paper (mu, kappa, D, omega) are set."""
        both = {"D1": ratios["D"], "D2": ratios["D"]} if "D" in ratios else {}
        given = {**ratios, **both}
        omega, mu, kappa, D1, D2 = (
            given.get(name, getattr(self, name)) for name in ("omega", "mu", "kappa", "D1", "D2")
        )
        k1 = self.m1 * omega**2 if "omega" in given else self.k1
        values = {  # by name: what it is, and what changes it
            "k1": (k1, {"omega"}),
            "m2": (mu * self.m1, {"mu"}),
            "k2": (kappa * k1, {"kappa", "omega"}),
            "d1": (damping_from_ratio(D1, omega, self.m1), {"D1", "omega"}),
            "d2": (damping_from_ratio(D2, omega, self.m1) * mu, {"D2", "mu", "omega"}),
        }
        return {name: value for name, (value, by) in values.items() if given.keys() & by}
