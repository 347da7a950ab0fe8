"""The platforms that an FMU can have binaries for, and the folders tools look for them in."""

from __future__ import annotations

import platform as machine
import struct
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from .errors import CannotExport


@dataclass(frozen=True)
class Platform:
    """A platform with binaries."""

    zig_target: str  # zig's name of it, with the oldest C library it is to run on
    cpu: str  # zig's name of the oldest processor it is to run on
    suffix: str  # of a shared library
    folder: str  # below `binaries/`, of FMI 2.0


PLATFORMS = {  # by FMI 3.0's names of their folders
    "x86_64-linux": Platform("x86_64-linux-gnu.2.17", "x86_64_v2", ".so", "linux64"),
    "x86_64-windows": Platform("x86_64-windows-gnu", "x86_64_v2", ".dll", "win64"),
    "x86_64-darwin": Platform("x86_64-macos.11.0", "x86_64_v2", ".dylib", "darwin64"),
    "aarch64-linux": Platform("aarch64-linux-gnu.2.17", "generic", ".so", "aarch64-linux"),
    "aarch64-windows": Platform("aarch64-windows-gnu", "generic", ".dll", "aarch64-windows"),
    "aarch64-darwin": Platform("aarch64-macos.11.0", "apple_m1", ".dylib", "aarch64-darwin"),
}
ALL = tuple(PLATFORMS)
ARCHITECTURES = {"amd64": "x86_64", "arm64": "aarch64"}
SYSTEMS = {"win32": "windows"}
FAT_MAGIC, FAT_ALIGNMENT = 0xCAFEBABE, 14  # of macOS; slices begin at multiples of 2**14 bytes
CPU_TYPE = 4  # where a Mach-O file has its processor's type, and its subtype after it


def platform_of_this_machine() -> str:
    """Return the name of the platform this process runs on; it need not be in :data:`PLATFORMS`."""
    found = machine.machine().lower()
    return f"{ARCHITECTURES.get(found, found)}-{SYSTEMS.get(sys.platform, sys.platform)}"


def default_platforms() -> tuple[str, ...]:
    wanted = ("x86_64-linux", "x86_64-windows", platform_of_this_machine())
    return tuple(name for name in ALL if name in wanted)


def select_platforms(wanted: Iterable[str]) -> tuple[str, ...]:
    """Return platforms by name, ``all`` and ``this`` included; raise for unknown ones."""
    names: set[str] = set()
    for name in wanted:
        names.update({"all": ALL, "this": (platform_of_this_machine(),)}.get(name, (name,)))
    for name in sorted(names - set(ALL)):
        raise CannotExport(f"platform {name}: expected all, this, or one of {', '.join(ALL)}")
    return tuple(name for name in ALL if name in names)


def universal_binary(slices: Iterable[bytes]) -> bytes:
    """Join macOS libraries of one processor each to a library for all of them."""
    libraries = list(slices)
    offset, header, body = 1 << FAT_ALIGNMENT, b"", b""
    for library in libraries:
        cpu, subtype = struct.unpack_from("<II", library, CPU_TYPE)
        header += struct.pack(">5I", cpu, subtype, offset, len(library), FAT_ALIGNMENT)
        body += library + bytes(-len(library) % (1 << FAT_ALIGNMENT))
        offset = (1 << FAT_ALIGNMENT) + len(body)
    head = struct.pack(">II", FAT_MAGIC, len(libraries)) + header
    return head.ljust(1 << FAT_ALIGNMENT, b"\0") + body


def binary_files(version: str, name: str, made: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return ``binaries/``; FMI 2.0's ``darwin64`` serves both processors of macOS."""
    files = {}
    for platform, library in made.items():
        of = PLATFORMS[platform]
        folder = of.folder if version == "fmi2" else platform
        files[f"binaries/{folder}/{name}{of.suffix}"] = library
    apple = [library for platform, library in made.items() if platform.endswith("-darwin")]
    if version == "fmi2" and apple:
        files[f"binaries/darwin64/{name}.dylib"] = universal_binary(apple)
    return files
