"""Checks of sections 3 and 3.1: permanent contact, windows, multiplicity, impacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...response.curves import CONTACT, FLIGHT, SEQUENCE
from ..cases import CASES
from ..later_responses import classify_changes
from ..sweep_windows import relative_peak, runs, window
from .claim import (
    LIMIT,
    NO,
    NUMBER,
    PARTLY,
    YES,
    Finding,
    check_limit,
    check_parts,
    register_claim,
    rounds_to,
)
from .results import (
    Results,
    between,
    impacts_in_response,
    irregular_between,
    is_orbit,
    lower_edge,
    upper_edge,
)

if TYPE_CHECKING:
    import xarray as xr
NOTHING = 1e-6  # of the largest gap or velocity
CHANGE = 0.01  # of the largest gap: what the paper's diagrams resolve
FEW = 0.01  # share of the frequencies


@register_claim(
    "3",
    "only for m_1 = m_2, k_1 = k_2, d_1 = d_2 do both masses vibrate without influence",
    "only then",
    "the FMU from rest: impacts in 2,000 periods at eta = 1.3",
)
def check_only_equal(results: Results) -> Finding:
    """Check whether only equal oscillators vibrate without influencing each other."""
    data = results.get("low_speed")
    alike = data.isel(motion=np.abs(data.kappa.values - data.mu.values) < 1e-12)
    unlike = data.isel(motion=(data.mu.values == 2) & (data.kappa.values != 2))
    equal = alike.mu.values == 1.0
    quiet, knocks = alike.impacts.values == 0, bool((unlike.impacts.values > 0).all())
    parts = [*quiet[equal], *~quiet[~equal], knocks]
    text = "; ".join(
        f"m_2/m_1 = {float(one.mu):g}, k_2/k_1 = {float(one.kappa):g}: {int(one.impacts)} impacts"
        for group in (alike, unlike)
        for one in (group.isel(motion=k) for k in range(group.sizes["motion"]))
    )
    why = (
        "By (7) and (8) it is so for any m_2/m_1 = k_2/k_1 with D_1 = D_2, not for equal ones only."
    )
    return check_parts(parts, text, why if quiet[~equal].any() else "")


@register_claim(
    "3", "natural frequencies of both subsystems", "1 and 1.095, about 10 % apart", "(7)", NUMBER
)
def check_detuning(results: Results) -> Finding:
    """Check the natural frequencies of both halves (7)."""
    case = CASES["elastic"]
    second = (case.kappa / case.mu) ** 0.5
    return Finding(
        f"{second:.4f}, {100 * (second - 1):.1f} % apart",
        YES if rounds_to(second, "1.095") else NO,
    )


@register_claim(
    "3",
    "natural frequencies that differ by about 10 % seem to be the most unfavourable situation",
    "k_2/k_1 = 1.2",
    "map over (eta, kappa): the largest impulse, which a test has to see",
    "10 % of the least",
)
def check_most_unfavourable(results: Results) -> Finding:
    """Check whether impulses are smallest at the paper's detuning."""
    largest = results.get("map_kappa").impulse_max.max("eta")
    own = CASES["elastic"].kappa
    here = float(largest.sel(kappa=own, method="nearest"))
    least, kappa_of_least = float(largest.min()), float(largest.idxmin())
    text = (
        f"largest impulse over eta at k_2/k_1 = {own:g}: {here:.3g} m_1 omega a eta^2; the least "
        f"of {float(largest.kappa.min()):.2f} to {float(largest.kappa.max()):.2f}: {least:.3g} at "
        f"{kappa_of_least:.2f}"
    )
    why = "The more alike the halves are, the weaker their impacts: by (6) alike ones never part."
    return Finding(text, YES if here <= 1.1 * least else NO, why if here > 1.1 * least else "")


@register_claim(
    "3",
    "eta = 0.4: separate motion, a sequence of impacts, permanent contact in each T",
    "three states",
    "Figure 5's data",
)
def check_three_states(results: Results) -> Finding:
    """Check whether Figure 5's response has all three states."""
    kinds = results.get("figure5").kind.values
    steady = results.impact_statistics("elastic").sel(eta=0.4, method="nearest")
    text = (
        f"{float(steady.contacts):.0f} permanent contact and {float(steady.impacts):.0f} impacts "
        "per T"
    )
    return check_parts(
        [bool((kinds == state).any()) for state in (SEQUENCE, CONTACT, FLIGHT)], text
    )


