"""Checks of section 4: large damping (4.1) and plastic impact (4.2)."""

from __future__ import annotations

import numpy as np

from ..cases import CASES
from .claim import LIMIT, NO, YES, Check, Finding, check_limit, check_parts, register_claim
from .limit_claims import (
    BRANCH,
    SWEEP,
    orbit_end,
    orbit_start,
    register_contact_end,
    register_limit,
    register_peak,
)
from .results import (
    Results,
    between,
    decreases,
    etas_where_sweeps_differ,
    impact_runs,
    impacts_in_turn,
    irregular_between,
    irregular_shares,
    is_orbit,
    longest_edges,
    lower_edge,
    upper_edge,
)

HUNDREDTH = 0.005  # by half a unit of its one digit 1.1 would hold anywhere from 1.05 to 1.15
SECOND_DIGIT = LIMIT.replace("last printed digit", "second digit, which its neighbours have")


def all_periodic(case: str, low: float, high: float) -> Check:
    """Return a check that all responses between two frequencies are T-periodic."""

    def check(results: Results) -> Finding:
        """Check a case's responses between the two frequencies; return the finding."""
        part = between(results.up(case), low, high)
        share = np.mean(part.multiplicity.values == 1)
        return check_parts(
            [share == 1.0], f"{100 * share:.1f} % of {part.sizes['eta']} frequencies"
        )

    return check


def make_alternation_check(case: str, low: float, high: float) -> Check:
    """Return a check that windows and irregular regions alternate as in section 3."""

    def check(results: Results) -> Finding:
        """Check that a case's windows and irregular regions alternate; return the finding."""
        part = between(results.up(case), low, 8.0)
        edges = [longest_edges(part, is_orbit(part, n, 1)) for n in (1, 2, 3, 4)]
        gaps = [(a[1][1], b[0][0]) for a, b in zip(edges, edges[1:], strict=False)]
        in_order = [low <= high and irregular_between(part, low, high) for low, high in gaps]
        begin, end = results.upper_limit(case, "T/1", 2.0), results.lower_limit(case, "2T/1", 4.2)
        chaotic, neutral = irregular_shares(results, case, begin.value, end.value)
        steady = between(results.impact_statistics(case), low, high)
        simple = bool(
            (
                (np.abs(steady.distance_min - 1.0) < 0.01)
                & (np.abs(steady.distance_max - 1.0) < 0.01)
            ).all()
        )
        ends = "; ".join(f"{n}T {a[1]:.3f} to {b[0]:.3f}" for n, (a, b) in enumerate(edges, 1))
        text = (
            f"T-periodic with one impact from {low} to {high}: {simple}; windows nT with one "
            f"impact: {ends}; irregular responses between them: {all(in_order)}"
        )
        why = (
            f"From {begin.value:.5f} to {end.value:.5f} {100 * chaotic:.0f} % of the responses are "
            f"chaotic, {100 * neutral:.0f} % neutral."
        )
        return check_parts([simple, *in_order], text, why)

    return check


register_contact_end("4.1", "0.48", "damped", 0.45)
register_claim("4.1", "T-periodic below 1.08", "all", SWEEP, full=True)(
    all_periodic("damped", 0.1, 1.077)
)


@register_claim(
    "4.1", "0.48 to 0.85: impacts diminish from seven to two", "7 to 2", SWEEP, full=True
)
def check_seven_to_two(results: Results) -> Finding:
    """Check that impacts of T-periodic responses fall from seven to two from 0.48 on."""
    found = impact_runs(between(results.up("damped"), 0.48, 0.85))
    steps = impacts_in_turn(found)
    why = f"{steps[0]} impacts remain from 0.480 to {found[0].high:.3f}." if steps[0] != 7 else ""
    return check_parts(
        [steps[0] == 7, steps[-1] == 2, decreases(steps)],
        ", ".join(map(str, steps)),
        why,
    )


@register_claim("4.1", "two impacts from", "0.85", BRANCH, LIMIT, full=True)
def check_two_impacts_from(results: Results) -> Finding:
    """Check the frequency from which responses have two impacts."""
    up, down, exponents = (
        results.up("damped"),
        results.down("damped"),
        between(results.exponent("damped"), 0.76, 0.95),
    )
    rest = (
        results.get("map_D")
        .sel(D=0.05, method="nearest")
        .impacts_per_period.sel(eta=slice(0.7, 0.9))
    )
    top = exponents.isel(eta=int(exponents.exponent.values.argmax()))
    from_rest = float(rest.eta[int((rest < 2.5).values.argmax())])
    why = (
        f"On the way down {lower_edge(down, is_orbit(down, 1, 2), 1.0)[1]:.3f}, from rest "
        f"{from_rest:.2f}: initial "
        "conditions do not explain 0.85. The response nearly doubles its period there: its "
        f"exponent rises to {float(top.exponent):.4f} ± {float(top.standard_error):.4f} at "
        f"{float(top.eta):.3f}, and at D = 0.005 it does so and turns chaotic."
    )
    edges = lower_edge(up, is_orbit(up, 1, 2), 1.0)
    return check_limit(edges, results.lower_limit("damped", "T/2", 1.0), "0.85", why)


register_limit("4.1", "two impacts up to", "1.08", orbit_end, "damped", "T/2", 1.0)
register_peak("4.1", "damped", "2.63", "1.056")
register_limit(
    "4.1",
    "T-periodic with one impact from 1.08 up to",
    "1.1",
    orbit_end,
    *("damped", "T/1", 1.09, HUNDREDTH),
    tolerance=SECOND_DIGIT,
)
register_limit(
    "4.1", "2T-periodic with three impacts from", "1.11", orbit_start, "damped", "2T/3", 1.2
)
register_limit(
    "4.1", "2T-periodic with three impacts up to", "1.33", orbit_end, "damped", "2T/3", 1.2
)


