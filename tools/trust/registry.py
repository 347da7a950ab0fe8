"""The campaigns by name, in the order of the page."""

from __future__ import annotations

from .campaign import Campaign
from .flights import Energy, Impacts, Roots
from .hostile import Hostile

CAMPAIGNS: dict[str, Campaign] = {
    campaign.name: campaign for campaign in (Impacts(), Roots(), Energy(), Hostile())
}
