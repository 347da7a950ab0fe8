"""A delaminated structure: two oscillators side by side, and how they knock against each other."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from os import PathLike
from typing import Any

from ..errors import InputError
from .ranges import NUMBERS, STRUCTURE, check_flag, made_of, one_of, recover

SI = tuple(STRUCTURE)
RATIOS = ("mu", "kappa", "D", "D1", "D2", "omega")
PARAMETERS = (*SI, *RATIOS)
ALTERNATIVES = {
    "mu": ("m2",),
    "kappa": ("k2",),
    "omega": ("k1",),
    "D": ("D1", "D2", "d1", "d2"),
    "D1": ("d1",),
    "D2": ("d2",),
}


def damping(ratio: float, omega: float, mass: float) -> float:
    """The damper of a damping ratio, d = 2 D omega m (8)."""
    return 2.0 * ratio * omega * mass


def short(value: float) -> str:
    """A number for a name, to the last digit."""
    return repr(value).removesuffix(".0")


@dataclass(frozen=True, kw_only=True)
class Structure:
    """Two masses on springs and dampers that touch without being glued (Figure 1 of the paper).

    Parameters
    ----------
    m1, m2 : float
        Masses, kg.
    k1, k2 : float
        Stiffnesses, N/m.
    d1, d2 : float
        Viscous damping, N s/m; overdamped oscillators are allowed.
    e : float
        Coefficient of restitution, 0 to 1.
    gamma : float
        End of chattering, as a time in units of 1/omega, see (17).
    bonded : bool
        The undamaged structure: both masses glued for good.

    Raises
    ------
    InputError
        Where a value is no number in its range.

    See Also
    --------
    Structure.nondimensional : the same by the paper's numbers.

    Examples
    --------
    >>> beam = Structure(m1=1.5, m2=1.5, k1=8437.5, k2=10125.0, d1=1.125, d2=1.125)
    >>> beam.omega, beam.mu, beam.kappa, beam.D1
    (75.0, 1.0, 1.2, 0.005)
    >>> beam.replace(D=0.05).d1
    11.25
    >>> Structure(e=1.5)
    Traceback (most recent call last):
    orchestrate.errors.InputError: e = 1.5: expected 0 <= e <= 1
    """

    m1: float = STRUCTURE["m1"].default
    m2: float = STRUCTURE["m2"].default
    k1: float = STRUCTURE["k1"].default
    k2: float = STRUCTURE["k2"].default
    d1: float = STRUCTURE["d1"].default
    d2: float = STRUCTURE["d2"].default
    e: float = STRUCTURE["e"].default
    gamma: float = STRUCTURE["gamma"].default
    bonded: bool = False

    def __post_init__(self) -> None:
        for name, quantity in STRUCTURE.items():
            object.__setattr__(self, name, quantity.check(getattr(self, name)))
        object.__setattr__(self, "bonded", check_flag("bonded", self.bonded))

    @classmethod
    def nondimensional(
        cls,
        mu: float = 1.0,
        kappa: float = 1.2,
        D: float = 0.005,
        D1: float | None = None,
        D2: float | None = None,
        e: float = STRUCTURE["e"].default,
        gamma: float = STRUCTURE["gamma"].default,
        bonded: bool = False,
        *,
        m1: float = 1.0,
        omega: float = 1.0,
    ) -> Structure:
        """A structure by the paper's numbers, (2) and (8).

        Parameters
        ----------
        mu, kappa : float
            Ratios m2/m1 and k2/k1.
        D : float
            Damping ratio of both masses.
        D1, D2 : float, optional
            Damping ratio of one mass, where it is not ``D``: d_i/(2 omega m_i).
        e, gamma, bonded
            As in :class:`Structure`.
        m1, omega : float
            The scale: kg, and sqrt(k1/m1) in rad/s. With 1 and 1, every SI number is the paper's.

        Examples
        --------
        >>> Structure.nondimensional(D=0.02, mu=0.5).parameters()["d2"]
        0.02
        """
        given = {"mu": mu, "kappa": kappa, "D": D, "D1": D1, "D2": D2, "omega": omega}
        v = {name: NUMBERS[name].check(x) for name, x in given.items() if x is not None}
        m1 = STRUCTURE["m1"].check(m1)
        k1 = m1 * v["omega"] ** 2
        return made_of(
            {"m1": m1, **v},
            lambda: cls(
                m1=m1,
                m2=v["mu"] * m1,
                k1=k1,
                k2=v["kappa"] * k1,
                d1=damping(v.get("D1", v["D"]), v["omega"], m1),
                d2=damping(v.get("D2", v["D"]), v["omega"], m1) * v["mu"],
                e=e,
                gamma=gamma,
                bonded=bonded,
            ),
        )

    @classmethod
    def from_file(cls, path: str | PathLike[str]) -> Structure:
        """The ``[structure]`` of a TOML file or of a set that comes with the package.

        Examples
        --------
        >>> Structure.from_file("paper") == Structure.nondimensional()
        True
        """
        from .files import read_section

        found = read_section(path, "structure")
        assert isinstance(found, cls)
        return found

    @property
    def omega(self) -> float:
        """The unit of frequency sqrt(k1/m1), rad/s (2)."""
        return math.sqrt(self.k1 / self.m1)

    @property
    def mu(self) -> float:
        """The mass ratio m2/m1 (2)."""
        return recover(self.m2 / self.m1, lambda mu: mu * self.m1, self.m2)

    @property
    def kappa(self) -> float:
        """The stiffness ratio k2/k1 (2)."""
        return recover(self.k2 / self.k1, lambda kappa: kappa * self.k1, self.k2)

    @property
    def D1(self) -> float:
        """The damping ratio d1/(2 omega m1) of mass 1 (8)."""
        omega, m1 = self.omega, self.m1
        return recover(
            self.d1 / (2.0 * omega * m1), lambda ratio: damping(ratio, omega, m1), self.d1
        )

    @property
    def D2(self) -> float:
        """The damping ratio d2/(2 omega m2) of mass 2 (8)."""
        omega, m1, mu = self.omega, self.m1, self.mu
        return recover(
            self.d2 / (2.0 * omega * self.m2),
            lambda ratio: damping(ratio, omega, m1) * mu,
            self.d2,
        )

    @property
    def D3(self) -> float:
        """The damping ratio of both masses together, in contact (8)."""
        return (self.d1 + self.d2) / (2.0 * self.omega * (self.m1 + self.m2))

    @property
    def omega_1(self) -> float:
        """The natural frequency of mass 1 over omega: 1 (7)."""
        return 1.0

    @property
    def omega_2(self) -> float:
        """The natural frequency of mass 2 over omega, sqrt(kappa/mu) (7)."""
        return math.sqrt(self.kappa / self.mu)

    @property
    def omega_3(self) -> float:
        """The natural frequency of both masses together over omega, in contact (7)."""
        return math.sqrt((1.0 + self.kappa) / (1.0 + self.mu))

    @property
    def alike(self) -> bool:
        """Whether both oscillators move alike, so that masses that start together never part."""
        return self.kappa == self.mu and self.D1 == self.D2

    def as_bonded(self) -> Structure:
        """The undamaged structure, both masses glued."""
        return dataclasses.replace(self, bonded=True)

    def as_delaminated(self) -> Structure:
        """The damaged structure, whose masses knock."""
        return dataclasses.replace(self, bonded=False)

    def get(self, name: str) -> float:
        """A parameter by its name, any of ``PARAMETERS``.

        Raises
        ------
        InputError
            Where there is none of that name; for ``D`` too where D1 and D2 differ.
        """
        if name not in PARAMETERS:
            raise InputError(f"{name}: no parameter of a structure; {one_of(name, PARAMETERS)}")
        if name != "D":
            return float(getattr(self, name))
        if self.D1 != self.D2:
            raise InputError(f"D: D1 = {self.D1!r} and D2 = {self.D2!r}; expected D1 or D2")
        return self.D1

    def replace(self, **changes: Any) -> Structure:
        """A structure that differs in some parameters.

        Parameters
        ----------
        **changes
            SI names leave all other SI values as they are. Of the paper's numbers, ``mu`` keeps m1
            and the damping ratios, ``omega`` keeps m1 and all ratios, the others change one SI
            value each; ``D`` sets D1 and D2. SI names are taken first.

        Examples
        --------
        >>> Structure().replace(kappa=2.0, e=0.3).label()
        'e0.3_D0.005_kappa2'
        """
        known = (*PARAMETERS, "bonded")
        for name in changes:
            if name not in known:
                raise InputError(f"{name}: no parameter of a structure; {one_of(name, known)}")
            for other in ALTERNATIVES.get(name, ()):
                if other in changes:
                    raise InputError(f"{name} and {other}: expected one of them")
        ratios = {
            name: NUMBERS[name].check(changes.pop(name)) for name in RATIOS if name in changes
        }
        fixed = dataclasses.replace(self, **changes)
        if not ratios:
            return fixed
        new = {k: v for k, v in fixed._by_ratios(ratios).items() if k not in changes}
        return made_of(ratios, lambda: dataclasses.replace(fixed, **new))

    def _by_ratios(self, ratios: dict[str, float]) -> dict[str, Any]:
        """The SI values that change where the paper's numbers ``ratios`` are set."""
        both = {"D1": ratios["D"], "D2": ratios["D"]} if "D" in ratios else {}
        given = {**ratios, **both}
        omega, mu = given.get("omega", self.omega), given.get("mu", self.mu)
        k1 = self.m1 * omega**2 if "omega" in given else self.k1
        new = {}
        if "omega" in given:
            new["k1"] = k1
        if "mu" in given:
            new["m2"] = mu * self.m1
        if given.keys() & {"kappa", "omega"}:
            new["k2"] = given.get("kappa", self.kappa) * k1
        if given.keys() & {"D1", "omega"}:
            new["d1"] = damping(given.get("D1", self.D1), omega, self.m1)
        if given.keys() & {"D2", "mu", "omega"}:
            new["d2"] = damping(given.get("D2", self.D2), omega, self.m1) * mu
        return new

    def parameters(self) -> dict[str, float | bool]:
        """The FMU's start values."""
        return dict(vars(self))

    def label(self) -> str:
        """A short name for files and titles; structures that differ have different ones."""
        default = type(self)()
        if (self.m1, self.k1) == (1.0, 1.0):
            damping_ratios = dict.fromkeys((short(self.D1), short(self.D2)))
            parts = [f"e{short(self.e)}", f"D{'-'.join(damping_ratios)}"]
            names: tuple[str, ...] = ("mu", "kappa", "gamma")
        else:
            pairs = (("m", "m1", "m2"), ("k", "k1", "k2"), ("d", "d1", "d2"))
            values = [(letter, self.get(one), self.get(two)) for letter, one, two in pairs]
            parts = [f"{letter}{short(one)}-{short(two)}" for letter, one, two in values]
            parts.insert(0, f"e{short(self.e)}")
            names = ("gamma",)
        for name in names:
            if self.get(name) != default.get(name):
                parts.append(f"{name}{short(self.get(name))}")
        return "_".join([*parts, *(["bonded"] if self.bonded else [])])
