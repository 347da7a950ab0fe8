"""The kernel compiled ahead of time: Numba to LLVM, LLVM to object files that need nothing but
``memset``.

Runs in a process of its own (``python -m fmu_src.export.compile_kernel MODEL FOLDER``), because
Numba reads its settings when it is imported. No fast-math, no fused multiply-add, a baseline
processor: with the kernel's own elementary functions every number has the bits that pure Python
gives. Only Numba's public ``inspect_llvm`` and llvmlite's binding layer are used.
"""

import functools
import importlib
import os
import re
import subprocess
import sys
import tempfile
import types
from pathlib import Path
from typing import Any

from .linking import PLATFORMS, NoCompiler

CPU = "x86-64-v2"
SETTINGS = {
    "NUMBA_CPU_NAME": CPU,
    "NUMBA_CPU_FEATURES": "",
    "NUMBA_OPT": "3",
    "NUMBA_CACHE_DIR": os.devnull,
}


@functools.cache
def compile_objects(model_module):
    """Compile a model's kernel for every platform, in a process of its own.

    Parameters
    ----------
    model_module : str
        Module with a ``MODEL`` (:class:`..runtime.table.Model`), e.g.
        ``"fmu_src.models.oscillator.model"``.

    Returns
    -------
    dict of str to bytes
        Object file by platform, of :data:`.linking.PLATFORMS`.

    Raises
    ------
    NoCompiler
        Where Numba is missing, or a new version breaks this way.
    """
    root = Path(__file__).resolve().parents[2]
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as folder:
        command = [sys.executable, "-m", __name__, model_module, folder]
        done = subprocess.run(
            command, cwd=root, env={**os.environ, **SETTINGS}, capture_output=True, text=True
        )
        if done.returncode != 0:
            raise NoCompiler(
                (done.stderr.strip().splitlines() or ["the compiler gave no reason"])[-1]
            )
        return {name: (Path(folder) / f"{name}.o").read_bytes() for name in PLATFORMS}


def kernel_modules():
    """Names of the kernels' modules imported so far: those the model is made of."""
    return [name for name in sorted(sys.modules) if name.startswith("fmu_src.kernels.")]


def jit_kernel(names):
    """Replace every function of imported modules by its Numba dispatcher."""
    import numba

    dispatchers = {}
    for module in map(sys.modules.__getitem__, names):
        for name, value in list(vars(module).items()):
            if isinstance(value, types.FunctionType) and value.__module__ in names:
                if value not in dispatchers:
                    dispatchers[value] = numba.njit(error_model="numpy")(value)
                setattr(module, name, dispatchers[value])
    return dispatchers


def entry_ir(entry, size):
    """LLVM IR of a C function ``int (double *memory, double time)``."""
    import numba

    def c_entry(pointer, time):
        return entry(numba.carray(pointer, (size,)), time)

    signature = numba.types.int32(numba.types.CPointer(numba.types.float64), numba.types.float64)
    compiled = numba.cfunc(signature, error_model="numpy")(c_entry)
    return compiled.inspect_llvm(), compiled.native_name


def link_ir(entries):
    """One optimised LLVM module of all entry points, everything else internal to it."""
    import llvmlite.binding as llvm

    module: Any = None
    names = {}
    for name, (ir, native_name) in entries.items():
        ir = re.sub(
            r"^declare double @sqrt\(double\).*$",
            "declare double @llvm.sqrt.f64(double)",
            ir,
            flags=re.M,
        )
        if ir.count("declare double @llvm.sqrt.f64(double)") > 1:
            ir = re.sub(r"^declare double @llvm\.sqrt\.f64\(double\) #.*\n", "", ir, flags=re.M)
        part = llvm.parse_assembly(ir.replace("@sqrt(", "@llvm.sqrt.f64("))
        names[native_name] = name
        if module is None:
            module = part
        else:
            module.link_in(part)
    for function in module.functions:
        if function.name in names:
            function.name = names[function.name]
            # or two FMUs in one process could call each other's kernel
            function.visibility = "hidden"
        elif not function.is_declaration:
            function.linkage = "internal"
    for variable in module.global_variables:
        if not variable.is_declaration:
            variable.linkage = "internal"
    return module


def emit_object(text, platform):
    """Optimise for the baseline processor and emit a position-independent object."""
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    text = re.sub(r"^target triple = .*$", f'target triple = "{platform.triple}"', text, flags=re.M)
    text = re.sub(r'^(target datalayout = "e-m:)e', rf"\g<1>{platform.mangling}", text, flags=re.M)
    module = llvm.parse_assembly(text)
    machine = llvm.Target.from_triple(platform.triple).create_target_machine(
        cpu=CPU, opt=3, reloc="pic", codemodel="default"
    )
    tuning = llvm.create_pipeline_tuning_options(speed_level=3)
    tuning.slp_vectorization = True  # two numbers at a time, each with its own bits
    builder = llvm.create_pass_builder(machine, tuning)
    for _ in range(2):  # the second round sees that no error path is left
        builder.getModulePassManager().run(module, builder)
    needed = [
        f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")
    ]
    if needed:
        raise NoCompiler(
            f"the kernel compiled by this version of Numba needs {', '.join(needed)}: allowed is nothing outside itself"
        )
    return machine.emit_object(module)


def main(model_module, folder):
    """Write one object file a platform; see :func:`compile_objects`."""
    model = importlib.import_module(model_module).MODEL
    dispatchers = jit_kernel(kernel_modules())
    entries = {
        f"kernel_{name}": entry_ir(dispatchers[function], model.memory_size)
        for name, function in model.entries.items()
    }
    text = str(link_ir(entries))
    for name, platform in PLATFORMS.items():
        (Path(folder) / f"{name}.o").write_bytes(emit_object(text, platform))


def failure(error):
    """One line on why the kernel could not be compiled."""
    reason = (str(error).strip().splitlines() or ["no reason given"])[0]
    if isinstance(error, (NoCompiler, ImportError)):
        return reason
    version = getattr(sys.modules.get("numba"), "__version__", "of unknown version")
    return f"Numba {version} cannot compile the kernel: {type(error).__name__}: {reason}"


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except Exception as error:
        sys.exit(failure(error))
