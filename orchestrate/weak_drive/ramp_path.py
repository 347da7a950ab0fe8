"""Follow a slow voltage ramp along traced branches: folds met, jumps and slow losses.

Branches turn back at folds, and have more of them than a ramp takes. It follows the stable motion
that it begins with, to the first fold; there the speed jumps to another motion at that voltage, and
the ramp goes on from there. Where the branches do not decide how it goes on, the path says so.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..dynamics.bifurcations import FLIP, FOLD, KINDS, TORUS
from ..dynamics.tracer import LIMIT

if TYPE_CHECKING:
    import xarray as xr

FIRST_LEG = {True: "from below", False: "from above"}


@dataclass
class Path:
    """Store what a slow ramp meets in one direction: jumps, landings, slow losses, end."""

    # folds at which its speed jumps, in turn, by their places along `bifurcation`
    jumps: list[int] = field(default_factory=list)
    # the speeds to which it jumps, rad/s; one fewer than jumps where that is not known
    landings: list[float] = field(default_factory=list)
    # neimark-Sacker points before a fold: there the motion is lost slowly, and a ramp that nothing
    # disturbs goes on to the fold
    slow_losses: list[int] = field(default_factory=list)
    end: str = ""  # why no more is known; empty where the ramp leaves the range of speeds


class Motions(NamedTuple):
    """Store the motions of one leg, in the order in which a ramp meets them."""

    voltage: np.ndarray
    speed: np.ndarray
    stable: np.ndarray
    revolutions: np.ndarray
    end: str

    def from_index(self, first: int, forward: bool) -> Motions:
        """Return the motions from an index on, in forward or reverse order."""
        rows = slice(first, None) if forward else slice(first, None, -1)
        end = self.end if forward else LIMIT
        columns = (self.voltage, self.speed, self.stable, self.revolutions)
        voltage, speed, stable, revolutions = (column[rows] for column in columns)
        return Motions(voltage, speed, stable, revolutions, end)


class Branches:
    """Store the legs and the bifurcations of one structure, and follow ramps on them."""

    def __init__(self, data: xr.Dataset, structure: str) -> None:
        """Read legs and bifurcations of one structure from the dataset."""
        branch = data.sel(structure=structure)
        self.legs: dict[str, Motions] = {}
        for leg in map(str, branch.leg.values):
            motions = branch.sel(leg=leg).dropna("point", subset=["voltage"])
            if motions.sizes["point"]:
                self.legs[leg] = Motions(
                    motions.voltage.values,
                    motions.speed.values,
                    motions.stable.values.astype(bool),
                    motions.revolutions.values,
                    motions.end.item(),
                )
        self.own = np.flatnonzero(data.bifurcation_structure.values == structure)
        self.kinds = data.bifurcation_kind.values
        self.places = np.stack([data.bifurcation_voltage.values, data.bifurcation_speed.values], 1)
        self.revolutions = data.bifurcation_revolutions.values
        self.spans = np.array([self.value_range("voltage"), self.value_range("speed")])

    def value_range(self, name: str) -> float:
        """Return the range of a quantity over all legs; 1 if it is empty."""
        values = np.concatenate([getattr(leg, name) for leg in self.legs.values()] or [np.zeros(1)])
        return float(np.ptp(values)) or 1.0

    def nearest_bifurcation(self, motions: Motions, i: int, kind: str) -> int | None:
        """Find the bifurcation of a kind between a motion and the next; None without one."""
        ends = np.stack([motions.voltage[i : i + 2], motions.speed[i : i + 2]], 1) / self.spans
        of_kind = [
            k
            for k in self.own
            if self.kinds[k] == kind and self.revolutions[k] == motions.revolutions[i]
        ]
        if not of_kind:
            return None
        away = np.linalg.norm(self.places[of_kind] / self.spans - ends.mean(axis=0), axis=1)
        step = float(np.linalg.norm(ends[1] - ends[0]))
        return int(of_kind[int(away.argmin())]) if away.min() <= max(step, 1e-3) else None

    def follow_ramp(self, up: bool) -> Path:
        """Follow a slow ramp up or down the voltage; return its path."""
        path, sign = Path(), 1.0 if up else -1.0
        motions = self.first_leg(up, sign)
        if motions is None:
            path.end = "its branch begins with no stable motion"
            return path
        for _ in range(12):
            motions = self.follow_to_loss(motions, path, sign)
            if motions is None:
                return path
        path.end = "more than it is worth to follow"
        return path

    def first_leg(self, up: bool, sign: float) -> Motions | None:
        """Return the leg on which a ramp starts, from its first stable motion, or None."""
        leg, below = self.legs.get(FIRST_LEG[up]), self.legs.get(FIRST_LEG[True])
        if leg is None and not up and below is not None and below.end == LIMIT:
            leg = below.from_index(len(below.speed) - 1, forward=False)
        if leg is None or not leg.stable.any():
            return None
        begin = int(np.argmax(leg.stable))
        turned = (sign * np.diff(leg.voltage[: begin + 1]) < 0.0).any()
        return None if turned else leg.from_index(begin, forward=True)

    def follow_to_loss(self, motions: Motions, path: Path, sign: float) -> Motions | None:
        """Follow a ramp until its motion is lost; return the next motions or None."""
        lost = False  # slowly, at a Neimark-Sacker point: a ramp does not see it
        for i in range(len(motions.speed) - 1):
            turned = sign * (motions.voltage[i + 1] - motions.voltage[i]) < 0.0
            if not turned and (lost or motions.stable[i + 1]):
                continue
            fold, torus, flip = (
                self.nearest_bifurcation(motions, i, KINDS[kind]) for kind in (FOLD, TORUS, FLIP)
            )
            if torus is not None and not lost:
                path.slow_losses.append(torus)
                lost = True
            if fold is not None or turned:
                return self.jump_at_fold(fold, path, sign)
            if not lost:
                return self.leg_after_period_doubling(flip, motions, i, path, sign)
        if motions.end != LIMIT:
            path.end = f"its motion ends at {motions.voltage[-1]:.5f} V: {motions.end}"
        return None

    def jump_at_fold(self, fold: int | None, path: Path, sign: float) -> Motions | None:
        """Record a jump at a fold; return the motions it lands on, None if unknown."""
        if fold is None:
            path.end = "its motion turns back at a fold that was not located"
            return None
        path.jumps.append(fold)
        voltage, speed = self.places[fold]
        landings = self.stable_motions_at(voltage, speed, sign)
        speeds = np.array([self.landing_speed(*landing, voltage) for landing in landings])
        if not landings or np.ptp(speeds) > 5e-3 * self.spans[1]:
            count = "several stable motions" if landings else "no stable motion"
            path.end = f"these branches have {count} at {voltage:.5f} V to jump to"
            return None
        path.landings.append(float(speeds[0]))
        motions, i = landings[0]
        forward = sign * (motions.voltage[i + 1] - motions.voltage[i]) > 0.0
        return motions.from_index(i + 1 if forward else i, forward)

    def stable_motions_at(
        self, voltage: float, speed: float, sign: float
    ) -> list[tuple[Motions, int]]:
        """Find all stable motions at a voltage that lie beyond a speed."""
        legs = []
        for motions in self.legs.values():
            for i in range(len(motions.speed) - 1):
                ends = motions.voltage[i : i + 2] - voltage
                beyond = (sign * (motions.speed[i : i + 2] - speed) > 0.0).all()
                if beyond and motions.stable[i : i + 2].all() and ends[0] * ends[1] <= 0.0:
                    legs.append((motions, i))
        return legs

    @staticmethod
    def landing_speed(motions: Motions, i: int, voltage: float) -> float:
        """Interpolate the speed of a leg at a voltage, rad/s."""
        low, high = motions.voltage[i : i + 2]
        part = (voltage - low) / (high - low) if high != low else 0.0
        return float(motions.speed[i] + part * (motions.speed[i + 1] - motions.speed[i]))

    def leg_after_period_doubling(
        self, flip: int | None, motions: Motions, i: int, path: Path, sign: float
    ) -> Motions | None:
        """Return the stable leg of twice the period; None without one."""
        voltage = float(motions.voltage[i])
        if flip is not None:
            voltage = float(self.places[flip][0])
            for name in ("first doubled", "second doubled"):
                leg = self.legs.get(name)
                if leg is None or len(leg.speed) < 2:
                    continue
                start = np.array([leg.voltage[0], leg.speed[0]])
                near = np.abs((start - self.places[flip]) / self.spans).max() < 0.02
                if near and leg.stable[0] and sign * (leg.voltage[1] - leg.voltage[0]) > 0.0:
                    return leg
        what = "its period doubles" if flip is not None else "it loses its stability"
        path.end = f"{what} at {voltage:.5f} V, and no stable motion was followed from there"
        return None


def ramp_paths(data: xr.Dataset, structure: str) -> dict[str, Path]:
    """Return what slow ramps up and down the voltage meet on traced branches."""
    branches = Branches(data, structure)
    return {"up": branches.follow_ramp(True), "down": branches.follow_ramp(False)}
