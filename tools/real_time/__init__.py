"""Measure the FMU on real-time targets, for the manual: ``python -m tools.real_time``.

==================  ============================================================================
module              idea
==================  ============================================================================
:mod:`.sources`     an FMU's C sources in a folder, and compilers
:mod:`.footprint`   bytes of stack by the compiler's call graph, which also shows recursion
:mod:`.targets`     one trajectory on a desktop, on a Cortex-M7 and on RISC-V: the same bits
:mod:`.step_times`  times of a hundred million steps
==================  ============================================================================
"""
