"""Hosts that an FMU in Python could trip over, in processes of their own."""

import sys
import types
from pathlib import Path

from driver import Fmu2, harmonic, open_fmu

NAMES = (
    *("fmu_src", "fmu_src.runtime", "runtime", "kernels", "models", "runtime.slave"),
    *("kernels.oscillator", "kernels.oscillator.memory", "oscillator", "models.oscillator.model"),
    *("slave", "table", "memory", "model", "variables", "TwoMassImpactOscillator", "stepper"),
    "compiled",
)


def host_with_modules_of_the_same_names(path):
    hosts = {name: types.ModuleType(name) for name in NAMES}
    sys.modules.update(hosts)
    for name in NAMES:
        (Path.cwd() / (name.split(".")[-1] + ".py")).write_text("raise SystemExit('imported')")
    sys.path.insert(0, str(Path.cwd()))
    outputs = open_fmu(path).start(**harmonic(1.13)).step(200.0).outputs()
    folder = str(Fmu2.folders[path])
    files = {name: str(getattr(m, "__file__", "")) for name, m in sys.modules.items()}
    new = sorted(name for name, file in files.items() if file.startswith(folder))
    return [outputs, [name for name in NAMES if sys.modules[name] is not hosts[name]], new]
