"""The weak drive: a structure and the motor that shakes it, two FMUs coupled.

==========================  ==================================================================
module                      idea
==========================  ==================================================================
:mod:`.exchange`            what the master exchanges with the two FMUs
:mod:`.polynomials`         polynomials over one communication step
:mod:`.master`              the co-simulation master and its algorithms
:mod:`.energy_balance`      where the motor's work has gone
:mod:`.schedule`            the voltage over time
:mod:`.controllers`         the voltage from the measured speed
:mod:`.revolutions`         a run as one row a revolution of the motor
:mod:`.jumps`               where the speed jumps
:mod:`.couple`              the question asked of both FMUs: a voltage that comes and goes
:mod:`.capture`             whether a motor switched on from rest passes the resonance
:mod:`.passage`             a run at full resolution, and spectra over its revolutions
:mod:`.averaged`            the averaged theory of the bonded structure
:mod:`.drive_spectra`       spectra at the resonance (Figure 3)
:mod:`.ssp`                 the coupled system as a package for other tools
==========================  ==================================================================
"""
