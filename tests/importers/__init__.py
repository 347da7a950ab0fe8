"""Compile an importer in C, with a fuzzer, against an FMU; rebuild its C shim with sanitizers."""

from __future__ import annotations

import importlib.util
import math
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fmu_src.export import forms, native_form, sources
from fmu_src.export.compiler import compile_kernel, compile_object
from fmu_src.export.model_header import model_header
from fmu_src.export.platforms import platform_of_this_machine
from fmu_src.export.source_code import kernel_c_source
from orchestrate.fmu import describe

HERE = Path(__file__).parent
TYPES = {"Real": "R", "Float64": "R", "Integer": "I", "Int32": "I", "Boolean": "B"}
FOLDERS = {"fmi2": ("linux64", "win64"), "fmi3": ("x86_64-linux", "x86_64-windows")}
SANITIZE = (
    "-fsanitize=address,undefined,float-cast-overflow,float-divide-by-zero",
    *("-fno-sanitize-recover=all", "-fno-omit-frame-pointer"),
)
WARNINGS = ("-std=gnu11", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function")


def own_compiler_command() -> list[str] | None:
    """Return the command of the machine's C compiler; None without one."""
    own = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    return [own] if own else None


def zig_compiler(target: str = "native") -> list[str] | None:
    """Return the command of ziglang's C compiler for a target; None if not installed."""
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target]
    return command if importlib.util.find_spec("ziglang") else None


def c_compiler() -> list[str] | None:
    """Return the command of any C compiler for this machine; None without one."""
    return own_compiler_command() or zig_compiler()


def run_compiler(command: Sequence[object], folder: Path) -> None:
    """Run a compiler in a folder; raise with its output if it fails."""
    done = subprocess.run([*map(str, command)], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-4000:]


def unpack_binary(fmu: Path, version: str, folder: Path, windows: bool = False) -> Path:
    """Unpack an FMU's binary of this machine into a folder; return its path."""
    name = f"{FOLDERS[version][windows]}/{fmu.stem}{'.dll' if windows else '.so'}"
    with zipfile.ZipFile(fmu) as archive:
        return Path(archive.extract(f"binaries/{name}", folder))


def names_header(fmu: Path) -> str:
    description = describe(fmu)
    rows, time = [], 0xFFFFFFFF
    for variable in description.variables.values():
        if variable.causality == "independent":
            time = variable.valueReference
        if variable.type not in TYPES or variable.dimensions or variable.causality == "independent":
            continue
        settable = variable.causality in ("parameter", "input")
        limits = [c_literal(variable.min, -math.inf), c_literal(variable.max, math.inf)]
        cells = [f'"{variable.name}"', f"{variable.valueReference}u", f"'{TYPES[variable.type]}'"]
        cells += [str(int(settable)), str(int(variable.variability == "fixed")), *limits]
        rows.append("    {" + ", ".join(cells) + "},")
    version = f"#define FMI_VERSION {description.fmi_version[0]}"
    defines = ["#include <math.h>", f'#define TOKEN "{description.guid}"']
    defines += [f"#define TIME_REFERENCE {time}u", version, f"#define MODEL_{description.name}"]
    return "\n".join([*defines, "static const Name NAMES[] = {", *rows, "};", ""])


def c_literal(text: str | None, otherwise: float) -> str:
    value = otherwise if text is None else float(text)
    return repr(value).replace("inf", "INFINITY") if math.isinf(value) else value.hex()


def compile_against(
    fmu: Path,
    folder: Path,
    programs: Iterable[Path],
    options: Sequence[str],
    command: Sequence[str] | None = None,
) -> Path:
    """Compile C files that include ``version.h`` against an FMU; return the program's path."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "names.h").write_text(names_header(fmu), encoding="utf-8")
    number = describe(fmu).fmi_version[0]
    for name, content in native_form.fmi_headers(f"fmi{number}").items():
        (folder / name).write_bytes(content)
    target = folder / f"importer{number}.exe"
    windows = any("windows" in word for word in command or ())
    libraries = [] if windows else ["-ldl", "-lpthread", "-lm"]
    places = [f"-I{folder}", f"-I{HERE}"]
    command = [*(command or c_compiler() or ["cc"]), *WARNINGS, *options, *places]
    files = [HERE / "importer.c", *programs]
    run_compiler([*command, "-o", target, *files, *libraries], folder)
    return target


def compile_importer(
    version: str,
    fmu: Path,
    folder: Path,
    command: Sequence[str] | None = None,
    options: Sequence[str] = ("-O1", "-g"),
) -> Path:
    """Compile the importer of an FMI version for an FMU; return the program's path."""
    number = version[-1]
    parts = ("modes", "fuzz", f"fuzz{number}")
    return compile_against(fmu, folder, [HERE / f"{part}.c" for part in parts], options, command)


