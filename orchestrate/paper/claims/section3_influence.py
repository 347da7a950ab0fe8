"""Claims of section 3.2: irregular regions, the main peak, what is quasi-periodic, the decay."""

from __future__ import annotations

import numpy as np

from ..windows import relative_peak
from .claim import NO, PARTLY, YES, Claim, Finding, holds, limit_at, number_at
from .results import (
    Results,
    between,
    impacts_in_response,
    kind,
    longest_edges,
    lower_edge,
    shares,
    upper_edge,
)
from .section3 import LIMIT, NUMBER


def first_region_ends(results: Results) -> Finding:
    """Where the first irregular region ends."""
    up, down = results.up("elastic"), results.down("elastic")
    on_way_down = lower_edge(down, kind(down, 1, 1), 2.0)
    why = (
        f"On the way down the T-periodic response lives on to {on_way_down[1]:.3f}: in between two "
        "responses coexist."
    )
    return limit_at(lower_edge(up, kind(up, 1, 1), 2.0), "1.37", why)


def impacts_decrease(results: Results) -> Finding:
    """Impacts of T-periodic responses from 0.43 to 0.9."""
    part = between(results.up("elastic"), 0.43, 0.9)
    counts = impacts_in_response(part)[part.multiplicity.values == 1]
    steps = list(dict.fromkeys(counts[counts > 0].tolist()))
    return holds(
        [all(a > b for a, b in zip(steps, steps[1:], strict=False))],
        "T-periodic with " + ", ".join(map(str, steps)) + " impacts in turn",
    )


def two_impacts_from(results: Results) -> Finding:
    """Where the T-periodic response with two impacts begins."""
    up = results.up("elastic")
    return limit_at(lower_edge(up, kind(up, 1, 2), 1.0), "0.89")


def peak_height(results: Results) -> Finding:
    """The largest gap of all."""
    return number_at(float(results.up("elastic").xi_rel_max.max()), "21.56", 3)


def peak_place(results: Results) -> Finding:
    """Where the largest gap is."""
    up, down = results.up("elastic").xi_rel_max, results.down("elastic").xi_rel_max
    others = int(results.get("attractors").number.sel(eta=1.045, method="nearest")) - 1
    why = (
        f"At 1.045 it is {float(up.sel(eta=1.045, method='nearest')):.2f}. The sweep downwards has "
        f"its peak at {float(down.idxmax()):.3f} too, and "
        f"random starts find {others or 'no'} other response there: the place is misprinted or was "
        "read off."
    )
    return number_at(float(up.idxmax()), "1.045", 3, why)


def no_influence(results: Results) -> Finding:
    """Whether the largest gap has an extremum at the natural frequencies."""
    gaps = results.up("elastic").xi_rel_max
    found, parts = [], []
    for eta in (1.0, 1.095):
        near = gaps.sel(eta=slice(eta - 0.0105, eta + 0.0105)).values
        change = np.diff(np.log(near))
        parts.append(bool((change > 0).all() or (change < 0).all()))
        found.append(
            f"around {eta:g} it changes by {100 * change.min():.1f} to {100 * change.max():.1f} % "
            f"a step, without an extremum: {parts[-1]}"
        )
    return holds(parts, "; ".join(found))


def irregular_again(results: Results) -> Finding:
    """Where the T-periodic response ends above the peak."""
    up = results.up("elastic")
    return limit_at(upper_edge(up, up.multiplicity.values == 1, 1.05), "1.07")


def nearly_2t(results: Results) -> Finding:
    """How nearly responses repeat after 2T in 1.07-1.37."""
    part = between(results.up("elastic"), 1.07, 1.367)
    samples = part.xi_rel.values
    after = [np.sqrt(np.mean((samples[:, n:] - samples[:, :-n]) ** 2, axis=1)) for n in (1, 2)]
    share = np.mean(after[1] < 0.5 * after[0])
    text = (
        f"at {100 * share:.0f} % of the frequencies samples differ less than half as much after 2T "
        "as after T"
    )
    return Finding(text, YES if share > 0.95 else PARTLY if share > 0.5 else NO)


def non_unique(results: Results) -> Finding:
    """Where several attractors are found in 1.07-1.37."""
    data = between(results.get("attractors"), 1.07, 1.37)
    several = data.eta.values[data.share.values[:, 1] >= 0.03]
    up, down = results.up("elastic"), results.down("elastic")
    differ = (
        (impacts_in_response(up) != impacts_in_response(down))
        & (up.eta.values > 1.07)
        & (up.eta.values < 1.37)
    )
    text = (
        f"two or more attractors at {len(several)} of {data.sizes['eta']} frequencies; up and down "
        f"differ at {int(differ.sum())}"
    )
    return holds(
        [len(several) > 0, differ.any()],
        text,
        f"Frequencies: {', '.join(f'{eta:.3f}' for eta in several[:8])}." if len(several) else "",
    )


def second_region(results: Results, printed: str, upper: bool) -> Finding:
    """A limit of the second irregular region, and how far it depends on the tolerance."""
    up = results.up("elastic")
    lower_window, upper_window = (
        longest_edges(up, kind(up, 1, 1)),
        longest_edges(up, kind(up, 2, 1)),
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
        f"{float(row.exponent):.5f} +- {float(row.standard_error):.5f}: stable, but slowly "
        f"decaying, e^(-D tau) being {remaining:.1e} after 500 T, so "
        "that transients widen the samples and the limit read depends on how narrow a band still "
        "counts as a line."
    )
    return limit_at(limit, printed, why)


