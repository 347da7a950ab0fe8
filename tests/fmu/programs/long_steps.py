"""Steps that nobody can count the oscillations of, in a fresh process: one could never end."""

from driver import Refused, open_fmu


def outcomes(path, steps):
    """What starts or steps are refused with, or empty texts: by start time, values and length."""
    return [outcome(path, *step) for step in steps]


def outcome(path, start_time, values, size):
    """After a step that is refused one of no length is done."""
    f, refusals = open_fmu(path), []
    try:
        f.start(start_time, **values)
        f.call("doStep", start_time, size)
    except Refused as refused:
        refusals = refused.messages
        if refused.function == "doStep":
            f.call("doStep", start_time, 0.0)
    return " ".join(refusals)
