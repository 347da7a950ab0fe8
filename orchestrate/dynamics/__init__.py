"""Dynamics of the structure: stability, Lyapunov exponents, attractors, basins, orbits, branches.

Three ways lead to an answer. Responses that are run on in the FMU until they are settled
(:mod:`.attractors`, :mod:`.basins`, :mod:`.parameter_map`, :mod:`.impact_statistics`). Deviations
that are carried along from impact to impact (:mod:`.lyapunov` by :mod:`.variational`). And periodic
orbits by Newton's method, stable or not, of which the FMU says whether it runs through them
(:mod:`.orbits`, :mod:`.branches`, :mod:`.borders` by :mod:`.periodic_orbit` and :mod:`.tracer`).
"""
