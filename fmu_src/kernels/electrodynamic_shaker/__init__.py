"""The kernel of the electrodynamic shaker: a coil moves a table on its suspension.

Standard library and what is shared in :mod:`..numerics` only, plain floats in one flat memory,
under the same rules as the oscillator's kernel. Between the amplifier's limits all is linear and
driven by cubics, so the motion over a short interval is a power series without an approximation but
its last term. Intervals are counted from the last event or the last new input, never from
communication points: these do not change a bit.

====================  =====================================================================
module                idea
====================  =====================================================================
:mod:`.memory`        the flat memory: what stands in which slot
:mod:`.intervals`     how long an interval may be
:mod:`.inputs`        the two cubics, which run on until they are set again
:mod:`.series`        the motion over an interval and its energies, as power series
:mod:`.amplifier`     which limits act: the commanded quantity is clipped, the other one is held
:mod:`.limits`        the first event of an interval, by certified roots
:mod:`.motion`        from state to state, and from interval to interval
:mod:`.outputs`       what an importer sees, with the inputs as set now
:mod:`.rates`         time derivatives of the outputs: the entry point ``differentiate``
:mod:`.stepper`       the other entry points: ``initialize``, ``advance``, ``refresh``
====================  =====================================================================
"""
