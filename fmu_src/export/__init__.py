"""Make an FMU of a kernel and a variable table: one file for each form, and what the forms share.

:mod:`.forms` is the face of it. Importing it needs only the standard library: ziglang,
pythonfmu and jinja2 are looked for when a build is asked for.
"""
