"""Section 3.2: irregular regions, chaos, coexisting responses, what fades with the frequency."""

from __future__ import annotations

import numpy as np

from ...dynamics.lyapunov import CHAOTIC
from .. import reading
from ..cases import CASES
from ..claims import Claim, Measured
from ..datasets import Datasets


def check_impacts_decrease(data: Datasets, claim: Claim) -> Measured:
    """Count the impacts of T-periodic responses from 0.43 to 0.9."""
    part = reading.between(data.up_sweep("elastic"), 0.43, 0.9)
    steps = reading.successive_impact_numbers(part) or [0]
    text = f"T-periodic with {', '.join(map(str, steps))} impacts in turn"
    return Measured(text, [steps[0] > steps[-1], reading.strictly_decreases(steps)])


def check_periodic_and_irregular_interchange(data: Datasets, claim: Claim) -> Measured:
    """Find T-periodic responses from 0.43 to 0.89, and what is between them."""
    settled = reading.between(data.settled_responses("elastic"), 0.43, 0.89)
    windows = reading.runs_of_true(settled.multiplicity.values == 1)
    chaotic, neutral = data.shares_chaotic_and_neutral("elastic", 0.43, 0.89)
    text = (
        "T-periodic, by number of impacts: "
        f"{', '.join(run.format() for run in reading.impact_runs(settled))}; {100 * chaotic:.0f} % "
        f"of all frequencies chaotic, {100 * neutral:.0f} % neutral"
    )
    return Measured(text, [len(windows) > 2, neutral > chaotic])


def find_extrema_at_natural_frequencies(data: Datasets, claim: Claim) -> Measured:
    gaps, texts, parts = data.up_sweep("elastic").xi_rel_max, [], []
    for eta in (1.0, 1.095):
        change = np.diff(np.log(gaps.sel(eta=slice(eta - 0.0105, eta + 0.0105)).values))
        parts.append(bool((change > 0).all() or (change < 0).all()))
        texts.append(
            f"around {eta:g} it changes by {100 * change.min():.1f} to {100 * change.max():.1f} % "
            f"a step, without an extremum: {parts[-1]}"
        )
    return Measured("; ".join(texts), parts)


def measure_share_nearly_2t_periodic(data: Datasets, claim: Claim) -> Measured:
    """Measure at how many frequencies samples differ less than half as much after 2T as after T."""
    samples = reading.between(data.up_sweep("elastic"), 1.07, 1.367).xi_rel.values
    one, two = (np.square(samples[:, n:] - samples[:, :-n]).mean(axis=1) for n in (1, 2))
    share = float(np.mean(np.sqrt(two) < 0.5 * np.sqrt(one)))
    text = (
        f"at {100 * share:.0f} % of the frequencies samples differ less than half as much after 2T "
        "as after T"
    )
    return Measured(text, [share > 0.95, share > 0.5])


def count_coexisting_attractors(data: Datasets, claim: Claim) -> Measured:
    """Count frequencies from 1.07 to 1.37 with several attractors, and where sweeps differ."""
    found = reading.between(data.attractors(), 1.07, 1.37)
    sweeps = data.up_sweep("elastic"), data.down_sweep("elastic")
    up, down = (reading.between(one, 1.0701, 1.3699) for one in sweeps)
    several = found.eta.values[found.number.values > 1]
    periodic = int(((found.multiplicity.values > 0).sum(axis=1) > 1).sum())
    differ = int((reading.impacts_in_response(up) != reading.impacts_in_response(down)).sum())
    text = (
        f"two or more attractors at {len(several)} of {found.sizes['eta']} frequencies, two "
        f"periodic at {periodic}; up and down differ at {differ}"
    )
    low = data.window_nearest("elastic", "T/1", 2.0).low
    high = data.window_nearest("elastic", "2T/3", 1.36).high
    text += f"; by exact limits T and 2T with three impacts coexist from {low:.5f} to {high:.5f}"
    if len(several):
        groups = np.split(several, np.flatnonzero(np.diff(several) > 0.006) + 1)
        text += f"; starts find two at {', '.join(f'{g[0]:.3f} to {g[-1]:.3f}' for g in groups)}"
    return Measured(text, [periodic > 0, differ > 0])


