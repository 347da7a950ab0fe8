"""Compile a loop (``couple.c``, ``respond.c``, ...) to a shared library for orchestration.

A library has a token of its sources among its bytes: so one of other sources is known, for whatever
platform it was made. A digest of the bytes lies next to it: one that was damaged, or replaced, is
known too.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from ..kernels import deviations, linear_response, orbits, repetition
from ..kernels.numerics import turn
from .archive import guid_of_files
from .compiler import compile_and_link
from .errors import CannotExport
from .platforms import PLATFORMS
from .sources import ROOT, Files, import_closure
from .translation.kernel import translate

LOOPS = ROOT / "kernels" / "loops"
HEADER = "fmi.h"  # of loops
VISIBLE = '__attribute__((visibility("default")))'
KERNELS = {  # headers that a source may include, translated from Python
    "rules.h": {
        "write_decided_multiplicity": repetition.write_decided_multiplicity,
        "write_least_multiplicity": repetition.write_least_multiplicity,
        "confirm_by_impacts": repetition.confirm_by_impacts,
        "write_nearest_state": repetition.write_nearest_state,
        "write_rest_and_threshold": linear_response.write_rest_and_threshold,
    },
    "turn.h": {"write_cosine_and_sine": turn.write_cosine_and_sine},
    "deviations.h": {"write_deviation_matrices": deviations.write_deviation_matrices},
    "orbits.h": {
        "write_free_flows": orbits.write_free_flows,
        "write_steady_states": orbits.write_steady_states,
        "write_rates_of_states": orbits.write_rates_of_states,
        "write_later_states": orbits.write_later_states,
        "write_segment_equations": orbits.write_segment_equations,
    },
}


def library_guid(source: Path) -> str:
    return guid_of_files({**import_closure("export/c_library.py"), **loop_files(source)})


def loop_files(source: Path) -> Files:
    text = source.read_bytes()
    header = {HEADER: (LOOPS / HEADER).read_bytes()} if HEADER.encode() in text else {}
    return {source.name: text, **header}


def files_with_translated_headers(source: Path) -> Files:
    files = loop_files(source)
    text = files[source.name]
    needed = {name: entries for name, entries in KERNELS.items() if name.encode() in text}
    return {**files, **{name: translate(entries).encode() for name, entries in needed.items()}}


def compile_loop(source: Path, platform: str) -> bytes:
    visibility = "__declspec(dllexport)" if platform.endswith("-windows") else VISIBLE
    token = f'{visibility} const char token[] = "{library_guid(source)}";\n'.encode()
    return compile_and_link(
        platform, source.stem, {**files_with_translated_headers(source), "token.c": token}
    )


def library_name(source: Path, platform: str) -> str:
    if platform not in PLATFORMS:
        raise CannotExport(f"platform {platform}: expected one of {', '.join(PLATFORMS)}")
    return f"{platform}/{source.stem}{PLATFORMS[platform].suffix}"


def library_digest(library: bytes) -> str:
    return hashlib.sha256(library).hexdigest()


def digest_path(path: Path) -> Path:
    return path.with_name(f"{path.name}.sha256")


def is_current_and_undamaged(path: Path, token: str) -> bool:
    """Return whether a library is of the sources with this token, and as it was compiled."""
    try:
        library, written = path.read_bytes(), digest_path(path).read_bytes()
    except OSError:
        return False
    return token.encode() in library and written == library_digest(library).encode()
