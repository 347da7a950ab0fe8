"""Values outside their ranges, and refused calls that must change nothing."""

import math
import re

from driver import Refused, harmonic, open_fmu


def ranges(path):
    f, tried, missed, kept = open_fmu(path), [], [], []
    f.enter()
    for variable in [v for v in real(f) if v.causality in ("parameter", "input")]:
        try_range(f, variable, tried, missed, kept)
    f.leave()
    f.step(1.0)
    for variable in [v for v in real(f) if v.causality == "input" or v.variability == "tunable"]:
        try_range(f, variable, tried, missed, kept)
    f.step(50.0)
    plain = open_fmu(path).start().step(1.0).step(50.0)
    return [len(tried), missed, kept, f.outputs() == plain.outputs()]


def real(f):
    """The variables that are floating-point numbers."""
    return [v for v in f.variables.values() if v.type in ("Real", "Float64")]


def try_range(f, variable, tried, missed, kept):
    """Set a variable to numbers just outside its range, then to its ends."""
    name, low, high = variable.name, float(variable.min), float(variable.max)
    before = f.get(name)
    beside = (math.nextafter(low, -math.inf), math.nextafter(high, math.inf))
    for value in (math.nan, math.inf, -math.inf, *beside):
        tried.append(name)
        try:
            f.set(**{name: value})
            missed.append([name, value, "accepted"])
        except Refused as refused:
            text = "\n".join(refused.messages)
            told = re.search(rf"\b{name} = (\S+?):? ", text)
            if not told or float(told[1]).hex() != value.hex():
                missed.append([name, value, text])
            missed.extend([name, value, end] for end in (repr(low), repr(high)) if end not in text)
    if f.get(name) != before:
        kept.append(name)
    for value in (low, high):
        f.set(**{name: value})  # the ends belong to the range
    f.set(**{name: before[0]})


def a_refused_set_sets_nothing(path):
    f = open_fmu(path)
    f.enter()
    references = [f.variables[name].valueReference for name in ("m1", "k1", "m2")]
    try:
        f.call("set" + f.variables["m1"].type, references, [2.0, math.nan, 3.0])
    except Refused:
        return f.get("m1", "k1", "m2")


def a_refused_step_leaves_the_instance_where_it_was(path):
    def run(spoil):
        f = open_fmu(path).start(d1=0.0, x2_start=0.25, box_frequency=1.13).step(30.0)
        before, refusals = f.outputs(), 0
        if spoil:
            f.set(box_frequency=1e9)  # more radians than a step may walk
            for target in (31.0, 30.5):
                try:
                    f.step(target)
                except Refused:
                    refusals += 1
            for point, size in ((30.0, -1.0), (30.0, math.nan), (12.0, 1.0)):
                try:
                    f.call("doStep", currentCommunicationPoint=point, communicationStepSize=size)
                except Refused:
                    refusals += 1
            f.set(box_frequency=1.13)
        return refusals, f.outputs() == before, f.step(90.0).outputs()

    return [run(True), run(False)]


def stderr_has_the_message_where_logging_is_off(path):
    f = open_fmu(path, logging=False, name="quiet")
    logged = []
    for call in (lambda: f.set(m1=-2.0), lambda: f.start() and f.step(-1.0)):
        try:
            call()
        except Refused as refused:
            logged.append([refused.status, refused.messages])
    return logged


def long_step_ends(path):
    f = open_fmu(path).start(**harmonic(0.4)).step(1e5)
    before = f.outputs()
    f.step(1e5)
    after = f.outputs()
    return [before, after]


def overdamped_masses_are_supported(path):
    f = open_fmu(path).start(box_amplitude=0.0, d2=5.0, x2_start=0.5)
    return [f.step(time).get("x2", "v2", "impact_count") for time in (0.5, 2.0, 6.0)]