@register_claim(
    "4.1", "non-unique solutions in 1.11-1.33", "found", "up- against down-sweep", full=True
)
def check_non_unique(results: Results) -> Finding:
    """Check at which frequencies up- and down-sweep differ."""
    differ = etas_where_sweeps_differ(results, "damped", 1.11, 1.33)
    text = (
        f"up and down differ at {len(differ)} frequencies from {differ.min():.3f} to "
        f"{differ.max():.3f}"
        if len(differ)
        else "up and down agree"
    )
    return check_parts([len(differ) > 0], text)


register_claim("4.1", "above 1.33 as for D = 0.005", "the same", SWEEP, full=True)(
    make_alternation_check("damped", 1.33, 2.6)
)


@register_claim(
    "4.1",
    "more damping turns 1.11-1.33 into T-periodic with one impact",
    "so",
    "map over (eta, D) from rest",
    full=True,
)
def check_more_damping(results: Results) -> Finding:
    """Check whether more damping leaves T-periodic responses with one impact at 1.11-1.33."""
    data = results.get("map_D").sel(eta=slice(1.11, 1.33))
    periodic = (data.multiplicity == 1).all("eta").values
    simple = periodic & (np.abs(data.impacts_per_period - 1.0) < 0.1).all("eta").values
    if not simple.any():
        return Finding("not up to D = 0.15", NO)
    damping = data.D.values[simple]
    why = (
        f"Beyond D = {damping.max():.3f} two impacts remain at 1.11, where the window of two "
        "impacts has moved to."
        if not simple[-1]
        else ""
    )
    return Finding(
        f"for D = {damping.min():.3f} to {damping.max():.3f} at all {data.sizes['eta']} "
        "frequencies",
        YES,
        why,
    )


@register_claim("4.1", "only the first irregular region is eliminated", "so", SWEEP, full=True)
def check_only_first_eliminated(results: Results) -> Finding:
    """Check that damping removes the first irregular region and not the second."""
    text, parts = [], []
    for low, high, expected in ((0.48, 1.37, 0.0), (2.61, 3.77, 0.2)):
        share = np.mean(between(results.up("damped"), low, high).multiplicity.values == 0)
        text.append(f"{low}-{high}: {100 * share:.1f} % not periodic")
        parts.append(share == 0.0 if expected == 0.0 else share > expected)
    return check_parts(parts, "; ".join(text))


register_contact_end("4.2", "0.97", "plastic", 0.90)
register_claim("4.2", "T-periodic below 1.37", "all", SWEEP, full=True)(
    all_periodic("plastic", 0.1, 1.37)
)
register_limit("4.2", "three impacts from", "0.97", orbit_start, "plastic", "T/3", 1.0)
register_limit("4.2", "three impacts up to", "1.02", orbit_end, "plastic", "T/3", 1.0)
register_limit("4.2", "two impacts up to", "1.23", orbit_end, "plastic", "T/2", 1.1)
register_peak("4.2", "plastic", "16.41", "1.048")
register_claim(
    "4.2", "one impact from 1.23 to 1.37, above as for e = 0.7", "the same", SWEEP, full=True
)(make_alternation_check("plastic", 1.23, 2.6))


@register_claim(
    "4.2", "the range of permanent contact is enlarged", "larger", "up-sweeps", full=True
)
def check_more_contact(results: Results) -> Finding:
    """Compare the ranges of permanent contact for e = 0.7 and 0.3."""
    ends = [
        upper_edge(up := results.up(case), up.permanent_contact.values == 1, 0.40)[0]
        for case in ("elastic", "plastic")
    ]
    e = [CASES[case].e for case in ("elastic", "plastic")]
    return Finding(
        f"up to {ends[0]:.3f} at e = {e[0]}, to {ends[1]:.3f} at e = {e[1]}",
        YES if ends[1] > ends[0] else NO,
    )


@register_claim(
    "4.2",
    "only the range of lower eta is significantly affected",
    "only lower eta",
    "branches: exact limits of both cases",
    "10 % and 2 %",
)
def check_only_lower(results: Results) -> Finding:
    """Check how far the windows' limits differ between e = 0.7 and 0.3."""
    text, moved = [], []
    for orbit, inside in (("T, contact", 0.4), ("T/2", 1.05)):
        limits = [results.upper_limit(case, orbit, inside).value for case in ("elastic", "plastic")]
        moved.append(abs(limits[1] / limits[0] - 1.0))
        text.append(f"end of {orbit}: {limits[0]:.3f}, {limits[1]:.3f}")
    stays = []
    for orbit, inside in (("T/1", 2.0), ("2T/1", 4.2), ("3T/1", 6.3), ("4T/1", 8.0)):
        limits = [results.upper_limit(case, orbit, inside).value for case in ("elastic", "plastic")]
        stays.append(abs(limits[1] / limits[0] - 1.0))
        text.append(f"end of {orbit}: {limits[0]:.4f}, {limits[1]:.4f}")
    why = f"Below 1.4 limits move by up to {100 * max(moved):.0f} %, above by "
    why += f"{100 * max(stays):.1f} %."
    return check_parts([np.max(moved) > 0.1, np.max(stays) < 0.02], "; ".join(text), why)
