"""What a motion is: stable or not, one of how many, and where each begins.

=========================  ========================================================================
module                     idea
=========================  ========================================================================
:mod:`.variational`        how a small deviation travels: flow and saltation matrices
:mod:`.following`          settled responses followed impact by impact
:mod:`.lyapunov`           the largest Lyapunov exponent, and the verdict it allows
:mod:`.impact_statistics`  what responses look like impact by impact
:mod:`.clusters`           responses told apart
:mod:`.attractors`         coexisting attractors, from random starts
:mod:`.basins`             which attractor each start of a plane leads to
:mod:`.parameter_map`      responses from rest over two parameters
=========================  ========================================================================
"""
