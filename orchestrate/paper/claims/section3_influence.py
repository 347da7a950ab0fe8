"""Checks of section 3.2: irregular regions, main peak, chaos, decay over frequency."""

from __future__ import annotations

import numpy as np

from ...dynamics.lyapunov import CHAOTIC
from ..cases import CASES
from ..sweep_windows import relative_peak, runs
from .claim import (
    LIMIT,
    NO,
    NUMBER,
    PARTLY,
    YES,
    Finding,
    check_limit,
    check_number,
    check_parts,
    register_claim,
)
from .limit_claims import BRANCH, SWEEP, orbit_start, peak_height, register_limit
from .results import (
    Results,
    between,
    decreases,
    etas_where_sweeps_differ,
    impact_runs,
    impacts_in_response,
    impacts_in_turn,
    irregular_shares,
    is_orbit,
    longest_edges,
    lower_edge,
    upper_edge,
)

DECADE, RESEMBLES = 10.0, 0.1


@register_claim("3.2", "the first irregular region ends", "1.37", BRANCH, LIMIT, full=True)
def check_first_region_ends(results: Results) -> Finding:
    """Check the frequency at which the first irregular region ends."""
    up, down = results.up("elastic"), results.down("elastic")
    on_way_down = lower_edge(down, is_orbit(down, 1, 1), 2.0)
    begins = results.lower_limit("elastic", "T/1", 2.0)
    why = (
        f"On the way down the T-periodic response lives on to {on_way_down[1]:.3f}, and is stable "
        f"from {begins.value:.8f} on: in between two responses coexist. The other one, 2T-periodic "
        "with three impacts, ends at the limit told."
    )
    edges = lower_edge(up, is_orbit(up, 1, 1), 2.0)
    return check_limit(edges, results.upper_limit("elastic", "2T/3", 1.36), "1.37", why)


@register_claim("3.2", "impacts during one T decrease with eta", "decreasing", SWEEP)
def check_impacts_decrease(results: Results) -> Finding:
    """Check that impacts of T-periodic responses decrease with eta up to 0.9."""
    steps = impacts_in_turn(impact_runs(between(results.up("elastic"), 0.43, 0.9)))
    return check_parts(
        [steps[0] > steps[-1], decreases(steps)],
        "T-periodic with " + ", ".join(map(str, steps)) + " impacts in turn",
        "" if decreases(steps) else "On the whole they do, but not from each number to the next.",
    )


@register_claim(
    "3.2",
    "0.43 to 0.89: bifurcated and quasi-periodic responses interchange with T-periodic ones",
    "so",
    "settled responses; largest Lyapunov exponents",
    full=True,
)
def check_alternation(results: Results) -> Finding:
    """Check that T-periodic windows and irregular regions alternate from 0.43 to 0.89."""
    settled = between(results.settled("elastic"), 0.43, 0.89)
    windows = runs(settled.multiplicity.values == 1)
    chaotic, neutral = irregular_shares(results, "elastic", 0.43, 0.89)
    listed = ", ".join(run.text() for run in impact_runs(settled))
    text = f"T-periodic with so many impacts: {listed}"
    why = f"In between 2T- and more periodic, {100 * chaotic:.0f} % of all frequencies chaotic, "
    why += f"{100 * neutral:.0f} % neutral (a torus, or not decided): what interchanges is chaos."
    return check_parts([len(windows) > 2, neutral > chaotic], text, why)


register_limit(
    "3.2",
    "T-periodic with two impacts from",
    "0.89",
    orbit_start,
    *("elastic", "T/2", 1.0, False),
)


@register_claim("3.2", "two impacts during one T up to", "1.07", BRANCH, LIMIT, full=True)
def check_two_impacts_up_to(results: Results) -> Finding:
    """Check the frequency up to which T-periodic responses have two impacts."""
    up, limit = results.up("elastic"), results.upper_limit("elastic", "T/2", 1.0)
    after = results.upper_limit("elastic", "T/1", 1.065)
    why = (
        f"From there to {after.value:.8f} the response is T-periodic with one impact; what begins "
        "at 1.07 is the end of T."
    )
    return check_limit(upper_edge(up, is_orbit(up, 1, 2), 1.0), limit, "1.07", why)


