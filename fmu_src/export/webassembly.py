"""Compile FMI 3.0 sources of models and the loops to one WebAssembly module, for web pages.

It exports its memory, functions of the loops, ``malloc`` and ``free``, and of each model, with its
folder's name before them, functions of FMI and of ``runtime/web/web.c``. It imports nothing.
WebAssembly fixes every operation of floats to the last bit, so the numbers are those of every form.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Sequence
from pathlib import Path

from .archive import guid_of_files, read_folder
from .c_library import HEADER, LOOPS, files_with_translated_headers
from .compiler import CLANG_FLAGS, FLAGS, run_compiler, ziglang_command
from .description_fmi3 import ARRAY_BASE
from .model_header import model_header
from .native_form import fmi_headers, shim_sources
from .source_code import kernel_c_source
from .sources import ROOT, Files, exporter_files, load_model, model_digest, require_unedited_sources

TARGET = ("-target", "wasm32-wasi", "-mcpu=mvp+bulk_memory+nontrapping_fptoint")  # WASI has headers
LINK_FLAGS = ("-mexec-model=reactor", "-Wl,--no-entry", "-Wl,--strip-all")
SECTION = "guid"  # name of the custom section that bears the GUID
WEB = ROOT / "runtime" / "web"
IN_PAGES = ("respond.c", "play.c", "spectrum.c", "exponent.c", "couple.c")  # loops
MODELS = ("oscillator", "motor_shaker")  # folders
OF_MODELS = (  # exported of each
    *("open_fmu", "close_fmu", "message", "state_functions", "fmi3Reset", "fmi3DoStep"),
    *("fmi3EnterInitializationMode", "fmi3ExitInitializationMode"),
    *("fmi3SetFloat64", "fmi3SetInt32", "fmi3SetBoolean", "fmi3GetFloat64", "fmi3GetInt32"),
    *(f"fmi3{verb}FMUState" for verb in ("Get", "Set", "Free", "Serialize", "Deserialize")),
    "fmi3SerializedFMUStateSize",
)
OF_LOOPS = (
    *("malloc", "free", "begin", "respond", "sample_evenly", "memory_size", "play", "couple"),
    "find_revolutions",
    *("rest_and_threshold", "find_gaps", "find_accelerations", "carry_state"),
    *("nearest_state", "spectrum_size", "acceleration_spectrum", "exponent_size"),
    *("largest_exponent", "wander_floor", "classify_exponent", "sizes_of_couple"),
)


def module_guid() -> str:
    files = {**exporter_files("export/webassembly.py"), **read_folder(LOOPS), **read_folder(WEB)}
    return guid_of_files({**files, **{name: model_digest(name).encode() for name in MODELS}})


def compile_module() -> bytes:
    compiler = [*ziglang_command("cc"), *TARGET]
    names = [*OF_LOOPS, *(f"{model}_{name}" for model in MODELS for name in OF_MODELS)]
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as place:
        objects = []
        for model in MODELS:
            header = model_header(load_model(model), module_guid(), model_digest(model))
            files = {**shim_sources("fmi3"), **fmi_headers("fmi3"), **read_folder(WEB)}
            files |= {"model.h": header, "kernel.c": kernel_c_source(model)}
            files[HEADER] = (LOOPS / HEADER).read_bytes()
            flags = [*FLAGS, f"-DFMI3_FUNCTION_PREFIX={model}_"]
            objects += compile_units(compiler, flags, Path(place) / model, files)
        loops: Files = {}
        for name in IN_PAGES:
            loops |= files_with_translated_headers(LOOPS / name)
        objects += compile_units(compiler, FLAGS, Path(place) / "loops", loops)
        exported = [f"-Wl,--export={name}" for name in names]
        linked = [*compiler, *LINK_FLAGS, *exported, *objects, "-o", "kernel.wasm"]
        run_compiler(linked, place, "WebAssembly")
        require_unedited_sources()
        section = bytes([len(SECTION)]) + (SECTION + module_guid()).encode()
        assert len(section) < 128, "a length of one byte"
        custom = bytes([0, len(section)]) + section  # 0: a custom section
        return (Path(place) / "kernel.wasm").read_bytes() + custom


def compile_units(
    compiler: Sequence[str], flags: Sequence[str], folder: Path, files: Files
) -> list[str]:
    """Write files into a folder and compile those in C; return the paths of the objects."""
    folder.mkdir()
    for name, content in files.items():
        (folder / name).write_bytes(content)
    units = [name for name in files if name.endswith(".c")]
    for unit in units:
        own = [*flags, *(CLANG_FLAGS if unit == "kernel.c" else ())]
        run_compiler([*compiler, *own, "-c", unit, "-o", f"{unit}.o"], str(folder), "WebAssembly")
    return [str(folder / f"{unit}.o") for unit in units]


def guid_inside_module(module: bytes) -> str:
    found = re.search(SECTION.encode() + rb"(\{[0-9a-f-]{36}\})\Z", module)
    return found[1].decode() if found else ""


def value_references(folder: str) -> dict[str, int]:
    model = load_model(folder)
    arrays = {array.name: ARRAY_BASE + i for i, array in enumerate(model.arrays)}
    return {v.name: v.slot for v in model.variables if not v.series} | arrays
