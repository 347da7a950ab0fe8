"""A motion computed impact by impact, through the events of FMI 3.0.

The FMI 3.0 form returns early from a step at each impact, at its exact time. Between impacts the
motion does not depend on the steps, so states sampled in a second run belong to the same motion to
the last bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike

import numpy as np

from ..errors import InputError
from .event_loop import EventLoop
from .impacts import Impacts
from .instance import Instance

NO_INPUT, NO_TIMES = np.empty((1, 0)), np.empty(0)


class EventInstance(Instance):
    """FMI 3.0 FMU instance that stops at each impact, so that all impacts can be read exactly."""

    EVENTS = {"eventModeUsed": True, "earlyReturnAllowed": True}

    def __init__(self, path: str | PathLike[str], name: str = "instance") -> None:
        self._loops: dict[tuple[tuple[str, ...], ...], EventLoop] = {}
        super().__init__(path, name)
        if not self.is_fmi3:
            version = self.description.fmi_version
            self.close()
            raise InputError(f"FMU {path}: is FMI {version}; expected FMI 3.0, which has events")

    def impacts(self, time: float, target: float) -> Impacts:
        return self.event_loop().run(np.array([time, target]), NO_INPUT, NO_TIMES).impacts

    def event_loop(self, inputs: Sequence[str] = (), outputs: Sequence[str] = ()) -> EventLoop:
        key = tuple(inputs), tuple(outputs)
        if key not in self._loops:
            self._loops[key] = EventLoop(self, *key)
        return self._loops[key]
