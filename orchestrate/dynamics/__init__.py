"""Dynamics of the structure: settled responses, carried deviations, and periodic orbits.

===============================  =================================================================
module                           idea
===============================  =================================================================
:mod:`.impacts_after_transient`  a motion's impacts once a transient is dropped: base of questions
:mod:`.impact_statistics`        how many impacts, how fast, how long contact lasts
:mod:`.poincare`                 sections of a motion at a phase, at impacts or releases
:mod:`.closed_form`              the motion between two impacts (10)
:mod:`.variational`              how a small deviation grows through impacts
:mod:`.lyapunov`                 largest exponents with errors: periodic, neutral or chaotic
:mod:`.lyapunov_spectrum`        all four exponents, and the dimension
:mod:`.settled_motion`           settled motions, and whether two of them are the same
:mod:`.settling`                 responses run until they settle, with all thresholds
:mod:`.clusters`                 whether irregular responses belong to one attractor
:mod:`.decision`                 to which motion a response settles: the one rule
:mod:`.global_continuation`      which attractors along a parameter are the same
:mod:`.attractors`               attractors found from random starts
:mod:`.basins`                   to which attractor each start of a plane leads
:mod:`.basin_entropy`            how unpredictable the attractor of a start is
:mod:`.parameter_map`            responses over a grid of two parameters
:mod:`.periodic_orbit`           equations of an orbit with a given sequence of impacts
:mod:`.turning_points`           extrema along an orbit: amplitudes, near misses
:mod:`.orbit_search`             orbits by Newton's method from guesses, checked in the FMU
:mod:`.orbit_records`            tables and variables of orbits in results
:mod:`.orbits`                   one periodic orbit of a structure
:mod:`.families`                 an orbit's equations over varying parameters
:mod:`.continuation`             curves of roots by pseudo-arclength, of any equations
:mod:`.bifurcation_kinds`        numbers and names of the kinds of bifurcations
:mod:`.tracer`                   one branch step by step: its bifurcations located, its end
:mod:`.orbit_tracer`             the same of orbits: test functions, impacts that come or go
:mod:`.branch_switching`         the branch that leaves another one at a bifurcation
:mod:`.branches`                 branches of orbits over a parameter
:mod:`.stable_windows`           where branches are stable, and what bounds it
:mod:`.bifurcation_curve`        equations of a bifurcation over two parameters
:mod:`.codimension_two`          points of codimension two on such a curve
:mod:`.borders`                  bifurcations followed over two parameters
:mod:`.curve_growth`             an image of a curve, refined until it is smooth
:mod:`.manifolds`                unstable manifolds of saddles
===============================  =================================================================
"""
