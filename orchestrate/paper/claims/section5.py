"""Checks of section 5: amplitudes and impulses at the main peak, case by case."""

from __future__ import annotations

import numpy as np

from ..cases import CASES
from .claim import Finding, check_parts, register_claim
from .results import Results

SAME_PLACE = 0.01  # in eta
SAME_ORDER = 10.0**0.5  # two numbers within such a factor are of the same order
HOW = "impact by impact at each up-sweep's peak; impulse (1+e) mu/(1+mu) times the closing velocity"


def peak_impulses(results: Results, case: str) -> tuple[float, float]:
    """Return a case's largest impulse at its peak over m1 omega a eta^2, and the sum in one T."""
    eta = float(results.up(case).xi_rel_max.idxmax())
    row = results.impact_statistics(case).sel(eta=eta, method="nearest")
    structure = CASES[case]
    factor = (1.0 + structure.e) * structure.mu / (1.0 + structure.mu)  # (15)
    return factor * float(row.closing_max), factor * float(row.closing_sum)


def amplitude(results: Results, index: int) -> float:
    """Return the largest displacement of either mass on one panel of Figure 12."""
    data = results.get("figure12")
    return float(np.abs(data.state.values[data.panel_of.values == index][:, :2]).max())


def compare_with_elastic(results: Results, case: str) -> tuple[float, float, str]:
    """Return a case's impulse and amplitude over the elastic case's, with a text."""
    (own, own_sum), (first, first_sum) = (
        peak_impulses(results, case),
        peak_impulses(results, "elastic"),
    )
    impulse, size = own / first, amplitude(results, list(CASES).index(case)) / amplitude(results, 0)
    text = (
        f"largest impulse {own:.3g} against {first:.3g}: ratio {impulse:.3f}; sum over T "
        f"{own_sum / first_sum:.3f}; amplitude {size:.3f}"
    )
    return impulse, size, text


@register_claim(
    "5",
    "amplitudes and impulses are both largest at the main resonance peak",
    "same place",
    HOW,
    "0.01 in eta",
)
def check_both_at_peak(results: Results) -> Finding:
    """Check that amplitudes of both masses and impulses are largest at the main peak."""
    text, parts, kept = [], [], []
    for case in CASES:
        up, speed = results.up(case), results.impact_statistics(case).closing_max
        peak = float(up.xi_rel_max.idxmax())
        places = [float(up[name].idxmax()) for name in ("xi1_max", "xi2_max")]
        places.append(float(speed.idxmax()))
        text.append(
            f"{case}: largest gap at {peak:.3f}, amplitudes at {places[0]:.3f} and "
            f"{places[1]:.3f}, impulse at {places[2]:.3f}"
        )
        parts += [abs(place - peak) <= SAME_PLACE for place in places]
        there = [up.xi1_max, up.xi2_max, speed]
        shares = [float(one.sel(eta=peak, method="nearest") / one.max()) for one in there]
        kept.append(f"{100 * min(shares):.0f} %")
    why = f"At the largest gap each is still {', '.join(kept)} of its largest value or more."
    return check_parts(parts, "; ".join(text), why if not all(parts) else "")


@register_claim(
    "5", "T-periodic motion with two impacts at all three peaks (Figure 12)", "two", HOW
)
def check_two_impacts_each(results: Results) -> Finding:
    """Check that responses at the peaks have two impacts per period."""
    counts = [
        float(
            results.impact_statistics(case).impacts.sel(
                eta=float(results.up(case).xi_rel_max.idxmax()), method="nearest"
            )
        )
        for case in CASES
    ]
    periods = [int(up.multiplicity[up.xi_rel_max.values.argmax()]) for up in map(results.up, CASES)]
    return check_parts(
        [abs(count - 2.0) < 0.02 and n == 1 for count, n in zip(counts, periods, strict=True)],
        ", ".join(
            f"{count:.0f} in T, {n}T-periodic" for count, n in zip(counts, periods, strict=True)
        ),
    )


@register_claim(
    "5",
    "large damping: amplitudes and impulses low, Figure 12(b) against (a)",
    "low",
    HOW,
    "a factor of 10^0.5",
)
def check_damping_lowers(results: Results) -> Finding:
    """Check that damping lowers impulses and amplitudes, case (b) over (a)."""
    impulse, size, text = compare_with_elastic(results, "damped")
    return check_parts([impulse < 1 / SAME_ORDER, size < 1 / SAME_ORDER], text)


@register_claim(
    "5",
    "low restitution: impulses of the same order, Figure 12(c) against (a)",
    "same order",
    HOW,
    "a factor of 10^0.5",
)
def check_restitution_minor(results: Results) -> Finding:
    """Check that restitution changes impulses little, case (c) over (a)."""
    impulse, _, text = compare_with_elastic(results, "plastic")
    return check_parts([1 / SAME_ORDER < impulse < SAME_ORDER], text)
