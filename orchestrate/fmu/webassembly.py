"""The models' FMUs and loops as WebAssembly modules for web pages: found, or compiled."""

from __future__ import annotations

import ctypes
import logging
from ctypes import c_bool, c_double
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from fmu_src.export import webassembly as sources
from fmu_src.export.archive import fingerprint
from fmu_src.export.errors import CannotExport
from fmu_src.export.forms import MODELS
from fmu_src.export.sources import model_sources

from ..errors import InputError
from ..files import made_once, open_folder, write_whole
from . import event_loop
from .exported import SHIPPED, check, default_folder
from .models import OSCILLATOR, SHAKER
from .oscillator import (
    COUNTS,
    DEVIATING,
    READ,
    SAMPLE_SERIES,
    SET,
    TRAIT_NAMES,
    OscillatorCalls,
    ResponseProgress,
    ResponseTask,
)

log = logging.getLogger(__name__)
FORM = "wasm"
WEB_MODELS = (OSCILLATOR, SHAKER)
STRUCTURES = (
    *(OscillatorCalls, ResponseTask, ResponseProgress),
    *(event_loop.PlayerCalls, event_loop.PlayTask, event_loop.PlayProgress),
)


@dataclass(frozen=True)
class WebKernel:
    """Kernel of a model for a web page: WebAssembly bytes, slots and start values of its
    variables.
    """

    module: bytes  # the WebAssembly module
    # place of each variable in an instance's memory, and `SIZE`, `TIME`, `STOP`, the place of the
    # flag that ends a step at its first event, and `SET`, that of the flag to be raised when an
    # input from the places `CUBIC` to `CUBIC_END` is set, the last not included
    slots: dict[str, int]
    starts: dict[str, float]  # start values of variables, where they are not zero
    variables: dict[str, int]  # value references by FMI 3.0
    guid: str  # of the module


def web_kernel(model: str, folder: str | PathLike[str] | None = None) -> WebKernel:
    """Return a model's kernel as WebAssembly; compile it first unless the present one is there."""
    check(model, "fmi3")
    folders = [Path(folder)] if folder is not None else [default_folder(), SHIPPED]
    guid = sources.guid(MODELS[model])
    name = MODELS[model]
    tables = sources.slots(name), sources.starts(name), sources.references(name)
    paths = [base / FORM / f"{model}.wasm" for base in folders]
    for path in paths:
        module = read_module(path, guid)
        if module:
            return WebKernel(module, *tables, guid)
    try:
        with made_once(paths[0]):
            module = read_module(paths[0], guid) or compile_module(model, folders[0]).read_bytes()
    except CannotExport as reason:
        text = f"{model}.wasm: none matches the current sources, and none can be built here"
        raise InputError(f"{text}: {reason}") from None
    return WebKernel(module, *tables, guid)


def read_module(path: Path, guid: str) -> bytes:
    """Return a WebAssembly file's bytes if it has the present sources' GUID, else ``b""``."""
    module = path.read_bytes() if path.is_file() else b""
    return module if sources.guid_inside(module) == guid else b""


def build_web_kernels(folder: str | PathLike[str] | None = None) -> list[Path]:
    """Compile the kernels of the explorer's models to WebAssembly files in a folder; return the
    paths of those made.
    """
    target, made = default_folder() if folder is None else Path(folder), []
    for model in WEB_MODELS:
        try:
            made.append(compile_module(model, target))
        except CannotExport as reason:
            log.warning("%s.wasm left out: %s", model, reason)
    return made


def loop_tables() -> dict[str, Any]:
    """Return what a page needs to call the loops, as JSON: structures, names, and their order."""
    booleans = [name for name, value in SET.items() if isinstance(value, bool)]
    return {
        "structures": {kind.__name__: layout(kind) for kind in STRUCTURES},
        "set": {name: float(value) for name, value in SET.items()},
        "booleans": booleans,
        "reals": [name for name in SET if name not in booleans],
        "read": READ,
        "series": SAMPLE_SERIES,
        "capacity": sources.array_sizes(MODELS[OSCILLATOR])[SAMPLE_SERIES[0]],
        "counts": COUNTS,
        "traits": TRAIT_NAMES,
        "deviating": DEVIATING,
    }


def layout(kind: type[ctypes.Structure]) -> list[tuple[str, str]]:
    """Return name and type of each field on a machine of 32 bits, those of inner structures too."""
    fields: list[tuple[str, str]] = []
    for name, type_, *_ in kind._fields_:
        if isinstance(type_, type) and issubclass(type_, ctypes.Structure):
            fields += [(f"{name}.{inner}", word) for inner, word in layout(type_)]
        else:
            fields.append((name, {c_double: "f64", c_bool: "u8"}.get(type_, "u32")))
    return fields


def kernel_digest(model: str) -> str:
    """Return a digest (32 hexadecimal digits) of a model's kernel sources."""
    files = model_sources(MODELS[model])
    return fingerprint({name: files[name] for name in files if name.startswith("kernels/")})


def compile_module(model: str, folder: Path) -> Path:
    """Compile a model's kernel to ``folder/wasm/NAME.wasm`` atomically; return the path."""
    path = folder / FORM / f"{model}.wasm"
    log.info("compiling %s", path)
    module = sources.export(MODELS[model])
    open_folder(path.parent)
    write_whole(path, lambda target: target.write_bytes(module))
    return path
