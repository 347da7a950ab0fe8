"""The kernel compiled ahead of time: Numba to LLVM, LLVM to an object file, linked into a library that needs nothing.

Runs in a process of its own (``python -m fmu_src.export.compile_kernel MODEL FOLDER``), because Numba reads its settings when it is
imported. No fast-math, no fused multiply-add, a baseline processor: with the kernel's own elementary functions every number has the
bits that pure Python gives. Only Numba's public ``inspect_llvm`` and llvmlite's binding layer are used.
"""

import importlib
import os
import re
import shutil
import subprocess
import sys
import types
from pathlib import Path

CPU = "x86-64-v2"
TRIPLE = "x86_64-unknown-linux-gnu"
LIBRARY = "kernel-x86_64-linux.so"
ZIG_TARGET = "x86_64-linux-gnu.2.17"  # runs on every glibc since 2012
SETTINGS = {"NUMBA_CPU_NAME": CPU, "NUMBA_CPU_FEATURES": "", "NUMBA_OPT": "3", "NUMBA_CACHE_DIR": os.devnull}
ENTRIES = ("initialize", "advance")


class NoCompiler(Exception):
    """Why no compiled kernel can be made here, as one line."""


def compile_library(model_module, folder):
    """Compile a model's kernel into ``folder``, in a process of its own.

    Parameters
    ----------
    model_module : str
        Module with a ``MODEL`` (:class:`.table.Model`), e.g. ``"fmu_src.oscillator.model"``.
    folder : Path
        Where the library goes.

    Raises
    ------
    NoCompiler
        Where Numba or a linker is missing, or a new version breaks this way.
    """
    command = [sys.executable, "-m", __name__, model_module, str(folder)]
    root = Path(__file__).resolve().parents[2]
    done = subprocess.run(command, cwd=root, env={**os.environ, **SETTINGS}, capture_output=True, text=True)
    if done.returncode != 0:
        raise NoCompiler((done.stderr.strip().splitlines() or ["the compiler gave no reason"])[-1])


def jit_kernel(package):
    """Replace every function of an imported package by its Numba dispatcher."""
    import numba

    modules = [module for name, module in sorted(sys.modules.items()) if name.startswith(package + ".")]
    dispatchers = {}
    for module in modules:
        for name, value in list(vars(module).items()):
            if isinstance(value, types.FunctionType) and value.__module__.startswith(package):
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

    module, names = None, {}
    for name, (ir, native_name) in entries.items():
        ir = re.sub(r"^declare double @sqrt\(double\).*$", "declare double @llvm.sqrt.f64(double)", ir, flags=re.M)
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
        elif not function.is_declaration:
            function.linkage = "internal"
    for variable in module.global_variables:
        if not variable.is_declaration:
            variable.linkage = "internal"
    return module


def emit_object(module, triple):
    """Optimise for the baseline processor and emit a position-independent object."""
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    machine = llvm.Target.from_triple(triple).create_target_machine(cpu=CPU, opt=3, reloc="pic", codemodel="default")
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=3))
    for _ in range(2):  # the second round sees that no error path is left
        builder.getModulePassManager().run(module, builder)
    needed = [f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")]
    if needed:
        raise NoCompiler(f"the kernel compiled by this version of Numba needs {', '.join(needed)}: allowed is nothing outside itself")
    return machine.emit_object(module)


def linker():
    """Command that links for old and new systems alike: the compiler from PyPI, else the machine's own."""
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc", "-target", ZIG_TARGET]
    for name in ("cc", "gcc", "clang"):
        if shutil.which(name):
            return [name]
    raise NoCompiler("no linker here: allowed is the PyPI package ziglang, or cc, gcc or clang on the path")


def main(model_module, folder):
    """Compile and link; see :func:`compile_library`."""
    if sys.platform != "linux":
        raise NoCompiler(f"compiled kernels are made on Linux, this is {sys.platform}")
    command = linker()
    model = importlib.import_module(model_module).MODEL
    package = model.advance.__module__.rsplit(".", 1)[0]
    dispatchers = jit_kernel(package)
    entries = {name: entry_ir(dispatchers[getattr(model, name)], model.memory_size) for name in ENTRIES}
    folder = Path(folder)
    object_file = folder / "kernel.o"
    object_file.write_bytes(emit_object(link_ir(entries), TRIPLE))
    library = folder / LIBRARY
    subprocess.run([*command, "-shared", "-s", "-nostdlib", "-o", str(library), str(object_file)], check=True)
    object_file.unlink()


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except Exception as error:
        sys.exit(f"{type(error).__name__}: {error}" if not isinstance(error, NoCompiler) else str(error))
