"""The models' FMUs and the loops as a WebAssembly module for web pages: found, or compiled."""

from __future__ import annotations

import ctypes
import logging
from ctypes import c_bool, c_double, c_int
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from fmu_src.export import webassembly as sources
from fmu_src.export.archive import content_hash
from fmu_src.export.errors import CannotExport
from fmu_src.export.forms import MODELS
from fmu_src.export.sources import load_model, model_sources

from ..errors import InputError
from ..files import find_or_make, make_writable_folder, write_atomically
from ..model.ranges import PUSHES
from . import events, oscillator
from .exported import SHIPPED, default_folder
from .models import OSCILLATOR

log = logging.getLogger(__name__)
FILE = Path("wasm") / "models.wasm"
KINDS = {c_double: "f64", c_bool: "u8", c_int: "i32"}  # else of 32 bits
WIDTHS = {"f64": 8, "u8": 1, "i32": 4, "u32": 4}
STRUCTURES = (
    *(oscillator.OscillatorCalls, oscillator.ResponseTask, oscillator.ResponseProgress),
    *(events.PlayerCalls, events.PlayTask, events.PlayProgress),
)


@dataclass(frozen=True)
class WebKernel:
    """The models and loops for a web page: WebAssembly bytes, value references of variables."""

    module: bytes  # the WebAssembly module
    variables: dict[str, dict[str, int]]  # value references by FMI 3.0, by the models' folders
    guid: str  # of the module


def find_or_compile_web_kernel(folder: str | PathLike[str] | None = None) -> WebKernel:
    """Return the models and loops as WebAssembly; compile them unless the present are there."""
    folders = [Path(folder)] if folder is not None else [default_folder(), SHIPPED]
    guid = sources.module_guid()
    variables = {name: sources.value_references(name) for name in sources.MODELS}

    def is_current(path: Path) -> bool:
        return path.is_file() and sources.guid_inside_module(path.read_bytes()) == guid

    try:
        paths = [base / FILE for base in folders]
        path = find_or_make(paths, is_current, lambda: compile_module(folders[0]))
    except CannotExport as reason:
        text = f"{FILE.name}: none matches the current sources, and none can be built here"
        raise InputError(f"{text}: {reason}") from None
    module = path.read_bytes()
    if sources.guid_inside_module(module) != guid:
        raise InputError(f"{path}: it has changed since it was read; expected a file that stays")
    return WebKernel(module, variables, guid)


def build_web_kernels(folder: str | PathLike[str] | None = None) -> list[Path]:
    """Compile the module; return its file, or [] with a warning if there is no compiler."""
    try:
        return [compile_module(default_folder() if folder is None else Path(folder))]
    except CannotExport as reason:
        log.warning("%s left out: %s", FILE.name, reason)
        return []


def tables_for_web_page(*more_structures: type[ctypes.Structure]) -> dict[str, Any]:
    """Return what a page needs to call the loops, as JSON: structures, names, and their order."""
    structures: tuple[type[ctypes.Structure], ...] = (*STRUCTURES, *more_structures)
    arrays = load_model(MODELS[OSCILLATOR]).arrays
    booleans = [name for name, value in oscillator.START_VALUES.items() if isinstance(value, bool)]
    return {
        "structures": {kind.__name__: c_layout(kind) for kind in structures},
        "pushes": PUSHES,
        "set": {name: float(value) for name, value in oscillator.START_VALUES.items()},
        "booleans": booleans,
        "reals": [name for name in oscillator.START_VALUES if name not in booleans],
        "read": oscillator.READ_VARIABLES,
        "series": oscillator.SAMPLE_SERIES,
        "capacity": next(a.size for a in arrays if a.name == oscillator.SAMPLE_SERIES[0]),
        "counts": oscillator.COUNTS,
        "traits": oscillator.TRAIT_NAMES,
        "deviating": oscillator.DEVIATING,
    }


def c_layout(kind: type[ctypes.Structure]) -> dict[str, Any]:
    """Return size and fields of a C structure of 32 bits; inner ones as ``force.places.0``."""
    size, _, fields = place_members(kind)
    return {"size": size, "fields": fields}


def place_members(kind: Any) -> tuple[int, int, dict[str, tuple[str, int]]]:
    """Return size, alignment and members (type, offset) of a C type on a machine of 32 bits."""
    if issubclass(kind, ctypes.Structure):
        parts = [(name, member) for name, member, *_ in kind._fields_]
    elif issubclass(kind, ctypes.Array):
        parts = [(str(i), kind._type_) for i in range(kind._length_)]
    else:
        word = KINDS.get(kind, "u32")
        return WIDTHS[word], WIDTHS[word], {"": (word, 0)}
    fields, end, widest = {}, 0, 1
    for name, member in parts:
        size, alignment, inner = place_members(member)
        start = round_up(end, alignment)
        for path, (word, offset) in inner.items():
            fields[f"{name}.{path}".rstrip(".")] = word, start + offset
        end, widest = start + size, max(widest, alignment)
    return round_up(end, widest), widest, fields


def round_up(offset: int, alignment: int) -> int:
    """Return the first multiple of an alignment that is not below an offset, in bytes."""
    return -(-offset // alignment) * alignment


def nonzero_numbers(structure: ctypes.Structure) -> dict[str, float]:
    """Return the numbers of a C structure that are not 0, by the names of :func:`c_layout`."""
    numbers = {}
    for path in c_layout(type(structure))["fields"]:
        value: Any = structure
        for name in path.split("."):
            value = value[int(name)] if name.isdigit() else getattr(value, name)
        if isinstance(value, int | float) and value:
            numbers[path] = value
    return numbers


def kernel_digest(model: str) -> str:
    files = model_sources(MODELS[model])
    return content_hash({name: files[name] for name in files if name.startswith("kernels/")})


def compile_module(folder: Path) -> Path:
    path = folder / FILE
    log.info("compiling %s", path)
    module = sources.compile_module()
    make_writable_folder(path.parent)
    write_atomically(path, lambda target: target.write_bytes(module))
    return path