@register_claim(
    "3",
    "Figure 5(a): the phase plot for each mass gives two closed loops",
    "two loops",
    "Figure 5's data: crossings of each curve with itself",
)
def check_two_loops(results: Results) -> Finding:
    """Check that Figure 5(a)'s phase curves close and how often they cross themselves."""
    data = results.get("figure5")
    state = data.state.values
    closed = bool(np.abs(state[-1] - state[0]).max() < 1e-3 * np.abs(state).max())
    counts = [crossings(state[:, mass], state[:, 2 + mass]) for mass in (0, 1)]
    text = f"both close after T: {closed}; they cross themselves {counts[0]} and {counts[1]} times"
    why = (
        "A curve that crosses itself once has two loops: so that of mass 2. Read as one closed "
        "loop of each mass, the sentence holds."
    )
    return check_parts([closed, *(count == 1 for count in counts)], text, why)


@register_claim(
    "3",
    "Figure 5(b): many loops in one response period, each begins and ends at an impact; "
    "contact is a point at the origin",
    "many loops",
    "Figure 5's data: jumps of the velocity, and the gap there",
    "1e-6 of the largest gap and velocity",
)
def check_many_loops(results: Results) -> Finding:
    """Check number, begin and end of the loops in Figure 5(b)'s relative motion."""
    data = results.get("figure5")
    state, kinds, tau = data.state.values, data.kind.values, data.tau.values
    gap, rate = state[:, 1] - state[:, 0], state[:, 3] - state[:, 2]
    jumps = np.flatnonzero((np.diff(tau) == 0.0) & (np.diff(rate) > 0.0))
    size, speed = np.abs(gap).max(), np.abs(rate).max()
    at_zero = bool(np.abs(gap[np.concatenate([jumps, jumps + 1])]).max() < NOTHING * size)
    in_contact = kinds == CONTACT
    point = bool(
        in_contact.any()
        and np.abs(gap[in_contact]).max() < NOTHING * size
        and np.abs(rate[in_contact][1:]).max(initial=0.0) < NOTHING * speed
    )
    released = len([run for run in runs(in_contact) if run[1] < len(kinds) - 1])
    loops = len(jumps)  # each ends at an impact; after a contact one begins without
    text = (
        f"{loops} loops in T, each ends at an impact, a jump of the velocity alone: {at_zero}; "
        f"{loops - released} begin at one, {released} at the end of contact; contact is a point at "
        f"the origin: {point}"
    )
    why = "The loop that begins where contact ends begins without an impact and without a jump."
    return check_parts([loops > 10, at_zero, point, released == 0], text, why if released else "")


@register_claim(
    "3",
    "transition to permanent contact at gamma = 1e-4 max xi'_Rel",
    "1e-4",
    "Figure 5's data; short sweeps with other gamma",
    "1 % of T; one step of the sweep",
)
def check_gamma_scale(results: Results) -> Finding:
    """Check where the paper's gamma would end chattering at eta = 0.4, beside the FMU."""
    data = results.get("figure5")
    tau, state = data.tau.values, data.state.values
    rate = state[:, 3] - state[:, 2]
    jumps = np.flatnonzero((np.diff(tau) == 0.0) & (rate[1:] > rate[:-1]))
    slow = jumps[rate[jumps + 1] < 1e-4 * np.abs(rate).max()]
    begins = tau[np.flatnonzero(data.kind.values == CONTACT)[0]]
    parting = tau[slow[0]] if len(slow) else np.nan
    gammas = results.get("gamma").last_contact.values
    spread = float((gammas.max(axis=1) - gammas.min(axis=1)).max())
    text = (
        f"by 1e-4 max xi'_Rel contact begins at tau = {parting:.4f}, in the FMU at {begins:.4f}; "
        f"limits of contact change by {spread:.3f} at most for gamma from 1e-5 to 5e-2"
    )
    why = (
        "max xi'_Rel is not known before the motion is; the FMU compares the next flight's time "
        "with the motion's own, which needs no scale."
    )
    return check_parts([abs(parting - begins) < 0.01 * tau[-1], spread <= 0.001 + 1e-9], text, why)


@register_claim(
    "3.1",
    "n = 500 periods eliminate transient effects",
    "500",
    "the sweep's responses run on to n = 5,000, and to 50,000 at 100 frequencies drawn by "
    "chance: multiplicity, impacts, largest gap",
    "others at 1 % of the frequencies up to the end of the window T, and beyond it",
    full=True,
)
def check_enough_periods(results: Results) -> Finding:
    """Check whether 500 periods of transient suffice, by running responses on."""
    up, end = results.up("elastic"), results.upper_limit("elastic", "T/1", 2.0).value
    later, latest = (
        results.dataset_of_case(name, "elastic", "_up") for name in ("later", "latest")
    )
    text, parts = [], []
    for low, high in ((float(up.eta.min()), end), (end, float(up.eta.max()))):
        others, count, which = count_changed(up, between(later, low, high))
        text.append(f"{others} of {count} frequencies from {low:.3f} to {high:.3f}{which}")
        parts.append(others <= FEW * count)
    others, count, which = count_changed(up, latest)
    late = f"after n = {first_sample(up, latest):,} {others} of {count} drawn by chance{which}"
    why = (
        "Each response was run on from where the sweep left it. A deviation decays as e^(-D tau), "
        f"and 500 periods are {500.0 * 2.0 * np.pi / end:.0f} of tau at {end:.2f}, but "
        f"{500.0 * 2.0 * np.pi / 8.0:.0f} at 8: there many a response nears its orbit still."
    )
    value = f"after n = {first_sample(up, later):,} others at {'; at '.join(text)}; {late}"
    return check_parts(parts, value, why if not all(parts) else "")


