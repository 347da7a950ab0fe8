"""Draw Matplotlib figures of the package's datasets; nothing here runs an FMU.

Each module has a function ``draw`` that takes one or several datasets and returns a
:class:`matplotlib.figure.Figure`; :func:`.files.save` writes it. Only this folder sees matplotlib,
whose settings and backend are the same after a drawing as before.
"""
