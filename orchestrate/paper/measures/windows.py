"""Sections 3, 3.1 and 4: contact, loops, windows of periodic responses, their multiplicity."""

from __future__ import annotations

import numpy as np
import xarray as xr

from .. import reading
from ..cases import CASES
from ..claims import Claim, Measured
from ..curves import CONTACT, FLIGHT, SEQUENCE
from ..datasets import Datasets

NOTHING = 1e-6  # of the largest gap or velocity


def count_impacts_of_equal_halves(data: Datasets, claim: Claim) -> Measured:
    """Count impacts of halves that are equal, alike, or not alike."""
    rows = data.slow_impact_counts().isel(motion=slice(-3, None))
    names = rows.mu.values, rows.kappa.values, rows.impacts.values
    listed = [(mu, kappa, int(count)) for mu, kappa, count in zip(*names, strict=True)]
    text = "; ".join(f"m_2/m_1 = {m:g}, k_2/k_1 = {k:g}: {count} impacts" for m, k, count in listed)
    equal = [(mu, kappa) == (1.0, 1.0) for mu, kappa, _ in listed]
    parts = [(count == 0) == same for (*_, count), same in zip(listed, equal, strict=True)]
    return Measured(text, parts)


def compute_detuning(data: Datasets, claim: Claim) -> Measured:
    """Calculate the natural frequencies of both halves (7)."""
    case = CASES["elastic"]
    second = (case.kappa / case.mu) ** 0.5
    apart = 100.0 * (second - 1.0)
    parts = [abs(second - 1.095) <= 0.0005 + 1e-9, abs(apart - 10.0) < 1.0]
    return Measured(f"{second:.4f}, {apart:.1f} % apart", parts)


def compare_impulses_over_detuning(data: Datasets, claim: Claim) -> Measured:
    """Compare the largest impulse at the paper's detuning with the least of the map."""
    largest, own = data.map("kappa").impulse_max.max("eta"), CASES["elastic"].kappa
    here, least = float(largest.sel(kappa=own, method="nearest")), float(largest.min())
    text = (
        f"largest impulse over eta at k_2/k_1 = {own:g}: {here:.3g} m_1 omega a eta^2; the least "
        f"of {float(largest.kappa.min()):.2f} to {float(largest.kappa.max()):.2f}: {least:.3g} at "
        f"{float(largest.idxmin()):.2f}"
    )
    return Measured(text, [here <= 1.1 * least])


def find_three_states(data: Datasets, claim: Claim) -> Measured:
    """Look for flights, a sequence of impacts and contact in Figure 5's response."""
    kinds = data.figure_curves("5").kind.values
    row = data.impact_statistics("elastic").sel(eta=0.4, method="nearest")
    text = f"{float(row.contacts):.0f} permanent contact and {float(row.impacts):.0f} impacts per T"
    return Measured(text, [bool((kinds == state).any()) for state in (SEQUENCE, CONTACT, FLIGHT)])


def count_loops_of_masses(data: Datasets, claim: Claim) -> Measured:
    """Count how often Figure 5(a)'s closed phase curves cross themselves."""
    state = data.figure_curves("5").state.values
    closed = bool(np.abs(state[-1] - state[0]).max() < 1e-3 * np.abs(state).max())
    counts = [count_self_crossings(state[:, mass], state[:, 2 + mass]) for mass in (0, 1)]
    text = f"both close after T: {closed}; they cross themselves {counts[0]} and {counts[1]} times"
    return Measured(text, [closed, *(count == 1 for count in counts)])


def count_self_crossings(x: np.ndarray, y: np.ndarray) -> int:
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


def count_loops_of_gap(data: Datasets, claim: Claim) -> Measured:
    """Count the loops of Figure 5(b)'s relative motion, and how they begin and end."""
    figure = data.figure_curves("5")
    state, kinds = figure.state.values, figure.kind.values
    gap, rate = state[:, 1] - state[:, 0], state[:, 3] - state[:, 2]
    jumps = np.flatnonzero((np.diff(figure.tau.values) == 0.0) & (np.diff(rate) > 0.0))
    size, speed, in_contact = np.abs(gap).max(), np.abs(rate).max(), kinds == CONTACT
    around = np.abs(gap[np.concatenate([jumps, jumps + 1])])
    at_zero = bool(around.max(initial=0.0) < NOTHING * size)
    point = bool(
        in_contact.any()
        and np.abs(gap[in_contact]).max() < NOTHING * size
        and np.abs(rate[in_contact][1:]).max(initial=0.0) < NOTHING * speed
    )
    released = len([run for run in reading.runs_of_true(in_contact) if run[1] < len(kinds) - 1])
    loops = len(jumps)  # each ends at an impact; after a contact one begins without
    text = (
        f"{loops} loops in T, each ends at an impact, a jump of only the velocity: {at_zero}; "
        f"{loops - released} begin at one, {released} at the end of contact; contact is a point at "
        f"the origin: {point}"
    )
    return Measured(text, [loops > 10, at_zero, point, released == 0])


