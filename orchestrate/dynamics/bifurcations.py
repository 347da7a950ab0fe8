"""Kinds of bifurcations of periodic orbits: their numbers and names in results."""

from __future__ import annotations

from enum import IntEnum


class BifurcationKind(IntEnum):
    """Kinds of bifurcation on a branch of orbits, by their numbers in results."""

    FOLD = 0
    FLIP = 1
    TORUS = 2
    GRAZING = 3
    TOUCHING = 4
    CONTACT_LOST = 5
    CONTACT_BEGUN = 6
    EARLIER_RELEASE = 7
    HALVING = 8

    @property
    def label(self) -> str:
        """Return the kind's name in words, such as "period doubling"."""
        return KINDS[self]


FOLD, FLIP, TORUS, GRAZING, TOUCHING, *_ = BifurcationKind
*_, CONTACT_LOST, CONTACT_BEGUN, EARLIER_RELEASE, HALVING = BifurcationKind
KINDS: dict[int, str] = {
    FOLD: "fold",
    FLIP: "period doubling",
    TORUS: "Neimark-Sacker",
    GRAZING: "grazing of an impact",  # its closing speed falls to zero
    TOUCHING: "grazing of a flight",  # the gap falls to zero between two impacts
    CONTACT_LOST: "loss of permanent contact",
    CONTACT_BEGUN: "begin of permanent contact",
    EARLIER_RELEASE: "earlier release",  # the contact force (18) falls to zero in permanent contact
    HALVING: "period halving",  # it has become the orbit of half its period, which doubles there
}
