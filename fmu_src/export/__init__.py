"""From a kernel and a variable table to an FMU: one file per form, one for
``modelDescription.xml``.
"""
