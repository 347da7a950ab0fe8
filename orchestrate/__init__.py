"""Public API: describe a vibro-impacting structure, call a function, get a dataset.

>>> import orchestrate
>>> beam = orchestrate.Structure.nondimensional(e=0.7, D=0.005)
>>> response = orchestrate.sweep(beam, eta=[0.4, 1.047], transient=50, samples=20)
>>> response.impacts_per_period.dims
('eta',)

What is described
    :class:`Structure`, :class:`Excitation`, :class:`Drive`, :class:`Shaker`: two masses and their
    contact, the box's harmonic motion, and a motor of limited power or an electrodynamic shaker
    that shakes the box; in SI or by the paper's numbers, in Python or in TOML files.
What is asked
    :func:`simulate`, :func:`resonance`, :func:`resonance_levels`, :func:`contact_threshold`,
    :func:`sweep`, :func:`spectra`; :func:`map`, :func:`lyapunov`, :func:`poincare`,
    :func:`attractors`, :func:`basin`, :func:`basin_entropy`, :func:`impact_statistics`;
    :func:`shake` as in the laboratory, by a :class:`SweptSine` or :class:`SteppedSine`,
    :class:`Random` vibration, a :class:`Shock` or :class:`Sampled` acceleration, or on a
    :class:`Shaker` by :class:`LevelControl`; :func:`measure`
    what a :class:`Sensor` reads of it, :func:`record`, :func:`read_record` and
    :func:`write_record` what was measured, :func:`read_curve` and :func:`resonance_curve` if that
    is a table of amplitudes; :func:`frf`, :func:`psd`, :func:`track_orders`,
    :func:`harmonics`, :func:`spectrogram`, :func:`shock_spectrum` and :func:`probability_density`
    of such a record, or of a measured one, :func:`record_of_run` of a motor's;
    :func:`signs` of delamination in it, :func:`fit` a structure to it and :func:`detect` whether
    it is delaminated, :func:`detect_all` of many; :func:`plan_test` for a record that shows it;
    :func:`orbit`, :func:`branch`, :func:`border` for what is periodic, :func:`manifold` for what
    leaves it; :func:`cosimulate`, :func:`couple`, :func:`couple_all`,
    :func:`capture`, :func:`passage`, :func:`waterfall`, :func:`jump_voltages`,
    :func:`drive_branch` and :func:`drive_spectra` for the weak drive, its voltage a
    :class:`Course`, a :class:`SpeedControl` or a :class:`SpeedGradient` too; :func:`write_ssp`
    for other tools.
What is answered
    An :class:`xarray.Dataset` with units, long names, all parameters, and where it comes from.
    :func:`plot` draws it, :func:`report` makes it a page to read, print and sign.

All is computed by FMPy through exported FMUs. Every function that computes takes the keywords of
:class:`orchestrate.running.options.Running`: ``jobs``, ``cluster``, ``store`` and more.
"""

from __future__ import annotations

import ast
from importlib import import_module
from pathlib import Path
from typing import Any


def read_public_names() -> dict[str, str]:
    """Return a dict from public name to its submodule, read from the stub ``__init__.pyi``."""
    stub = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    imports = (node for node in stub.body if isinstance(node, ast.ImportFrom))
    return {alias.name: node.module or "" for node in imports for alias in node.names}


PLACES = read_public_names()  # a name is imported when it is used, so that `import` takes no time
__all__ = sorted(PLACES)


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used, and return it."""
    if name not in PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"{__name__}.{PLACES[name]}"), name)
    return value


def __dir__() -> list[str]:
    """Return the sorted public names of the package."""
    return __all__
