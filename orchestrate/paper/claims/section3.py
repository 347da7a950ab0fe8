"""Claims of section 3 and 3.1: permanent contact, windows, multiplicity and impacts."""

from __future__ import annotations

import numpy as np

from ...response.curves import CONTACT, FLIGHT, SEQUENCE
from ..cases import CASES
from ..windows import relative_peak, window
from .claim import NO, PARTLY, YES, Claim, Finding, holds, limit_at, rounds_to
from .results import Results, between, impacts_in_response, kind, lower_edge, upper_edge

LIMIT = "half a unit of the last printed digit, within one step of the sweep"
NUMBER = "half a unit of the last printed digit"


def detuning(results: Results) -> Finding:
    """Natural frequencies of both subsystems, (7)."""
    case = CASES["elastic"]
    second = (case.kappa / case.mu) ** 0.5
    return Finding(
        f"{second:.4f}, {100 * (second - 1):.1f} % apart",
        YES if rounds_to(second, "1.095") else NO,
    )


def three_states(results: Results) -> Finding:
    """Figure 5's three states."""
    kinds = results.get("figure5").kind.values
    steady = results.steady("elastic").sel(eta=0.4, method="nearest")
    found = (
        f"{float(steady.contacts):.0f} permanent contact and {float(steady.impacts):.0f} impacts "
        "per T"
    )
    return holds([bool((kinds == state).any()) for state in (SEQUENCE, CONTACT, FLIGHT)], found)


def contact_limit(results: Results) -> Finding:
    """Where permanent contact ends on the way up."""
    up, gammas = results.up("elastic"), results.get("gamma").last_contact.sel(case="elastic").values
    low, high = upper_edge(up, up.permanent_contact.values == 1, 0.40)
    row = up.sel(eta=0.425, method="nearest")
    slow = results.steady("elastic").sel(eta=0.43, method="nearest")
    why = (
        f"Chattering stops being complete at {low:.3f}, on the way up and down, whatever gamma: "
        f"{np.nanmin(gammas):.3f} to {np.nanmax(gammas):.3f} "
        f"for 1e-5 to 5e-2. At 0.425 the response has {float(row.impacts_per_period):.0f} impacts "
        "and no contact; at 0.43 the slowest impact closes "
        f"at {float(slow.closing_min / slow.closing_max):.1e} of the fastest, far above the "
        "paper's gamma of 1e-4."
    )
    return limit_at((low, high), "0.43", why)


def periodic_limit(results: Results) -> Finding:
    """Where T-periodicity ends on the way up."""
    up = results.up("elastic")
    near = between(up, 0.415, 0.45)
    others = [
        f"{float(eta):.3f}" for eta, n in zip(near.eta, near.multiplicity, strict=True) if n != 1
    ]
    why = (
        f"Frequencies that are not T-periodic come one by one at first: {', '.join(others[:6])}, "
        "..."
    )
    return limit_at(upper_edge(up, up.multiplicity.values == 1, 0.41), "0.43", why)


def no_contact_above(results: Results) -> Finding:
    """Whether contact occurs again above."""
    up = results.up("elastic")
    part = between(up, 0.43, 8.0)
    again = part.eta.values[part.permanent_contact.values == 1]
    if not len(again):
        return Finding("none", YES)
    why = (
        f"Inside the irregular regions {len(again)} frequencies from {again.min():.3f} to "
        f"{again.max():.3f} chatter into contact now and then."
    )
    none_below = not (again < 2.6).any()
    return Finding(
        f"none from 0.43 to 2.6: {none_below}; {len(again)} frequencies above",
        PARTLY if none_below else NO,
        why,
    )


def windows_in_order(results: Results) -> Finding:
    """Windows nT with one impact, in order."""
    up = results.up("elastic")
    found = [window(up, n) for n in range(1, 5)]
    text = "; ".join(f"{n}T: {w[0]:.3f} to {w[1]:.3f}" for n, w in enumerate(found, 1) if w)
    before: tuple[float, float] | None = None
    ordered = []
    for limits in found:
        ordered.append(limits is not None and (before is None or before[1] < limits[0]))
        before = limits
    return holds(ordered, text)


def one_impact_at_peaks(results: Results) -> Finding:
    """Impacts at the peaks of Figure 7."""
    data = results.get("figure7")
    counts = []
    for index in range(data.sizes["panel"]):
        state = data.state.values[data.panel_of.values == index]
        jumps = (state[1:, 2] != state[:-1, 2]) & (
            np.diff(data.tau.values[data.panel_of.values == index]) == 0.0
        )
        counts.append(int(jumps.sum()))
    text = ", ".join(
        f"{count} in 20 T at {float(eta):.3f}" for count, eta in zip(counts, data.eta, strict=True)
    )
    return holds([abs(count - 20 / n) <= 1 for n, count in enumerate(counts, 1)], text)


