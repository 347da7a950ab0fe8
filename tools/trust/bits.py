"""Campaign on bits: a motion on several communication grids, by all forms and platforms."""

from __future__ import annotations

import functools
import math
import shutil
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from orchestrate.access import OSCILLATOR, Instance, find
from orchestrate.errors import FmuError, InputError

from . import parameter_sets
from .campaign import BatchOutcome, Campaign
from .parameter_sets import ParameterSet
from .programs import temporary_folder

STATE = (
    *("x1", "x2", "v1", "v2", "x_rel", "v_rel", "xi1", "xi2", "xi_rel", "box_force"),
    *("contact_force", "in_contact", "phase", "impact_count", "impact_time", "impact_velocity"),
    *("impact_energy", "contact_count"),
)
STEP = (
    "box_impulse",
    "box_impulse_moment",
    "x_rel_max",
    "evaluations",
)  # of the last step, not of the state
FORMS = ("fmi3", "fmi2", "fmi2-python")
ARM = ("qemu-aarch64", "-L", "/usr/aarch64-linux-gnu")
ARM_EVERY = 25  # sets: a process under an emulator each
NOT = "no"  # where it is refused, or does not finish

Bits = tuple[str, ...]


def to_hexadecimal(values: Sequence[float]) -> Bits:
    """Return numbers as hexadecimal texts with all bits; all NaNs alike."""
    return tuple("nan" if math.isnan(value) else float(value).hex() for value in values)


def simulate_by_fmu(fmu: Path, drawn: ParameterSet, grid: Sequence[float]) -> Bits:
    """Return the outputs at the end of a communication grid, by an FMU."""
    values = {**drawn.values, "bonded": bool(drawn.values.get("bonded"))}
    with Instance(fmu) as instance:
        try:
            instance.initialize(drawn.start_time, **values)
            time = drawn.start_time
            for target in grid:
                instance.step(time, target)
                time = target
        except (FmuError, InputError):
            return (NOT,)
        return to_hexadecimal([float(value) for value in instance.get(*STATE, *STEP)])


@functools.cache
def load_web_module() -> Any:
    """Return the kernel's WebAssembly module under wasmtime."""
    from orchestrate.access.webassembly import web_kernel
    from tools.web_instance import WebInstance

    return WebInstance(web_kernel(OSCILLATOR))


def simulate_by_web(drawn: ParameterSet, grid: Sequence[float]) -> Bits:
    """Return the outputs at the end of a communication grid, by the WebAssembly module."""
    web = load_web_module()
    size = 8 * web.slots["SIZE"]
    web.exports["memory"].write(web.store, bytes(size), web.address)
    web.set(**{**web.starts, **drawn.values})
    if web.exports["kernel_initialize"](web.store, web.address, drawn.start_time):
        return (NOT,)
    time = drawn.start_time
    for target in grid:
        web.set(STOP=0.0)
        reached = max(time + (target - time), float(web.memory()[web.slots["TIME"]]))
        if web.exports["kernel_advance"](web.store, web.address, reached):
            return (NOT,)
        time = target
    memory = web.memory()
    return to_hexadecimal([float(memory[web.slots[name]]) for name in (*STATE, *STEP)])


@functools.cache
def arm_importer() -> Any:
    """Return the importer with the FMU's 64-bit ARM binary; None if it cannot run here."""
    from fmu_src.export import forms
    from tools import importers

    command = importers.zig_compiler("aarch64-linux-gnu.2.28")
    if shutil.which(ARM[0]) is None or not Path(ARM[2]).is_dir() or command is None:
        return None
    folder = temporary_folder() / "arm"
    forms.export(OSCILLATOR, "fmi3", folder, ("x86_64-linux", "aarch64-linux"))
    path = folder / "fmi3" / f"{OSCILLATOR}.fmu"
    program = importers.compile_importer("fmi3", path, folder / "importer", command)
    with zipfile.ZipFile(path) as archive:
        binary = archive.extract(f"binaries/aarch64-linux/{OSCILLATOR}.so", folder)
    return importers.Importer(program, Path(binary), "fmi3")


