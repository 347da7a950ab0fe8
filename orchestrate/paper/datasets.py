"""The paper's datasets: each is a call of a public function, made when it is first asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import orchestrate

from ..dynamics.lyapunov import CHAOTIC, NEUTRAL
from ..dynamics.settling import AttractorSettings
from ..dynamics.stable_windows import StableWindow, stable_windows
from ..model import Drive, Structure
from ..model.outcomes import REPEATED
from ..running.store import write_netcdf
from ..weak_drive import averaged
from . import cases
from .cases import CASES
from .curves import Panel, curves_dataset, trace_curve
from .reading import Region, between, list_regions, relative_peak_eta
from .resolution import Resolution

SETTLED: dict[str, Any] = {"samples": 48, "tolerance": 1e-6}  # periods kept; what has repeated
ELASTIC = CASES["elastic"]
Answer = Callable[..., xr.Dataset]


class Datasets:
    """The paper's datasets by what they are; what is stored is read, what is not is computed."""

    def __init__(self, folder: Path, size: Resolution, running: Mapping[str, Any]) -> None:
        self.folder, self.size, self.running = folder, size, dict(running)
        self.known: dict[str, Any] = {}

    def get_or_compute(
        self, name: str, function: Answer, *arguments: Any, **keywords: Any
    ) -> xr.Dataset:
        if name not in self.known:
            store = self.folder / f"{name}.nc"
            self.known[name] = function(*arguments, **keywords, **self.running, store=store)
        return self.known[name]

    # -- sweeps and what follows from their responses ----------------------------------------------

    def sweep(self, case: str, direction: str) -> xr.Dataset:
        name, eta = f"orbit_{CASES[case].label()}_{direction}", self.size.etas()
        more = {"direction": direction, **self.period_keywords()}
        return self.get_or_compute(name, orchestrate.sweep, CASES[case], eta=eta, **more)

    def period_keywords(self) -> dict[str, Any]:
        """Return as keywords the periods dropped and kept: n = 500(1)700 has both ends."""
        return {"transient": self.size.transient - 1, "samples": self.size.samples + 1}

    def up_sweep(self, case: str) -> xr.Dataset:
        return self.sweep(case, "up")

    def down_sweep(self, case: str) -> xr.Dataset:
        return self.sweep(case, "down")

    def impact_statistics(self, case: str) -> xr.Dataset:
        name, eta = f"steady_{CASES[case].label()}_up", self.size.etas()
        more = {"start": self.up_sweep(case), "transient": 0, "periods": self.size.steady}
        ask = orchestrate.impact_statistics
        return self.get_or_compute(name, ask, CASES[case], eta=eta, **more)

    def continued_sweep(self, first: int, count: int | None = None) -> xr.Dataset:
        """Return the elastic up-sweep's responses sampled from n = first on; of all or a few."""
        size, etas = self.size, np.array(self.size.etas())
        if count is not None:
            etas = np.sort(np.random.default_rng(500).choice(etas, count, replace=False))
        done = size.transient + size.samples  # the sweep's last n
        more: dict[str, Any] = {"transient": first - 1 - done, "samples": size.samples + 1}
        more |= {"eta": etas, "start": self.up_sweep("elastic")}
        return self.get_or_compute(f"later_{first}", orchestrate.sweep, ELASTIC, **more)

    def settled_responses(self, case: str) -> xr.Dataset:
        """Return each fifth response of the up-sweep from eta = 0.43, run on until it repeats."""
        name = f"settled_{CASES[case].label()}_up"
        if name not in self.known:
            before, parts, done = self.up_sweep(case), [], 0
            etas = before.eta.values[before.eta.values >= 0.43][::5]
            for stage, periods in enumerate(self.size.stages):
                more = {"start": before, "transient": periods, **SETTLED}
                stored = f"{name}_{stage}"
                part = self.get_or_compute(stored, orchestrate.sweep, CASES[case], eta=etas, **more)
                before, done = part, done + periods + part.sizes["sample"]
                repeats = (part.multiplicity_decided == REPEATED).values
                kept = part.drop_dims("sample").assign(
                    multiplicity=part.multiplicity.where(repeats, 0),
                    periods=("eta", np.full(len(etas), done)),
                )
                last = periods == self.size.stages[-1]
                parts.append(kept.isel(eta=repeats | last))
                etas = etas[~repeats]
                if not len(etas):
                    break
            self.known[name] = xr.concat(parts, "eta").sortby("eta")
        return self.known[name]

    def lyapunov_exponents(self, case: str) -> xr.Dataset:
        name, settled = f"exponent_{CASES[case].label()}", self.settled_responses(case)
        more = {"start": settled, "transient": 0, "periods": self.size.long_run}
        etas = settled.eta.values
        return self.get_or_compute(name, orchestrate.lyapunov, CASES[case], eta=etas, **more)

    def largest_exponents(self, case: str) -> xr.Dataset:
        """Return exponents of longer runs at the two eta of each region where they are largest."""
        etas: set[float] = set()
        for region in self.regions(case):
            part = between(self.lyapunov_exponents(case), region.low, region.high).exponent
            etas |= set(part.eta.values[np.argsort(-part.values, kind="stable")[:2]].tolist())
        name, start = f"largest_{CASES[case].label()}", self.settled_responses(case)
        more = {"start": start, "transient": self.size.part, "periods": 5 * self.size.part}
        more["eta"] = sorted(etas)
        return self.get_or_compute(name, orchestrate.lyapunov, CASES[case], **more)

    # -- exact limits ------------------------------------------------------------------------------

    def windows_of_branch(self, case: str, orbit: str) -> list[StableWindow]:
        """Return the stable windows of the branch through the up-sweep's response, upwards."""
        eta, period, limits = cases.BRANCHES[case][orbit]
        guess = self.up_sweep(case).end_state.sel(eta=eta, method="nearest").values
        name = f"{CASES[case].label()}_{orbit.replace('/', '-').replace(', ', '-')}"
        first = {"eta": eta, "period": period, "guess": guess}
        start = self.get_or_compute(f"orbit_{name}", orchestrate.orbit, CASES[case], **first)
        along = {"start": start, "limits": limits}
        branch = self.get_or_compute(f"branch_{name}", orchestrate.branch, CASES[case], **along)
        return sorted(stable_windows(branch))

    def window_nearest(self, case: str, orbit: str, eta: float) -> StableWindow:
        windows = self.windows_of_branch(case, orbit)
        return min(windows, key=lambda one: max(one.low - eta, eta - one.high, 0.0))

    def regions(self, case: str) -> list[Region]:
        """Return a case's windows and what lies between that hold more than one frequency."""
        listed = list_regions(lambda orbit, eta: self.window_nearest(case, orbit, eta))
        settled = self.settled_responses(case)
        return [one for one in listed if between(settled, *one[:2]).sizes["eta"] > 1]

    def shares_chaotic_and_neutral(self, case: str, low: float, high: float) -> tuple[float, float]:
        """Return the shares of responses between two frequencies that are chaotic, and neutral."""
        verdicts = between(self.lyapunov_exponents(case), low, high).verdict.values
        repeats = between(self.settled_responses(case), low, high).multiplicity.values > 0
        chaotic, neutral = (np.mean((verdicts == kind) & ~repeats) for kind in (CHAOTIC, NEUTRAL))
        return float(chaotic), float(neutral)

    def last_eta_with_contact(self, case: str) -> np.ndarray:
        """Return the last eta with permanent contact on short sweeps from rest, for each gamma."""
        last = []
        for gamma in cases.GAMMAS:
            etas = np.round(np.arange(*cases.CONTACT_RANGES[case], 0.001), 9)
            name = f"contact_{CASES[case].label()}_gamma{gamma:g}"
            more = {"eta": etas, "transient": 250, "samples": 40}
            structure = CASES[case].replace(gamma=gamma)
            one = self.get_or_compute(name, orchestrate.sweep, structure, **more)
            touching = one.eta.values[one.permanent_contact.values == 1]
            last.append(touching[-1] if len(touching) else np.nan)
        return np.array(last)

    # -- single motions ----------------------------------------------------------------------------

    def chattering_by_restitution(self) -> xr.Dataset:
        """Return what follows one kick of masses that lie together, for each e and gamma (16)."""
        if "chattering" not in self.known:
            rows = [
                self.measure_chattering(ELASTIC.replace(e=e, gamma=gamma))
                for e in cases.RESTITUTIONS
                for gamma in cases.STICKING_GAMMAS
            ]
            columns = np.array(rows).T.reshape(3, len(cases.RESTITUTIONS), -1)
            names = "impacts", "sticks", "ratio_error"
            variables = {k: (("e", "gamma"), v) for k, v in zip(names, columns, strict=True)}
            coordinates = {"e": list(cases.RESTITUTIONS), "gamma": list(cases.STICKING_GAMMAS)}
            self.known["chattering"] = xr.Dataset(variables, coordinates)
        return self.known["chattering"]

    def measure_chattering(self, structure: Structure) -> list[float]:
        """Return impacts until the masses stick, whether they do, how far ratios are from e."""
        middle = (1.0 + structure.mu) / (1.0 + structure.kappa)  # (6) without rates
        parting, share = 0.01 * ((1.0 - structure.e) or 1.0), structure.mu / (1.0 + structure.mu)
        start = middle, middle, -share * parting, (1.0 - share) * parting
        kick: dict[str, Any] = {"eta": 0.02, "phase": 0.5 * np.pi, "start": start, "points": 4}
        motion = orchestrate.simulate(structure, **kick, periods=1, **self.running)
        quarter = motion.impact_time.values < float(motion.time[1])
        times, sticks = motion.impact_time.values[quarter], motion.sticks.values[quarter] > 0
        times = times[: int(sticks.argmax()) + 1] if sticks.any() else times
        gaps = np.diff(times)
        clear = gaps[gaps > 1e8 * np.finfo(float).eps * times[-1]] if len(times) else gaps
        ratios = (clear[1:] / clear[:-1])[-3:]  # of the latest that rounding does not reach
        away = np.abs(ratios - structure.e).max(initial=0.0) if len(ratios) else np.nan
        return [len(times), sticks.any(), away]

    def slow_impact_counts(self) -> xr.Dataset:
        """Return counts of impacts from rest: all, sticking, slower than gamma, pulled of these."""
        if "slow_impacts" not in self.known:
            alike = [(ELASTIC.replace(mu=mu, kappa=kappa), 1.3) for mu, kappa in ALIKE]
            etas = np.round(np.arange(0.45, 8.0, 0.15), 3).tolist()
            motions = [*((ELASTIC, eta) for eta in etas), *alike]
            rows = [self.count_slow_impacts(*motion) for motion in motions]
            names = "mu", "kappa", "impacts", "sticking", "slow", "pulled"
            columns = zip(names, np.transpose(rows), strict=True)
            self.known["slow_impacts"] = xr.Dataset({k: ("motion", v) for k, v in columns})
        return self.known["slow_impacts"]

    def count_slow_impacts(self, structure: Structure, eta: float) -> list[float]:
        """Return mu, kappa and the counts of one motion in 2,000 periods from rest."""
        asked = {"eta": eta, "at": "impacts", "transient": 0, "periods": 2000, **self.running}
        found = orchestrate.poincare(structure, **asked)
        closing, mu, kappa = found.impact_velocity.values, structure.mu, structure.kappa
        slow = structure.e * closing < 1e-4 * closing.max(initial=0.0)
        pulled = slow & ((1.0 - kappa / mu) * found.x1.values >= 0.0)  # (18) with D_1 = D_2
        return [mu, kappa, len(closing), found.sticks.sum().item(), slow.sum(), pulled.sum()]

    def figure_curves(self, number: str) -> xr.Dataset:
        """Return the curves of Figure 5, 7, 8, 9 or 12, and write them next to the results."""
        name = f"figure{number}"
        if name not in self.known:
            etas, keep, points = cases.PANELS[number]
            chosen = CASES if number == "12" else ("elastic",)
            panels = [panel for case in chosen for panel in self.figure_panels(number, case, etas)]
            keep = keep or self.size.keep
            curves = [trace_curve(panel, keep, points, self.running) for panel in panels]
            self.known[name] = curves_dataset(panels, curves)
            write_netcdf(self.known[name], self.folder / f"{name}.nc")
        return self.known[name]

    def figure_panels(self, number: str, case: str, etas: tuple[float, ...]) -> list[Panel]:
        swept = self.up_sweep(case) if number != "7" else self.up_sweep_to_9()
        if number == "7":
            etas = tuple(eta for n in range(1, 5) if (eta := relative_peak_eta(swept, n)))
        elif number == "12":
            etas = (float(swept.xi_rel_max.idxmax()),)
        chosen = swept.sel(eta=list(etas), method="nearest")
        name, etas = f"figure{number}_{CASES[case].label()}_settled", chosen.eta.values
        more = {"start": chosen, "transient": self.size.skip, **SETTLED}
        found = self.get_or_compute(name, orchestrate.sweep, CASES[case], eta=etas, **more)
        n = found.multiplicity.where(found.multiplicity_decided == REPEATED, 0).values.astype(int)
        rows = zip(found.eta.values.tolist(), found.end_state.values, n.tolist(), strict=True)
        return [Panel(CASES[case], *row) for row in rows]

    def up_sweep_to_9(self) -> xr.Dataset:
        """Return the elastic up-sweep, continued to 9.0: the window 4T has its peak above 8.0."""
        up, etas = self.up_sweep("elastic"), np.arange(8001, 9001) / 1000.0
        more = {"start": up.end_state[-1].values, **self.period_keywords()}
        beyond = self.get_or_compute("orbit_beyond", orchestrate.sweep, ELASTIC, eta=etas, **more)
        return xr.concat([up, beyond], "eta", join="exact")  # the same samples

    # -- beyond the paper --------------------------------------------------------------------------

    def settling_keywords(self) -> dict[str, Any]:
        """Return as keywords how long responses from many starts are run."""
        settings = AttractorSettings(longest=self.size.settle_most)
        return {"transient": self.size.settle, "settings": settings}

    def attractors(self) -> xr.Dataset:
        etas = self.size.attractor_etas()
        more = {"starts": self.size.starts, "seed": 2026, **self.settling_keywords()}
        return self.get_or_compute("attractors", orchestrate.attractors, ELASTIC, eta=etas, **more)

    def basin(self) -> xr.Dataset:
        found = between(self.attractors(), 1.07, 1.37)
        at = found.isel(eta=index_of_most_even_shares(found))
        middle = np.nanmean(at.state.values[np.argsort(-at.share.values, kind="stable")[:2]], 0)
        eta, side = float(at.eta), self.size.basin
        reach = 3.0 * float(self.up_sweep("elastic").xi_rel_max.sel(eta=eta, method="nearest"))
        plane = {"x": ("x_rel", 0.0, reach, side), "y": ("v_rel", -reach, reach, side)}
        more = {"at": middle, **plane, **self.settling_keywords()}
        return self.get_or_compute("basin", orchestrate.basin, ELASTIC, eta=eta, **more)

    def map(self, parameter: str) -> xr.Dataset:
        size, etas = self.size, np.linspace(*cases.MAP_ETAS, self.size.map_etas)
        spaced = np.geomspace if parameter == "D" else np.linspace
        axes = {"eta": etas, parameter: spaced(*cases.MAPS[parameter], size.map_rows)}
        more = {"transient": size.map_settle, "samples": size.map_keep}
        return self.get_or_compute(f"map_{parameter}", orchestrate.map, ELASTIC, **axes, **more)

    def spectra(self) -> xr.Dataset:
        etas = float(self.up_sweep("elastic").xi_rel_max.idxmax()), 0.4, 1.13
        return self.get_or_compute("spectra", orchestrate.spectra, ELASTIC, eta=etas)

    def ramp(self, kind: str) -> xr.Dataset:
        """Return a slow voltage ramp of the set ``rig`` up to its fold, bonded or delaminated."""
        structure, drive = Structure.from_file(cases.RIG), Drive.from_file(cases.RIG)
        volts = drive.volts(structure)
        fold = averaged.folds(structure, drive)[0].eta0
        ends = 0.55 * fold * volts, 1.02 * fold * volts
        rate = self.size.ramp_rate * volts * structure.omega
        one = structure.as_bonded() if kind == "bonded" else structure.as_delaminated()
        more = {"voltage": ends, "rate": rate, "back": False}
        return self.get_or_compute(f"ramp_{kind}", orchestrate.couple, one, drive, **more)


ALIKE = ((1, 1), (2, 2), (2, 2.2))  # mu, kappa


def index_of_most_even_shares(data: xr.Dataset) -> int:
    """Return the index of the eta at which two periodic attractors share starts most evenly."""
    frequent = np.argsort(-data.share.values, axis=1, kind="stable")[:, :2]
    names = "share", "impacts_per_period", "multiplicity"
    share, impacts, n = (np.take_along_axis(data[x].values, frequent, axis=1) for x in names)
    clear = (n > 0).all(axis=1) & (np.abs(impacts[:, 0] - impacts[:, -1]) > 0.2)
    least = np.where(clear, share[:, -1], 0.0)
    return int((least if least.max() > 0.0 else share[:, -1]).argmax())
