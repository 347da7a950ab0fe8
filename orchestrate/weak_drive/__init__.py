"""Couple a structure with a motor of limited power, as two FMUs, and find its speed jumps.

======================  ============================================================
module                  idea
======================  ============================================================
:mod:`.exchange`        the variables that the master exchanges with the two FMUs
:mod:`.polynomials`     polynomials over one communication step
:mod:`.master`          the master: algorithms, and where the communication step is chosen
:mod:`.compiled`        the same steps in compiled code, with the same bits
:mod:`.extremes`        largest displacements within a communication step
:mod:`.energy_balance`  where energies are balanced, and the coupling's energy defect
:mod:`.schedule`        the voltage over time
:mod:`.controllers`     the voltage from the measured speed
:mod:`.revolutions`     a run as one row per revolution of the motor
:mod:`.run`             both FMU instances of a run, stepped together
:mod:`.jumps`           where a ramp's record shows a jump of the speed
:mod:`.further_jumps`   where a ramp's record suggests further jumps
:mod:`.voltage_hold`    a voltage held until the speed has settled
:mod:`.held`            where a jump is bracketed, by holding voltages
:mod:`.jump_verdicts`   jump, none or undecided in each direction, and why
:mod:`.ramp_record`     where a ramp's record passes the resonance, and suspected jumps
:mod:`.losses`          all losses of stability on one ramp: the jump and further ones
:mod:`.connection`      any drive's variables by our names, checked; the box's motion from them
:mod:`.cosimulate`      the oscillator and any drive that is an FMU
:mod:`.couple`          a run of both FMUs under a varying voltage, and its jumps
:mod:`.couple_all`      many coupled runs at once
:mod:`.jump_voltages`   jump voltages extrapolated to rate 0, with an error
:mod:`.settling`        whether the speed at a constant voltage has settled
:mod:`.capture`         whether a motor switched on from rest passes the resonance
:mod:`.passage`         a run at full resolution, and spectra over its revolutions
:mod:`.averaged`        the averaged theory of the bonded structure
:mod:`.own_resonance`   the delaminated structure's resonance and its dividing speed
:mod:`.shooting`        stationary motions of structure and motor, by shooting
:mod:`.grazing`         how near a stationary motion is to grazing
:mod:`.drive_tracer`    one branch of stationary motions, by arclength continuation
:mod:`.drive_branch`    branches of stationary motions, stable and unstable
:mod:`.ramp_path`       the folds and jumps that a slow ramp meets on these branches
:mod:`.drive_spectra`   spectra at the resonance (Figure 3)
:mod:`.ssp`             the coupled system as a package for other tools
======================  ============================================================
"""
