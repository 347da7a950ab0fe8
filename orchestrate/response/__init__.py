"""How a shaken structure responds: its motion in time, along a parameter, as spectra.

=====================  ============================================================================
module                 idea
=====================  ============================================================================
:mod:`.questions`      at which structures and excitations a question is asked
:mod:`.labels`         units and long names of what is answered
:mod:`.equations`      accelerations from the state: (6) and (18)
:mod:`.multiplicity`   after how many periods a response repeats
:mod:`.respond`        one settled response: stroboscopic samples, impacts, largest gap
:mod:`.peaks`          amplitudes and peak accelerations of both masses
:mod:`.simulate`       a motion in time
:mod:`.sweep`          responses along a parameter, each from the end of the last
:mod:`.resonance`      resonance curves, bonded against delaminated, with peaks and jumps
:mod:`.curves`         phase curves with both sides of each impact
:mod:`.spectra`        amplitude spectra of the masses' accelerations
=====================  ============================================================================
"""
