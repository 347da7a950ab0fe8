"""What the paper could not ask: chaos by region, where a delamination shows, what coexists."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from ...dynamics.lyapunov import PERIODIC
from ..cases import CASES, MAPS
from .results import Region, Results, between, shares

LEAST = 0.01  # share of chaotic or neutral responses from which a region is called so


def regions(datasets: Mapping[str, xr.Dataset]) -> list[dict[str, str]]:
    """Return the verdict on each region of each case, between exact limits, as texts.

    Parameters
    ----------
    datasets : mapping of xarray.Dataset
        By name.
    """
    results = Results(datasets)
    return [
        {"case": f"e = {case.e:g}, D = {case.get('D'):g}", **region_row(results, name, region)}
        for name, case in CASES.items()
        for region in results.regions(name)
    ]


def region_row(results: Results, case: str, region: Region) -> dict[str, str]:
    """Return one region; the largest exponent by a run of its own, with one standard error."""
    low, high, name = region
    chaotic, neutral = shares(results, case, low, high)
    kinds = {"chaotic in part": chaotic, "neutral in part": neutral, "periodic": 1.0}
    return {
        "region": f"{low:.5f} to {high:.5f} ({name})",
        "chaotic": f"{100 * chaotic:.0f} %",
        "neutral": f"{100 * neutral:.0f} %",
        "count": str(between(results.exponent(case), low, high).sizes["eta"]),
        "largest": results.largest(case, region).text(),
        "verdict": next(word for word, share in kinds.items() if share > LEAST),
    }


def sentences(datasets: Mapping[str, xr.Dataset]) -> list[str]:
    """Return the other answers, a sentence each.

    Parameters
    ----------
    datasets : mapping of xarray.Dataset
        By name.
    """
    return [
        *(
            strongest(datasets[f"map_{parameter}"], datasets[f"peak_{parameter}"], parameter)
            for parameter in MAPS
        ),
        coexisting(datasets["basin"]),
        compare_spectra(datasets["spectra"]),
    ]


def strongest(data: xr.Dataset, run_on: xr.Dataset, parameter: str) -> str:
    """Return where the largest impulse of a map is, how large it is in a longer run, and how wide.

    Parameters
    ----------
    data : xarray.Dataset
        The map.
    run_on : xarray.Dataset
        Its largest response, followed longer.
    parameter : str
    """
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


def coexisting(data: xr.Dataset) -> str:
    """Format the attractors of the basin picture, with their shares of the plane."""
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


def compare_spectra(data: xr.Dataset) -> str:
    """Return how much of the delaminated structure's acceleration lies above the excitation."""
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