def one_impact_everywhere(results: Results) -> Finding:
    """Whether all periodic responses above 1.37 have one impact."""
    up = between(results.up("elastic"), 1.37, 8.0)
    periodic, counts = up.multiplicity.values > 0, impacts_in_response(up)
    one = np.mean(counts[periodic] == 1)
    others = up.eta.values[periodic & (counts > 1)]
    why = (
        f"Narrow windows inside the irregular regions have more: {len(others)} frequencies, as 3T "
        "with three at 2.737 or 4T with three at 3.49."
    )
    return Finding(
        f"{100 * one:.1f} % of the periodic responses above 1.37",
        YES if one == 1.0 else PARTLY,
        why if one < 1.0 else "",
    )


def impact_distance(results: Results) -> Finding:
    """Times between impacts at the peaks of the windows."""
    up, steady = results.up("elastic"), results.steady("elastic")
    found, parts = [], []
    for n in range(1, 4):
        eta = relative_peak(up, n)
        if eta is None:
            parts.append(False)
            continue
        row = steady.sel(eta=eta, method="nearest")
        low, high = float(row.distance_min), float(row.distance_max)
        found.append(f"{low:.3f} to {high:.3f} T at {eta:.3f}")
        parts.append(abs(low - n) < 0.01 and abs(high - n) < 0.01)
    return holds(parts, "; ".join(found))


def relative_peaks(results: Results) -> Finding:
    """Where the relative peaks are."""
    data = results.get("figure7")
    text = ", ".join(f"{n}T: {float(eta):.3f}" for n, eta in enumerate(data.eta, 1))
    why = (
        "Each lies near 2n times the main peak's frequency; the one of 4T lies beyond 8.0, where "
        "the sweep was continued to find it."
    )
    return holds(
        [abs(float(eta) / (2 * n * 1.047) - 1.0) < 0.03 for n, eta in enumerate(data.eta, 1)],
        text,
        why,
    )


def other_regions(results: Results) -> Finding:
    """The irregular regions beyond the second."""
    up = results.up("elastic")
    edges = [
        upper_edge(up, kind(up, n, 1), eta) + lower_edge(up, kind(up, n + 1, 1), after)
        for n, eta, after in ((2, 4.2, 6.2), (3, 6.2, 8.0))
    ]
    text = "; ".join(
        f"{a:.3f} to {d:.3f}, from {n}T to {n + 1}T" for n, (a, _, _, d) in enumerate(edges, 2)
    )
    return holds([bool(np.isfinite(edge).all()) for edge in edges], text)


CLAIMS = (
    Claim(
        "3",
        "natural frequencies of both subsystems",
        "1 and 1.095, about 10 % apart",
        "(7)",
        NUMBER,
        detuning,
    ),
    Claim(
        "3",
        "eta = 0.4: separate motion, a sequence of impacts, permanent contact in each T",
        "three states",
        "Figure 5's data",
        "-",
        three_states,
    ),
    Claim(
        "3.1",
        "permanent contact vanishes",
        "0.43",
        "up-sweep, last eta with contact",
        LIMIT,
        contact_limit,
    ),
    Claim("3.1", "T-periodic below", "0.43", "up-sweep, multiplicity 1", LIMIT, periodic_limit),
    Claim(
        "3.1",
        "permanent contact vanishes for all larger eta",
        "none",
        "up-sweep",
        "-",
        no_contact_above,
    ),
    Claim(
        "3.1",
        "windows between irregular regions, multiplicity rising by one T",
        "T, 2T, 3T, 4T",
        "up-sweep: longest window of each",
        "-",
        windows_in_order,
    ),
    Claim(
        "3.1",
        "one impact in a response period at the relative peaks",
        "one",
        "Figure 7's data",
        "-",
        one_impact_at_peaks,
    ),
    Claim(
        "3.1",
        "all periodic responses show one impact in a response period",
        "one",
        "up-sweep above 1.37",
        "-",
        one_impact_everywhere,
    ),
    Claim(
        "3.1",
        "the time between impacts grows by one T from window to window",
        "T, 2T, 3T",
        "impact by impact",
        "0.01 T",
        impact_distance,
    ),
    Claim(
        "3.1",
        "relative resonance peaks within the windows (Figure 7)",
        "no numbers",
        "found in the sweep",
        "-",
        relative_peaks,
    ),
    Claim(
        "3.2",
        "further irregular regions, each shifting one window to the next",
        "no numbers",
        "up-sweep",
        "-",
        other_regions,
    ),
)
