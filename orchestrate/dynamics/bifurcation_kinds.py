"""Kinds of bifurcations of periodic orbits: their numbers and names in results."""

from __future__ import annotations

from enum import IntEnum


class NamedKind(IntEnum):
    """Base of kinds with a number in results, and a name in words."""

    label: str

    def __new__(cls, number: int, label: str) -> NamedKind:
        kind = int.__new__(cls, number)
        kind._value_, kind.label = number, label
        return kind


class Kind(NamedKind):
    """Kinds of bifurcation on a branch of orbits."""

    FOLD = 0, "fold"
    FLIP = 1, "period doubling"
    TORUS = 2, "Neimark-Sacker"
    GRAZING = 3, "grazing of an impact"  # its closing speed falls to zero
    TOUCHING = 4, "grazing of a flight"  # the gap falls to zero between two impacts
    CONTACT_LOST = 5, "loss of permanent contact"
    CONTACT_BEGUN = 6, "begin of permanent contact"
    EARLIER_RELEASE = 7, "earlier release"  # the contact force (18) falls to zero in contact
    HALVING = 8, "period halving"  # it has become the orbit of half its period


KINDS: dict[int, str] = {kind: kind.label for kind in Kind}
