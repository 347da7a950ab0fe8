"""Jobs of the curves in Figures 5, 7, 8, 9 and 12: sweep responses traced in time."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..access import OSCILLATOR, Instance
from ..dynamics.clusters import AttractorSettings, run_until_settled
from ..response.curves import KINDS, simulate_curve
from ..response.labels import flags, variable
from ..response.questions import Point
from ..response.relative_resonance import follow_to_peak
from ..running.job import Inputs, Job, Table
from ..structures import Excitation, Structure
from .sweep_windows import relative_peak, window

if TYPE_CHECKING:
    import xarray as xr

COORDINATES = ("xi_1", "xi_2", "xi_1'", "xi_2'")
NUMBERS = ("e", "D", "eta", "multiplicity")  # of a panel


@dataclass(frozen=True)
class Panel:
    """One response to trace: structure, frequency ratio, start state and multiplicity."""

    structure: Structure
    eta: float
    start: tuple[float, ...]  # state at phase 0 that the motion starts from
    multiplicity: int  # 0 where irregular

    @property
    def point(self) -> Point:
        """Structure and excitation of the panel, as a ``Point``."""
        excitation = Excitation.nondimensional(self.eta, self.structure)
        return Point(self.structure, excitation)

    def numbers(self) -> list[float]:
        """Return e, D, eta and multiplicity as a list."""
        return [self.structure.e, self.structure.get("D"), self.eta, self.multiplicity]


def panel_at(sweep: xr.Dataset, structure: Structure, eta: float) -> Panel:
    """Return the panel of a sweep's response nearest to a frequency ratio."""
    row = sweep.sel(eta=eta, method="nearest")
    start = tuple(map(float, row.end_state.values))
    return Panel(structure, float(row.eta), start, int(row.multiplicity))


@dataclass(frozen=True, kw_only=True)
class CurvesJob(Job):
    """Base of jobs that trace the curves of a figure, one panel each."""

    sweeps: tuple[str, ...]  # names of the upward sweeps whose responses they start from
    structures: tuple[Structure, ...]  # of these sweeps
    # periods dropped and kept
    skip: int
    keep: int
    points: int  # states a period, beside both sides of each impact
    item: ClassVar[str] = "curve"

    def needs(self) -> tuple[str, ...]:
        """Return the names of the sweep jobs whose results it needs."""
        return self.sweeps

    @abstractmethod
    def panels(self, sweeps: Sequence[xr.Dataset]) -> list[Panel]:
        """Return the panels to trace, chosen from the sweeps' results."""

    def settle_panel(self, fmu: Path, panel: Panel) -> Panel:
        """Run a panel's response until it is settled; return the panel with its multiplicity."""
        settling = AttractorSettings(transient=self.skip, settle=0.0)
        with Instance(fmu) as instance:
            response, _ = run_until_settled(instance, panel.point, panel.start, settling)
        return replace(panel, multiplicity=response.multiplicity)

    def items(self, inputs: Inputs) -> list[tuple[int, Panel]]:
        """Return the panels with their numbers."""
        return list(enumerate(self.panels([inputs[name] for name in self.sweeps])))

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[tuple[int, Panel]], previous: Table | None
    ) -> Table:
        """Settle and trace one panel's response; return its times, states and kinds of state."""
        ((index, panel),) = items
        panel = self.settle_panel(fmus[OSCILLATOR], panel)
        settings = self.skip, self.keep, self.points
        curve = simulate_curve(fmus[OSCILLATOR], panel.point, panel.start, *settings)
        return {
            "tau": curve.tau,
            "state": curve.state.astype(np.float32),
            "kind": curve.kind,
            "panel": np.full(len(curve.tau), index, dtype=np.int16),
            "about": np.array([panel.numbers()]),
        }

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return a dataset of all curves' points, one after the other, with their panel numbers."""
        import xarray as xr

        time = "non-dimensional time from the first period shown"
        state = ("point", "coordinate"), table["state"], "1", "non-dimensional state"
        e, D, eta, multiplicity = table["about"].T
        text = "excitation periods after which the settled response repeats; 0: irregular"
        variables = {
            "tau": variable("point", table["tau"], "1", time),
            "state": variable(*state),
            "kind": flags("point", table["kind"], "state of the motion (1)", KINDS),
            "panel_of": variable("point", table["panel"], "1", "panel of the point"),
            "e": variable("panel", e, "1", "coefficient of restitution"),
            "D": variable("panel", D, "1", "damping ratio of both masses (8)"),
            "eta": variable("panel", eta, "1", "frequency ratio Omega/omega"),
            "multiplicity": variable("panel", multiplicity.astype("i4"), "1", text),
        }
        names = variable("coordinate", np.array(COORDINATES), "1", "co-ordinate of the state")
        return xr.Dataset(variables, {"coordinate": names}, {"title": self.name})


@dataclass(frozen=True, kw_only=True)
class CurvesAtFrequencies(CurvesJob):
    """Job of Figures 5, 8 and 9: the first sweep's responses at chosen frequencies."""

    etas: tuple[float, ...]

    def count(self) -> int:
        """Return the number of frequencies."""
        return len(self.etas)

    def panels(self, sweeps: Sequence[xr.Dataset]) -> list[Panel]:
        """Return the sweep's responses nearest to the frequencies."""
        return [panel_at(sweeps[0], self.structures[0], eta) for eta in self.etas]


@dataclass(frozen=True, kw_only=True)
class CurvesAtPeaks(CurvesJob):
    """Job of Figure 12: each sweep's response at its largest gap."""

    def count(self) -> int:
        """Return the number of sweeps."""
        return len(self.sweeps)

    def panels(self, sweeps: Sequence[xr.Dataset]) -> list[Panel]:
        """Return each sweep's response at its largest gap."""
        return [
            panel_at(sweep, structure, float(sweep.xi_rel_max.idxmax()))
            for sweep, structure in zip(sweeps, self.structures, strict=True)
        ]


@dataclass(frozen=True, kw_only=True)
class CurvesInWindows(CurvesJob):
    """Job of Figure 7: relative peaks of the windows T, 2T, ... with one impact."""

    windows: int = 4

    def count(self) -> int:
        """Return the number of windows."""
        return self.windows

    def panels(self, sweeps: Sequence[xr.Dataset]) -> list[Panel]:
        """Return each window's peak; without one, its last response with multiplicity -n."""
        sweep, structure, panels = sweeps[0], self.structures[0], []
        for n in range(1, self.windows + 1):
            peak = relative_peak(sweep, n)
            last = (window(sweep, n) or (0.0, float(sweep.eta.max())))[1]
            panel = panel_at(sweep, structure, last if peak is None else peak)
            panels.append(panel if peak is not None else replace(panel, multiplicity=-n))
        return panels

    def settle_panel(self, fmu: Path, panel: Panel) -> Panel:
        """Follow a panel without a peak upwards beyond the sweep to its peak."""
        n = -panel.multiplicity
        if n <= 0:
            return super().settle_panel(fmu, panel)
        with Instance(fmu) as instance:
            peak = follow_to_peak(instance, panel.structure, panel.eta, panel.start, n)
        return replace(panel, eta=peak.eta, start=peak.state, multiplicity=n)
