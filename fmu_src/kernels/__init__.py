"""The equations of the FMUs and the rules on their motions, as functions on a list of floats.

Each number of a model has its index in that list, a slot named in ``memory.py``. The same source
runs in pure Python and compiled, with the same bits.
"""
