"""The kernel compiled ahead of time: Numba to LLVM, LLVM to object files that need only ``memset``.

Runs in a process of its own (``python -m fmu_src.export.compile_kernel MODEL TARGET``), because
Numba reads its settings when it is imported. No fast-math, no fused multiply-add, a baseline
processor: with the kernel's own elementary functions every number has the bits that pure Python
gives. Only Numba's public ``inspect_llvm`` and llvmlite's binding layer are used.
"""

from __future__ import annotations

import functools
import os
import re
import subprocess
import sys
import tempfile
import types
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from .errors import CannotExport, require
from .platforms import PLATFORMS, Platform
from .sources import ROOT, Files, load

SETTINGS = {
    "NUMBA_CPU_NAME": PLATFORMS["x86_64-linux"].cpu,
    "NUMBA_CPU_FEATURES": "",
    "NUMBA_OPT": "3",
    "NUMBA_CACHE_DIR": os.devnull,
}
SQRT = "declare double @llvm.sqrt.f64(double)"
LLVM_OPTIONS = (
    # two numbers side by side only where that saves much: LLVM does not count what moving them
    # there and back costs
    "-slp-threshold=24",
    # a loop for each mode of the state, not a question in every turn of one
    "-unswitch-threshold=200",
)


@functools.cache
def compile_objects(folder: str, platforms: tuple[str, ...]) -> Files:
    """Compile a model's kernel for platforms, in a process of its own.

    Parameters
    ----------
    folder : str
        The model's, below ``fmu_src/models``.
    platforms : tuple of str
        Of :data:`.platforms.PLATFORMS`.

    Returns
    -------
    dict of str to bytes
        Object file by platform.

    Raises
    ------
    CannotExport
        Where Numba is missing, or a new version breaks this way.
    """
    require("numba", "compiles the kernel")
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as target:
        command = [sys.executable, "-m", __name__, folder, target, *platforms]
        settings = {**os.environ, **SETTINGS}
        done = subprocess.run(
            command, cwd=ROOT.parent, env=settings, capture_output=True, text=True
        )
        if done.returncode != 0:
            told = done.stderr.strip().splitlines()
            raise CannotExport(told[-1] if told else "the compiler gave no reason")
        return {name: (Path(target) / f"{name}.o").read_bytes() for name in platforms}


def kernel_modules() -> list[str]:
    """Names of the kernels' modules imported so far: those the model is made of."""
    kernels = f"{ROOT.name}.kernels."
    return [name for name in sorted(sys.modules) if name.startswith(kernels)]


def jit_kernel(names: Iterable[str]) -> dict[Callable[..., Any], Any]:
    """Replace every function of imported modules by its Numba dispatcher; returns these."""
    import numba

    wanted = set(names)
    dispatchers: dict[Callable[..., Any], Any] = {}
    for module in map(sys.modules.__getitem__, sorted(wanted)):
        for name, value in list(vars(module).items()):
            if isinstance(value, types.FunctionType) and value.__module__ in wanted:
                if value not in dispatchers:
                    dispatchers[value] = numba.njit(error_model="numpy")(value)
                setattr(module, name, dispatchers[value])
    return dispatchers


def entry_ir(entry: Any, size: int) -> tuple[str, str]:
    """LLVM IR of a C function ``int (double *memory, double time)``, and its name there."""
    import numba

    def c_entry(pointer: Any, time: Any) -> Any:
        return entry(numba.carray(pointer, (size,)), time)

    double = numba.types.float64
    signature = numba.types.int32(numba.types.CPointer(double), double)
    compiled = numba.cfunc(signature, error_model="numpy")(c_entry)
    return with_known_memory(compiled.inspect_llvm(), size), compiled.native_name


def with_known_memory(ir: str, size: int) -> str:
    """IR that says of every function's flat memory what Numba leaves out: all of it is there, and
    nothing else the function is given lies in it.

    So constants are read once before a loop, and a choice of two slots needs no branch.
    """
    known = f"noalias nonnull align 8 dereferenceable({8 * size}) "
    parameter = re.compile(r"(?=%arg\.(?:m\.4|pointer)\b)")  # the data of the array m; a C entry's
    return re.sub(r"^define .*$", lambda line: parameter.sub(known, line[0]), ir, flags=re.M)


def with_intrinsic_sqrt(ir: str) -> str:
    """IR that calls LLVM's square root, one processor instruction, not the C library's."""
    ir = re.sub(r"^declare double @sqrt\(double\).*$", SQRT, ir, flags=re.M)
    if ir.count(SQRT) > 1:
        ir = re.sub(rf"^{re.escape(SQRT)} #.*\n", "", ir, flags=re.M)
    return ir.replace("@sqrt(", "@llvm.sqrt.f64(")


def link_ir(entries: Mapping[str, tuple[str, str]]) -> Any:
    """One LLVM module of all entry points, everything else internal to it."""
    import llvmlite.binding as llvm

    module: Any = None
    names = {}
    for name, (ir, native_name) in entries.items():
        part = llvm.parse_assembly(with_intrinsic_sqrt(ir))
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


@functools.cache
def set_options() -> None:
    """LLVM's own options, which a process can set once."""
    import llvmlite.binding as llvm

    for option in LLVM_OPTIONS:
        llvm.set_option("vibroimpact", option)


def optimised(text: str, platform: Platform) -> tuple[Any, Any]:
    """LLVM's target machine and the module optimised for its baseline processor."""
    import llvmlite.binding as llvm

    set_options()
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple(platform.triple)
    machine = target.create_target_machine(
        cpu=platform.cpu, opt=3, reloc="pic", codemodel="default"
    )
    module = llvm.parse_assembly(text)
    module.triple = platform.triple
    module.data_layout = str(machine.target_data)
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    options.slp_vectorization = True  # two numbers at a time, each with its own bits
    builder = llvm.create_pass_builder(machine, options)
    for _ in range(2):  # the second round sees that no error path is left
        builder.getModulePassManager().run(module, builder)
    declared = [function.name for function in module.functions if function.is_declaration]
    needed = ", ".join(name for name in declared if not name.startswith("llvm."))
    if needed:
        raise CannotExport(f"a kernel by this version of Numba needs {needed}: expected nothing")
    return machine, module


def emit_object(text: str, platform: Platform) -> bytes:
    """A position-independent object file."""
    machine, module = optimised(text, platform)
    made = machine.emit_object(module)
    assert isinstance(made, bytes)
    return made


def kernel_ir(folder: str) -> str:
    """LLVM IR of a model's entry points, of which every platform's object is made."""
    model = load(folder)
    dispatchers = jit_kernel(kernel_modules())
    entries = {
        f"kernel_{name}": entry_ir(dispatchers[function], model.memory_size)
        for name, function in model.entries.items()
    }
    return str(link_ir(entries))


def main(folder: str, target: str, *platforms: str) -> None:
    """Write one object file a platform; see :func:`compile_objects`."""
    text = kernel_ir(folder)
    for name in platforms:
        (Path(target) / f"{name}.o").write_bytes(emit_object(text, PLATFORMS[name]))


def failure(error: Exception) -> str:
    """One line on why the kernel could not be compiled."""
    reason = (str(error).strip().splitlines() or ["no reason given"])[0]
    if isinstance(error, (CannotExport, ImportError)):
        return reason
    version = getattr(sys.modules.get("numba"), "__version__", "of unknown version")
    return f"Numba {version} cannot compile the kernel: {type(error).__name__}: {reason}"


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except Exception as error:
        sys.exit(failure(error))