def measure_share_without_period(data: Datasets, claim: Claim) -> Measured:
    n = reading.between(data.settled_responses("elastic"), 1.07, 1.367).multiplicity.values
    text = (
        f"at {100 * np.mean(n == 0):.0f} % of the frequencies impacts do not repeat; at "
        f"{100 * np.mean(n == 2):.0f} % they repeat after 2T, at {100 * np.mean(n > 2):.0f} % "
        "after more"
    )
    return Measured(text, [bool((n == 0).any()), bool((n == 0).all())])


def measure_one_impact_share_beside_region_2(data: Datasets, claim: Claim) -> Measured:
    """Measure the share of one-impact responses in the T and 2T windows beside region 2."""
    text, parts = [], []
    for n, low, high in ((1, 1.37, 2.61), (2, 3.77, 4.74)):
        part = reading.between(data.settled_responses("elastic"), low, high)
        one = (part.multiplicity.values == n) & (reading.impacts_in_response(part) == 1)
        text.append(f"{low} to {high}: {100 * one.mean():.1f} % of {len(one)} frequencies")
        parts.append(bool(one.all()))
    return Measured("; ".join(text), parts)


def measure_chaos_by_region(data: Datasets, claim: Claim) -> Measured:
    """Measure how much of each irregular region is chaotic, and its largest exponent."""
    text, parts = [], []
    for region in data.regions("elastic"):
        if not region.is_window:
            chaotic, neutral = data.shares_chaotic_and_neutral("elastic", region.low, region.high)
            largest = largest_exponent_text(data, "elastic", region)
            text.append(
                f"{region.low:.3f}-{region.high:.3f}: {100 * chaotic:.0f} % chaotic, "
                f"{100 * neutral:.0f} % neutral, largest {largest}"
            )
            parts.append(chaotic < 0.02)
    return Measured("; ".join(text), parts)


def count_irregular_by_region(data: Datasets, claim: Claim) -> Measured:
    """Count responses that do not repeat, between windows nT and (n+1)T and elsewhere."""
    settled, exponents = data.settled_responses("elastic"), data.lyapunov_exponents("elastic")
    text, inside, outside = [], 0, 0
    for low, high, name in (region for region in data.regions("elastic") if not region.is_window):
        irregular = reading.between(settled, low, high).multiplicity.values == 0
        chaotic = reading.between(exponents, low, high).verdict.values == CHAOTIC
        count, sure = int(irregular.sum()), int((irregular & chaotic).sum())
        if name.split(" to ")[0].endswith("T/1"):
            inside += count
        else:
            outside += count
            text.append(f"{count} from {low:.3f} to {high:.3f} ({name}; {sure} of them chaotic)")
    found = (
        f"of {inside + outside} settled responses that do not repeat {inside} lie between windows "
        f"nT and (n+1)T of one impact; {'; '.join(text)}"
    )
    return Measured(found, [outside == 0, inside > 0])


def count_hidden_impact_numbers(data: Datasets, claim: Claim) -> Measured:
    kinds = np.unique([run.impacts for run in reading.impact_runs(data.up_sweep("elastic"))] or [0])
    text = (
        f"T-periodic responses, one line each in Figure 6, have {kinds.min()} to {kinds.max()} "
        f"impacts in T, {len(kinds)} different numbers"
    )
    return Measured(text, [len(kinds) > 1])


def find_peak_of_closing_velocity(data: Datasets, claim: Claim) -> Measured:
    speed = data.impact_statistics("elastic").closing_max
    eta = float(speed.idxmax())
    text = f"largest closing velocity {float(speed.max()):.2f} at {eta:.3f}"
    return Measured(text, [abs(eta - float(claim.printed)) <= 0.01])


