"""The platforms that an FMU has binaries for."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Platform:
    """A platform with binaries.

    Attributes
    ----------
    triple : str
        LLVM's target triple.
    zig_target : str
        With the oldest C library it is to run on.
    suffix : str
        Of a shared library.
    folders : dict of str to str
        Folder below ``binaries/`` by FMI version.
    """

    triple: str
    zig_target: str
    suffix: str
    folders: dict[str, str]


PLATFORMS = {
    "x86_64-linux": Platform(
        "x86_64-unknown-linux-gnu",
        "x86_64-linux-gnu.2.17",
        ".so",
        {"fmi2": "linux64", "fmi3": "x86_64-linux"},
    ),
    "x86_64-windows": Platform(
        "x86_64-pc-windows-gnu",
        "x86_64-windows-gnu",
        ".dll",
        {"fmi2": "win64", "fmi3": "x86_64-windows"},
    ),
}
