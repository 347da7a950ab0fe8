"""Load the shipped Figure 6 (a sweep of the paper's structure) for the page."""

from __future__ import annotations

import logging
from pathlib import Path

from ..fmu import OSCILLATOR
from ..fmu.webassembly import kernel_digest
from ..lazy import xr
from ..model import Structure
from ..running.store import load
from ..units import Units
from .sweep_data import SweepData, empty_sweep, in_ratios, read_sweep

FILE = Path(__file__).with_name("figure6.nc")  # written by tools/figure6_states.py
STAMP = "kernel"  # attribute: digest of the kernel that computed it

log = logging.getLogger(__name__)


def first_diagram(structure: Structure, units: Units | None = None) -> SweepData:
    """Return the page's first diagram: Figure 6 for the paper's structure, else an empty one."""
    units = units or Units()
    if structure != Structure() or not in_ratios(structure, units):
        return empty_sweep(structure, units)
    data = load(FILE)
    if not is_current(data):
        log.warning("Figure 6 was computed by another kernel: the page computes its own")
        return empty_sweep(structure, units)
    return read_sweep(data)


def is_current(data: xr.Dataset) -> bool:
    """Return whether the present kernel computed a stored Figure 6."""
    return bool(data.attrs.get(STAMP) == kernel_digest(OSCILLATOR))
