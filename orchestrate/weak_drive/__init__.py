"""Couple a structure with a motor of limited power, as two FMUs, and find its speed jumps.

========================  ============================================================
module                    idea
========================  ============================================================
:mod:`.polynomials`       polynomials over one communication step
:mod:`.connection`        any drive's variables by our names, checked
:mod:`.inputs`            the drive's other inputs: courses over time, and a controlled one
:mod:`.master`            calls the compiled loop that steps the two
:mod:`.step_record`       what a run leaves of its steps, by columns
:mod:`.extremes`          largest displacements within a communication step
:mod:`.energy_balance`    where energies are balanced, and the coupling's energy defect
:mod:`.schedule`          the voltage over time
:mod:`.controllers`       the voltage from the measured speed
:mod:`.revolutions`       a run as one row per revolution of the motor
:mod:`.run`               two FMU instances stepped together, in chunks that go on
:mod:`.ramp_record`       where the record of a ramp shows a jump, and how
:mod:`.steady_speed`      whether the speed at a held voltage has settled
:mod:`.growth`            how fast disturbances of a held motion grow
:mod:`.hysteresis`        the rule that decides about jumps: voltages held over a ramp, and back
:mod:`.cosimulation_job`  the job of the oscillator and any drive that is an FMU
:mod:`.cosimulate`        the function, its checks and warnings
:mod:`.couple`            a run of both FMUs under a varying voltage, and its jumps
:mod:`.couple_all`        many coupled runs at once
:mod:`.jump_voltages`     jump voltages at rate 0, and on ramps of several rates
:mod:`.capture_rule`      whether a motor switched on has settled, below or beyond the resonance
:mod:`.capture`           whether a motor switched on from rest passes the resonance
:mod:`.passage`           a run at full resolution, and spectra over its revolutions
:mod:`.averaged`          the averaged theory of the bonded structure
:mod:`.own_resonance`     the delaminated structure's resonance and its dividing speed
:mod:`.shooting`          stationary motions of structure and motor, by shooting
:mod:`.drive_tracer`      one branch of stationary motions, by arclength continuation
:mod:`.drive_branch`      branches of stationary motions, stable and unstable
:mod:`.drive_spectra`     spectra at the resonance (Figure 3)
:mod:`.ssp`               the coupled system as a package for other tools
========================  ============================================================
"""