register_limit(
    "3.2",
    "absolute resonance peak, max xi_Rel",
    "21.56",
    peak_height,
    *("elastic", 3),
    how="up-sweep, largest xi_Rel over time, exact",
    tolerance=NUMBER,
    full=False,
)


@register_claim("3.2", "place of the peak", "1.045", "up-sweep", NUMBER)
def check_peak_frequency(results: Results) -> Finding:
    """Check the frequency of the largest gap, up and down."""
    up, down = results.up("elastic").xi_rel_max, results.down("elastic").xi_rel_max
    others = int(results.get("attractors").number.sel(eta=1.045, method="nearest")) - 1
    why = (
        f"At 1.045 it is {float(up.sel(eta=1.045, method='nearest')):.2f}. The sweep downwards has "
        f"its peak at {float(down.idxmax()):.3f} too, and "
        f"random starts find {others or 'no'} other response there: the place is misprinted or was "
        "read off."
    )
    return check_number(float(up.idxmax()), "1.045", 3, why)


@register_claim(
    "3.2",
    "eta = 1.0 and 1.095 have no influence",
    "none",
    "up-sweep: extrema of the largest gap within 0.01",
)
def check_no_influence(results: Results) -> Finding:
    """Check that the largest gap has no extremum at the halves' natural frequencies."""
    gaps = results.up("elastic").xi_rel_max
    texts, parts = [], []
    for eta in (1.0, 1.095):
        near = gaps.sel(eta=slice(eta - 0.0105, eta + 0.0105)).values
        change = np.diff(np.log(near))
        parts.append(bool((change > 0).all() or (change < 0).all()))
        texts.append(
            f"around {eta:g} it changes by {100 * change.min():.1f} to {100 * change.max():.1f} % "
            f"a step, without an extremum: {parts[-1]}"
        )
    return check_parts(parts, "; ".join(texts))


@register_claim(
    "3.2",
    "bifurcated and quasi-periodic responses interchange again from",
    "1.07",
    BRANCH,
    LIMIT,
    full=True,
)
def check_irregular_again(results: Results) -> Finding:
    """Check the frequency above the peak at which T-periodic responses end."""
    up = results.up("elastic")
    edges = upper_edge(up, up.multiplicity.values == 1, 1.05)
    return check_limit(edges, results.upper_limit("elastic", "T/1", 1.065), "1.07")


@register_claim(
    "3.2",
    "responses in 1.07-1.37 are approximately 2T-periodic",
    "all",
    "up-sweep: stroboscopic samples",
    "95 %",
)
def check_nearly_2t(results: Results) -> Finding:
    """Check how nearly responses between 1.07 and 1.37 repeat after 2T."""
    part = between(results.up("elastic"), 1.07, 1.367)
    samples = part.xi_rel.values
    after = [np.sqrt(np.mean((samples[:, n:] - samples[:, :-n]) ** 2, axis=1)) for n in (1, 2)]
    share = np.mean(after[1] < 0.5 * after[0])
    text = (
        f"at {100 * share:.0f} % of the frequencies samples differ less than half as much after 2T "
        "as after T"
    )
    return Finding(text, YES if share > 0.95 else PARTLY if share > 0.5 else NO)


@register_claim(
    "3.2",
    "non-unique solutions in 1.07-1.37",
    "found",
    "random starts, run on until they repeat; up- against down-sweep",
    full=True,
)
def check_non_unique(results: Results) -> Finding:
    """Check at which frequencies between 1.07 and 1.37 several attractors exist."""
    data = between(results.get("attractors"), 1.07, 1.37)
    several = data.eta.values[data.number.values > 1]
    sure = data.eta.values[(data.multiplicity.values > 0).sum(axis=1) > 1]
    differ = etas_where_sweeps_differ(results, "elastic", 1.07, 1.37)
    text = (
        f"two or more attractors at {len(several)} of {data.sizes['eta']} frequencies, two "
        f"periodic at {len(sure)}; up and down differ at {len(differ)}"
    )
    why = (
        "Each start is run on until its state repeats within 1e-6, at most 8,000 periods; what it "
        "is then Newton's method decides by its orbit, and each attractor is carried to the next "
        "frequencies. Of irregular responses how many there are depends on how alike one's "
        "statistics must be."
    )
    low = results.lower_limit("elastic", "T/1", 2.0).value
    high = results.upper_limit("elastic", "2T/3", 1.36).value
    why += (
        f" By their exact limits T and 2T with three impacts coexist from {low:.5f} to {high:.5f}: "
        "near its end few starts lead to the second."
    )
    if len(several):
        why += f" Frequencies at which starts find two: {format_frequencies(several)}."
    return check_parts([len(sure) > 0, len(differ) > 0], text, why)