def find_end_of_chattering(data: Datasets, claim: Claim) -> Measured:
    """Find where the paper's gamma ends chattering at eta = 0.4, and what other gammas change."""
    figure = data.figure_curves("5")
    tau, state = figure.tau.values, figure.state.values
    rate, contact = state[:, 3] - state[:, 2], figure.kind.values == CONTACT
    jumps = np.flatnonzero((np.diff(tau) == 0.0) & (np.diff(rate) > 0.0))
    slow = jumps[rate[jumps + 1] < 1e-4 * np.abs(rate).max()]
    begins = tau[contact.argmax()] if contact.any() else np.nan
    parting = tau[slow[0]] if len(slow) else np.nan
    last = [data.last_eta_with_contact(case) for case in CASES]
    spread = float(np.max([one.max() - one.min() for one in last]))
    text = (
        f"by 1e-4 max xi'_Rel contact begins at tau = {parting:.4f}, in the FMU at {begins:.4f}; "
        f"limits of contact change by {spread:.3f} at most for gamma from 1e-5 to 5e-2"
    )
    return Measured(text, [abs(parting - begins) < 0.01 * tau[-1], spread <= 0.001 + 1e-9])


def count_responses_that_change(data: Datasets, claim: Claim) -> Measured:
    """Count responses of the sweep that are others after more periods."""
    up, end = data.up_sweep("elastic"), data.window_nearest("elastic", "T/1", 2.0).high
    first, most = data.size.later, data.size.latest
    later, latest = data.continued_sweep(first), data.continued_sweep(most, 100)
    text, parts = [], []
    for low, high in ((float(up.eta.min()), end), (end, float(up.eta.max()))):
        part = reading.between(later, low, high)
        others, kinds = count_changes(up, part)
        total = part.sizes["eta"]
        text.append(f"{others} of {total} frequencies from {low:.3f} to {high:.3f}{kinds}")
        parts.append(others <= 0.01 * total)  # share of the frequencies
    others, kinds = count_changes(up, latest)
    found = (
        f"after n = {first:,} others at {'; at '.join(text)}; after n = {most:,} {others} of "
        f"{latest.sizes['eta']} drawn by chance{kinds}"
    )
    return Measured(found, parts)


def count_changes(swept: xr.Dataset, later: xr.Dataset) -> tuple[int, str]:
    """Return how many responses have changed later, and a text on how many in which way."""
    first = swept.sel(eta=later.eta.values, method="nearest")
    before, after = first.multiplicity.values, later.multiplicity.values
    both = (before > 0) & (after > 0)
    counts = first.impacts_per_period.values - later.impacts_per_period.values
    kind = both & ((before != after) | (np.abs(counts) > 3.0 / swept.sizes["sample"]))
    # what the paper's diagrams resolve
    size = np.abs(later.xi_rel_max.values / first.xi_rel_max.values - 1.0) > 0.01
    kinds = {
        "irregular, later periodic": (before == 0) & (after > 0),
        "periodic, later irregular": (before > 0) & (after == 0),
        "periodic, later with another period or other impacts": kind,
        "of another size later": both & ~kind & size,
    }
    named = [f"{flags.sum()} {words}" for words, flags in kinds.items() if flags.any()]
    total = int(sum(flags.sum() for flags in kinds.values()))
    return total, f" ({', '.join(named)})" if named else ""


def count_contacts_above_limit(data: Datasets, claim: Claim) -> Measured:
    """Count frequencies above the limit of contact that chatter into contact."""
    part = reading.between(data.up_sweep("elastic"), 0.43, 8.0)
    again = part.eta.values[part.permanent_contact.values == 1]
    low, ends = (again < 2.6).sum(), f" up to {again.max():.3f}" if len(again) else ""
    text = f"{low} frequencies from 0.43 to 2.6, {len(again) - low} above{ends}"
    return Measured(text, [low == 0, not len(again)])


