"""Claims of section 4: large damping (4.1) and plastic impact (4.2)."""

from __future__ import annotations

import numpy as np

from ..cases import CASES
from .claim import (
    LIMIT,
    NO,
    NUMBER,
    YES,
    Check,
    Claim,
    Finding,
    border,
    holds,
    number_at,
    rounds_to,
)
from .results import Results, between, impacts_in_response, kind, lower_edge, shares, upper_edge


def contact_limit(case: str, printed: str, inside: float) -> Check:
    """A check of where permanent contact ends; the sentence says how it depends on gamma."""

    def check(results: Results) -> Finding:
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

    return check


def edge(case: str, printed: str, orbit: str, inside: float, slack: float | None = None) -> Check:
    """A check of where responses mT/k end upwards, and where on the way down."""

    def check(results: Results) -> Finding:
        up, down, numbers = results.up(case), results.down(case), numbers_of(orbit)
        back = upper_edge(down, kind(down, *numbers), inside)
        limit = results.ends(case, orbit, inside)
        edges = upper_edge(up, kind(up, *numbers), inside)
        why = f"On the way down: between {back[0]:.3f} and {back[1]:.3f}."
        if edges[0] > limit.value:
            why += (
                f" The sweep is {edges[0] - limit.value:.3f} beyond the exact limit before it "
                "leaves the orbit: a deviation takes long to grow."
            )
        return border(edges, limit, printed, why, slack)

    return check


def start(case: str, printed: str, orbit: str, inside: float) -> Check:
    """A check of where responses mT/k begin."""

    def check(results: Results) -> Finding:
        up, down, numbers = results.up(case), results.down(case), numbers_of(orbit)
        back = lower_edge(down, kind(down, *numbers), inside)
        why = f"On the way down: between {back[0]:.3f} and {back[1]:.3f}."
        edges = lower_edge(up, kind(up, *numbers), inside)
        return border(edges, results.begins(case, orbit, inside), printed, why)

    return check


def numbers_of(orbit: str) -> tuple[int, int]:
    """Periods and impacts of mT/k."""
    periods, impacts = orbit.split("T/")
    return int(periods or 1), int(impacts)


def all_periodic(case: str, low: float, high: float) -> Check:
    """A check that all responses between two frequencies are T-periodic."""

    def check(results: Results) -> Finding:
        part = between(results.up(case), low, high)
        share = np.mean(part.multiplicity.values == 1)
        return holds([share == 1.0], f"{100 * share:.1f} % of {part.sizes['eta']} frequencies")

    return check


def seven_to_two(results: Results) -> Finding:
    """Impacts of the T-periodic responses from 0.48 on."""
    counts = impacts_in_response(between(results.up("damped"), 0.48, 0.85))
    steps = list(dict.fromkeys(counts.tolist()))
    edges = between(results.up("damped"), 0.48, 0.85).eta.values[counts == steps[0]]
    why = f"{steps[0]} impacts remain from 0.480 to {edges.max():.3f}." if steps[0] != 7 else ""
    return holds(
        [steps[0] == 7, steps[-1] == 2, all(a > b for a, b in zip(steps, steps[1:], strict=False))],
        ", ".join(map(str, steps)),
        why,
    )


def peak(case: str, height: str, place: str) -> tuple[Check, Check]:
    """Checks of the peak's height and place."""

    def check_height(results: Results) -> Finding:
        return number_at(float(results.up(case).xi_rel_max.max()), height, 4)

    def check_place(results: Results) -> Finding:
        gaps = results.up(case).xi_rel_max
        there, top = float(gaps.sel(eta=float(place), method="nearest")), float(gaps.max())
        why = (
            f"A flat peak: at {place} it is {there:.4f}, {100 * (1 - there / top):.4f} % less."
            if not rounds_to(float(gaps.idxmax()), place)
            else ""
        )
        return number_at(float(gaps.idxmax()), place, 3, why)

    return check_height, check_place


def non_unique(results: Results) -> Finding:
    """Where up- and down-sweep differ."""
    up, down = results.up("damped"), results.down("damped")
    differ = up.eta.values[
        (impacts_in_response(up) != impacts_in_response(down))
        & (up.eta.values > 1.0)
        & (up.eta.values < 1.4)
    ]
    text = (
        f"up and down differ at {len(differ)} frequencies from {differ.min():.3f} to "
        f"{differ.max():.3f}"
        if len(differ)
        else "up and down agree"
    )
    return holds([len(differ) > 0], text)


def more_damping(results: Results) -> Finding:
    """Whether more damping leaves only T-periodic responses with one impact in 1.11-1.33."""
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


