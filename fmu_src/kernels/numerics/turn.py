"""Cosine and sine of an angle in turns, for loops that are written in C."""

from .elementary import sincos_turns


def write_cosine_and_sine(m, turns):
    """Write cosine and sine of ``2 pi`` times a number of turns."""
    m[1], m[0] = sincos_turns(turns)
    return 0
