"""What was probably meant by a name that is not known, as the end of an error message."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def expected_one_of(name: str, known: Iterable[str]) -> str:
    """Return error text "expected one of ..." with the known names and the closest match."""
    names = list(known)
    return f"expected one of {', '.join(names)}{did_you_mean(closest_name(name, names))}"


def did_you_mean(*names: str) -> str:
    near = " or ".join(filter(None, names))
    return f"; did you mean {near}?" if near else ""


def closest_name(name: str, names: Iterable[str]) -> str:
    """Return the name that begins so, whatever its case, or is most alike; empty if none is."""
    known = {one.lstrip("-"): one for one in sorted(names, key=len)}
    plain = str(name).lstrip("-")
    near = [one for one in known if plain and one.lower().startswith(plain.lower())]
    near = near or difflib.get_close_matches(plain, known, n=1, cutoff=0.5)
    return known[near[0]] if near else ""