def simulate_by_arm(drawn: ParameterSet, grid: Sequence[float]) -> Bits:
    """Return the outputs at the end of a grid, by the ARM binary under an emulator."""
    from tools import importers

    names, settings = ",".join((*STATE, *STEP)), importers.settings(drawn.values)
    program, times = arm_importer(), [drawn.start_time, *grid]
    done = program.run("simulate", names, *settings, under=ARM, times=times, success=False)
    rows = [line.split() for line in done.stdout.splitlines() if not line.startswith("CHECKS")]
    if done.returncode:
        return (NOT,)
    return to_hexadecimal([float.fromhex(cell) for cell in rows[-1]])


def reachable_points(start: float, grid: Sequence[float]) -> list[float]:
    """Return the grid points that steps reach to the last bit.

    A master's step ends at ``time + (target - time)``, which may be the number beside the target;
    the end would then be another one on another grid.
    """
    end = start + (grid[-1] - start)
    points = [start]
    for point in grid[:-1]:
        if points[-1] + (point - points[-1]) == point:
            points.append(point)
    while len(points) > 1 and points[-1] + (end - points[-1]) != end:
        points.pop()
    return [*points[1:], end]


def bit_differences(drawn: ParameterSet, on_arm: bool) -> list[str]:
    """Return a line for each pair of computations whose outputs differ in a bit."""
    wrong: list[str] = []
    grids = [reachable_points(drawn.start_time, grid) for grid in drawn.grids()]
    first = [simulate_by_fmu(find(OSCILLATOR).path, drawn, grid) for grid in grids]
    for i, bits in enumerate(first[1:], 1):
        if bits[: len(STATE)] != first[0][: len(STATE)]:
            wrong.append(f"grid {i}: {differing_outputs(bits, first[0])}")
    last = len(grids) - 1
    others = {
        form: simulate_by_fmu(find(OSCILLATOR, form).path, drawn, grids[last]) for form in FORMS[1:]
    }
    others["wasm"] = simulate_by_web(drawn, grids[last])
    if on_arm:
        others["aarch64-linux"] = simulate_by_arm(drawn, grids[last])
    for name, bits in others.items():
        if bits != first[last] and not (name == "wasm" and NOT in (*bits, *first[last])):
            wrong.append(f"{name}: {differing_outputs(bits, first[last])}")
    return wrong


def differing_outputs(one: Bits, other: Bits) -> str:
    """Return the names of the outputs that differ between two computations."""
    if NOT in (*one, *other):
        return "one of them does not get there"
    names = (*STATE, *STEP)
    pairs = zip(names, one, other, strict=True)
    return ", ".join(name for name, a, b in pairs if a != b)


class BitCampaign(Campaign):
    """Campaign: a motion has the same bits on all grids, forms and platforms."""

    name = "bits"
    title = "Grids, forms and platforms"
    asks = (
        "The outputs at a time do not depend on the communication points on the way: one step, "
        "two, five uneven ones, 24, cubic inputs included, less the points that a step size in 53 "
        "bits does not hit. Nor on the form: native FMI 3.0 and 2.0, the compiled kernel in the "
        "pythonfmu form, WebAssembly; "
        "nor on the platform: each 25th set by the 64-bit ARM binary under an emulator. Parameter "
        "sets are drawn from twelve adversarial classes; that a set is refused, or not finished, "
        "may not depend on the grid either, up to the limit of work of one step: a step that has "
        "more to do gives up, where several would not. One differing bit is a finding."
    )
    unit, target, batch = "parameter sets", 10_000, 250

    def run(self, fmu: Path, seed: int, count: int) -> BatchOutcome:
        """Compute ``count`` motions in all ways and compare their bits; return the outcome."""
        notes: list[str] = []
        findings, on_arm = 0, 0
        for number in range(count):
            drawn = parameter_sets.draw_parameter_set(seed, number)
            asked = number % ARM_EVERY == ARM_EVERY - 1 and sys.platform == "linux"
            asked = asked and arm_importer() is not None
            on_arm += asked
            lines = bit_differences(drawn, asked)
            findings += bool(lines)
            notes += [f"seed {seed}, set {number} ({drawn.kind}): {line}" for line in lines]
        return BatchOutcome(count, findings, counts={"on ARM:": on_arm}, notes=tuple(notes))
