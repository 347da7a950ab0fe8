"""Limits of stable responses: where the sweeps pass them, and where they are exactly."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .claim import LIMIT, Finding, border, claim, number_at, rounds_to
from .results import Results, impacts_in_response, kind, lower_edge, upper_edge

SWEEP = "up-sweep, multiplicity and impacts"
BRANCH = f"{SWEEP}; branch"
LAST_CONTACT = "up-sweep, last eta with contact; branch"


def limit(
    section: str,
    text: str,
    printed: str,
    find: Callable[..., Finding],
    *where: str | float,
    how: str = BRANCH,
    tolerance: str = LIMIT,
    full: bool = True,
) -> None:
    """Enter a claim whose printed number one of the functions below is to find.

    Parameters
    ----------
    section, text, printed
        Of the claim.
    find : callable
        From the results, the printed number and ``where`` to a finding.
    *where
        Case, orbit mT/k, a frequency inside of its window.
    how, tolerance, full
        Of the claim.
    """
    enter = claim(section, text, printed, how, tolerance, full)
    enter(lambda results: find(results, printed, *where))


def contact_end(results: Results, printed: str, case: str, inside: float) -> Finding:
    """Find where permanent contact ends; the sentence says how it depends on gamma."""
    up, down = results.up(case), results.down(case)
    low, high = upper_edge(up, up.permanent_contact.values == 1, inside)
    back = upper_edge(down, down.permanent_contact.values == 1, inside)
    gammas = results.get("gamma").last_contact.sel(case=case).values
    slow = results.steady(case).sel(eta=float(printed), method="nearest")
    after = impacts_in_response(up)[int(np.abs(up.eta.values - high).argmin())]
    why = (
        f"Down-sweep: {back[0]:.3f}; gamma from 1e-5 to 5e-2: {np.nanmin(gammas):.3f} to "
        f"{np.nanmax(gammas):.3f}. From {high:.3f} on the "
        f"response is T-periodic without contact, with {after} impacts. At {printed} the "
        "slowest impact closes at "
        f"{float(slow.closing_min / slow.closing_max):.1e} of the fastest, far above the "
        "paper's gamma of 1e-4."
    )
    return border((low, high), results.ends(case, "T, contact", inside), printed, why)


def orbit_end(
    results: Results,
    printed: str,
    case: str,
    orbit: str,
    inside: float,
    slack: float | None = None,
) -> Finding:
    """Find where responses mT/k end upwards, and where on the way down."""
    up, down, numbers = results.up(case), results.down(case), numbers_of(orbit)
    back = upper_edge(down, kind(down, *numbers), inside)
    exact = results.ends(case, orbit, inside)
    edges = upper_edge(up, kind(up, *numbers), inside)
    why = f"On the way down: between {back[0]:.3f} and {back[1]:.3f}."
    if edges[0] > exact.value:
        why += (
            f" The sweep is {edges[0] - exact.value:.3f} beyond the exact limit before it "
            "leaves the orbit: a deviation takes long to grow."
        )
    return border(edges, exact, printed, why, slack)


def orbit_start(
    results: Results, printed: str, case: str, orbit: str, inside: float, both_ways: bool = True
) -> Finding:
    """Find where responses mT/k begin, and where on the way down."""
    up, down, numbers = results.up(case), results.down(case), numbers_of(orbit)
    back = lower_edge(down, kind(down, *numbers), inside)
    why = f"On the way down: between {back[0]:.3f} and {back[1]:.3f}." if both_ways else ""
    edges = lower_edge(up, kind(up, *numbers), inside)
    return border(edges, results.begins(case, orbit, inside), printed, why)


def numbers_of(orbit: str) -> tuple[int, int]:
    """Return m and k of an orbit named mT/k: its periods, and its impacts."""
    periods, impacts = orbit.split("T/")
    return int(periods or 1), int(impacts)


def peak_height(results: Results, printed: str, case: str, digits: int = 4) -> Finding:
    """Find the largest gap of all."""
    return number_at(float(results.up(case).xi_rel_max.max()), printed, digits)


def peak_place(results: Results, printed: str, case: str) -> Finding:
    """Find where the largest gap is, and how much less it is at the printed place."""
    gaps = results.up(case).xi_rel_max
    there, top = float(gaps.sel(eta=float(printed), method="nearest")), float(gaps.max())
    why = (
        f"A flat peak: at {printed} it is {there:.4f}, {100 * (1 - there / top):.4f} % less."
        if not rounds_to(float(gaps.idxmax()), printed)
        else ""
    )
    return number_at(float(gaps.idxmax()), printed, 3, why)