def find_windows(data: Datasets, claim: Claim) -> Measured:
    """Find the windows nT with one impact, irregular responses between them, and exact limits."""
    up = data.up_sweep("elastic")
    edges, names = reading.window_edges(up), ["T/1", "2T/1", "3T/1", "4T/1"]
    text = "; ".join(f"{n}T: {a[1]:.3f} to {b[0]:.3f}" for n, (a, b) in enumerate(edges, 1))
    middles = [0.5 * (a[1] + b[0]) for a, b in edges]
    exact = [data.window_nearest("elastic", *which) for which in zip(names, middles, strict=True)]
    text += "; exact: " + "; ".join(f"{w.low:.5f} to {w.high:.5f}" for w in exact)
    return Measured(text, reading.are_windows_separated(up))


def count_impacts_at_relative_peaks(data: Datasets, claim: Claim) -> Measured:
    """Count the impacts of Figure 7's responses in 20 T."""
    figure, texts, parts = data.figure_curves("7"), [], []
    for index, eta in enumerate(figure.eta.values.tolist()):
        there = figure.panel_of.values == index
        jump = np.diff(figure.state.values[there, 2]) != 0.0
        count = int((jump & (np.diff(figure.tau.values[there]) == 0.0)).sum())
        texts.append(f"{count} in 20 T at {eta:.3f}")
        parts.append(abs(count - 20 / (index + 1)) <= 1)
    return Measured(", ".join(texts), parts)


def measure_share_with_one_impact(data: Datasets, claim: Claim) -> Measured:
    """Measure the share of periodic responses above 1.37 that have one impact in their period."""
    shares = []
    for responses in (data.settled_responses("elastic"), data.up_sweep("elastic")):
        part = reading.between(responses, 1.37, 8.0)
        ones = reading.impacts_in_response(part)[part.multiplicity.values > 0] == 1
        shares.append(float(np.mean(ones)) if len(ones) else np.nan)
    text = (
        f"{100 * shares[0]:.1f} % of the periodic responses above 1.37 run on until they repeat, "
        f"{100 * shares[1]:.1f} % of those after 500 periods"
    )
    return Measured(text, [shares[0] == 1.0, shares[0] > 0.5])


def measure_times_between_impacts(data: Datasets, claim: Claim) -> Measured:
    up, texts, parts = data.up_sweep("elastic"), [], []
    for n in range(1, 4):
        eta = reading.relative_peak_eta(up, n)
        row = data.impact_statistics("elastic").sel(eta=eta or 0.0, method="nearest")
        low, high = float(row.distance_min), float(row.distance_max)
        texts.append(f"{low:.3f} to {high:.3f} T at {eta or np.nan:.3f}")
        parts.append(eta is not None and abs(low - n) < 0.01 and abs(high - n) < 0.01)
    return Measured("; ".join(texts), parts)


def find_relative_peaks(data: Datasets, claim: Claim) -> Measured:
    """Find the relative peaks of the four windows; each is near 2n times the main one."""
    etas = data.figure_curves("7").eta.values
    main = float(data.up_sweep("elastic").xi_rel_max.idxmax())
    text = ", ".join(f"{n}T: {eta:.3f}" for n, eta in enumerate(etas, 1))
    parts = [abs(eta / (2 * n * main) - 1.0) < 0.03 for n, eta in enumerate(etas, 1)]
    return Measured(text, [len(etas) == 4, *parts])


def find_further_irregular_regions(data: Datasets, claim: Claim) -> Measured:
    up = data.up_sweep("elastic")
    edges = reading.window_edges(up)[1:]
    text = "; ".join(
        f"{a[1][0]:.3f} to {b[0][1]:.3f}, from {n}T to {n + 1}T"
        for n, (a, b) in enumerate(zip(edges, edges[1:], strict=False), 2)
    )
    return Measured(text, reading.are_windows_separated(up)[1:])


def measure_share_t_periodic(
    data: Datasets, claim: Claim, case: str, low: float, high: float
) -> Measured:
    part = reading.between(data.up_sweep(case), low, high)
    share = float(np.mean(part.multiplicity.values == 1))
    return Measured(f"{100 * share:.1f} % of {part.sizes['eta']} frequencies", [share == 1.0])


