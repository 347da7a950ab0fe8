"""Ask a vibro-impacting structure: describe it, ask a question, get a dataset.

>>> import orchestrate
>>> beam = orchestrate.Structure.nondimensional(e=0.7, D=0.005)
>>> response = orchestrate.sweep(beam, eta=[0.4, 1.047], transient=50, samples=20)
>>> response.impacts_per_period.dims
('eta',)

What is described
    :class:`Structure`, :class:`Excitation`, :class:`Drive`: two masses and their contact, the box's
    harmonic motion, and a motor of limited power that shakes the box; in SI or by the paper's
    numbers, in Python or in TOML files.
What is asked
    :func:`simulate`, :func:`resonance`, :func:`sweep`, :func:`spectra`; :func:`map`,
    :func:`lyapunov`, :func:`attractors`, :func:`basin`, :func:`impact_statistics`;
    :func:`shake` as in the laboratory, by a :class:`SweptSine`, :class:`Random` vibration, a
    :class:`Shock` or :class:`Sampled` acceleration; :func:`measure` what a :class:`Sensor` reads
    of it, :func:`record`, :func:`read_record` and :func:`write_record` what was measured;
    :func:`frf`, :func:`psd`, :func:`track_orders`, :func:`harmonics`, :func:`spectrogram`,
    :func:`shock_spectrum` and :func:`probability_density` of such a record, or of a measured one;
    :func:`orbit`, :func:`branch`, :func:`border` for what is periodic; :func:`couple`,
    :func:`couple_all`,
    :func:`capture`, :func:`passage`, :func:`waterfall`, :func:`jump_voltages`,
    :func:`drive_branch` and :func:`drive_spectra` for the weak drive, its voltage a
    :class:`Course`, a :class:`SpeedControl` or a :class:`SpeedGradient` too; :func:`write_ssp`
    for other tools.
What is answered
    An :class:`xarray.Dataset` with units, long names, all parameters, and where it comes from.
    :func:`plot` draws it.

All is computed by FMPy through exported FMUs. Every function that computes takes the keywords of
:class:`orchestrate.running.options.Running`: ``jobs``, ``cluster``, ``store`` and more.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .version import __version__

if TYPE_CHECKING:
    from .dynamics.attractors import attractors
    from .dynamics.basins import basin
    from .dynamics.borders import border
    from .dynamics.branches import branch
    from .dynamics.impact_statistics import impact_statistics
    from .dynamics.lyapunov import lyapunov
    from .dynamics.orbits import orbit
    from .dynamics.parameter_map import map
    from .errors import FmuError, InputError, StaleError, StoreError, VibroimpactError, WorkerError
    from .figures.plot import plot
    from .laboratory.analysis.density import probability_density
    from .laboratory.analysis.frf import frf
    from .laboratory.analysis.harmonics import harmonics
    from .laboratory.analysis.orders import track_orders
    from .laboratory.analysis.psd import psd
    from .laboratory.analysis.shock_spectrum import shock_spectrum
    from .laboratory.analysis.spectrogram import spectrogram
    from .laboratory.random_vibration import Random
    from .laboratory.record import record
    from .laboratory.record_files import read_record, write_record
    from .laboratory.sampled import Sampled
    from .laboratory.sensors import Sensor, measure
    from .laboratory.shake import shake
    from .laboratory.shock import Shock
    from .laboratory.swept_sine import SweptSine
    from .response.resonance import resonance
    from .response.simulate import simulate
    from .response.spectra import spectra
    from .response.sweep import sweep
    from .response.threshold import contact_threshold
    from .structures import Drive, Excitation, Structure
    from .weak_drive.capture import capture
    from .weak_drive.controllers import SpeedControl, SpeedGradient
    from .weak_drive.couple import couple
    from .weak_drive.couple_all import couple_all
    from .weak_drive.drive_branch import drive_branch
    from .weak_drive.drive_spectra import drive_spectra
    from .weak_drive.jump_voltages import jump_voltages
    from .weak_drive.passage import passage, waterfall
    from .weak_drive.schedule import Course
    from .weak_drive.ssp import write_ssp

__all__ = [
    "Course",
    "Drive",
    "Excitation",
    "FmuError",
    "InputError",
    "Random",
    "Sampled",
    "Sensor",
    "Shock",
    "SpeedControl",
    "SpeedGradient",
    "StaleError",
    "StoreError",
    "Structure",
    "SweptSine",
    "VibroimpactError",
    "WorkerError",
    "__version__",
    "attractors",
    "basin",
    "border",
    "branch",
    "capture",
    "contact_threshold",
    "couple",
    "couple_all",
    "drive_branch",
    "drive_spectra",
    "frf",
    "harmonics",
    "impact_statistics",
    "jump_voltages",
    "lyapunov",
    "map",
    "measure",
    "orbit",
    "passage",
    "plot",
    "probability_density",
    "psd",
    "read_record",
    "record",
    "resonance",
    "shake",
    "shock_spectrum",
    "simulate",
    "spectra",
    "spectrogram",
    "sweep",
    "track_orders",
    "waterfall",
    "write_record",
    "write_ssp",
]
PLACES = {  # where each name lives: it is imported when it is used, so that `import` takes no time
    "structures": ("Drive", "Excitation", "Structure"),
    "errors": (
        *("FmuError", "InputError", "StaleError", "StoreError"),
        *("VibroimpactError", "WorkerError"),
    ),
    "figures.plot": ("plot",),
    "laboratory.random_vibration": ("Random",),
    "laboratory.record": ("record",),
    "laboratory.record_files": ("read_record", "write_record"),
    "laboratory.sampled": ("Sampled",),
    "laboratory.sensors": ("Sensor", "measure"),
    "laboratory.shock": ("Shock",),
    "laboratory.swept_sine": ("SweptSine",),
    "laboratory.shake": ("shake",),
    "laboratory.analysis.frf": ("frf",),
    "laboratory.analysis.psd": ("psd",),
    "laboratory.analysis.orders": ("track_orders",),
    "laboratory.analysis.harmonics": ("harmonics",),
    "laboratory.analysis.spectrogram": ("spectrogram",),
    "laboratory.analysis.shock_spectrum": ("shock_spectrum",),
    "laboratory.analysis.density": ("probability_density",),
    "response.simulate": ("simulate",),
    "response.resonance": ("resonance",),
    "response.sweep": ("sweep",),
    "response.spectra": ("spectra",),
    "response.threshold": ("contact_threshold",),
    "dynamics.parameter_map": ("map",),
    "dynamics.lyapunov": ("lyapunov",),
    "dynamics.attractors": ("attractors",),
    "dynamics.basins": ("basin",),
    "dynamics.orbits": ("orbit",),
    "dynamics.branches": ("branch",),
    "dynamics.borders": ("border",),
    "dynamics.impact_statistics": ("impact_statistics",),
    "weak_drive.capture": ("capture",),
    "weak_drive.controllers": ("SpeedControl", "SpeedGradient"),
    "weak_drive.couple": ("couple",),
    "weak_drive.couple_all": ("couple_all",),
    "weak_drive.drive_branch": ("drive_branch",),
    "weak_drive.drive_spectra": ("drive_spectra",),
    "weak_drive.jump_voltages": ("jump_voltages",),
    "weak_drive.passage": ("passage", "waterfall"),
    "weak_drive.schedule": ("Course",),
    "weak_drive.ssp": ("write_ssp",),
}


def __getattr__(name: str) -> Any:
    for place, names in PLACES.items():
        if name in names:
            value = getattr(import_module(f"{__name__}.{place}"), name)
            globals()[name] = value
            return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
