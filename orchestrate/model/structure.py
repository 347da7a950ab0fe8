"""A delaminated structure: two oscillators side by side, and how their contact behaves."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Any

from ..errors import InputError
from .conversions import (
    checked_thicknesses,
    damping_from_ratio,
    stiffness_from_frequency,
    warn_of_ratios_in_per_cent,
)
from .described import Described
from .ranges import ADDED, RATIO_QUANTITIES, STRUCTURE, checked_flag, construct_or_explain
from .spelling import expected_one_of
from .structure_numbers import FLAGS, MODAL_PARAMETERS, OF_MASS_2, PARAMETERS, RATIO_PARAMETERS
from .structure_text import StructureText

ALTERNATIVES = {  # names that set the same value
    "mu": ("m2",),
    "kappa": ("k2",),
    "omega": ("k1",),
    "D": ("D1", "D2", "d1", "d2"),
    "D1": ("d1",),
    "D2": ("d2",),
    "f1": ("k1", "omega"),
    "f2": ("k2", "kappa"),
    "zeta1": ("d1", "D", "D1"),
    "zeta2": ("d2", "D", "D2"),
}
OF_HALVES = ("m1", "m2", "k1", "k2", "d1", "d2")


def with_tabulated_fields(kind: type[Described]) -> type[Described]:
    """Give a class fields for the parameters of the variable table that it does not write out."""
    types, text, before = kind.__annotations__, kind.__doc__ or "", "    bonded : bool"
    last = {name: types.pop(name) for name in FLAGS if name in types}
    for name in [name for name in STRUCTURE if name not in types]:
        quantity = STRUCTURE[name]
        types[name] = "float"
        setattr(kind, name, quantity.default)
        meaning = f"    {name} : float\n        {quantity.description}, {quantity.unit}.\n"
        text = text.replace(before, meaning + before, 1)
    kind.__annotations__, kind.__doc__ = types | last, text
    return kind


def check_keywords(keywords: Mapping[str, Any], *known: str) -> None:
    """Raise ``InputError`` for a keyword that is neither known nor a parameter of the contact."""
    names = (*known, *(name for name in STRUCTURE if name not in OF_HALVES))
    for name in keywords:
        if name not in names:
            raise InputError(f"{name}: no parameter here; {expected_one_of(name, names)}")


@dataclass(frozen=True, kw_only=True)
@with_tabulated_fields
class Structure(StructureText, Described):
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
        End of chattering, see (17): pressed together, the masses stick where all flights that are
        left would last less than gamma over the faster half's sqrt(k/m); never at e = 1.
    clearance : float
        Gap between the faces where both springs are unloaded, m. Below zero the masses are pressed
        together: at rest with the force ``preload``, at the displacements ``at_rest``. A bonded
        structure ignores it.
    e_slope : float
        Decrease of the coefficient of restitution with the closing speed v, s/m: it is
        e/(1 + e_slope v), see :meth:`restitution`; 0 for e at all speeds.
    stroke : float
        Largest gap, m: there the faces strike on their other side, with the same e (a play, a mass
        between two stops); 0 for no limit. A bonded structure ignores it.
    bonded : bool
        The undamaged structure: both masses glued for good.
    wall : bool
        Mass 2 is a rigid wall fixed to the box: m2, k2, d2 have no effect, and what is made of them
        (``mu``, ``kappa``, ``f2``, ...) is refused.

    Raises
    ------
    InputError
        Where a value is no number in its range, or values contradict each other.

    See Also
    --------
    Structure.nondimensional : the same by the paper's numbers.
    Structure.from_halves : the same by natural frequencies and damping ratios.
    Structure.from_bonded : from a measurement of the undamaged beam.
    Structure.one_mass : one mass against a wall, or between two.

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

    quantities = STRUCTURE
    m1: float = STRUCTURE["m1"].default
    m2: float = STRUCTURE["m2"].default
    k1: float = STRUCTURE["k1"].default
    k2: float = STRUCTURE["k2"].default
    d1: float = STRUCTURE["d1"].default
    d2: float = STRUCTURE["d2"].default
    e: float = STRUCTURE["e"].default
    gamma: float = STRUCTURE["gamma"].default
    clearance: float = STRUCTURE["clearance"].default
    e_slope: float = STRUCTURE["e_slope"].default
    stroke: float = STRUCTURE["stroke"].default
    bonded: bool = False
    wall: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in FLAGS:
            object.__setattr__(self, name, checked_flag(name, getattr(self, name)))
        if self.wall and self.bonded:
            raise InputError("bonded = True with wall = True: expected one of both at most")
        if 0.0 < self.stroke < self.clearance and not self.bonded:
            expected = f"expected at least clearance = {self.clearance!r} m"
            raise InputError(f"stroke = {self.stroke!r} m: {expected}")

    @classmethod
    def one_mass(
        cls,
        *,
        m: float = STRUCTURE["m1"].default,
        k: float | None = None,
        d: float | None = None,
        f: float | None = None,
        zeta: float | str | None = None,
        clearance: float = STRUCTURE["clearance"].default,
        stroke: float = 0.0,
        **added: Any,
    ) -> Structure:
        """Make one mass on a spring and a damper in front of a wall, or between two.

        Parameters
        ----------
        m : float
            Mass, kg. Without other forces than those of gravity and the box it has no effect.
        k, d : float, optional
            Stiffness and damping, N/m, N s/m; by default as mass 1 of :class:`Structure` has it.
        f, zeta : float, optional
            In their place, as of a half: natural frequency, Hz, and damping ratio, 0.01 or "1 %".
        clearance : float
            Distance to the wall at rest, m, which is where x1 = clearance; below zero the mass
            rests on the wall, pressed to it by ``-k clearance``.
        stroke : float
            Free way between the wall and another one opposite, where x1 = clearance - stroke, m; 0:
            there is none.
        **added
            ``e`` and others, as in :class:`Structure`.

        Examples
        --------
        >>> mass = Structure.one_mass(m=2.0, k=50.0, d=0.1, e=0.8, clearance=-0.01)
        >>> mass.omega, mass.at_rest, mass.preload
        (5.0, (-0.01, 0.0), 0.5)
        >>> Structure.one_mass(f=12.0, zeta="1 %", clearance=3e-4).f1
        12.0
        """
        check_keywords(added, "m", "k", "d", "f", "zeta")
        own = {"m1": m, "k1": k, "d1": d, "f1": f, "zeta1": zeta}
        given = {name: value for name, value in own.items() if value is not None}
        one = cls().replace(**given)
        same: dict[str, Any] = {"m2": one.m1, "k2": one.k1, "d2": one.d1, "wall": True}
        return dataclasses.replace(one, **same, clearance=clearance, stroke=stroke, **added)

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
        **added: Any,
    ) -> Structure:
        """Make a structure from mu, kappa, D and omega of the paper, (2) and (8).

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
        **added
            As in :class:`Structure`, in SI: the paper's numbers have none of them, and no unit of
            length. Under ``eta=`` a ``clearance`` counts in units of xi.

        Examples
        --------
        >>> Structure.nondimensional(D=0.02, mu=0.5).parameters()["d2"]
        0.02
        """
        numbers = {"mu": mu, "kappa": kappa, "D": D, "D1": D1, "D2": D2, "omega": omega}
        check_keywords(added, "m1", *numbers, *FLAGS)
        v = {name: RATIO_QUANTITIES[name].check(x) for name, x in numbers.items() if x is not None}
        m1 = STRUCTURE["m1"].check(m1)
        k1, contact = m1 * v["omega"] ** 2, {"e": e, "gamma": gamma, "bonded": bonded, **added}
        return construct_or_explain(
            {"m1": m1, **v},
            lambda: cls(
                m1=m1,
                m2=v["mu"] * m1,
                k1=k1,
                k2=v["kappa"] * k1,
                d1=damping_from_ratio(v.get("D1", v["D"]), v["omega"], m1),
                d2=damping_from_ratio(v.get("D2", v["D"]), v["omega"], m1) * v["mu"],
                **contact,
            ),
        )

    @classmethod
    def from_halves(
        cls,
        *,
        m1: float,
        m2: float,
        f1: float,
        f2: float,
        zeta1: float | str = 0.0,
        zeta2: float | str = 0.0,
        e: float = STRUCTURE["e"].default,
        gamma: float = STRUCTURE["gamma"].default,
        bonded: bool = False,
        **added: Any,
    ) -> Structure:
        """Make a structure from mass, natural frequency and damping ratio of each half alone.

        Parameters
        ----------
        m1, m2 : float
            Masses, kg.
        f1, f2 : float
            Undamped natural frequencies sqrt(k_i/m_i)/(2 pi) of each half alone, Hz.
        zeta1, zeta2 : float or str
            Damping ratios d_i/(2 sqrt(k_i m_i)) of each half at its frequency, 0.007 or "0.7 %".
            The paper's ``D_i`` (8) refer to the frequency of mass 1 instead: ``D1`` is ``zeta1``,
            ``D2`` is ``zeta2 f2/f1``.
        e, gamma, bonded, **added
            As in :class:`Structure`.

        Raises
        ------
        InputError
            Where a value is no number in its range, or makes one that is not.

        Examples
        --------
        >>> beam = Structure.from_halves(m1=1.5, m2=1.2, f1=42.0, f2=55.0, zeta1=0.007, zeta2=0.007)
        >>> beam.f2, beam.zeta2, round(beam.D2, 6)
        (55.0, 0.007, 0.009167)
        """
        halves = {"f1": f1, "f2": f2, "zeta1": zeta1, "zeta2": zeta2}
        check_keywords(added, "m1", "m2", *halves, *FLAGS)
        v = {name: RATIO_QUANTITIES[name].check(value) for name, value in halves.items()}
        warn_of_ratios_in_per_cent({"zeta1": v["zeta1"], "zeta2": v["zeta2"]})
        m1, m2 = STRUCTURE["m1"].check(m1), STRUCTURE["m2"].check(m2)
        contact = {"e": e, "gamma": gamma, "bonded": bonded, **added}
        return construct_or_explain(
            {"m1": m1, "m2": m2, **v},
            lambda: cls(
                m1=m1,
                m2=m2,
                k1=stiffness_from_frequency(v["f1"], m1),
                k2=stiffness_from_frequency(v["f2"], m2),
                d1=damping_from_ratio(v["zeta1"], 2.0 * math.pi * v["f1"], m1),
                d2=damping_from_ratio(v["zeta2"], 2.0 * math.pi * v["f2"], m2),
                **contact,
            ),
        )

    @classmethod
    def from_bonded(
        cls,
        *,
        mass: float,
        f: float,
        zeta: float = 0.0,
        thicknesses: tuple[float, float],
        e: float = STRUCTURE["e"].default,
        gamma: float = STRUCTURE["gamma"].default,
        bonded: bool = False,
        **added: Any,
    ) -> Structure:
        """Make a structure by splitting the undamaged beam's mode between two layers by thickness.

        A layer of a beam of one material and width has its share of the thickness in the mass, and
        of the cubes of the thicknesses in the bending stiffness E b h^3/12 (Timoshenko and Gere,
        Mechanics of Materials, beam of rectangular section), whatever the supports. Both layers
        together have the measured mass, frequency and damping, which is split like the stiffness
        (a material's viscous damping). So ``as_bonded()`` is the beam that was measured, and
        f2/f1 = h2/h1.

        Bonded layers are stiffer than the two that slide on each other, by (h1 + h2)^3 against
        h1^3 + h2^3 where the delamination takes the whole length. How much of it a shorter one
        takes depends on its place: where the frequency of the delaminated beam is known, use
        :meth:`from_halves`.

        Parameters
        ----------
        mass : float
            Modal mass of the undamaged beam, kg.
        f : float
            Its natural frequency, Hz.
        zeta : float
            Its damping ratio.
        thicknesses : tuple of float
            Of the layers 1 and 2, in any unit: their ratio counts.
        e, gamma, bonded, **added
            As in :class:`Structure`.

        Raises
        ------
        InputError
            Where a value is no number in its range, or makes one that is not.

        Examples
        --------
        >>> beam = Structure.from_bonded(mass=2.0, f=50.0, zeta=0.01, thicknesses=(3.0, 2.0))
        >>> round(beam.m1, 12), round(beam.f2 / beam.f1, 12), round(beam.omega_3 * beam.f1, 12)
        (1.2, 0.666666666667, 50.0)
        """
        check_keywords(added, "mass", "f", "zeta", "thicknesses", *FLAGS)
        mass, f = STRUCTURE["m1"].check(mass), RATIO_QUANTITIES["f1"].check(f)
        zeta = RATIO_QUANTITIES["zeta1"].check(zeta)
        warn_of_ratios_in_per_cent({"zeta": zeta})
        h1, h2 = checked_thicknesses(thicknesses)
        heavy, light = h1 / (h1 + h2), h2 / (h1 + h2)
        stiff, soft = heavy**3 / (heavy**3 + light**3), light**3 / (heavy**3 + light**3)
        k, d = stiffness_from_frequency(f, mass), damping_from_ratio(zeta, 2.0 * math.pi * f, mass)
        halves: dict[str, Any] = {
            **{"m1": heavy * mass, "k1": stiff * k, "d1": stiff * d},
            **{"m2": light * mass, "k2": soft * k, "d2": soft * d},
        }
        return construct_or_explain(
            {"mass": mass, "f": f, "zeta": zeta},
            lambda: cls(**halves, e=e, gamma=gamma, bonded=bonded, **added),
        )

    @classmethod
    def from_file(cls, path: str | PathLike[str]) -> Structure:
        """Read the ``[structure]`` of a TOML file or of a set that comes with the package.

        Examples
        --------
        >>> Structure.from_file("paper") == Structure.nondimensional()
        True
        """
        return cls._read(path)

    @classmethod
    def from_attributes(cls, attributes: Mapping[str, Any]) -> Structure:
        """Return the structure described by the attributes of a dataset.

        What was added later, and an older file has not, is at its default.

        Raises
        ------
        KeyError, ValueError, TypeError
            Where there is none, or it is no number.
        """
        older = {name: STRUCTURE[name].default for name in ADDED}
        numbers: dict[str, Any] = {name: float({**older, **attributes}[name]) for name in STRUCTURE}
        flags = {name: float(attributes.get(name, 0.0)) for name in FLAGS}
        if not {*flags.values()} <= {0.0, 1.0}:
            raise ValueError(f"{flags}")
        own: dict[str, Any] = {name: bool(flag) for name, flag in flags.items()}
        return cls(**numbers, **own)

    def as_bonded(self) -> Structure:
        """Return a copy without delamination: both masses move as one (clearance kept unused)."""
        return dataclasses.replace(self, bonded=True)

    def as_delaminated(self) -> Structure:
        """Return a delaminated copy of equal parameters: its masses can separate and impact."""
        return dataclasses.replace(self, bonded=False)

    def replace(self, **changes: Any) -> Structure:
        """Return a copy with some parameters changed, given as keywords, SI or non-dimensional.

        Parameters
        ----------
        **changes
            SI names leave all other SI values as they are. Of the paper's numbers, ``mu`` keeps m1
            and the damping ratios, ``omega`` keeps m1 and all ratios, the others change one SI
            value each; ``D`` sets D1 and D2. Of the halves, ``f1`` and ``f2`` keep the half's mass
            and damping ratio ``zeta``. SI names are taken first, the halves' last.

        Examples
        --------
        >>> Structure().replace(kappa=2.0, e=0.3).label()
        'e0.3_D0.005_kappa2'
        """
        known = (*PARAMETERS, *FLAGS)
        wall = changes.get("wall", self.wall)
        for name in changes:
            if name in OF_MASS_2 and wall is True:
                dataclasses.replace(self, wall=True, bonded=False).require_mass_2(name)
            if name not in known:
                text = f"{name}: no parameter of a structure"
                raise InputError(f"{text}; {expected_one_of(name, known)}")
            for alternative in ALTERNATIVES.get(name, ()):
                if alternative in changes:
                    raise InputError(f"{name} and {alternative}: expected one of them")
        ratios, halves = (
            {n: RATIO_QUANTITIES[n].check(changes.pop(n)) for n in names if n in changes}
            for names in (RATIO_PARAMETERS, MODAL_PARAMETERS)
        )
        fixed = dataclasses.replace(self, **changes)
        if ratios:
            with_mass_2 = dataclasses.replace(fixed, wall=False)  # whose ratios are numbers
            new = {**with_mass_2._si_from_ratios(ratios), **changes}
            fixed = construct_or_explain(ratios, lambda: dataclasses.replace(fixed, **new))
        if halves:
            new = {**fixed._si_from_halves(halves), **changes}
            fixed = construct_or_explain(halves, lambda: dataclasses.replace(fixed, **new))
        return fixed

    def parameters(self) -> dict[str, float | bool]:
        """Return all parameters by name in SI, as the FMU takes them at its start."""
        return dict(vars(self))