def two_impacts_from(results: Results) -> Finding:
    """Where the response with two impacts begins, and why that may look like 0.85."""
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
        f"On the way down {lower_edge(down, kind(down, 1, 2), 1.0)[1]:.3f}, from rest "
        f"{from_rest:.2f}: initial "
        "conditions do not explain 0.85. The response nearly doubles its period there: its "
        f"exponent rises to {float(top.exponent):.4f} ± {float(top.standard_error):.4f} at "
        f"{float(top.eta):.3f}, and at D = 0.005 it does so and turns chaotic."
    )
    edges = lower_edge(up, kind(up, 1, 2), 1.0)
    return border(edges, results.begins("damped", "T/2", 1.0), "0.85", why)


def only_first_eliminated(results: Results) -> Finding:
    """Shares of responses that are not periodic, in the first and second regions."""
    text, parts = [], []
    for low, high, expected in ((0.48, 1.37, 0.0), (2.61, 3.77, 0.2)):
        share = np.mean(between(results.up("damped"), low, high).multiplicity.values == 0)
        text.append(f"{low}-{high}: {100 * share:.1f} % not periodic")
        parts.append(share == 0.0 if expected == 0.0 else share > expected)
    return holds(parts, "; ".join(text))


def as_before(case: str, low: float, high: float) -> Check:
    """A check that windows and irregular regions alternate as in section 3 above a frequency."""

    def check(results: Results) -> Finding:
        part = between(results.up(case), low, 8.0)
        found = [n for n in (1, 2, 3, 4) if kind(part, n, 1).any()]
        begin, end = results.ends(case, "T/1", 2.0), results.begins(case, "2T/1", 4.2)
        chaotic, neutral = shares(results, case, begin.value, end.value)
        steady = between(results.steady(case), low, high)
        simple = bool(
            (
                (np.abs(steady.distance_min - 1.0) < 0.01)
                & (np.abs(steady.distance_max - 1.0) < 0.01)
            ).all()
        )
        text = (
            f"T-periodic with one impact from {low} to {high}: {simple}; windows nT with one "
            f"impact for n = {found}"
        )
        why = (
            f"From {begin.value:.5f} to {end.value:.5f} {100 * chaotic:.0f} % of the responses are "
            f"chaotic, {100 * neutral:.0f} % neutral."
        )
        return holds([simple, found == [1, 2, 3, 4]], text, why)

    return check


def more_contact(results: Results) -> Finding:
    """The range of contact in both cases."""
    ends = [
        upper_edge(up := results.up(case), up.permanent_contact.values == 1, 0.40)[0]
        for case in ("elastic", "plastic")
    ]
    e = [CASES[case].e for case in ("elastic", "plastic")]
    return Finding(
        f"up to {ends[0]:.3f} at e = {e[0]}, to {ends[1]:.3f} at e = {e[1]}",
        YES if ends[1] > ends[0] else NO,
    )


def only_lower(results: Results) -> Finding:
    """How far limits of the windows differ between e = 0.7 and 0.3."""
    text, moved = [], []
    for orbit, inside in (("T, contact", 0.4), ("T/2", 1.05)):
        limits = [results.ends(case, orbit, inside).value for case in ("elastic", "plastic")]
        moved.append(abs(limits[1] / limits[0] - 1.0))
        text.append(f"end of {orbit}: {limits[0]:.3f}, {limits[1]:.3f}")
    stays = []
    for orbit, inside in (("T/1", 2.0), ("2T/1", 4.2), ("3T/1", 6.3), ("4T/1", 8.0)):
        limits = [results.ends(case, orbit, inside).value for case in ("elastic", "plastic")]
        stays.append(abs(limits[1] / limits[0] - 1.0))
        text.append(f"end of {orbit}: {limits[0]:.4f}, {limits[1]:.4f}")
    why = f"Below 1.4 limits move by up to {100 * max(moved):.0f} %, above by "
    why += f"{100 * max(stays):.1f} %."
    return holds([max(moved) > 0.1, max(stays) < 0.02], "; ".join(text), why)


