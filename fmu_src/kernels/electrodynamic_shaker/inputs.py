"""The command and the force on the box: cubics that run on until one of their inputs is set."""

from . import memory as at


def does_cubic_restart(m, flag, inputs):
    """Return whether a cubic restarts: an input changed, or one of a cubic that moves was set."""
    moves = False
    for i in range(at.CUBIC):
        before = m[at.STATE_INPUTS + inputs - at.COMMAND + i]
        if m[inputs + i] != before:
            return True
        if i > 0 and before != 0.0:
            moves = True
    return moves and m[flag] != 0.0


def store_inputs(m):
    """Make the inputs as they are now those of the present state."""
    for i in range(2 * at.CUBIC):
        m[at.STATE_INPUTS + i] = m[at.COMMAND + i]


def write_input_series(m, h):
    """Write command, source and force over an interval of length ``h``."""
    now = m[at.INTERVAL] * m[at.SPACING]
    age = ((m[at.ORIGIN] - m[at.COMMAND_TIME]) + m[at.ORIGIN_LOW]) + now
    write_cubic_series(m, at.COMMAND_SERIES, at.STATE_INPUTS, age, h)
    age = ((m[at.ORIGIN] - m[at.FORCE_TIME]) + m[at.ORIGIN_LOW]) + now
    write_cubic_series(m, at.FORCE_SERIES, at.STATE_INPUTS + at.CUBIC, age, h)
    write_source_series(m)


def write_cubic_series(m, series, inputs, age, h):
    """Write a cubic's series, ``age`` (s) after it began; a constant keeps its bits."""
    d0, d1, d2, d3 = m[inputs], m[inputs + 1], m[inputs + 2], m[inputs + 3]
    m[series] = d0 + age * (d1 + 0.5 * age * (d2 + age * d3 / 3.0))
    m[series + 1] = h * (d1 + age * (d2 + 0.5 * age * d3))
    m[series + 2] = h * h * 0.5 * (d2 + age * d3)
    m[series + 3] = h * h * h * d3 / 6.0


def write_source_series(m):
    """Write the source's series: the command, or its limit."""
    for i in range(at.CUBIC):
        m[at.SOURCE_SERIES + i] = m[at.COMMAND_SERIES + i] if m[at.CLIPPED] == 0.0 else 0.0
    if m[at.CLIPPED] != 0.0:
        m[at.SOURCE_SERIES] = m[at.CLIPPED] * m[at.COMMAND_LIMIT]
