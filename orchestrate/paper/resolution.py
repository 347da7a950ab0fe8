"""Sizes of the paper's computations: in full as printed, or reduced for a quick look."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Resolution:
    """Numbers of frequencies, periods, starts and grid points of all computations."""

    name: str = "full"
    # number of the first sample at each eta of a sweep, and of periods sampled after it
    transient: int = 500
    samples: int = 200
    steady: int = 100  # periods after the sweep followed impact by impact
    # periods dropped and kept for phase curves (section 3.2)
    skip: int = 2000
    keep: int = 500
    long_run: int = 2500  # periods of the long runs that decide between regular and chaotic
    longest: int = 100_000  # periods up to which a response is run on that does not repeat
    part: int = 10_000  # periods of each part of the runs that give the largest exponents
    # number n of the first sample at which the sweep's responses are looked at again: at all
    # frequencies, and at a few
    later: int = 5000
    latest: int = 50_000
    ramp_rate: float = 2e-5  # of the motor's no-load speed over omega, in a time 1/omega
    # of eta, where coexisting attractors are looked for; the fine one where sweeps up and down
    # differ
    attractor_step: float = 0.005
    fine_step: float = 0.002
    starts: int = 60  # random starts at each
    basin: int = 160  # starts along each side of the basin picture
    # periods before a response from a random start counts as settled; up to which it is run on
    settle: int = 400
    settle_most: int = 8000
    # values along the sides of a parameter map
    map_etas: int = 181
    map_rows: int = 51
    # periods dropped and kept at each of its points
    map_settle: int = 300
    map_keep: int = 60

    def etas(self) -> tuple[float, ...]:
        """Return the frequency ratios of the sweeps: 0.1 to 8.0, by 0.001 in full."""
        return tuple(float(eta) for eta in np.arange(100, 8001) / 1000.0)

    def attractor_etas(self) -> tuple[float, ...]:
        """Return the frequency ratios of the random starts, dense from 1.07 to 1.37."""
        step, fine = self.attractor_step, self.fine_step
        ranges = [(0.44, 1.4, step), (1.06, 1.38, fine), (1.4, 8.0, 10 * step)]
        etas = np.concatenate([np.arange(*ends) for ends in ranges])
        return tuple(float(eta) for eta in np.unique(np.round(etas, 6)))

    @property
    def decides(self) -> bool:
        """Return whether transients have the paper's 500 periods, which claims need."""
        return self.transient >= 500


FULL = Resolution()
QUICK = Resolution(
    name="quick",
    transient=160,
    samples=60,
    steady=40,
    skip=300,
    keep=100,
    long_run=400,
    longest=2000,
    part=500,
    later=500,
    latest=2000,
    ramp_rate=2e-4,
    attractor_step=0.02,
    fine_step=0.02,
    starts=16,
    basin=40,
    settle=150,
    settle_most=1000,
    map_etas=41,
    map_rows=11,
    map_settle=80,
    map_keep=20,
)
