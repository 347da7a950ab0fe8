"""The campaigns by name, in the order of the page."""

from __future__ import annotations

from .attractors import Attractors
from .bits import Grids
from .campaign import Campaign
from .clusters import Clusters
from .diagnosis import Diagnosis
from .faults import Faults
from .flights import Energy, Impacts, Roots
from .fuzzing import Fuzzing
from .hostile import Hostile
from .intervals import Intervals
from .leaks import Leaks
from .mutants import Mutants
from .restores import Restores
from .verdicts import Verdicts

CAMPAIGNS: dict[str, Campaign] = {
    campaign.name: campaign
    for campaign in (
        *(Impacts(), Roots(), Grids(), Restores(), Energy(), Fuzzing()),
        *(Attractors(), Verdicts(), Diagnosis(), Intervals(), Faults(), Clusters()),
        *(Hostile(), Mutants(), Leaks()),
    )
}
