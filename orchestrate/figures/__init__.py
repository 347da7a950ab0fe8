"""Draw Matplotlib figures of the package's datasets; nothing here runs an FMU.

Five families, each a module of what its pictures share and of a function per kind of result:

- lines over a parameter: ``lines``, ``resonance``, ``weak_drive``; branches over them: ``overlay``
- ``planes``: maps, basins, borders, sections, phase curves
- time histories: ``histories``, ``passage``
- ``spectra``, and what an analyser shows: ``analysis``
- special: ``diagnosis``

``plot`` has the table of which function draws what. Each takes datasets and returns a
:class:`matplotlib.figure.Figure`; :func:`.files.save` writes it. Only this folder sees matplotlib,
whose settings and backend are the same after a drawing as before.
"""
