"""Answers beyond the paper's claims: chaos by region, largest impulses, coexisting attractors."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from ...dynamics.lyapunov import PERIODIC
from ..cases import CASES, MAPS
from .results import Region, Results, between, irregular_shares

LEAST = 0.01  # share of chaotic or neutral responses from which a region is called so


def region_rows(datasets: Mapping[str, xr.Dataset]) -> list[dict[str, str]]:
    """Return a row of texts for each region of each case: limits, chaotic share, verdict."""
    results = Results(datasets)
    return [
        {"case": f"e = {case.e:g}, D = {case.get('D'):g}", **region_row(results, name, region)}
        for name, case in CASES.items()
        for region in results.regions(name)
    ]


def region_row(results: Results, case: str, region: Region) -> dict[str, str]:
    """Return a region's row: limits, chaotic and neutral shares, largest exponent, verdict."""
    low, high, name = region
    chaotic, neutral = irregular_shares(results, case, low, high)
    kinds = {"chaotic in part": chaotic, "neutral in part": neutral, "periodic": 1.0}
    return {
        "region": f"{low:.5f} to {high:.5f} ({name})",
        "chaotic": f"{100 * chaotic:.0f} %",
        "neutral": f"{100 * neutral:.0f} %",
        "count": str(between(results.exponent(case), low, high).sizes["eta"]),
        "largest": results.largest_exponent(case, region).text(),
        "verdict": next(word for word, share in kinds.items() if share > LEAST),
    }


def answer_sentences(datasets: Mapping[str, xr.Dataset]) -> list[str]:
    """Return a sentence each on largest impulses, coexisting attractors and spectra."""
    return [
        *(
            describe_largest_impulse(
                datasets[f"map_{parameter}"], datasets[f"peak_{parameter}"], parameter
            )
            for parameter in MAPS
        ),
        describe_attractors(datasets["basin"]),
        describe_spectra(datasets["spectra"]),
    ]


def describe_largest_impulse(data: xr.Dataset, run_on: xr.Dataset, parameter: str) -> str:
    """Return a sentence on a map's largest impulse: where it is, and its size in a longer run."""
    impulses = data.impulse_max
    best = impulses.where(impulses == impulses.max(), drop=True)
    near = impulses.max(parameter) > 0.5 * impulses.max()
    etas = data.eta.values[near.values]
    eta, value = float(best.eta[0]), float(best[parameter][0])
    here, periods = float(run_on.impulse_max[0]), int(run_on.attrs["periods"])
    kind = "periodic" if float(run_on.verdict[0]) == PERIODIC else "irregular"
    extent = f"eta = {etas.min():.2f}"
    if etas.max() > etas.min():
        extent += f" to {etas.max():.2f}"
    return (
        f"Over (eta, {parameter}) impulses are largest at eta = {eta:.2f}, {parameter} = "
        f"{value:.3g}: {here:.3g} m_1 omega a eta^2 at most in {periods} periods of the {kind} "
        f"response there ({float(impulses.max()):.3g} in those of the map); more than half of the "
        f"map's largest is reached for some {parameter} at {extent}."
    )


def describe_attractors(data: xr.Dataset) -> str:
    """Return a sentence on the basin's attractors and their shares of the starts."""
    kinds = []
    for k in range(min(4, data.sizes["attractor"])):
        n = int(data.multiplicity[k])
        kind = f"{n if n > 1 else ''}T-periodic" if n else "not periodic"
        impacts, share = float(data.impacts_per_period[k]), 100 * float(data.share[k])
        kinds.append(f"{kind} with {impacts:.2f} impacts per T from {share:.1f} %")
    y, x = (data[name].values for name in data.attractor_of.dims)
    return (
        f"At eta = {float(data.eta):.3f} the plane of starts with mass 1 at rest in its middle at "
        f"phase 0, gap {x[0]:.3g} to {x[-1]:.3g}, gap velocity {y[0]:.3g} to {y[-1]:.3g} "
        f"({data.attractor_of.size} starts) leads to: {'; '.join(kinds)}. Of another plane the "
        "shares are others."
    )


def describe_spectra(data: xr.Dataset) -> str:
    """Return a sentence comparing spectral lines above the excitation, bonded and delaminated."""
    shown = data.acceleration.sel(mass=1).isel(eta=0)
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
