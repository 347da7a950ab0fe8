"""Limits and peaks that the paper prints: where its sweeps pass them, and where they are."""

from __future__ import annotations

import xarray as xr

from ..claims import Claim, Measured
from ..datasets import Datasets
from ..reading import Edges, edges_of_longest_run, edges_of_run_around, is_on_orbit

AGREES = {
    (True, True): "both",
    (True, False): "the paper's protocol, not the exact limit",
    (False, True): "the exact limit, not the paper's protocol",
    (False, False): "neither",
}


def find_limit(
    data: Datasets,
    claim: Claim,
    case: str,
    orbit: str,
    edge: str,
    inside: float,
    exact: str = "",
    near: float = 0.0,
    slack: float = 0.0,
) -> Measured:
    """Find a limit in the sweep, the middle of two frequencies, and the exact one of a branch."""
    # orbit: "contact", "T" of any impacts, or mT/k; around `inside`, or the longest run where that
    # is 0. exact: the orbit, around `near`, that decides where it is another one; "upper:" before
    # it asks for its other end
    sweeps = data.up_sweep(case), data.down_sweep(case)
    swept, back = (edges_of_orbit(one, orbit, inside) for one in sweeps)
    which, printed = int(edge == "upper"), float(claim.printed)
    slack = slack or claim.rounding_tolerance
    end, _, decides = exact.rpartition(":")
    decides = decides or ("T, contact" if orbit == "contact" else orbit)
    window = data.window_nearest(case, decides, near or inside or 3.0)
    upper = (end or edge) == "upper"
    value, kind = (window.high, window.above) if upper else (window.low, window.below)
    parts = abs(0.5 * sum(swept[which]) - printed) <= slack, abs(value - printed) <= slack
    digits = 6 if "contact" in kind else 8  # a loss of contact depends on gamma
    text = (
        f"sweep: between {swept[which][0]:.3f} and {swept[which][1]:.3f}; exact: "
        f"{value:.{digits}f} ({kind} of {decides}); the paper's number agrees with "
        f"{AGREES[parts]}; downwards {back[which][0]:.3f} to {back[which][1]:.3f}"
    )
    if orbit == "contact":
        last = data.last_eta_with_contact(case)
        text += f"; for gamma from 1e-5 to 5e-2 {last.min():.3f} to {last.max():.3f}"
    return Measured(text, parts)


def edges_of_orbit(sweep: xr.Dataset, orbit: str, inside: float) -> tuple[Edges, Edges]:
    """Return the edges of the run of an orbit's responses, around a frequency or the longest."""
    if orbit == "contact":
        flags = sweep.permanent_contact.values == 1
    else:
        flags = sweep.multiplicity.values == 1 if orbit == "T" else is_on_orbit(sweep, orbit)
    if inside:
        return edges_of_run_around(sweep, flags, inside)
    return edges_of_longest_run(sweep, flags)


def find_peak_height(data: Datasets, claim: Claim, case: str, digits: float) -> Measured:
    largest = float(data.up_sweep(case).xi_rel_max.max())
    return Measured(f"{largest:.{int(digits)}f}", [claim.is_rounded_to_printed(largest)])


def find_peak_frequency(data: Datasets, claim: Claim, case: str) -> Measured:
    """Find the frequency of the largest gap of an up-sweep, and the gap at the printed one."""
    gaps = data.up_sweep(case).xi_rel_max
    place, there = float(gaps.idxmax()), gaps.sel(eta=float(claim.printed), method="nearest")
    text, rounds = f"{place:.3f}", claim.is_rounded_to_printed(place)
    if not rounds:
        less = 100 * (1 - float(there / gaps.max()))
        text += f", down {float(data.down_sweep(case).xi_rel_max.idxmax()):.3f}"
        text += f"; at {claim.printed} the gap is {less:.4f} % less"
    return Measured(text, [rounds])
