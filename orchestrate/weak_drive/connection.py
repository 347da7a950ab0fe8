"""Connect the oscillator to a drive's FMU of any names: what is exchanged, with which sign.

The drive gives the motion of the box (an acceleration, or a velocity or position whose derivatives
are taken), and takes the force on it. Names are checked against the FMU before anything is
computed: each has to exist, to be a real input or output, and to have the unit of its partner.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ..errors import InputError
from ..fmu.description import Description
from ..fmu.instance import INTEGER_TYPES, REAL_TYPES
from ..fmu.unit_names import parse_unit
from ..model.spelling import did_you_mean

MOTION = ("box_acceleration", "box_velocity", "box_position")  # outputs of a drive
FORCE = ("box_force", "box_force_1", "box_force_2", "box_force_3")  # inputs: with its derivatives
PUSHES = ("force1", "force2")  # outputs of a drive: forces on the halves
UNITS = {
    **dict(zip(MOTION, ("m/s2", "m/s", "m"), strict=True)),
    **dict(zip(FORCE, ("N", "N/s", "N/s2", "N/s3"), strict=True)),
    **dict.fromkeys(PUSHES, "N"),
}


def exponents_of(word: str) -> Mapping[str, int]:
    unit = parse_unit(word)
    assert unit is not None, word
    return unit.exponents


EXPONENTS = {name: exponents_of(word) for name, word in UNITS.items()}
OURS = {name: name for name in (*MOTION, *FORCE)}  # of the package's own drives
EXPECTED = f"expected some of {', '.join(MOTION)}, and box_force; or {' or '.join(PUSHES)}"


@dataclass(frozen=True)
class Link:
    """One connection: the drive's variable, and by what it is multiplied to be ours, in SI."""

    theirs: str
    scale: float


@dataclass(frozen=True)
class Connection:
    """What a master sets and reads of a drive."""

    links: Mapping[str, Link]  # by our names
    inputs: tuple[str, ...] = ()  # its others, by its names
    outputs: tuple[str, ...] = ()
    recorded: tuple[str, ...] = ()  # what is read at the end of each interval
    first_cubic: int = -1  # place among its inputs from which on they are cubics; -1: all are held

    @property
    def connected_pushes(self) -> tuple[str, ...]:
        """Return on which halves a force of the drive acts."""
        return tuple(name for name in PUSHES if name in self.links)


ENERGIES = ("box_force_work", "motor_energy", "box_damper_energy", "stored_energy")
MOTOR = Connection(  # the first two outputs are what the step control needs
    {name: Link(name, 1.0) for name in OURS}, ("voltage",), (*ENERGIES, "angle", "speed")
)


def checked_links(
    connect: Mapping[str, str], drive: Description, units: Mapping[str, str], alone: bool = False
) -> dict[str, Link]:
    """Return the connections by our names; raise ``InputError`` where one cannot be made.

    ``units`` has those that the drive does not state, by its names; a name in ``connect`` may say
    its own: ``table_pos[mm]``. A drive that runs ``alone`` has no force on it.
    """
    if not all(isinstance(theirs, str) for theirs in connect.values()):
        raise InputError(f"connect = {connect!r}: expected names of theirs by names of ours")
    for name in connect:
        if name not in UNITS:
            raise InputError(
                f"connect: {name} is no name of ours{suggest_similar(name, UNITS)}; {EXPECTED}"
            )
    if alone and set(connect) & set(FORCE):
        raise InputError("connect: box_force has no structure that exerts it; leave it out")
    pushes, moves = set(connect) & set(PUSHES), set(connect) & set(MOTION)
    if alone and pushes:
        raise InputError(f"connect: {min(pushes)} has no structure that it acts on; leave it out")
    whole = moves and (alone or "box_force" in connect)
    if not whole and (not pushes or moves or set(connect) & set(FORCE)):
        missing = "box_force" if moves else "a motion of the box"
        likely = ", ".join(map("=".join, propose_connections(drive).items()))
        hint = f"; by unit and name likely: {likely}" if likely else ""
        raise InputError(f"connect: {missing} is missing; {EXPECTED}{hint}")
    links: dict[str, Link] = {}
    for ours, theirs in connect.items():
        sign, name = (-1.0, theirs[1:]) if theirs.startswith("-") else (1.0, theirs)
        stated = re.fullmatch(r"(.+)\[([^\[\]]+)\]", name)
        if name not in drive.variables and stated and stated[1] in drive.variables:
            name = stated[1]
            units = {**units, **checked_units({name: stated[2]}, drive)}
        causality = "input" if ours in FORCE else "output"
        checked_variable(drive, name, causality)
        if name in (link.theirs for link in links.values()):
            raise InputError(f"connect: {name} is connected twice; expected it once")
        links[ours] = Link(name, sign * factor_to_si(drive, ours, name, units))
    return links


