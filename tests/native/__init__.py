"""The native FMUs as C and FMI 3.0 importers meet them: calls in any order, event mode, the same
bits in every form and on every platform.
"""