def find_alternating_windows(
    data: Datasets, claim: Claim, case: str, low: float, high: float
) -> Measured:
    """Find windows nT with one impact and irregular responses between them, as in section 3."""
    steady, part = reading.between(data.impact_statistics(case), low, high), data.up_sweep(case)
    distances = np.array([steady.distance_min.values, steady.distance_max.values])
    simple = bool((np.abs(distances - 1.0) < 0.01).all())
    between_them, edges = reading.are_windows_separated(part), reading.window_edges(part)
    ends = "; ".join(f"{n}T {a[1]:.3f} to {b[0]:.3f}" for n, (a, b) in enumerate(edges, 1))
    begin = data.window_nearest(case, "T/1", 2.0).high
    end = data.window_nearest(case, "2T/1", 4.2).low
    chaotic, neutral = data.shares_chaotic_and_neutral(case, begin, end)
    text = (
        f"T-periodic with one impact from {low} to {high}: {simple}; windows nT with one impact: "
        f"{ends}; irregular responses between them: {all(between_them)}; from {begin:.5f} to "
        f"{end:.5f} {100 * chaotic:.0f} % chaotic, {100 * neutral:.0f} % neutral"
    )
    return Measured(text, [simple, *between_them])


def check_impacts_fall_from_seven_to_two(data: Datasets, claim: Claim) -> Measured:
    """Count impacts of the damped case from 0.48 to 0.85."""
    part = reading.between(data.up_sweep("damped"), 0.48, 0.85)
    steps = reading.successive_impact_numbers(part) or [0]
    runs = ", ".join(run.format() for run in reading.impact_runs(part))
    text = f"{', '.join(map(str, steps))}; {runs}"
    return Measured(text, [steps[0] == 7, steps[-1] == 2, reading.strictly_decreases(steps)])


def count_differences_of_sweeps(
    data: Datasets, claim: Claim, case: str, low: float, high: float
) -> Measured:
    """Count frequencies between two at which up- and down-sweep differ in their impacts."""
    sweeps = data.up_sweep(case), data.down_sweep(case)
    up, down = (reading.between(one, low, high) for one in sweeps)
    etas = up.eta.values[reading.impacts_in_response(up) != reading.impacts_in_response(down)]
    text = f" from {etas.min():.3f} to {etas.max():.3f}" if len(etas) else ""
    return Measured(f"up and down differ at {len(etas)} frequencies{text}", [len(etas) > 0])


def find_damping_for_one_impact(data: Datasets, claim: Claim) -> Measured:
    """Find the damping with which all responses at 1.11 to 1.33 are T-periodic with one impact."""
    part = data.map("D").sel(eta=slice(1.11, 1.33))
    one = (part.multiplicity == 1) & (np.abs(part.impacts_per_period - 1.0) < 0.1)
    damping = part.D.values[one.all("eta").values]
    text = f"not up to D = {float(part.D.max()):g}"
    if len(damping):
        ends = f"{damping.min():.3f} to {damping.max():.3f}"
        text = f"for D = {ends} at all {part.sizes['eta']} frequencies"
    return Measured(text, [len(damping) > 0])


def measure_irregular_share_when_damped(data: Datasets, claim: Claim) -> Measured:
    regions = (0.48, 1.37), (2.61, 3.77)
    shares, texts = [], []
    for low, high in regions:
        n = reading.between(data.up_sweep("damped"), low, high).multiplicity.values
        shares.append(float(np.mean(n == 0)))
        texts.append(f"{low}-{high}: {100 * shares[-1]:.1f} % not periodic")
    return Measured("; ".join(texts), [shares[0] == 0.0, shares[1] > 0.2])


def compare_contact_ranges(data: Datasets, claim: Claim) -> Measured:
    sweeps = (data.up_sweep(case) for case in ("elastic", "plastic"))
    contact = ((up, up.permanent_contact.values == 1) for up in sweeps)
    ends = [reading.edges_of_run_around(up, flags, 0.40)[1][0] for up, flags in contact]
    text = f"up to {ends[0]:.3f} at e = 0.7, to {ends[1]:.3f} at e = 0.3"
    return Measured(text, [ends[1] > ends[0]])


def compare_windows_over_restitution(data: Datasets, claim: Claim) -> Measured:
    low = {"T, contact": 0.4, "T/2": 1.05}
    texts, moved = [], {}
    for orbit, inside in {**low, "T/1": 2.0, "2T/1": 4.2, "3T/1": 6.3, "4T/1": 8.0}.items():
        both = (data.window_nearest(case, orbit, inside) for case in ("elastic", "plastic"))
        one, two = (window.high for window in both)
        moved[orbit] = abs(two / one - 1.0)
        texts.append(f"end of {orbit}: {one:.4f}, {two:.4f}")
    lower = np.max([moved[orbit] for orbit in low])
    higher = np.max([part for orbit, part in moved.items() if orbit not in low])
    return Measured("; ".join(texts), [lower > 0.1, higher < 0.02])
