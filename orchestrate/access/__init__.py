"""The one place that talks to FMPy: FMUs described, found, exported, instantiated, stepped and read."""

from .begin import REST, begin, sampled
from .channel import Channel
from .description import Description, describe
from .events import STATE, EventInstance, Impacts
from .exported import FORMS, MODELS, build, find, finder, up_to_date
from .instance import Instance
from .models import OSCILLATOR, SHAKER

__all__ = [
    "FORMS",
    "MODELS",
    "OSCILLATOR",
    "REST",
    "SHAKER",
    "STATE",
    "Channel",
    "Description",
    "EventInstance",
    "Impacts",
    "Instance",
    "begin",
    "build",
    "describe",
    "find",
    "finder",
    "sampled",
    "up_to_date",
]