def format_frequencies(etas: np.ndarray) -> str:
    """Format frequencies as ranges, split where the gap exceeds 0.006."""
    groups = np.split(etas, np.flatnonzero(np.diff(etas) > 0.006) + 1)
    return ", ".join(f"{g[0]:.3f}" + (f" to {g[-1]:.3f}" if len(g) > 1 else "") for g in groups)


def second_region(results: Results, printed: str, upper: bool) -> Finding:
    """Check a limit of the second irregular region, and its dependence on tolerance."""
    up = results.up("elastic")
    lower_window, upper_window = (
        longest_edges(up, is_orbit(up, 1, 1)),
        longest_edges(up, is_orbit(up, 2, 1)),
    )
    limit = upper_window[0] if upper else lower_window[1]
    row = results.exponent("elastic").sel(eta=float(printed), method="nearest")
    samples = up.sel(eta=float(printed), method="nearest").xi_rel.values
    n = 2 if upper else 1
    spread = np.abs(samples[n:] - samples[:-n]).max() / samples.max()
    remaining = np.exp(-0.005 * 500 * 2 * np.pi / float(printed))
    why = (
        f"At {printed} the response is {'2T' if upper else 'T'}-periodic to {spread:.1e} after the "
        "periods dropped, exponent "
        f"{float(row.exponent):.5f} ± {float(row.standard_error):.5f}: stable, but slowly "
        f"decaying, e^(-D tau) being {remaining:.1e} after 500 T, so "
        "that transients widen the samples and the limit read depends on how narrow a band still "
        "counts as a line."
    )
    exact = (
        results.lower_limit("elastic", "2T/1", 4.2)
        if upper
        else results.upper_limit("elastic", "T/1", 2.0)
    )
    return check_limit(limit, exact, printed, why)


@register_claim(
    "3.2", "impacts in 1.07-1.37 are distributed irregularly", "so", "settled responses", full=True
)
def check_irregular_impacts(results: Results) -> Finding:
    """Check whether responses between 1.07 and 1.37 are irregular."""
    settled = between(results.settled("elastic"), 1.07, 1.367)
    n = settled.multiplicity.values
    text = (
        f"at {100 * np.mean(n == 0):.0f} % of the frequencies impacts do not repeat; at "
        f"{100 * np.mean(n == 2):.0f} % they repeat after 2T, at {100 * np.mean(n > 2):.0f} % "
        "after more"
    )
    return check_parts([bool((n == 0).any()), bool((n == 0).all())], text)


register_limit("3.2", "the second irregular region begins", "2.61", second_region, False)
register_limit("3.2", "the second irregular region ends", "3.77", second_region, True)


@register_claim(
    "3.2",
    "both windows beside the second irregular region have one impact in a response period",
    "one",
    "settled responses",
    "all frequencies",
    full=True,
)
def check_one_impact_beside(results: Results) -> Finding:
    """Check that responses beside the second irregular region have one impact."""
    text, parts = [], []
    for n, low, high in ((1, 1.37, 2.61), (2, 3.77, 4.74)):
        part = between(results.settled("elastic"), low, high)
        multiplicity = part.multiplicity.values
        counts = np.round(multiplicity * part.impacts_per_period.values).astype(int)
        share = float(np.mean((multiplicity == n) & (counts == 1)))
        text.append(f"{low} to {high}: {100 * share:.1f} % of {part.sizes['eta']} frequencies")
        parts.append(share == 1.0)
    return check_parts(parts, "; ".join(text))


