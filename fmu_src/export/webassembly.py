"""Compile the kernel to a WebAssembly module: the same C as the FMUs', for web pages.

The module exports its memory, ``__heap_base``, from where on instances may lie one after the other,
and the entry points ``kernel_NAME(address of an instance, time)``. It imports nothing. WebAssembly
fixes every operation of floats to the last bit, so the numbers are those of every other form.
"""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

from .archive import guid_of
from .compiler import CLANG_FLAGS, FLAGS, run, ziglang
from .source_code import kernel_source
from .sources import check_unedited, import_closure, load_model, model_digest

TARGET = ("-target", "wasm32-wasi", "-mcpu=mvp+bulk_memory+nontrapping_fptoint")  # WASI has headers
SECTION = "guid"  # name of the custom section that bears the GUID


def guid(folder: str) -> str:
    """Return the GUID that a module of the present sources bears, in braces."""
    return guid_of(
        {**import_closure("export/webassembly.py"), "model": model_digest(folder).encode()}
    )


def export(folder: str) -> bytes:
    """Compile a model's kernel.

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
        Where ziglang is missing or fails, or a source was edited meanwhile.
    """
    compiler = [*ziglang("cc"), *TARGET, *FLAGS, *CLANG_FLAGS]
    exported = [f"--export=kernel_{name}" for name in load_model(folder).entries]
    linker = [*ziglang("wasm-ld"), "--no-entry", "--strip-all", "--export=__heap_base", *exported]
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as place:
        (Path(place) / "kernel.c").write_bytes(kernel_source(folder))
        run([*compiler, "-c", "kernel.c", "-o", "kernel.o"], place, "WebAssembly")
        run([*linker, "kernel.o", "-o", "kernel.wasm"], place, "WebAssembly")
        check_unedited()
        return (Path(place) / "kernel.wasm").read_bytes() + custom_section(SECTION, guid(folder))


def custom_section(name: str, text: str) -> bytes:
    """Return a custom section of a WebAssembly module; both texts must be short."""
    content = bytes([len(name)]) + name.encode() + text.encode()
    assert len(content) < 128, "a length of one byte"
    return bytes([0, len(content)]) + content


def guid_inside(module: bytes) -> str:
    """Return the GUID that a module bears; an empty string where it has none."""
    found = re.search(SECTION.encode() + rb"(\{[0-9a-f-]{36}\})\Z", module)
    return found[1].decode() if found else ""


def slots(folder: str) -> dict[str, int]:
    """Return the size of a model's memory and the slot of each of its variables: of a series its
    first.

    ``SET`` is the flag to be raised when an input between ``CUBIC`` and before ``CUBIC_END`` is
    set.
    """
    model = load_model(folder)
    found = {"SIZE": model.memory_size, "TIME": model.time_slot, "STOP": model.stop_slot}
    cubic = model.set_flags
    found |= {"SET": model.set_slot, "CUBIC": min(cubic), "CUBIC_END": max(cubic) + 1}
    for variable in model.variables:
        name, _, element = variable.name.partition("[")
        if element in ("", "1]"):
            found[name] = variable.slot
    return found


def starts(folder: str) -> dict[str, float]:
    """Return the start values of a model's variables, where they are not zero."""
    given = {v.name: float(v.start) for v in load_model(folder).variables if v.start is not None}
    return {name: value for name, value in given.items() if value != 0.0}
