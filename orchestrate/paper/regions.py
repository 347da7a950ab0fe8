"""Frequency regions between exact limits: windows of one or two impacts, and between."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from .stability_limits import stable_windows_of

if TYPE_CHECKING:
    import xarray as xr

    from ..dynamics.stable_windows import StableWindow

CONTACT = ("T, contact", 0.4)
WINDOWS = {"T/2": 1.05, "T/1": 2.0, "2T/1": 4.2, "3T/1": 6.3, "4T/1": 8.0}  # an eta inside
LAST = 8.0  # of the paper's range
COUNT = 2 * len(WINDOWS)


class Region(NamedTuple):
    """Frequencies between two limits of windows, with the windows' names."""

    low: float
    high: float
    name: str  # the window, or the two it lies between

    @property
    def is_window(self) -> bool:
        """Whether one orbit is stable in the whole region."""
        return " to " not in self.name

    @property
    def adds_a_period(self) -> bool:
        """Whether the region lies between windows nT and (n+1)T, each with one impact."""
        before, _, after = self.name.partition(" to ")
        return before.endswith("T/1") and after.endswith("T/1")


def nearest_window(limits: xr.Dataset, case: str, orbit: str, inside: float) -> StableWindow:
    """Return the stable window of an orbit around a frequency, or nearest to it."""
    windows = stable_windows_of(limits, case, orbit)
    return min(windows, key=lambda one: max(one.low - inside, inside - one.high, 0.0))


def list_regions(limits: xr.Dataset, case: str) -> list[Region]:
    """Return a case's windows and the regions between them, up to eta = 8.

    Irregular regions of the paper are between the exact limits of two windows.
    """
    last, label = nearest_window(limits, case, *CONTACT).high, "contact"
    listed = []
    for orbit, eta in WINDOWS.items():
        window = nearest_window(limits, case, orbit, eta)
        listed.append(Region(last, window.low, f"{label} to {orbit}"))
        listed.append(Region(window.low, min(window.high, LAST), orbit))
        last, label = window.high, orbit
    return listed