@register_claim(
    "3.2",
    "dark regions are quasi-periodic; that chaos begins there is disproved",
    "no chaos",
    "largest Lyapunov exponents of settled responses",
    "chaotic: three standard errors above zero",
    full=True,
)
def check_chaos(results: Results) -> Finding:
    """Check whether irregular regions are quasi-periodic rather than chaotic, by region."""
    text, parts = [], []
    for region in results.regions("elastic"):
        if region.is_window:
            continue
        low, high, _ = region
        chaotic, neutral = irregular_shares(results, "elastic", low, high)
        text.append(
            f"{low:.3f}-{high:.3f}: {100 * chaotic:.0f} % chaotic, {100 * neutral:.0f} % neutral, "
            f"largest {results.largest_exponent('elastic', region).text()}"
        )
        parts.append(chaotic < 0.02)
    second = {
        case: irregular_shares(
            results,
            case,
            results.upper_limit(case, "T/1", 2.0).value,
            results.lower_limit(case, "2T/1", 4.2).value,
        )
        for case in ("plastic", "damped")
    }
    settled = results.settled("elastic")
    late = int(((settled.multiplicity > 0) & (settled.periods > 2000)).sum())
    why = (
        "Each response was run on until its state repeated within 1e-6, or for "
        f"{float(settled.periods.max()):.0f} periods, before its exponent was taken: {late} "
        "responses took more than 2,000. The largest exponents are of runs of their own, from "
        "another start. "
        "Regions are those between exact limits. At e = 0.3, D = 0.005 the second one is "
        f"{100 * second['plastic'].neutral:.0f} % neutral, {100 * second['plastic'].chaotic:.0f} % "
        f"chaotic, at e = 0.7, D = 0.05 {100 * second['damped'].chaotic:.0f} % of it is chaotic."
    )
    return check_parts(parts, "; ".join(text), why)


@register_claim(
    "3.2",
    "all irregularities occur when increasing the response period by one T and keeping one "
    "impact in a response period",
    "all",
    "settled responses between the exact limits of windows; largest Lyapunov exponents",
    "none elsewhere",
    full=True,
)
def check_irregularities(results: Results) -> Finding:
    """Count irregular responses between windows nT and (n+1)T, and elsewhere.

    Irregular are responses that do not repeat; of those how many are chaotic for sure.
    """
    settled, exponents = results.settled("elastic"), results.exponent("elastic")
    text, inside, outside = [], 0, 0
    for region in results.regions("elastic"):
        if region.is_window:
            continue
        low, high, name = region
        irregular = between(settled, low, high).multiplicity.values == 0
        chaotic = between(exponents, low, high).verdict.values == CHAOTIC
        count, sure = int(irregular.sum()), int((irregular & chaotic).sum())
        inside += count if region.adds_a_period else 0
        outside += 0 if region.adds_a_period else count
        if not region.adds_a_period:
            text.append(f"{count} from {low:.3f} to {high:.3f} ({name}; {sure} of them chaotic)")
    steps = impacts_in_turn(impact_runs(between(settled, 0.43, 0.89))) or [0]
    value = (
        f"of {inside + outside} settled responses that do not repeat {inside} lie between windows "
        f"nT and (n+1)T of one impact; {'; '.join(text)}"
    )
    why = (
        f"From 0.43 to 0.89 the responses on both sides are T-periodic, with {min(steps)} to "
        f"{max(steps)} impacts: from one to the next their number changes, no period is added."
    )
    return check_parts([outside == 0, inside > 0], value, why if outside else "")


@register_claim(
    "3.2",
    "bifurcation diagrams cannot provide full information about motions with impacts",
    "so",
    "up-sweep: impacts of responses of the same multiplicity",
)
def check_hidden_impacts(results: Results) -> Finding:
    """Check that responses which look alike in the diagram differ in their impacts."""
    up = results.up("elastic")
    counts = impacts_in_response(up)[up.multiplicity.values == 1]
    kinds = np.unique(counts[counts > 0])
    value = (
        f"T-periodic responses, one line each in Figure 6, have {kinds.min()} to {kinds.max()} "
        f"impacts in T, {len(kinds)} different numbers"
    )
    return Finding(value, YES if len(kinds) > 1 else NO)