def measure_decay_between_peaks(data: Datasets, claim: Claim) -> Measured:
    """Measure by which factors gap and closing velocity fall from peak to peak."""
    up, speed = data.up_sweep("elastic"), data.impact_statistics("elastic").closing_max
    etas = [float(up.xi_rel_max.idxmax()), *(reading.relative_peak_eta(up, n) for n in (1, 2, 3))]
    if None in etas:
        return Measured("a window without a relative peak", [])
    sizes = up.xi_rel_max, speed
    rows = [[float(one.sel(eta=eta, method="nearest")) for one in sizes] for eta in etas]
    listed = zip(etas, rows, strict=True)
    text = "; ".join(f"{eta:.3f}: {gap:.3g}, {velocity:.3g}" for eta, (gap, velocity) in listed)
    factors = np.divide(rows[:-1], rows[1:])
    by = "; ".join(f"{a:.3g}, {b:.3g}" for a, b in factors)
    text = f"eta: largest gap, closing velocity: {text}; they fall by {by}"
    return Measured(text, (factors >= 10.0).ravel().tolist())


def compare_with_single_oscillator(data: Datasets, claim: Claim) -> Measured:
    up, case = data.up_sweep("elastic"), CASES["elastic"]
    stiffness = (1.0 + case.kappa) / (1.0 + case.mu)
    text, away = [], []
    for eta in (1.047, 2.07, 4.166, 6.268, 8.0):
        row = up.sel(eta=eta, method="nearest")
        alone = 1.0 / np.hypot(stiffness - eta**2, 2.0 * case.get("D") * eta)
        ratios = [float(row[f"xi{mass}_max"]) / alone for mass in (1, 2)]
        away.append(max(abs(ratio - 1.0) for ratio in ratios))
        gap = float(row.xi_rel_max / row.xi1_max)
        text.append(f"{eta:g}: {ratios[0]:.3f}, {ratios[1]:.3f}, gap {gap:.2f}")
    near = [part < 0.1 for part in away[1:]]  # beyond the main peak
    falls = all(a > b for a, b in zip(away[1:], away[2:], strict=False))
    what = "amplitudes of both masses over that of both as one (6), and gap over amplitude"
    return Measured(f"{what}: {'; '.join(text)}", [*near, falls])


def region_table_rows(data: Datasets) -> list[dict[str, str]]:
    """Return a row of texts for each region of each case: limits, chaotic share, verdict."""
    rows = []
    for case, structure in CASES.items():
        for region in data.regions(case):
            chaotic, neutral = data.shares_chaotic_and_neutral(case, region.low, region.high)
            kinds = {"chaotic in part": chaotic, "neutral in part": neutral, "periodic": 1.0}
            settled = reading.between(data.settled_responses(case), *region[:2])
            row = {
                "case": f"e = {structure.e:g}, D = {structure.get('D'):g}",
                "region": f"{region.low:.5f} to {region.high:.5f} ({region.name})",
                "chaotic": f"{100 * chaotic:.0f} %",
                "neutral": f"{100 * neutral:.0f} %",
                "count": str(settled.sizes["eta"]),
                "largest": largest_exponent_text(data, case, region),
                "verdict": next(word for word, share in kinds.items() if share > 0.01),
            }
            rows.append(row)
    return rows


def largest_exponent_text(data: Datasets, case: str, region: reading.Region) -> str:
    """Return a region's largest exponent with its error and place, from long runs."""
    # an exponent of which less than half is left there is named: its chaos has ended
    exponents = data.largest_exponents(case), data.lyapunov_exponents(case)
    part, first = (reading.between(one, *region[:2]) for one in exponents)
    best = part.isel(eta=int(part.exponent.values.argmax()))
    text = f"{float(best.exponent):.4f} ± {float(best.standard_error):.4f} at {float(best.eta):.3f}"
    for one in (part.isel(eta=k) for k in range(part.sizes["eta"])):
        screened = float(first.exponent.sel(eta=one.eta))
        if screened > 0.001 and float(one.exponent) < 0.5 * screened:
            text += f" ({screened:.4f} at {float(one.eta):.3f} did not last)"
    return text
