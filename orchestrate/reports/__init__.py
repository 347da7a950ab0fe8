"""Write stored results as one HTML report for a person to read, print and sign.

==================  ===============================================================================
module              idea
==================  ===============================================================================
:mod:`.report`      answers in, one page out
:mod:`.page`        what a page is made of, and its HTML
:mod:`.verdict`     the sections of a verdict on a beam
:mod:`.answers`     the sections of any other answer, and where all come from
==================  ===============================================================================
"""
