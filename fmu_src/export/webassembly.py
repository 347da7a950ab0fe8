"""The kernel as a WebAssembly module: the same Numba IR as the FMUs', for web pages.

The module exports its memory, ``__heap_base``, from where on instances may lie one after the other,
and the entry points ``kernel_NAME(address of an instance, time)``. It imports nothing. WebAssembly
fixes every operation of floats to the last bit, so the numbers are those of every other form.

Runs in a process of its own (``python -m fmu_src.export.webassembly MODEL TARGET``), as
:mod:`.compile_kernel` does.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from .archive import guid_of
from .compile_kernel import SETTINGS, entry_ir, failure, jit_kernel, kernel_modules, link_ir
from .errors import CannotExport, require
from .sources import ROOT, check_unedited, closure, load, model_digest

TRIPLE = "wasm32-unknown-unknown"
SECTION = "guid"  # name of the custom section that bears the GUID


def guid(folder: str) -> str:
    """The GUID that a module of the present sources bears, in braces."""
    return guid_of({**closure("export/webassembly.py"), "model": model_digest(folder).encode()})


def export(folder: str) -> bytes:
    """Compile a model's kernel, in a process of its own.

    Parameters
    ----------
    folder : str
        The model's, below ``fmu_src/models``.

    Returns
    -------
    bytes
        The WebAssembly module, its GUID in a custom section.

    Raises
    ------
    CannotExport
        Where Numba or the linker is missing, a new version breaks this way, or a source was
        edited meanwhile.
    """
    require("numba", "compiles the kernel")
    require("ziglang", "links it")
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as target:
        run([sys.executable, "-m", __name__, folder, target], {**os.environ, **SETTINGS})
        link(Path(target), [f"kernel_{name}" for name in load(folder).entries])
        check_unedited()
        return (Path(target) / "kernel.wasm").read_bytes() + custom_section(SECTION, guid(folder))


def run(command: list[str], environment: dict[str, str] | None = None) -> None:
    """Run a program from the sources' root; the last line it tells is the reason of a failure."""
    done = subprocess.run(command, cwd=ROOT.parent, env=environment, capture_output=True, text=True)
    if done.returncode != 0:
        told = done.stderr.strip().splitlines()
        raise CannotExport(told[-1] if told else "the compiler gave no reason")


def link(folder: Path, entries: Iterable[str]) -> None:
    """``kernel.wasm`` of ``kernel.o``, with the entry points exported."""
    linker = [sys.executable, "-m", "ziglang", "wasm-ld", "--no-entry", "--strip-all"]
    exported = [f"--export={name}" for name in (*entries, "__heap_base")]
    run([*linker, *exported, str(folder / "kernel.o"), "-o", str(folder / "kernel.wasm")])


def custom_section(name: str, text: str) -> bytes:
    """A custom section of a WebAssembly module; both texts short."""
    content = bytes([len(name)]) + name.encode() + text.encode()
    assert len(content) < 128, "a length of one byte"
    return bytes([0, len(content)]) + content


def guid_inside(module: bytes) -> str:
    """The GUID that a module bears; an empty string where it has none."""
    found = re.search(SECTION.encode() + rb"(\{[0-9a-f-]{36}\})\Z", module)
    return found[1].decode() if found else ""


def slots(folder: str) -> dict[str, int]:
    """Size of a model's memory and the place of each of its variables: series by their first.

    ``SET`` is the flag to be raised when an input between ``CUBIC`` and before ``CUBIC_END`` is
    set.
    """
    model = load(folder)
    found = {"SIZE": model.memory_size, "TIME": model.time_slot, "STOP": model.stop_slot}
    cubic = model.polynomial
    found |= {"SET": model.set_slot, "CUBIC": cubic.start, "CUBIC_END": cubic.stop}
    for variable in model.variables:
        name, _, element = variable.name.partition("[")
        if element in ("", "1]"):
            found[name] = variable.slot
    return found


def starts(folder: str) -> dict[str, float]:
    """Start values of a model's variables, where they are not zero."""
    given = {v.name: float(v.start) for v in load(folder).variables if v.start is not None}
    return {name: value for name, value in given.items() if value != 0.0}


def emit_object(text: str) -> bytes:
    """Optimise for WebAssembly without extensions and emit an object file."""
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    machine = llvm.Target.from_triple(TRIPLE).create_target_machine(opt=3, reloc="static")
    module = llvm.parse_assembly(re.sub(r"^target (triple|datalayout).*$", "", text, flags=re.M))
    module.triple = TRIPLE
    module.data_layout = str(machine.target_data)
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    builder = llvm.create_pass_builder(machine, options)
    for _ in range(2):  # the second round sees that no error path is left
        builder.getModulePassManager().run(module, builder)
    made: Any = machine.emit_object(module)
    assert isinstance(made, bytes)
    return made


def main(folder: str, target: str) -> None:
    """Write ``kernel.o``; see :func:`export`."""
    model = load(folder)
    dispatchers = jit_kernel(kernel_modules())
    entries = {
        f"kernel_{name}": entry_ir(dispatchers[function], model.memory_size)
        for name, function in model.entries.items()
    }
    (Path(target) / "kernel.o").write_bytes(emit_object(str(link_ir(entries))))


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except Exception as error:
        sys.exit(failure(error))
