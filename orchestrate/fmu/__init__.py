"""The one package that talks to FMPy: describe, export, unpack, load and step FMUs.

===================  =================================================================
module               idea
===================  =================================================================
:mod:`.description`  an FMU's archive and modelDescription.xml, read and validated
:mod:`.exported`     the FMUs of the present sources: found, or exported where missing
:mod:`.models`       names of the models
:mod:`.unit_names`   units by name only
:mod:`.unpacked`     unpacking of FMUs and loading of their binaries, once per process
:mod:`.instance`     a co-simulation instance: set, step, read, save its state
:mod:`.fmi`          an instance as the compiled loops call it
:mod:`.events`       a motion computed impact by impact, under inputs given as cubics
:mod:`.oscillator`   an oscillator: its start, its loop, states at equal times, gaps
:mod:`.impacts`      the impacts of a motion
:mod:`.channel`      an instance as a co-simulation master has it
:mod:`.c_library`    C libraries of the package: found, or compiled
:mod:`.webassembly`  the kernels for web pages: found, or compiled
===================  =================================================================
"""

from .c_library import build_libraries
from .description import describe
from .events import NO_INPUT, PLAYED, EventInstance, Player
from .exported import (
    FORMS,
    MODELS,
    PLAIN_FORMS,
    build,
    find_or_export,
    is_current_and_trusted,
    make_fmu_finder,
    source_forms_of,
)
from .impacts import STATE, Impacts
from .instance import Instance
from .models import ELECTRODYNAMIC_SHAKER, MOTOR_SHAKER, OSCILLATOR
from .oscillator import (
    REST,
    START_VALUES,
    Oscillator,
    checked_four_numbers,
    gaps_of_states,
    respond_library,
    sample_evenly,
    sample_stroboscopically,
    start_motion,
    traits_for_loops,
)
from .webassembly import build_web_kernels

__all__ = [
    "ELECTRODYNAMIC_SHAKER",
    "FORMS",
    "MODELS",
    "NO_INPUT",
    "OSCILLATOR",
    "Oscillator",
    "PLAIN_FORMS",
    "PLAYED",
    "REST",
    "START_VALUES",
    "MOTOR_SHAKER",
    "STATE",
    "EventInstance",
    "Impacts",
    "Instance",
    "Player",
    "start_motion",
    "build",
    "build_libraries",
    "build_web_kernels",
    "describe",
    "find_or_export",
    "make_fmu_finder",
    "checked_four_numbers",
    "gaps_of_states",
    "respond_library",
    "sample_evenly",
    "sample_stroboscopically",
    "traits_for_loops",
    "source_forms_of",
    "is_current_and_trusted",
]