def checked_units(units: Mapping[str, str], drive: Description) -> dict[str, str]:
    for name, unit in units.items():
        checked_variable(drive, name, "")
        if parse_unit(str(unit)) is None:
            raise InputError(f"units: {name} = {unit!r}; expected a unit such as m/s2, mm or kN")
    return dict(units)


def checked_variable(drive: Description, name: str, causality: str, any_type: bool = False) -> Any:
    if name not in drive.variables:
        raise InputError(
            f"the FMU {drive.name} has no variable {name!r}{suggest_similar(name, drive.variables)}"
            f"; expected {format_candidates(drive, causality)}"
        )
    variable = drive.variable(name)
    numbers = (*REAL_TYPES, *INTEGER_TYPES, "Boolean")
    if any_type and variable.type not in numbers:
        raise InputError(f"{name} of the FMU {drive.name} is {variable.type}; expected a number")
    if not any_type and variable.type not in REAL_TYPES:
        raise InputError(
            f"{name} of the FMU {drive.name} is {variable.type}; expected a real number of double "
            "precision (Real, Float64)"
        )
    if causality and variable.causality != causality:
        raise InputError(
            f"{name} of the FMU {drive.name} is of causality {variable.causality}; "
            f"expected {format_candidates(drive, causality)}"
        )
    return variable


def format_candidates(drive: Description, causality: str) -> str:
    names = [name for name, one in drive.variables.items() if causality in ("", one.causality)]
    listed = ", ".join(names[:8]) + (", ..." if len(names) > 8 else "")
    return f"one of its {f'{causality}s' if causality else 'variables'}: {listed or 'it has none'}"


def factor_to_si(drive: Description, ours: str, theirs: str, units: Mapping[str, str]) -> float:
    """Return what one of the drive's unit is in SI; raise ``InputError`` for another quantity."""
    name = units.get(theirs, drive.variable(theirs).unit or "")
    unit = parse_unit(name) if theirs in units else drive.units.get(name)
    if not name:
        return 1.0
    if unit is None or unit.exponents != EXPONENTS[ours]:
        fits = [one for one in MOTION if unit is not None and unit.exponents == EXPONENTS[one]]
        hint = f" ({name}: {fits[0]}?)" if fits else ""
        if unit is None:
            hint = f"; this unit is not known: state it, as units={{{theirs!r}: {UNITS[ours]!r}}}"
        raise InputError(
            f"{theirs} of the FMU {drive.name} is in {name}; {ours} expects {UNITS[ours]}{hint}"
        )
    return unit.factor


def suggest_similar(name: str, known: Iterable[str]) -> str:
    return did_you_mean(*difflib.get_close_matches(name, list(known), 3))


def propose_connections(drive: Description) -> dict[str, str]:
    """Return by our names the drive's variables that are likely meant, by unit and name.

    - An input (force) or output (motion) whose unit is of the same dimension is likely, whose name
      looks most like ours first; where none has a unit, one with a part that abbreviates ours.
    - Derivatives of the force are proposed only by our own names, no variable is proposed twice,
      and without a motion and a force nothing is.
    """
    proposed: dict[str, str] = {}
    for ours in OURS:
        ranks = {}
        for name, variable in drive.variables.items():
            unit = drive.units.get(variable.unit or "")
            theirs = unit and unit.exponents
            rank = name_similarity(ours.partition("_")[2], name)
            fits = theirs == EXPONENTS[ours] or (theirs is None and rank == 1.0)
            fits = fits and variable.type in REAL_TYPES and name not in proposed.values()
            if fits and variable.causality == ("input" if ours in FORCE else "output"):
                ranks[name] = (theirs is not None, rank)
        if ranks and (ours not in FORCE[1:] or ours in ranks):
            proposed[ours] = ours if ours in ranks else max(ranks, key=lambda name: ranks[name])
    return proposed if FORCE[0] in proposed and set(MOTION) & set(proposed) else {}


def explain_proposal(drive: Description, ours: str, theirs: str) -> str:
    variable = drive.variable(theirs)
    if ours == theirs:
        return "has the same name"
    alike = name_similarity(ours.partition("_")[2], theirs) == 1.0
    has_unit = variable.unit in drive.units
    reasons = [f"{variable.causality} in {variable.unit}"] * has_unit + ["a name like it"] * alike
    return " and ".join(reasons)


def name_similarity(word: str, name: str) -> float:
    """Return how much a name looks like a word: 1 where a part of it abbreviates the word."""
    parts = [part for part in re.split(r"[^a-z]+", name.lower()) if len(part) > 2]
    if any(word.startswith(part) or part.startswith(word) for part in parts):
        return 1.0
    return difflib.SequenceMatcher(None, word, name.lower()).ratio()
