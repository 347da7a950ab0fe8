"""Answers beyond the paper's claims: chaos by region, largest impulses, coexisting attractors."""

from __future__ import annotations

from .cases import CASES, MAPS
from .datasets import Datasets
from .reading import Region, between

LEAST = 0.01  # share of chaotic or neutral responses from which a region is called so


def region_rows(data: Datasets) -> list[dict[str, str]]:
    """Return a row of texts for each region of each case: limits, chaotic share, verdict."""
    rows = []
    for case, structure in CASES.items():
        for region in data.regions(case):
            chaotic, neutral = data.shares(case, region.low, region.high)
            kinds = {"chaotic in part": chaotic, "neutral in part": neutral, "periodic": 1.0}
            rows.append(
                {
                    "case": f"e = {structure.e:g}, D = {structure.get('D'):g}",
                    "region": f"{region.low:.5f} to {region.high:.5f} ({region.name})",
                    "chaotic": f"{100 * chaotic:.0f} %",
                    "neutral": f"{100 * neutral:.0f} %",
                    "count": str(between(data.settled(case), *region[:2]).sizes["eta"]),
                    "largest": largest_text(data, case, region),
                    "verdict": next(word for word, share in kinds.items() if share > LEAST),
                }
            )
    return rows


def largest_text(data: Datasets, case: str, region: Region) -> str:
    """Return a region's largest exponent with its error and place, from long runs.

    The largest of many exponents is biased by its error: they only say where to look. One of
    which less than half is left in a long run is named: its chaos has ended.
    """
    part, first = (between(one, *region[:2]) for one in (data.largest(case), data.exponent(case)))
    best = part.isel(eta=int(part.exponent.values.argmax()))
    text = f"{float(best.exponent):.4f} ± {float(best.standard_error):.4f} at {float(best.eta):.3f}"
    for one in (part.isel(eta=k) for k in range(part.sizes["eta"])):
        screened = float(first.exponent.sel(eta=one.eta))
        if screened > 0.001 and float(one.exponent) < 0.5 * screened:
            text += f" ({screened:.4f} at {float(one.eta):.3f} did not last)"
    return text


def answer_sentences(data: Datasets) -> list[str]:
    """Return a sentence each on largest impulses, coexisting attractors and spectra."""
    impulses = [describe_largest_impulse(data, parameter) for parameter in MAPS]
    return [*impulses, describe_basin(data), describe_spectra(data)]


def describe_largest_impulse(data: Datasets, parameter: str) -> str:
    """Return a sentence on a map's largest impulse: where it is, and its size in a longer run."""
    impulses, run_on = data.map(parameter).impulse_max, data.map_peak(parameter)
    best = impulses.where(impulses == impulses.max(), drop=True)
    structure = CASES["elastic"].replace(**{parameter: float(best[parameter][0])})
    here = (1.0 + structure.e) * structure.mu / (1.0 + structure.mu) * run_on.closing_max.item()
    irregular = run_on.exponent.item() > 3.0 * run_on.standard_error.item()
    etas = impulses.eta.values[(impulses.max(parameter) > 0.5 * impulses.max()).values]
    extent = f"eta = {etas.min():.2f}"
    if len(etas) > 1:
        extent += f" to {etas.max():.2f}"
    return (
        f"Over (eta, {parameter}) impulses are largest at eta = {float(best.eta[0]):.2f}, "
        f"{parameter} = {float(best[parameter][0]):.3g}: {here:.3g} m_1 omega a eta^2 at most in "
        f"{run_on.attrs['periods']} periods of the {'irregular' if irregular else 'periodic'} "
        f"response there ({float(impulses.max()):.3g} in those of the map); more than half of the "
        f"map's largest is reached for some {parameter} at {extent}."
    )


def describe_basin(data: Datasets) -> str:
    """Return a sentence on the basin's attractors and their shares of the starts."""
    basin, kinds = data.basin(), []
    for k in range(min(4, basin.sizes["attractor"])):
        n, share = int(basin.multiplicity[k]), 100 * float(basin.share[k])
        kind = f"{n if n > 1 else ''}T-periodic" if n else "not periodic"
        impacts = float(basin.impacts_per_period[k])
        kinds.append(f"{kind} with {impacts:.2f} impacts per T from {share:.1f} %")
    y, x = (basin[name].values for name in basin.attractor_of.dims)
    return (
        f"At eta = {float(basin.eta):.3f} the plane of starts with mass 1 at rest in its middle at "
        f"phase 0, gap {x[0]:.3g} to {x[-1]:.3g}, gap velocity {y[0]:.3g} to {y[-1]:.3g} "
        f"({basin.attractor_of.size} starts) leads to: {'; '.join(kinds)}. Of another plane the "
        "shares are others."
    )


def describe_spectra(data: Datasets) -> str:
    """Return a sentence comparing spectral lines above the excitation, bonded and delaminated."""
    shown = data.spectra().acceleration.sel(mass=1).isel(eta=0)
    above = shown.where(shown.order > 1.5, drop=True)
    first = float(shown.sel(kind="delaminated").max())
    bonded, delaminated, sampled = (
        float(above.sel(kind=kind).max()) / first for kind in ("bonded", "delaminated", "sampled")
    )
    return (
        f"At eta = {float(shown.eta):.3f} the largest line above the excitation's frequency is "
        f"{delaminated:.3f} of the largest of all in the "
        f"delaminated structure's acceleration ({sampled:.3f} in sampled accelerations, which lack "
        f"the impulses), {bonded:.1e} in the bonded one's."
    )
