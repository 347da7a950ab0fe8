"""Section 5: amplitudes and impulses at the main peak, case by case."""

from __future__ import annotations

import numpy as np

from ..cases import CASES
from ..claims import Claim, Measured
from ..datasets import Datasets

SAME_ORDER = 10.0**0.5  # two numbers within such a factor are of the same order


def peak_eta(data: Datasets, case: str) -> float:
    return float(data.up_sweep(case).xi_rel_max.idxmax())


def peak_impulses(data: Datasets, case: str) -> np.ndarray:
    """Return a case's largest impulse at its peak over m1 omega a eta^2, and the sum in one T."""
    row = data.impact_statistics(case).sel(eta=peak_eta(data, case), method="nearest")
    mu = CASES[case].mu
    factor = (1.0 + CASES[case].e) * mu / (1.0 + mu)  # (15)
    return factor * np.array([float(row.closing_max), float(row.closing_sum)])


def peak_amplitude(data: Datasets, case: str) -> float:
    """Return the largest displacement of either mass on a case's panel of Figure 12."""
    figure = data.figure_curves("12")
    there = figure.panel_of.values == list(CASES).index(case)
    return float(np.abs(figure.state.values[there, :2]).max())


def ratios_to_elastic(data: Datasets, case: str) -> tuple[float, float, str]:
    """Return a case's impulse and amplitude over the elastic case's, with a text."""
    (own, own_sum), (first, first_sum) = (peak_impulses(data, one) for one in (case, "elastic"))
    size = peak_amplitude(data, case) / peak_amplitude(data, "elastic")
    text = (
        f"largest impulse {own:.3g} against {first:.3g}: ratio {own / first:.3f}; sum over T "
        f"{own_sum / first_sum:.3f}; amplitude {size:.3f}"
    )
    return own / first, size, text


def find_largest_amplitudes_and_impulses(data: Datasets, claim: Claim) -> Measured:
    text, parts = [], []
    for case in CASES:
        up, eta = data.up_sweep(case), peak_eta(data, case)
        sizes = [up.xi1_max, up.xi2_max, data.impact_statistics(case).closing_max]
        places = [float(one.idxmax()) for one in sizes]
        kept = min(float(one.sel(eta=eta, method="nearest") / one.max()) for one in sizes)
        text.append(
            f"{case}: largest gap at {eta:.3f}, amplitudes at {places[0]:.3f} and {places[1]:.3f}, "
            f"impulse at {places[2]:.3f}, at the gap's still {100 * kept:.0f} %"
        )
        parts += [abs(place - eta) <= 0.01 for place in places]  # in eta
    return Measured("; ".join(text), parts)


def count_impacts_at_peaks(data: Datasets, claim: Claim) -> Measured:
    etas = {case: peak_eta(data, case) for case in CASES}
    rows = (data.impact_statistics(case).sel(eta=etas[case], method="nearest") for case in etas)
    counts = [float(row.impacts) for row in rows]
    periods = [int(data.up_sweep(case).multiplicity.sel(eta=etas[case])) for case in etas]
    listed = list(zip(counts, periods, strict=True))
    texts = (f"{count:.0f} in T, {n if n > 1 else ''}T-periodic" for count, n in listed)
    return Measured(", ".join(texts), [abs(count - 2.0) < 0.02 and n == 1 for count, n in listed])


def compare_damped_with_elastic(data: Datasets, claim: Claim) -> Measured:
    impulse, size, text = ratios_to_elastic(data, "damped")
    return Measured(text, [impulse < 1 / SAME_ORDER, size < 1 / SAME_ORDER])


def compare_plastic_with_elastic(data: Datasets, claim: Claim) -> Measured:
    impulse, _, text = ratios_to_elastic(data, "plastic")
    return Measured(text, [1 / SAME_ORDER < impulse < SAME_ORDER])