def first_sample(up: xr.Dataset, later: xr.Dataset) -> int:
    """Return the number of the excitation period at which a later run's samples begin."""
    done = int(up.attrs["transient"]) + up.sizes["sample"]
    return done + int(later.attrs["transient"]) + 1


def count_changed(up: xr.Dataset, later: xr.Dataset) -> tuple[int, int, str]:
    """Count responses that are different later; return count, total and a text on kinds."""
    kinds = {what: int(part.sum()) for what, part in classify_changes(up, later, CHANGE).items()}
    named = ", ".join(f"{count} {what}" for what, count in kinds.items() if count)
    return sum(kinds.values()), later.sizes["eta"], f" ({named})" if named else ""


def crossings(x: np.ndarray, y: np.ndarray) -> int:
    """Return how often a closed polygon crosses itself."""
    points = x + 1j * y
    begin, piece = points[:-1], np.diff(points)
    count = 0
    for i in range(len(piece) - 2):
        offset = begin[i + 2 :] - begin[i]
        turn = (piece[i].conjugate() * piece[i + 2 :]).imag
        with np.errstate(divide="ignore", invalid="ignore"):
            here = (offset.conjugate() * piece[i + 2 :]).imag / turn
            there = (offset.conjugate() * piece[i]).imag / turn
        inside = (here > 0.0) & (here < 1.0) & (there > 0.0) & (there < 1.0)
        count += int(inside[: -1 if i == 0 else None].sum())
    return count


@register_claim(
    "3.1",
    "permanent contact vanishes",
    "0.43",
    "up-sweep, last eta with contact; branch",
    LIMIT,
    full=True,
)
def check_contact_limit(results: Results) -> Finding:
    """Check the frequency up to which permanent contact occurs."""
    up, gammas = results.up("elastic"), results.get("gamma").last_contact.sel(case="elastic").values
    low, high = upper_edge(up, up.permanent_contact.values == 1, 0.40)
    row = up.sel(eta=0.425, method="nearest")
    slow = results.impact_statistics("elastic").sel(eta=0.43, method="nearest")
    why = (
        f"Chattering stops being complete at {low:.3f}, on the way up and down, whatever gamma: "
        f"{np.nanmin(gammas):.3f} to {np.nanmax(gammas):.3f} "
        f"for 1e-5 to 5e-2. At 0.425 the response has {float(row.impacts_per_period):.0f} impacts "
        "and no contact; at 0.43 the slowest impact closes "
        f"at {float(slow.closing_min / slow.closing_max):.1e} of the fastest, far above the "
        "paper's gamma of 1e-4."
    )
    return check_limit((low, high), results.upper_limit("elastic", "T, contact", 0.4), "0.43", why)


@register_claim(
    "3.1", "T-periodic below", "0.43", "up-sweep, multiplicity 1; branch", LIMIT, full=True
)
def check_periodic_limit(results: Results) -> Finding:
    """Check the frequency up to which responses are T-periodic."""
    up = results.up("elastic")
    near = between(up, 0.415, 0.45)
    others = [
        f"{float(eta):.3f}" for eta, n in zip(near.eta, near.multiplicity, strict=True) if n != 1
    ]
    begins = results.lower_limit("elastic", "T/13", 0.421)
    limit = results.upper_limit("elastic", "T/13", 0.421)
    why = (
        "Frequencies that are not T-periodic come one by one at first: "
        f"{', '.join(others[:6])}, ... The exact limit is that of the T-periodic response with 13 "
        f"impacts, which is stable from {begins.value:.5f} on; "
        "others with fewer impacts follow."
    )
    return check_limit(upper_edge(up, up.multiplicity.values == 1, 0.41), limit, "0.43", why)


@register_claim(
    "3.1", "permanent contact vanishes for all larger eta", "none", "up-sweep", full=True
)
def check_no_contact_above(results: Results) -> Finding:
    """Check that no permanent contact occurs at larger frequencies."""
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