def rebuild_shim(
    version: str, folder: Path, objects: Mapping[str, bytes], options: Sequence[str], model: str
) -> Path:
    """Compile an FMU's binary from its own sources with other options; return its path."""
    folder.mkdir(parents=True, exist_ok=True)
    token = native_form.native_fmu_guid(model, version)
    header = model_header(sources.load_model(model), token, sources.model_digest(model))
    files = {**native_form.shim_sources(version), **native_form.fmi_headers(version)}
    files |= {"model.h": header, "kernel.o": objects["x86_64-linux"]}
    for name, content in files.items():
        (folder / name).write_bytes(content)
    target = folder / "rebuilt.so"
    fixed = ("-shared", "-fPIC", "-fvisibility=hidden", "-g", "-O1", "-ffp-contract=off")
    parts = [name for name in native_form.shim_sources(version) if name.endswith(".c")]
    command = [*(c_compiler() or ["cc"]), *fixed, *options, "-o", target, *parts, "kernel.o"]
    run_compiler(command, folder)
    return target


def settings(values: Mapping[str, float]) -> list[str]:
    """Return start values as arguments of a program that calls ``fmu_set_all``."""
    return [f"{name}={float(value).hex()}" for name, value in values.items()]


def read_rows(text: str) -> list[list[float]]:
    lines = (line.split() for line in text.splitlines() if not line.startswith("CHECKS"))
    return [[float.fromhex(cell) for cell in line] for line in lines]


@dataclass(frozen=True)
class Importer:
    """A compiled importer program and the FMU's binary that it loads."""

    program: Path
    library: Path
    version: str

    def run(
        self,
        *arguments: object,
        under: Sequence[str] = (),
        times: Iterable[float] = (),
        text: str = "",
        timeout: float = 300,
        success: bool = True,
        env: Mapping[str, str] | None = None,
    ) -> subprocess.CompletedProcess[str]:
        """Run a mode of the program with times or a text as input; return the process."""
        command = [*under, self.program, self.library, *arguments]
        text += "".join(f"{float(time).hex()}\n" for time in times)
        how: Any = {"input": text, "timeout": timeout, "env": env}
        done = subprocess.run([*map(str, command)], capture_output=True, text=True, **how)
        shown = f"exit code {done.returncode}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}"
        assert done.returncode == 0 or not success, shown
        return done

    def simulate(
        self,
        names: Sequence[str],
        times: Iterable[float],
        under: Sequence[str] = (),
        **values: float,
    ) -> list[list[float]]:
        """Return outputs at each of ``times``; the first one is the start."""
        done = self.run("simulate", ",".join(names), *settings(values), under=under, times=times)
        return read_rows(done.stdout)


def importer(version: str, fmu: Path, folder: Path) -> Importer:
    """Compile the importer of an FMU; return it with the FMU's own binary."""
    program = compile_importer(version, fmu, folder / "importer")
    return Importer(program, unpack_binary(fmu, version, folder), version)


def kernel_objects(model: str, sanitizer: Sequence[str] = ()) -> dict[str, bytes]:
    """Compile a model's C kernel; return a dict from this machine's platform to its object file.

    With a sanitizer by the machine's own compiler.
    """
    source = kernel_c_source(forms.MODELS[model])
    if not sanitizer:
        return {platform_of_this_machine(): compile_kernel(platform_of_this_machine(), source)}
    fixed = ("-c", "-fPIC", "-g", "-O2", "-ffp-contract=off", "-DINLINE=inline")
    command = (*(c_compiler() or ["cc"]), *fixed, *sanitizer, "kernel.c", "-o", "kernel.o")
    return {platform_of_this_machine(): compile_object(command, source, "kernel with a sanitizer")}


def importer_with_sanitizer(
    version: str, model: str, exported: Path, folder: Path, sanitizer: Sequence[str]
) -> Importer:
    """Compile importer, shim and kernel of a model with a sanitizer in all; return the importer."""
    path = exported / version / f"{model}.fmu"
    options = ("-O1", "-g", *sanitizer)
    program = compile_importer(version, path, folder / "importer", options=options)
    objects = kernel_objects(model, sanitizer)
    library = rebuild_shim(version, folder / "shim", objects, sanitizer, forms.MODELS[model])
    return Importer(program, library, version)
