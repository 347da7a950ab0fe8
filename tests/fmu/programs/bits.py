"""A run of an FMU, every number as hexadecimal text."""

from pathlib import Path

from driver import open_fmu


def simulate(path, end, count, values, names):
    f = open_fmu(path).start(**values)
    times = [end * k / count for k in range(1, count + 1)]
    rows = [[float(x).hex() for x in f.step(time).get(*names)] for time in times]
    lines = Path("/proc/self/maps").read_text().splitlines()
    mapped = {line.split("/", 1)[1].strip() for line in lines if "/" in line}
    return {"rows": rows, "mapped": sorted(mapped)}
