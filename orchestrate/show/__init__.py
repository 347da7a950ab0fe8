"""Draw datasets with Matplotlib, and write pages to read, print and sign; no FMU runs here.

Pictures are five families, each a module of what its pictures share and of a function per kind of
result; :mod:`.kinds` knows which function draws what:

- lines over a parameter: ``lines``, ``resonance``, ``weak_drive``; branches over them: ``overlay``
- ``planes``: maps, basins, borders, sections, phase curves
- time histories: ``histories``, ``passage``
- ``spectra``, and what an analyser shows: ``analysis``
- special: ``diagnosis``

A page is :mod:`.report`: answers in, one HTML file out; :mod:`.page` is what it is made of,
:mod:`.verdict`  has the sections of a verdict, :mod:`.answers` those of any other answer.

A picture's function takes datasets and returns a :class:`matplotlib.figure.Figure`, which
:func:`.figure_files.save` writes. Only this folder sees matplotlib, whose settings and backend are
the same after a drawing as before.
"""

import os

from ..errors import InputError

if "MPLBACKEND" in os.environ:
    try:
        import matplotlib  # noqa: F401
    except ValueError as error:
        raise InputError(
            f"MPLBACKEND = {os.environ['MPLBACKEND']!r} in the environment: matplotlib has no such "
            "backend; expected one that it has, such as agg, or the variable not to be set"
        ) from error
