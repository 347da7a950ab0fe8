"""Simulate a structure under an input given as cubic pieces, through all impacts.

Each cubic is set where it begins and runs on, so the motion does not depend on where it is read.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..model import Excitation, Structure
from .begin import REST, begin
from .event_loop import Played
from .events import EventInstance

BOX = "box_acceleration"
CUBICS = {  # inputs by the quantity that they make a cubic of
    BOX: (BOX, "box_jerk", "box_snap", "box_crackle"),
    **{name: (name, *(f"{name}_{n}" for n in (1, 2, 3))) for name in ("force1", "force2")},
}
PLAYED = ("x1", "x2", "v1", "v2", "x_rel", "v_rel", "contact_force")


class Player(EventInstance):
    """Oscillator FMU instance that simulates motions under inputs given as cubics."""

    def start(
        self, structure: Structure, start: ArrayLike = REST, beside: Excitation | None = None
    ) -> None:
        """Start a motion at time 0; ``beside`` acts beside the cubics, by default nothing."""
        at_rest = Excitation(frequency=structure.omega, amplitude=0.0)
        begin(self, structure, beside or at_rest, start)

    def play(
        self,
        nodes: NDArray[np.float64],
        derivatives: NDArray[np.float64],
        samples: NDArray[np.float64],
        outputs: Sequence[str] = PLAYED,
        drives: Sequence[str] = (BOX,),
    ) -> Played:
        """Simulate under consecutive cubics of what drives; return samples and impacts."""
        inputs = (*(name for drive in drives for name in CUBICS[drive]),)
        return self.event_loop(inputs, tuple(outputs)).run(nodes, derivatives, samples)
