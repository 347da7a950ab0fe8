"""Couple a structure with a motor of limited power, as two FMUs, and find its speed jumps.

======================  ============================================================
module                  idea
======================  ============================================================
:mod:`.exchange`        what the master exchanges with the two FMUs
:mod:`.polynomials`     polynomials over one communication step
:mod:`.master`          the co-simulation master and its algorithms
:mod:`.compiled`        the same steps in compiled code, with the same bits
:mod:`.extremes`        largest displacements within a communication step
:mod:`.energy_balance`  where the motor's work has gone
:mod:`.schedule`        the voltage over time
:mod:`.controllers`     the voltage from the measured speed
:mod:`.revolutions`     a run as one row per revolution of the motor
:mod:`.run`             a run under way, step by step
:mod:`.jumps`           where the speed jumps
:mod:`.further_jumps`   where a ramp's record shows that it may jump once more
:mod:`.held`            held-voltage test: whether a motion is lost at the resonance
:mod:`.jump_verdicts`   jump, none or undecided in each direction, and why
:mod:`.losses`          all jumps of a direction, in the ramp's order
:mod:`.couple`          a run of both FMUs under a voltage over time
:mod:`.couple_all`      many coupled runs at once
:mod:`.jump_voltages`   jump voltages extrapolated to rate 0, with an error
:mod:`.settling`        whether the speed at a constant voltage has settled
:mod:`.capture`         whether a motor switched on from rest passes the resonance
:mod:`.passage`         a run at full resolution, and spectra over its revolutions
:mod:`.averaged`        the averaged theory of the bonded structure
:mod:`.own_resonance`   where the delaminated structure resonates, and what divides its motions
:mod:`.shooting`        stationary motions of structure and motor, by shooting
:mod:`.grazing`         how near a stationary motion is to grazing
:mod:`.drive_tracer`    the shooting problem as the tracer of branches needs it
:mod:`.drive_branch`    branches of stationary motions, stable and unstable
:mod:`.ramp_path`       what a slow ramp meets on these branches
:mod:`.drive_spectra`   spectra at the resonance (Figure 3)
:mod:`.ssp`             the coupled system as a package for other tools
======================  ============================================================
"""
