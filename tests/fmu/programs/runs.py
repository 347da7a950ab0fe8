"""Runs of an FMU in a process of their own: another one, a hostile one, one that may never end."""

import sys
import types
from pathlib import Path

from driver import Refused, extracted, harmonic, open_fmu

NAMES = (
    *("fmu_src", "fmu_src.runtime", "runtime", "kernels", "models", "runtime.slave"),
    *("kernels.oscillator", "kernels.oscillator.memory", "oscillator", "models.oscillator.model"),
    *("slave", "table", "memory", "model", "variables", "TwoMassImpactOscillator", "stepper"),
    "compiled",
)


def simulate(path, end, count, values, names):
    """Outputs at equal times, every number as hexadecimal text, and files in the memory."""
    f = open_fmu(path).start(**values)
    times = [end * k / count for k in range(1, count + 1)]
    rows = [[float(x).hex() for x in f.step(time).get(*names)] for time in times]
    lines = Path("/proc/self/maps").read_text().splitlines()
    return {"rows": rows, "mapped": [line.split("/", 1)[1] for line in lines if "/" in line]}


def run_and_resume(path, data):
    """Outputs of a run of this process at 77 s, and x1 at 2000 s; those of the resumed state."""
    f = open_fmu(path).start(**harmonic(1.13)).step(77.0)
    resumed = open_fmu(path).restore(bytes.fromhex(data), 77.0).step(2000.0)
    return [[f.outputs(), f.step(2000.0).one("x1")], resumed.outputs()]


def refusals(path, steps):
    """What starts and steps are refused with, by start time, values and length, or empty texts.

    After a step that is refused one of no length is done.
    """
    found = []
    for start_time, values, size in steps:
        f, messages = open_fmu(path), []
        try:
            f.start(start_time, **values)
            f.call("doStep", start_time, size)
        except Refused as refused:
            messages = refused.messages
            if refused.function == "doStep":
                f.call("doStep", start_time, 0.0)
        found.append(" ".join(messages))
    return found


def host_with_modules_of_the_same_names(path):
    hosts = {name: types.ModuleType(name) for name in NAMES}
    sys.modules.update(hosts)
    for name in NAMES:
        (Path.cwd() / (name.split(".")[-1] + ".py")).write_text("raise SystemExit('imported')")
    sys.path.insert(0, str(Path.cwd()))
    outputs = open_fmu(path).start(**harmonic(1.13)).step(200.0).outputs()
    folder = str(extracted(path))
    files = {name: str(getattr(m, "__file__", "")) for name, m in sys.modules.items()}
    new = sorted(name for name, file in files.items() if file.startswith(folder))
    return [outputs, [name for name in NAMES if sys.modules[name] is not hosts[name]], new]
