"""What a motion is: stable or not, one of how many, and where each begins.

=========================  ========================================================================
module                     idea
=========================  ========================================================================
:mod:`.variational`        how a small deviation travels: flow and saltation matrices
:mod:`.following`          settled responses followed impact by impact
:mod:`.lyapunov`           the largest Lyapunov exponent, and the verdict it allows
:mod:`.long_runs`          exponents over successive parts: steady, or a transient that ended
:mod:`.impact_statistics`  what responses look like impact by impact
:mod:`.clusters`           responses told apart
:mod:`.attractors`         coexisting attractors, from random starts
:mod:`.basins`             which attractor each start of a plane leads to
:mod:`.parameter_map`      responses from one start over two parameters
:mod:`.closed_form`        the closed form between impacts
:mod:`.impact_sequence`    the equations of periodic orbits with a given sequence of impacts
:mod:`.guesses`            where Newton's method begins
:mod:`.orbit_search`       what makes a root a motion, and the FMU's word on it
:mod:`.orbits`             one periodic orbit, stable or not
:mod:`.continuation`       curves of roots followed by their arclength
:mod:`.families`           orbits of one sequence over parameters
:mod:`.bifurcations`       functions that change their sign where something happens to an orbit
:mod:`.turning_points`     where displacements and gap turn inside an orbit
:mod:`.branch_walk`        a branch followed until it ends, and the branches that leave it
:mod:`.branches`           orbits along a parameter, with the bifurcations on the way
:mod:`.orbit_records`      what is told of an orbit, one row each
=========================  ========================================================================
"""
