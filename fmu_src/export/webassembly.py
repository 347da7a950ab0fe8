"""Compile a model's FMI 3.0 sources and the loops to a WebAssembly module, for web pages.

It exports its memory, functions of ``runtime/web/web.c`` and of the loops, ``malloc`` and ``free``,
and the kernel's entry points ``kernel_NAME(address of a memory, time)``. It imports nothing.
WebAssembly fixes every operation of floats to the last bit, so the numbers are those of every form.
"""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

from ..runtime.table import Model
from .archive import guid_of, read_folder
from .c_library import LOOPS, compiled_files
from .compiler import CLANG_FLAGS, FLAGS, run, ziglang
from .description_fmi3 import ARRAY_BASE
from .model_header import model_header
from .native_form import fmi_headers, shim_sources
from .source_code import kernel_source
from .sources import ROOT, Files, check_unedited, exporter_files, load_model, model_digest

TARGET = ("-target", "wasm32-wasi", "-mcpu=mvp+bulk_memory+nontrapping_fptoint")  # WASI has headers
LINK_FLAGS = ("-mexec-model=reactor", "-Wl,--no-entry", "-Wl,--strip-all")
SECTION = "guid"  # name of the custom section that bears the GUID
WEB = ROOT / "runtime" / "web"
IN_PAGES = ("respond.c", "play.c", "spectrum.c", "exponent.c")  # loops
EXPORTED = (
    *("malloc", "free", "open_fmu", "close_fmu", "memory_of", "message"),
    *("begin", "respond", "sample_evenly", "memory_size", "describe_linear_response", "play"),
    *("find_gaps", "find_accelerations", "carry_state", "nearest_state", "spectrum_size"),
    *("acceleration_spectrum", "exponent_size", "largest_exponent", "wander_floor"),
    "classify_exponent",
)


def guid(folder: str) -> str:
    """Return the GUID that a module of the present sources bears, in braces."""
    files = {**exporter_files("export/webassembly.py"), **read_folder(LOOPS), **read_folder(WEB)}
    return guid_of({**files, "model": model_digest(folder).encode()})


def sources(model: Model, folder: str) -> Files:
    """Return the C files of a module by name."""
    header = model_header(model, guid(folder), model_digest(folder))
    shim = {**shim_sources("fmi3"), **fmi_headers("fmi3"), "model.h": header}
    loops = {k: v for name in IN_PAGES for k, v in compiled_files(LOOPS / name).items()}
    return {"kernel.c": kernel_source(folder), **shim, **loops, **read_folder(WEB)}


def export(folder: str) -> bytes:
    """Compile a model.

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
    compiler = [*ziglang("cc"), *TARGET]
    model = load_model(folder)
    files = sources(model, folder)
    units = [name for name in files if name.endswith(".c")]
    names = (*EXPORTED, *(f"kernel_{name}" for name in model.entries))
    exported = [f"-Wl,--export={name}" for name in names]
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as place:
        for name, content in files.items():
            (Path(place) / name).write_bytes(content)
        for unit in units:
            flags = [*FLAGS, *(CLANG_FLAGS if unit == "kernel.c" else ())]
            run([*compiler, *flags, "-c", unit, "-o", f"{unit}.o"], place, "WebAssembly")
        objects = [f"{unit}.o" for unit in units]
        run(
            [*compiler, *LINK_FLAGS, *exported, *objects, "-o", "kernel.wasm"], place, "WebAssembly"
        )
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
    cubic = [slot for slot, flag in model.set_flags.items() if flag == model.set_slot]
    found |= {"SET": model.set_slot, "CUBIC": min(cubic), "CUBIC_END": max(cubic) + 1}
    for variable in model.variables:
        name, _, element = variable.name.partition("[")
        if element in ("", "1]"):
            found[name] = variable.slot
    return found


def references(folder: str) -> dict[str, int]:
    """Return the value references of a model's variables, as FMI 3.0 has them."""
    model = load_model(folder)
    arrays = {array.name: ARRAY_BASE + i for i, array in enumerate(model.arrays)}
    return {v.name: v.slot for v in model.variables if not v.series} | arrays


def array_sizes(folder: str) -> dict[str, int]:
    """Return how many numbers each array of a model has."""
    return {array.name: array.size for array in load_model(folder).arrays}


def starts(folder: str) -> dict[str, float]:
    """Return the start values of a model's variables, where they are not zero."""
    given = {v.name: float(v.start) for v in load_model(folder).variables if v.start is not None}
    return {name: value for name, value in given.items() if value != 0.0}
