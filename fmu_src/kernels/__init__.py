"""The numbers of the FMUs: plain functions on floats in a flat memory, the same bits in pure Python
and compiled.
"""