HUNDREDTH = 0.005  # by half a unit of its one digit 1.1 would hold anywhere from 1.05 to 1.15
SECOND_DIGIT = LIMIT.replace("last printed digit", "second digit, which its neighbours have")
SWEEP = "up-sweep, multiplicity and impacts"
BRANCH = "up-sweep, multiplicity and impacts; branch"
HEIGHT_41, PLACE_41 = peak("damped", "2.63", "1.056")
HEIGHT_42, PLACE_42 = peak("plastic", "16.41", "1.048")
CLAIMS = (
    Claim(
        "4.1",
        "T-periodic with permanent contact below",
        "0.48",
        "up-sweep, last eta with contact; branch",
        LIMIT,
        contact_limit("damped", "0.48", 0.45),
        full=True,
    ),
    Claim(
        "4.1",
        "T-periodic below 1.08",
        "all",
        SWEEP,
        "-",
        all_periodic("damped", 0.1, 1.077),
        full=True,
    ),
    Claim(
        "4.1",
        "0.48 to 0.85: impacts diminish from seven to two",
        "7 to 2",
        SWEEP,
        "-",
        seven_to_two,
        full=True,
    ),
    Claim("4.1", "two impacts from", "0.85", BRANCH, LIMIT, two_impacts_from, full=True),
    Claim(
        "4.1",
        "two impacts up to",
        "1.08",
        BRANCH,
        LIMIT,
        edge("damped", "1.08", "T/2", 1.0),
        full=True,
    ),
    Claim("4.1", "max xi_Rel", "2.63", "up-sweep, exact", NUMBER, HEIGHT_41),
    Claim("4.1", "its place", "1.056", "up-sweep", NUMBER, PLACE_41),
    Claim(
        "4.1",
        "T-periodic with one impact from 1.08 up to",
        "1.1",
        BRANCH,
        SECOND_DIGIT,
        edge("damped", "1.1", "T/1", 1.09, HUNDREDTH),
        full=True,
    ),
    Claim(
        "4.1",
        "2T-periodic with three impacts from",
        "1.11",
        BRANCH,
        LIMIT,
        start("damped", "1.11", "2T/3", 1.2),
        full=True,
    ),
    Claim(
        "4.1",
        "2T-periodic with three impacts up to",
        "1.33",
        BRANCH,
        LIMIT,
        edge("damped", "1.33", "2T/3", 1.2),
        full=True,
    ),
    Claim(
        "4.1",
        "non-unique solutions in 1.11-1.33",
        "found",
        "up- against down-sweep",
        "-",
        non_unique,
        full=True,
    ),
    Claim(
        "4.1",
        "above 1.33 as for D = 0.005",
        "the same",
        SWEEP,
        "-",
        as_before("damped", 1.33, 2.6),
        full=True,
    ),
    Claim(
        "4.1",
        "more damping turns 1.11-1.33 into T-periodic with one impact",
        "so",
        "map over (eta, D) from rest",
        "-",
        more_damping,
        full=True,
    ),
    Claim(
        "4.1",
        "only the first irregular region is eliminated",
        "so",
        SWEEP,
        "-",
        only_first_eliminated,
        full=True,
    ),
    Claim(
        "4.2",
        "T-periodic with permanent contact below",
        "0.97",
        "up-sweep, last eta with contact; branch",
        LIMIT,
        contact_limit("plastic", "0.97", 0.90),
        full=True,
    ),
    Claim(
        "4.2",
        "T-periodic below 1.37",
        "all",
        SWEEP,
        "-",
        all_periodic("plastic", 0.1, 1.37),
        full=True,
    ),
    Claim(
        "4.2",
        "three impacts from",
        "0.97",
        BRANCH,
        LIMIT,
        start("plastic", "0.97", "T/3", 1.0),
        full=True,
    ),
    Claim(
        "4.2",
        "three impacts up to",
        "1.02",
        BRANCH,
        LIMIT,
        edge("plastic", "1.02", "T/3", 1.0),
        full=True,
    ),
    Claim(
        "4.2",
        "two impacts up to",
        "1.23",
        BRANCH,
        LIMIT,
        edge("plastic", "1.23", "T/2", 1.1),
        full=True,
    ),
    Claim("4.2", "max xi_Rel", "16.41", "up-sweep, exact", NUMBER, HEIGHT_42),
    Claim("4.2", "its place", "1.048", "up-sweep", NUMBER, PLACE_42),
    Claim(
        "4.2",
        "one impact from 1.23 to 1.37, above as for e = 0.7",
        "the same",
        SWEEP,
        "-",
        as_before("plastic", 1.23, 2.6),
        full=True,
    ),
    Claim(
        "4.2",
        "the range of permanent contact is enlarged",
        "larger",
        "up-sweeps",
        "-",
        more_contact,
        full=True,
    ),
    Claim(
        "4.2",
        "only the range of lower eta is significantly affected",
        "only lower eta",
        "branches: exact limits of both cases",
        "10 % and 2 %",
        only_lower,
    ),
)
