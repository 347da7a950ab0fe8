"""Samples for the clearance."""

from driver import Refused, open_fmu


def ends(path, runs, stops, names):
    """Outputs at the end of one step each."""
    f = open_fmu(path)
    found = []
    for values, stop in zip(runs, stops, strict=True):
        f.reset()
        found.append(f.start(**values).step(stop).get(*names))
    return found


def rows(path, values, times, names):
    """Outputs at some times, the start among them."""
    f = open_fmu(path).start(**values)
    return [(f.step(time) if time else f).get(*names) for time in times]


def pushed_rows(path, values, times, names):
    """The same; each step begins with inputs that are set to something new."""
    f = open_fmu(path).start(**values)
    found = []
    for k, time in enumerate(times):
        f.set(box_acceleration=0.01 * (k % 3 - 1))
        found.append(f.step(time).get(*names))
    return found


def refusal(path, values):
    """What is said where a start is refused."""
    try:
        open_fmu(path).start(**values)
    except Refused as refused:
        return " ".join(refused.messages)
    return ""
