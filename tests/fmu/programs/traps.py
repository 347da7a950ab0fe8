"""Hosts, names, folders and repetitions that an FMU in Python could trip over."""

import gc
import math
import os
import sys
import tempfile
import time
import types
from pathlib import Path

import fmpy
import numpy as np
from driver import OK, Fmu2, Refused, describe, harmonic, messages, open_fmu


def two_versions_in_one_process_do_not_share_code(mine, other, first):
    def numbers(path):
        f = open_fmu(path)
        f.enter()
        (e,) = f.get("e")
        f.leave()
        return [e, f.step(200.0).outputs()]

    order = [mine, other, mine] if first == "mine" else [other, mine, other]
    found = [numbers(path) for path in order]
    data, time = open_fmu(mine).start().step(1.0).save()
    try:
        open_fmu(other).start().restore(data, time)
        status = OK
    except Refused as refused:
        status = [refused.status, "\n".join(refused.messages)]
    return [found, status]


def host_with_modules_of_the_same_names(path):
    names = (
        "fmu_src",
        "fmu_src.runtime",
        "runtime",
        "kernels",
        "models",
        "runtime.slave",
        "kernels.oscillator",
        "kernels.oscillator.memory",
        "oscillator",
        "models.oscillator.model",
        "slave",
        "table",
        "memory",
        "model",
        "variables",
        "TwoMassImpactOscillator",
        "stepper",
        "compiled",
    )
    hosts = {name: types.ModuleType(name) for name in names}
    sys.modules.update(hosts)
    for name in names:
        (Path.cwd() / (name.split(".")[-1] + ".py")).write_text("raise SystemExit('imported')")
    sys.path.insert(0, str(Path.cwd()))
    outputs = open_fmu(path).start(**harmonic(1.13)).step(200.0).outputs()
    new = sorted(
        name
        for name, module in sys.modules.items()
        if str(getattr(module, "__file__", "")).startswith(str(Fmu2.folders[path]))
    )
    return [outputs, [name for name in names if sys.modules[name] is not hosts[name]], new]


def many_instances_and_resets(path):
    def resident():
        return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

    expected = open_fmu(path).start(**harmonic(1.13)).step(20.0).outputs()
    f, sizes = open_fmu(path), []
    for k in range(5000):
        f.reset().start(**harmonic(1.13)).step(1.0)
        if k % 1000 == 0:
            gc.collect()
            sizes.append(resident())
    same = [f.reset().start(**harmonic(1.13)).step(20.0).outputs() == expected]
    for k in range(500):
        g = open_fmu(path, name=f"instance {k}").start(**harmonic(1.13)).step(1.0)
        if k % 3 == 0:
            g.reset()
        g.free()
        if k % 100 == 0:
            gc.collect()
            same.append(f.reset().start(**harmonic(1.13)).step(20.0).outputs() == expected)
    return [same, sizes]


def instantiation_takes_less_than_a_second(path):
    (
        describe(path),
        Fmu2.folders.update({path: fmpy.extract(path, tempfile.mkdtemp(dir=Path.cwd()))}),
    )
    seconds = []
    for k in range(6):
        begin = time.process_time()
        f = open_fmu(path, name=f"instance {k}")
        made = time.process_time()
        f.start().step(0.1)
        seconds.append([made - begin, time.process_time() - begin])
    return seconds


def hostile_instance_names(path, name):
    f = open_fmu(path, name=name)
    try:
        f.set(m1=math.nan)
    except Refused as refused:
        return ["\n".join(refused.messages), f.reset().start().step(1.0).get("phase")]


def percent_signs_in_a_message_reach_the_importer(path):
    module = (
        [m for n, m in sys.modules.items() if n.endswith("runtime.slave")] if open_fmu(path) else []
    )
    table = sys.modules[module[0].__name__.replace("slave", "table")]
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
    result = fmpy.simulate_fmu(
        path,
        stop_time=10.0,
        output_interval=1.0,
        output=["x1"],
        input=np.array(
            [(0.0, 0.9), (4.5, 0.9), (4.5, 1e9), (10.0, 1e9)],
            dtype=[("time", "f8"), ("box_frequency", "f8")],
        ),
    )
    return list(result["time"])


def working_folder_and_paths(path, folder):
    if folder:
        os.chdir("/")
        folder = fmpy.extract(path, folder)
    return open_fmu(path, folder=folder).start().step(50.0).outputs()


def short_steps(path):
    """The log categories on offer, and what is logged of a thousand steps that lead nowhere."""
    f, texts = open_fmu(path).start(1e9, **harmonic(1.13)), []
    before = f.outputs()
    for _ in range(1000):
        f.call("doStep", 1e9, 1e-9)
        texts += messages
    assert f.outputs() == before != f.step(1e9 + 1.0).outputs()
    return [[category.name for category in describe(path).logCategories], texts + messages]


def log_category(path, categories):
    f = open_fmu(path)
    f.slave.setDebugLogging(True, categories)
    texts = []
    for _ in range(300):
        try:
            f.set(m1=-1.0)
        except Refused as refused:
            texts += refused.messages
    return texts