@register_claim(
    "3.2", "impulses are extremal near the absolute peak", "1.045", "impact by impact", "0.01"
)
def check_impulse_peak(results: Results) -> Finding:
    """Check that impulses are largest near the absolute peak."""
    speed = results.impact_statistics("elastic").closing_max
    eta = float(speed.idxmax())
    return check_parts(
        [abs(eta - 1.045) <= 0.01],
        f"largest closing velocity {float(speed.max()):.2f} at {eta:.3f}",
    )


@register_claim(
    "3.2",
    "displacement and velocity diminish by powers of ten with eta",
    "powers of ten",
    "at the relative peaks",
    "a factor of ten from each to the next",
)
def check_decay(results: Results) -> Finding:
    """Check by which factors gap and velocity fall from peak to peak."""
    up, steady = results.up("elastic"), results.impact_statistics("elastic")
    etas = [float(up.xi_rel_max.idxmax())] + [
        eta for n in (1, 2, 3) if (eta := relative_peak(up, n))
    ]
    gaps = [float(up.xi_rel_max.sel(eta=eta)) for eta in etas]
    speeds = [float(steady.closing_max.sel(eta=eta, method="nearest")) for eta in etas]
    text = "; ".join(
        f"{eta:.3f}: {gap:.3g}, {speed:.3g}"
        for eta, gap, speed in zip(etas, gaps, speeds, strict=True)
    )
    steps = [a / b for values in (gaps, speeds) for a, b in zip(values, values[1:], strict=False)]
    factors = "; ".join(
        f"{a:.3g}, {b:.3g}"
        for a, b in zip(steps[: len(steps) // 2], steps[len(steps) // 2 :], strict=True)
    )
    why = (
        f"From peak to peak both fall by factors of {factors}: by less than a power of ten "
        "in the end."
    )
    parts = [step >= DECADE for step in steps]
    value = "eta: largest gap, closing velocity: " + text
    if len(etas) < 4:
        parts.append(False)
    return check_parts(parts, value, why if not all(parts) else "")


@register_claim(
    "3.2",
    "at high eta the oscillations resemble those of a single-d.o.f. system without separation",
    "in a first approximation",
    "up-sweep: amplitudes against (10) of both masses as one",
    "10 % at each of the peaks beyond the main one, and at 8.0",
)
def check_single_oscillator(results: Results) -> Finding:
    """Check how near amplitudes at high eta are to both masses as one oscillator."""
    up, case = results.up("elastic"), CASES["elastic"]
    stiffness = (1.0 + case.kappa) / (1.0 + case.mu)
    text, away, apart = [], [], []
    for eta in (1.047, 2.07, 4.166, 6.268, 8.0):
        row = up.sel(eta=eta, method="nearest")
        alone = 1.0 / np.hypot(stiffness - eta**2, 2.0 * case.get("D") * eta)
        ratios = [float(row[f"xi{mass}_max"]) / alone for mass in (1, 2)]
        away.append(max(abs(ratio - 1.0) for ratio in ratios))
        apart.append(float(row.xi_rel_max) / float(row.xi1_max))
        text.append(f"{eta:g}: {ratios[0]:.3f}, {ratios[1]:.3f}")
    value = "amplitudes of both masses over that of both as one (6): " + "; ".join(text)
    near = [part < RESEMBLES for part in away[1:]]  # beyond the main peak
    falls = all(a > b for a, b in zip(away[1:], away[2:], strict=False))
    why = (
        f"At the first of these peaks beyond the main one amplitudes are {100 * away[1]:.0f} % "
        f"off, at 8.0 {100 * away[-1]:.0f} %. The masses do separate: the largest gap is "
        f"{100 * apart[1]:.0f} % of the amplitude there, and {100 * apart[-1]:.0f} % at 8.0."
    )
    return check_parts([*near, falls], value, "" if all(near) else why)
