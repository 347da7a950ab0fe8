"""Find in the record of a ramp where the speed passes the resonance or may jump once more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..running.job import Table
from . import averaged, own_resonance
from .further_jumps import LAST_STRETCH, find_further_jumps
from .jump_verdicts import averaged_predictions, is_doubtful
from .jumps import Passing, SweepLeg, explain_not_passed, find_passing
from .run import CoupledRun

UPWARD = (True, False)  # both directions: whether the voltage rises
LAST_REVOLUTIONS = 20  # of a ramp: their mean speed is where it ends
LATE = 3.0  # of the rotor's time 1/b: how much later a ramp may show what it loses


@dataclass(frozen=True)
class RampRecord:
    """Search the revolutions of a run for passages of the resonance and suspected jumps."""

    job: CoupledRun  # what was run
    table: Table  # its revolutions, a row each

    @property
    def sense(self) -> float:
        """Return the sense of rotation: -1 where the motor turns backward, else 1."""
        voltage = self.table["voltage"]
        return -1.0 if -voltage.min(initial=0.0) > voltage.max(initial=0.0) else 1.0

    def forward(self) -> Table:
        """Return the table of the mirror image of the run, in which the motor turns forward."""
        signed = ("voltage", "speed")
        return {**self.table, **{name: self.sense * self.table[name] for name in signed}}

    def sweep_leg(self, up: bool) -> tuple[SweepLeg, np.ndarray]:
        """Return the revolutions with rising (or falling) voltage and their row indices.

        A motor that turns backward is looked at in a mirror: its voltage rises from 0 too.
        """
        eta0 = self.sense * self.table["voltage"] / self.job.drive.volts(self.job.structure)
        Omega = np.abs(self.table["speed"]) / self.job.structure.omega
        trend = self.sense * self.job.schedule.trend(self.table["time"])
        rows = np.flatnonzero((trend > 0 if up else trend < 0) & (eta0 > 0.0))
        return SweepLeg(
            self.table["time"][rows] * self.job.structure.omega, eta0[rows], Omega[rows]
        ), rows

    def resonance_passing(self, up: bool) -> Passing | None:
        """Find how the speed passes the resonance in one direction; None if it does not."""
        leg, rows = self.sweep_leg(up)
        structure, drive = self.job.structure, self.job.drive
        threshold = own_resonance.dividing_speed(structure, drive)
        calm = averaged.calm_speed(structure, drive)
        rows_in_leg = find_passing(leg, drive.b(structure), up, threshold, calm=calm)
        if rows_in_leg is None:
            return None
        row, before, after = (int(rows[index]) for index in rows_in_leg[:3])
        half = float(np.interp(rows_in_leg.half, np.arange(len(rows)), rows))
        return Passing(row, before, after, rows_in_leg.look, half)

    def doubtful_passing(self, up: bool) -> tuple[Passing, tuple[int, int]] | None:
        """Return a doubtful passage of the resonance in steps; None if the record is clear."""
        passing = None if self.job.control else self.resonance_passing(up)
        theory = averaged_predictions(self.job.structure, self.job.drive)[UPWARD.index(up)]
        if passing is None or not is_doubtful(passing, self.job.structure.bonded, theory):
            return None
        return self.to_steps(passing, up)

    def to_steps(self, passing: Passing, up: bool) -> tuple[Passing, tuple[int, int]]:
        """Convert a passage from table rows to communication steps, with its sweep's ends."""
        rows = self.sweep_leg(up)[1]
        times = self.table["time"][[*passing[:3], rows[0], rows[-1]]]
        row, before, after, first, last = (
            min(math.ceil(time / self.job.scheme.h), self.job.steps() - 1) for time in times
        )
        return Passing(row, before, after, passing.look, float(row)), (first, last)

    def begin_earlier(self, passing: Passing, up: bool) -> Passing:
        """Move the start of a suspected jump earlier, because a ramp shows losses late."""
        time, rows = self.table["time"], self.sweep_leg(up)[1]
        late = LATE / (self.job.drive.b(self.job.structure) * self.job.structure.omega)
        before = max(int(np.searchsorted(time, time[passing.before] - late)) - 1, int(rows[0]))
        return passing._replace(before=min(before, passing.before))

    def find_further_passings(self, up: bool) -> list[Passing]:
        """Find suspected further jumps in one direction, as rows of the table."""
        leg, rows = self.sweep_leg(up)
        if self.job.control or not rows.size:
            return []
        threshold = own_resonance.dividing_speed(self.job.structure, self.job.drive)
        main, b = self.resonance_passing(up), self.job.drive.b(self.job.structure)
        places = []
        for part in np.split(np.arange(len(rows)), np.flatnonzero(np.diff(rows) > 1) + 1):
            first = int(rows[part[0]])
            span = None if main is None else (main.before - first, main.after - first)
            one_ramp = SweepLeg(*(values[part] for values in leg))
            places += [
                Passing(row + first, before + first, after + first, look, half + first)
                for row, before, after, look, half in find_further_jumps(
                    one_ramp, b, up, threshold, span
                )
            ]
        return places

    def last_stretch(self, up: bool, places: Sequence[Passing]) -> tuple[int, int] | None:
        """Return first and last step of a stretch that may hide a loss; None where nothing does.

        The jump comes late, the more so the faster the ramp: near its last voltage it may come
        after the end. None where the record shows a passing or a suspected jump there. Of a bonded
        structure the averaged theory knows whether and where.
        """
        (_, eta0, Omega), rows = self.sweep_leg(up)
        if self.job.control or not rows.size:
            return None
        sign, end, main = 1.0 if up else -1.0, eta0[-1], self.resonance_passing(up)
        if self.job.structure.bonded:
            theory = averaged_predictions(self.job.structure, self.job.drive)[UPWARD.index(up)]
            losses = [at for at in theory.losses if eta0.min() <= at <= eta0.max()]
            divide = averaged.dividing_speed(self.job.structure, self.job.drive)
            began_beyond = bool((sign * (Omega - divide) > 0.0).all())
            if not losses or began_beyond or main:
                return None
            end = min(losses, key=lambda at: sign * at)
        far = np.flatnonzero(sign * (end - eta0) > LAST_STRETCH)
        first = int(rows[far[-1]]) if far.size else int(rows[0])
        if any(seen.after >= first for seen in (*places, *([main] if main else []))):
            return None
        times = self.table["time"][[first, rows[-1]]]
        begin, end = (min(math.ceil(at / self.job.scheme.h), self.job.steps() - 1) for at in times)
        return begin, end

    def end_voltage(self, up: bool) -> float:
        """Return the voltage at which the ramp in a direction ends, V; NaN without one."""
        eta0 = self.sweep_leg(up)[0].eta0
        return float(eta0[-1]) * self.job.drive.volts(self.job.structure) if eta0.size else math.nan

    def explain_no_passing(self, up: bool) -> str:
        """Explain why the speed does not pass the resonance in a direction."""
        if self.job.control:
            return "a controller sets the voltage"
        resonance = own_resonance.resonance(self.job.structure, self.job.drive)
        return explain_not_passed(self.sweep_leg(up)[0], up, resonance)

    def explain_short_sweep(self, up: bool) -> str:
        """Explain that the sweep ends before a resonance; empty text if it does not."""
        leg, rows = self.sweep_leg(up)
        low, high = own_resonance.dividing_speeds(self.job.structure, self.job.drive)
        end = float(leg.Omega[-LAST_REVOLUTIONS:].mean())
        if low == high or (end > high if up else end < low):
            return ""
        volts, beyond = float(self.table["voltage"][rows[-1]]), high if up else low
        return (
            f"undecided: the voltage goes to {volts:.5g} V only, which does not take the speed "
            "past both resonances, the bonded structure's and the delaminated one's own; expected "
            f"one that takes it {'above' if up else 'below'} "
            f"{beyond * self.job.structure.omega:.5g} rad/s"
        )
