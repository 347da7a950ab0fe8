"""Hosts that an FMU in Python could trip over, in processes of their own."""

import sys
import types
from pathlib import Path

import fmpy
import numpy as np
from driver import Fmu2, Refused, harmonic, open_fmu

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


def percent_signs_in_a_message_reach_the_importer(path):
    open_fmu(path)
    (name,) = [name for name in sys.modules if name.endswith("runtime.slave")]
    table = sys.modules[name.replace("slave", "table")]
    real = table.Variable.problem
    table.Variable.problem = lambda self, value: (
        "%s%n %d 100 %: expected everything" if value == 7.5 else real(self, value)
    )
    texts = []
    for _ in range(50):
        try:
            open_fmu(path).set(m1=7.5)
        except Refused as refused:
            texts += refused.messages
    return texts


def discarded_step_is_noticed(path):
    columns = [("time", "f8"), ("box_frequency", "f8")]
    signal = np.array([(0.0, 0.9), (4.5, 0.9), (4.5, 1e9), (10.0, 1e9)], dtype=columns)
    options = {"stop_time": 10.0, "output_interval": 1.0, "output": ["x1"], "input": signal}
    return list(fmpy.simulate_fmu(path, **options)["time"])
