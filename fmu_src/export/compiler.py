"""Compile C sources to shared libraries, for each platform an FMU has a binary for.

The compiler is the clang of the PyPI package ziglang, which compiles for every platform on every
machine and gives the same bytes everywhere; where that is missing, the machine's own compiler
serves its own platform. No option lets a compiler fuse, reorder or leave out an operation on
floating-point numbers: each has the bits that Python gives.
"""

from __future__ import annotations

import functools
import importlib.util
import logging
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from .errors import EXTRA, CannotExport, require_package
from .platforms import PLATFORMS, platform_of_this_machine

log = logging.getLogger(__name__)
FLAGS = (
    *("-O2", "-g0", "-std=c99", "-ffp-contract=off", "-fno-math-errno", "-fvisibility=hidden"),
    *("-Wall", "-Wextra"),
)
CLANG_FLAGS = (  # which gcc does not know
    "-Xclang",  # ziglang takes -O3 for -O2
    "-O3",
    # a loop for each mode of the state, not a question in every turn of one
    *("-mllvm", "-unswitch-threshold=200"),
    *("-mllvm", "-inline-threshold=1000"),  # each function where it is called
)
LINK_FLAGS = ("-dynamic", "-O", "ReleaseFast", "-fstrip", "-fno-ubsan-rt", "-fno-soname")
# Of Windows's C library the shim needs these parts. Linked as a whole it would be compiled first:
# a minute of a fresh machine.
WINDOWS_PARTS = ("heap", "stdio", "string", "convert", "private")
WINDOWS_FOLDER = "lib/libc/mingw/stdio"  # of mingw-w64, in ziglang's folder
WINDOWS_SOURCES = ("ucrt_snprintf.c", "ucrt___local_stdio_printf_options.c")
WINDOWS_FLAGS = ("-U__CRT__NO_INLINE",)  # its headers' isnan and isfinite, inline


@functools.cache
def warn_once(line: str) -> None:
    log.warning("%s", line)


def ziglang_command(*arguments: str) -> list[str]:
    require_package("ziglang", "compiles the kernel")
    return [sys.executable, "-m", "ziglang", *arguments]


def own_compiler_command(platform: str) -> list[str]:
    """Return the command of the machine's own C compiler; an empty list where ziglang is there."""
    if importlib.util.find_spec("ziglang"):
        return []
    own = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if own and platform == platform_of_this_machine():
        return [own]
    raise CannotExport(
        f"no C compiler for {platform}: expected {EXTRA} (ziglang), or, for the machine's own "
        "platform, cc, gcc or clang"
    )


def run_compiler(command: Iterable[str], folder: str | Path, target: str) -> None:
    done = subprocess.run([*command], cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        output = done.stderr.splitlines()
        lines = [line for line in output if "error" in line] or output or ["no reason given"]
        raise CannotExport(f"the C compiler failed for {target}: {lines[0]}")


def targeted_ziglang_command(program: str, platform: str) -> list[str]:
    target = PLATFORMS[platform]
    return [*ziglang_command(program), "-target", target.zig_target, f"-mcpu={target.cpu}"]


def compile_command(platform: str) -> list[str]:
    compiler = own_compiler_command(platform)
    compiler = compiler or [*targeted_ziglang_command("cc", platform), *CLANG_FLAGS]
    fixed = WINDOWS_FLAGS if platform.endswith("-windows") else ("-fPIC",)
    return [*compiler, *FLAGS, *fixed, "-c"]


def link_command(platform: str, title: str, objects: Iterable[str]) -> list[str]:
    file = f"{title}{PLATFORMS[platform].suffix}"
    own = own_compiler_command(platform)
    if own:
        return [*own, "-shared", "-s", "-o", file, *objects]
    command = [*targeted_ziglang_command("build-lib", platform), *LINK_FLAGS, "--name", title]
    if platform.endswith("-windows"):
        command += ["-fno-entry", "-fno-emit-implib"]
        command += [f"-lapi-ms-win-crt-{part}-l1-1-0" for part in WINDOWS_PARTS]
    else:
        command += ["-lc", "-fno-compiler-rt"]
    if platform.endswith("-darwin"):
        command += ["-install_name", f"@rpath/{file}"]
    return [*command, f"-femit-bin={file}", *objects]


def compile_kernel(platform: str, source: bytes) -> bytes:
    return compile_object(tuple(compile_command(platform)), source, platform)


@functools.cache
def compile_object(command: tuple[str, ...], source: bytes, target: str) -> bytes:
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as folder:
        (Path(folder) / "kernel.c").write_bytes(source)
        run_compiler([*command, "kernel.c", "-o", "kernel.o"], folder, target)
        return (Path(folder) / "kernel.o").read_bytes()


def compile_and_link(platform: str, title: str, files: Mapping[str, bytes]) -> bytes:
    """Compile and link named files to a library called ``title``; return its bytes."""
    if platform.endswith("-windows"):
        require_package("ziglang", "brings the C library of Windows")
        spec = importlib.util.find_spec("ziglang")
        assert spec is not None and spec.origin is not None
        library = Path(spec.origin).parent / WINDOWS_FOLDER
        files = {**files, **{name: (library / name).read_bytes() for name in WINDOWS_SOURCES}}
    objects = [file for file in files if file.endswith(".o")]
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as place:
        folder = Path(place)
        for file, content in files.items():
            (folder / file).write_bytes(content)
        for unit in [file for file in files if file.endswith(".c")]:
            objects.append(f"{Path(unit).stem}.o")
            run_compiler([*compile_command(platform), unit, "-o", objects[-1]], folder, platform)
        run_compiler(link_command(platform, title, objects), folder, platform)
        return (folder / f"{title}{PLATFORMS[platform].suffix}").read_bytes()


def link_for_platforms(
    names: Iterable[str], title: str, kernel: bytes, files: Mapping[str, bytes]
) -> dict[str, bytes]:
    """Link a library for all platforms that can be made here; warn of those left out."""

    def link_or_reason(platform: str) -> bytes | CannotExport:
        try:
            compiled = {**files, "kernel.o": compile_kernel(platform, kernel)}
            return compile_and_link(platform, title, compiled)
        except CannotExport as reason:
            return reason

    wanted = tuple(names)
    with ThreadPoolExecutor(os.cpu_count()) as threads:
        results = list(threads.map(link_or_reason, wanted))
    pairs = zip(wanted, results, strict=True)
    made = {name: result for name, result in pairs if isinstance(result, bytes)}
    reasons = [result for result in results if isinstance(result, CannotExport)]
    if not made:
        raise reasons[0]
    for left_out in reasons:
        warn_once(f"the FMUs will have binaries only for {', '.join(made)}: {left_out}")
    return made