@register_claim(
    "3.1",
    "windows between irregular regions, multiplicity rising by one T",
    "steps of one T",
    "up-sweep: longest window of each; exact limits of one-impact orbits",
    full=True,
)
def check_windows_in_order(results: Results) -> Finding:
    """Check that windows nT with one impact follow each other in order."""
    up = results.up("elastic")
    windows = [window(up, n) for n in range(1, 5)]
    exact = [
        results.window("elastic", f"{n if n > 1 else ''}T/1", 0.5 * (w[0] + w[1]))
        for n, w in enumerate(windows, 1)
        if w
    ]
    text = "; ".join(f"{n}T: {w[0]:.3f} to {w[1]:.3f}" for n, w in enumerate(windows, 1) if w)
    text += "; exact: " + "; ".join(f"{w.low:.5f} to {w.high:.5f}" for w in exact)
    before: tuple[float, float] | None = None
    ordered = []
    for limits in windows:
        ordered.append(
            limits is not None
            and (limits is windows[0] or before is not None)
            and (before is None or irregular_between(up, before[1], limits[0]))
        )
        before = limits
    return check_parts(ordered, text)


@register_claim(
    "3.1", "one impact in a response period at the relative peaks", "one", "Figure 7's data"
)
def check_one_impact_at_peaks(results: Results) -> Finding:
    """Check that Figure 7's responses have one impact per response period."""
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
    return check_parts([abs(count - 20 / n) <= 1 for n, count in enumerate(counts, 1)], text)


@register_claim(
    "3.1",
    "all periodic responses show one impact in a response period",
    "one",
    "settled responses above 1.37",
    full=True,
)
def check_one_impact_everywhere(results: Results) -> Finding:
    """Check that all periodic responses above eta = 1.37 have one impact."""
    settled = between(results.settled("elastic"), 1.37, 8.0)
    up = between(results.up("elastic"), 1.37, 8.0)
    n = settled.multiplicity.values
    counts = np.round(n * settled.impacts_per_period.values).astype(int)
    one, later = np.mean(counts[n > 0] == 1), float(settled.periods.max())
    swept = np.mean(impacts_in_response(up)[up.multiplicity.values > 0] == 1)
    others = settled.eta.values[counts > 1]
    why = (
        f"After the paper's 500 periods {100 * swept:.1f} % of those at all frequencies; run on "
        f"for up to {later:.0f} periods more, at each fifth frequency, as told. Narrow windows "
        f"inside the irregular regions have more impacts: {len(others)} of {len(n)} frequencies."
    )
    return check_parts(
        [one == 1.0, one > 0.5],
        f"{100 * one:.1f} % of the periodic responses above 1.37",
        why if one < 1.0 else "",
    )


@register_claim(
    "3.1",
    "the time between impacts grows by one T from window to window",
    "by one T",
    "impact by impact",
    "0.01 T",
)
def check_impact_distance(results: Results) -> Finding:
    """Check that impacts at the windows' peaks are n periods apart."""
    up, steady = results.up("elastic"), results.impact_statistics("elastic")
    texts, parts = [], []
    for n in range(1, 4):
        eta = relative_peak(up, n)
        if eta is None:
            parts.append(False)
            continue
        row = steady.sel(eta=eta, method="nearest")
        low, high = float(row.distance_min), float(row.distance_max)
        texts.append(f"{low:.3f} to {high:.3f} T at {eta:.3f}")
        parts.append(abs(low - n) < 0.01 and abs(high - n) < 0.01)
    return check_parts(parts, "; ".join(texts))


@register_claim(
    "3.1",
    "relative resonance peaks within the windows (Figure 7)",
    "no numbers",
    "found in the sweep",
)
def check_relative_peaks(results: Results) -> Finding:
    """Check the frequencies of the relative peaks in the windows."""
    data = results.get("figure7")
    text = ", ".join(f"{n}T: {float(eta):.3f}" for n, eta in enumerate(data.eta, 1))
    why = (
        "Each lies near 2n times the main peak's frequency; the one of 4T lies beyond 8.0, where "
        "the sweep was continued to find it."
    )
    return check_parts(
        [abs(float(eta) / (2 * n * 1.047) - 1.0) < 0.03 for n, eta in enumerate(data.eta, 1)],
        text,
        why,
    )


@register_claim(
    "3.2",
    "further irregular regions, each shifting one window to the next",
    "no numbers",
    "up-sweep",
    full=True,
)
def check_other_regions(results: Results) -> Finding:
    """Check that irregular regions lie between the further windows."""
    up = results.up("elastic")
    edges = [
        upper_edge(up, is_orbit(up, n, 1), eta) + lower_edge(up, is_orbit(up, n + 1, 1), after)
        for n, eta, after in ((2, 4.2, 6.2), (3, 6.2, 8.0))
    ]
    text = "; ".join(
        f"{a:.3f} to {d:.3f}, from {n}T to {n + 1}T" for n, (a, _, _, d) in enumerate(edges, 2)
    )
    irregular = [irregular_between(up, b, c) for _, b, c, _ in edges]
    return check_parts(irregular, text)
