"""Sizes of the paper's computations: in full as printed, or reduced for a quick look."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Resolution:
    """Numbers of frequencies, periods, starts and grid points of all computations."""

    name: str = "full"
    transient: int = 500  # number n of the first sample at each eta of a sweep
    samples: int = 200  # periods sampled after it
    steady: int = 100  # periods after the sweep followed impact by impact
    skip: int = 2000  # periods dropped for phase curves (section 3.2)
    keep: int = 500  # and kept
    long_run: int = 2500  # periods that decide between regular and chaotic
    stages: tuple[int, ...] = (0, 400, 3000, 15_000, 81_000)  # run on for while nothing repeats
    part: int = 10_000  # periods; five times that for the largest exponents
    later: int = 5000  # n of the first sample at which all the sweep's responses are seen again
    latest: int = 50_000  # and a few
    ramp_rate: float = 2e-5  # of the motor's no-load speed over omega, in a time 1/omega
    attractor_step: float = 0.005  # of eta, where coexisting attractors are searched
    fine_step: float = 0.002  # and where sweeps up and down differ
    starts: int = 60  # random starts at each
    basin: int = 160  # starts along each side of the basin picture
    settle: int = 400  # periods before a response from a random start counts as settled
    settle_most: int = 8000  # up to which it is run on
    map_etas: int = 181  # values along the sides of a parameter map
    map_rows: int = 51
    map_settle: int = 300  # periods dropped and kept at each of its points
    map_keep: int = 60

    def etas(self) -> tuple[float, ...]:
        """Return the frequency ratios of the sweeps: 0.1 to 8.0 by 0.001."""
        return tuple(float(eta) for eta in np.arange(100, 8001) / 1000.0)

    def attractor_etas(self) -> tuple[float, ...]:
        """Return the frequency ratios of the random starts, dense from 1.07 to 1.37."""
        step, fine = self.attractor_step, self.fine_step
        ranges = [(0.44, 1.4, step), (1.06, 1.38, fine), (1.4, 8.0, 10 * step)]
        etas = np.concatenate([np.arange(*ends) for ends in ranges])
        return tuple(float(eta) for eta in np.unique(np.round(etas, 6)))

    @property
    def has_full_transients(self) -> bool:
        """Whether transients have the paper's 500 periods, which claims need."""
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
    stages=(0, 400, 4000),
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
