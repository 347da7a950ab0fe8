"""Responses of a shaken structure: motion in time, sweeps, resonance curves, spectra, threshold.

==========================  ==================================================================
module                      idea
==========================  ==================================================================
:mod:`.questions`           checks of the user's arguments; base classes of jobs
:mod:`.signatures`          a public function as a question: its signature has the fields of its job
:mod:`.labels`              dataset variables with units and long names
:mod:`.equations`           accelerations from the state: (6) and (18)
:mod:`.multiplicity`        period of a response in excitation periods
:mod:`.response_loop`       many steady-state responses by one call of compiled code
:mod:`.respond`             steady-state response at one operating point
:mod:`.simulate`            a motion in time
:mod:`.sweep`               responses along a parameter; the columns of their CSV
:mod:`.resonance`           resonance curves, bonded against delaminated, with peaks and jumps
:mod:`.threshold`           the level at which a pressed structure opens, or an open one touches
:mod:`.maxima_and_jumps`     significant maxima and jumps of a curve
:mod:`.spectra`             amplitude spectra of the masses' accelerations
==========================  ==================================================================
"""
