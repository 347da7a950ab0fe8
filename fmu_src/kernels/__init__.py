"""The numbers of the FMUs: plain functions on floats in a flat memory.

The same source runs in pure Python and compiled, with the same bits.
"""
