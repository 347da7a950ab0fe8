"""FMPy's own functions, and the driver's numbers beside them."""

import itertools
import time

import fmpy
from driver import compiled, open_fmu


def reference(path, names, values, step, count):
    f = open_fmu(path).start(**values)
    return [
        [0.0, *f.get(*names)],
        *[[k * step, *f.step(k * step).get(*names)] for k in range(1, count + 1)],
    ]


def simulate_fmu(path, values, names):
    result = fmpy.simulate_fmu(
        path, stop_time=200.0, output_interval=0.125, start_values=values, output=names
    )
    return [result[name].astype(float).tolist() for name in ["time", *names]]


def second_simulation_is_as_fast_as_the_first(path):
    values, seconds, ends = {"box_frequency": 1.13, "x_rel_max_on": False}, [], []
    for _ in range(4):
        begin = time.process_time()
        result = fmpy.simulate_fmu(
            path, stop_time=2e4, output_interval=1e4, start_values=values, output=["x1"]
        )
        seconds.append(time.process_time() - begin)
        ends.append(float(result["x1"][-1]))
    return [seconds, ends, compiled()]


def steps_that_differ_in_the_last_bits(path):
    values, names = {"box_frequency": 2.0, "box_amplitude": 0.25}, ["x1", "v1", "x2", "v2", "phase"]
    rows = fmpy.simulate_fmu(
        path, output_interval=0.1, stop_time=1000.0, start_values=values, output=names
    )
    f = open_fmu(path).start(**values).step(float(rows["time"][-1]))
    steps = {b - a for a, b in itertools.pairwise(rows["time"])}
    return [len(steps), len(rows), [float(rows[name][-1]) for name in names], f.get(*names)]
