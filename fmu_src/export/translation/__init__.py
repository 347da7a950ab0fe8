"""Translate the kernels' Python to C99; :func:`.kernel.translate` is the way in.

==================  ============================================================================
module              idea
==================  ============================================================================
:mod:`.subset`      what can be read off the Python: names, comments, blocks, who writes the memory
:mod:`.values`      types, and expressions in C with them
:mod:`.expressions` an expression: order of evaluation, calls, conversions
:mod:`.functions`   a function: its statements, and where its variables are declared
:mod:`.kernel`      all functions that the entry points need, and the C file
==================  ============================================================================
"""
