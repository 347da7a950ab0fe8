"""The shaker kernel: a box on springs, shaken by a motor of limited power with an unbalance.

Standard library and the elementary functions of :mod:`..numerics` only, plain floats in one flat
memory, under the same rules as the oscillator's kernel: the same source runs in any Python 3.9+,
translates to C as it stands, and gives the same bits everywhere. Unlike that one, this has no
closed form: box and rotor are integrated by a Runge-Kutta formula of order 8, so the result belongs
to the communication points, within the formula's tolerance.

====================  =====================================================================
module                idea
====================  =====================================================================
:mod:`.memory`        the flat memory: what stands in which slot
:mod:`.tableau`       coefficients of the formula of Dormand and Prince
:mod:`.equations`     mass matrix, motor, force over the step: the right-hand side
:mod:`.integrate`     one sub-step and its error; sub-steps through a communication step
:mod:`.outputs`       what an importer sees, with the inputs as set now
:mod:`.rates`         time derivatives of the outputs: the entry point ``differentiate``
:mod:`.stepper`       the other entry points: ``initialize``, ``advance``, ``refresh``
====================  =====================================================================
"""
