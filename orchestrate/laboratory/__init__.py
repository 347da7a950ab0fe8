"""The laboratory: how a shaker excites the structure, and what is recorded.

========================  =========================================================================
module                    idea
========================  =========================================================================
:mod:`.pieces`            a box acceleration as cubic pieces, which the FMU takes exactly
:mod:`.signals`           what every excitation is, and sums of them
:mod:`.swept_sine`        a sine of moving frequency
:mod:`.random_vibration`  a power spectral density
:mod:`.shock`             a classical pulse
:mod:`.sampled`           a record played again
:mod:`.shake`             time histories and impacts under any of these
:mod:`.analysis`          what an analyser shows of a record
========================  =========================================================================
"""