def second_region_begins(results: Results) -> Finding:
    """Where the second region begins."""
    return second_region(results, "2.61", False)


def second_region_ends(results: Results) -> Finding:
    """Where the second region ends."""
    return second_region(results, "3.77", True)


def chaos(results: Results) -> Finding:
    """Whether dark regions are quasi-periodic and not chaotic, by region and case."""
    text, parts = [], []
    for low, high in ((0.43, 0.89), (1.07, 1.37), (2.61, 3.77), (4.72, 5.75), (6.76, 7.96)):
        chaotic, neutral, top, error, eta = shares(results.exponent("elastic"), low, high)
        text.append(
            f"{low}-{high}: {100 * chaotic:.0f} % chaotic, {100 * neutral:.0f} % neutral, largest "
            f"{top:.3f} +- {error:.3f} at {eta:.3f}"
        )
        parts.append(chaotic < 0.02)
    plastic = shares(results.exponent("plastic"), 2.61, 3.77)
    damped = shares(results.exponent("damped"), 2.61, 3.77)
    why = (
        "The dark bands are chaotic over wide ranges of eta, exponents many standard errors above "
        "zero. At e = 0.3, D = 0.005 the second region "
        f"is mostly quasi-periodic or periodic ({100 * plastic[1]:.0f} % neutral, "
        f"{100 * plastic[0]:.0f} % chaotic); at e = 0.7, D = 0.05 "
        f"{100 * damped[0]:.0f} % of it is chaotic."
    )
    return holds(parts, "; ".join(text), why)


def impulse_peak(results: Results) -> Finding:
    """Where the largest closing velocity is."""
    speed = results.steady("elastic").closing_max
    eta = float(speed.idxmax())
    return holds(
        [abs(eta - 1.045) <= 0.01],
        f"largest closing velocity {float(speed.max()):.2f} at {eta:.3f}",
    )


def decay(results: Results) -> Finding:
    """Displacement and velocity at the peaks of the windows."""
    up, steady = results.up("elastic"), results.steady("elastic")
    etas = [float(up.xi_rel_max.idxmax())] + [
        eta for n in (1, 2, 3) if (eta := relative_peak(up, n))
    ]
    gaps = [float(up.xi_rel_max.sel(eta=eta)) for eta in etas]
    speeds = [float(steady.closing_max.sel(eta=eta, method="nearest")) for eta in etas]
    text = "; ".join(
        f"{eta:.3f}: {gap:.3g}, {speed:.3g}"
        for eta, gap, speed in zip(etas, gaps, speeds, strict=True)
    )
    falls = [a > b for values in (gaps, speeds) for a, b in zip(values, values[1:], strict=False)]
    return holds([*falls, gaps[0] > 1000 * gaps[-1]], "eta: largest gap, closing velocity: " + text)


SWEEP = "up-sweep, multiplicity and impacts"
CLAIMS = (
    Claim("3.2", "the first irregular region ends", "1.37", SWEEP, LIMIT, first_region_ends),
    Claim(
        "3.2", "impacts during one T decrease with eta", "decreasing", SWEEP, "-", impacts_decrease
    ),
    Claim("3.2", "T-periodic with two impacts from", "0.89", SWEEP, LIMIT, two_impacts_from),
    Claim(
        "3.2",
        "absolute resonance peak, max xi_Rel",
        "21.56",
        "up-sweep, largest xi_Rel over time, exact",
        NUMBER,
        peak_height,
    ),
    Claim("3.2", "place of the peak", "1.045", "up-sweep", NUMBER, peak_place),
    Claim(
        "3.2",
        "eta = 1.0 and 1.095 have no influence",
        "none",
        "up-sweep: extrema of the largest gap within 0.01",
        "-",
        no_influence,
    ),
    Claim(
        "3.2",
        "bifurcated and quasi-periodic responses interchange again from",
        "1.07",
        SWEEP,
        LIMIT,
        irregular_again,
    ),
    Claim(
        "3.2",
        "responses in 1.07-1.37 are approximately 2T-periodic",
        "all",
        "up-sweep: stroboscopic samples",
        "95 %",
        nearly_2t,
    ),
    Claim(
        "3.2",
        "non-unique solutions in 1.07-1.37",
        "found",
        "random starts (3 % of them or more); up- against down-sweep",
        "-",
        non_unique,
    ),
    Claim("3.2", "the second irregular region begins", "2.61", SWEEP, LIMIT, second_region_begins),
    Claim("3.2", "the second irregular region ends", "3.77", SWEEP, LIMIT, second_region_ends),
    Claim(
        "3.2",
        "dark regions are quasi-periodic; that chaos begins there is disproved",
        "no chaos",
        "largest Lyapunov exponents",
        "3 standard errors",
        chaos,
    ),
    Claim(
        "3.2",
        "impulses are extremal near the absolute peak",
        "1.045",
        "impact by impact",
        "0.01",
        impulse_peak,
    ),
    Claim(
        "3.2",
        "displacement and velocity diminish by powers of ten with eta",
        "decaying",
        "at the relative peaks",
        "-",
        decay,
    ),
)
