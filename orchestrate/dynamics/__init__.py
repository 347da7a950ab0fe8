"""Dynamics of the structure: settled responses, carried deviations, and periodic orbits.

Responses: :mod:`.attractors` and :mod:`.basins`, with what settles when (:mod:`.settling`), to what
(:mod:`.decision`), and as what along a parameter (:mod:`.global_continuation`);
:mod:`.parameter_map`, :mod:`.impact_statistics`, :mod:`.poincare`. Deviations: :mod:`.variational`,
:mod:`.lyapunov`. Orbits: equations in :mod:`.periodic_orbit` by the motion of :mod:`.closed_form`,
one in :mod:`.orbits`, over a parameter in :mod:`.branches`, bifurcations over two in
:mod:`.borders`, unstable manifolds in :mod:`.manifolds`. Curves of any equations are followed by
:mod:`.continuation` and :mod:`.tracer`.
"""
