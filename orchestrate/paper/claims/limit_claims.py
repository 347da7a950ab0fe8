"""Checks of claims on limits of responses, in sweeps and as exact bifurcations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .claim import LIMIT, NUMBER, Finding, check_limit, check_number, register_claim, rounds_to
from .results import Results, impacts_in_response, is_orbit, lower_edge, upper_edge

SWEEP = "up-sweep, multiplicity and impacts"
BRANCH = f"{SWEEP}; branch"
LAST_CONTACT = "up-sweep, last eta with contact; branch"


def register_limit(
    section: str,
    text: str,
    printed: str,
    find: Callable[..., Finding],
    *where: str | float,
    how: str = BRANCH,
    tolerance: str = LIMIT,
    full: bool = True,
) -> None:
    """Add a claim on a printed limit, checked by one of this module's functions."""
    enter = register_claim(section, text, printed, how, tolerance, full)
    enter(lambda results: find(results, printed, *where))


def register_contact_end(section: str, printed: str, case: str, inside: float) -> None:
    """Add the claim on the frequency at which a case's permanent contact ends."""
    text = "T-periodic with permanent contact below"
    register_limit(section, text, printed, contact_end, case, inside, how=LAST_CONTACT)


def register_peak(section: str, case: str, height: str, place: str) -> None:
    """Add the claims on the size and the frequency of a case's largest gap."""
    settings: Any = {"tolerance": NUMBER, "full": False}
    how = "up-sweep, exact"
    register_limit(section, "max xi_Rel", height, peak_height, case, how=how, **settings)
    register_limit(section, "its place", place, peak_frequency, case, how="up-sweep", **settings)


def contact_end(results: Results, printed: str, case: str, inside: float) -> Finding:
    """Check where permanent contact ends: in sweeps, exactly, and its dependence on gamma."""
    up, down = results.up(case), results.down(case)
    low, high = upper_edge(up, up.permanent_contact.values == 1, inside)
    back = upper_edge(down, down.permanent_contact.values == 1, inside)
    gammas = results.get("gamma").last_contact.sel(case=case).values
    slow = results.impact_statistics(case).sel(eta=float(printed), method="nearest")
    after = impacts_in_response(up)[int(np.abs(up.eta.values - high).argmin())]
    why = (
        f"Down-sweep: {back[0]:.3f}; gamma from 1e-5 to 5e-2: {np.nanmin(gammas):.3f} to "
        f"{np.nanmax(gammas):.3f}. From {high:.3f} on the "
        f"response is T-periodic without contact, with {after} impacts. At {printed} the "
        "slowest impact closes at "
        f"{float(slow.closing_min / slow.closing_max):.1e} of the fastest, far above the "
        "paper's gamma of 1e-4."
    )
    return check_limit((low, high), results.upper_limit(case, "T, contact", inside), printed, why)


def orbit_end(
    results: Results,
    printed: str,
    case: str,
    orbit: str,
    inside: float,
    slack: float | None = None,
) -> Finding:
    """Check the frequency at which responses mT/k end, in sweeps and exactly."""
    up, down, numbers = results.up(case), results.down(case), parse_orbit_name(orbit)
    back = upper_edge(down, is_orbit(down, *numbers), inside)
    exact = results.upper_limit(case, orbit, inside)
    edges = upper_edge(up, is_orbit(up, *numbers), inside)
    why = f"On the way down: between {back[0]:.3f} and {back[1]:.3f}."
    if edges[0] > exact.value:
        why += (
            f" The sweep is {edges[0] - exact.value:.3f} beyond the exact limit before it "
            "leaves the orbit: a deviation takes long to grow."
        )
    return check_limit(edges, exact, printed, why, slack)


def orbit_start(
    results: Results, printed: str, case: str, orbit: str, inside: float, both_ways: bool = True
) -> Finding:
    """Check the frequency at which responses mT/k begin, in sweeps and exactly."""
    up, down, numbers = results.up(case), results.down(case), parse_orbit_name(orbit)
    back = lower_edge(down, is_orbit(down, *numbers), inside)
    why = f"On the way down: between {back[0]:.3f} and {back[1]:.3f}." if both_ways else ""
    edges = lower_edge(up, is_orbit(up, *numbers), inside)
    return check_limit(edges, results.lower_limit(case, orbit, inside), printed, why)


def parse_orbit_name(orbit: str) -> tuple[int, int]:
    """Return m and k of an orbit named mT/k: its periods and impacts."""
    periods, impacts = orbit.split("T/")
    return int(periods or 1), int(impacts)


def peak_height(results: Results, printed: str, case: str, digits: int = 4) -> Finding:
    """Check the size of the largest gap of an up-sweep."""
    return check_number(float(results.up(case).xi_rel_max.max()), printed, digits)


def peak_frequency(results: Results, printed: str, case: str) -> Finding:
    """Check the frequency of the largest gap of an up-sweep."""
    gaps = results.up(case).xi_rel_max
    there, top = float(gaps.sel(eta=float(printed), method="nearest")), float(gaps.max())
    why = (
        f"A flat peak: at {printed} it is {there:.4f}, {100 * (1 - there / top):.4f} % less."
        if not rounds_to(float(gaps.idxmax()), printed)
        else ""
    )
    return check_number(float(gaps.idxmax()), printed, 3, why)
