"""The one place that talks to FMPy.

====================  =============================================================================
module                idea
====================  =============================================================================
:mod:`.description`   what an FMU says of itself
:mod:`.exported`      the FMUs of the present sources: exported where missing, and found
:mod:`.models`        names of the models
:mod:`.unpacked`      where FMUs are unpacked, once a process
:mod:`.library`       their binaries, loaded once a process
:mod:`.instance`      a co-simulation instance: set, step, read, save its state
:mod:`.events`        a motion impact by impact
:mod:`.begin`         how a motion begins, and its states at equal times
:mod:`.play`          a motion under an acceleration of the box that is given as cubics
:mod:`.channel`       fast calls on one instance, for co-simulation masters
:mod:`.c_library`     C sources of the package compiled, and found
:mod:`.webassembly`   the kernels for web pages: the same
====================  =============================================================================
"""

from .begin import REST, begin, last_samples, sampled, samples_per_step
from .c_library import build_libraries
from .channel import Channel
from .description import Description, describe
from .events import STATE, EventInstance, Impacts
from .exported import FORMS, MODELS, PLAIN_FORMS, build, find, finder, sources_of, up_to_date
from .instance import Instance
from .models import OSCILLATOR, SHAKER
from .play import PLAYED, Played, play
from .webassembly import build_web_kernels

__all__ = [
    "FORMS",
    "MODELS",
    "OSCILLATOR",
    "PLAIN_FORMS",
    "PLAYED",
    "REST",
    "SHAKER",
    "STATE",
    "Channel",
    "Description",
    "EventInstance",
    "Impacts",
    "Instance",
    "Played",
    "begin",
    "build",
    "build_libraries",
    "build_web_kernels",
    "describe",
    "find",
    "finder",
    "last_samples",
    "play",
    "samples_per_step",
    "sampled",
    "sources_of",
    "up_to_date",
]
