"""The native FMUs as C and FMI 3.0 importers meet them: no Python inside, hostile callers, event
mode, the same bits in every form.
"""
