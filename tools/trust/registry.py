"""All campaigns by name, in the order of the ledger's page."""

from __future__ import annotations

from .attractors import AttractorCampaign
from .bits import BitCampaign
from .campaign import Campaign
from .clusters import ClusterCampaign
from .diagnosis import DiagnosisCampaign
from .faults import FaultCampaign
from .flights import EnergyCampaign, ImpactCampaign, RootCampaign
from .fuzzing import FuzzCampaign
from .hostile import HostileCampaign
from .intervals import IntervalCampaign
from .leaks import LeakCampaign
from .mutants import MutantCampaign
from .restores import RestoreCampaign
from .verdicts import Verdicts

CAMPAIGNS: dict[str, Campaign] = {
    campaign.name: campaign
    for campaign in (
        *(
            ImpactCampaign(),
            RootCampaign(),
            BitCampaign(),
            RestoreCampaign(),
            EnergyCampaign(),
            FuzzCampaign(),
        ),
        *(
            AttractorCampaign(),
            Verdicts(),
            DiagnosisCampaign(),
            IntervalCampaign(),
            FaultCampaign(),
            ClusterCampaign(),
        ),
        *(HostileCampaign(), MutantCampaign(), LeakCampaign()),
    )
}
