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
from fmu_src.export.compiler import compile_object
from fmu_src.export.model_header import model_header
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


def own_compiler_command() -> list[str]:
    """Return the command of the machine's C compiler; an empty list without one."""
    own = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    return [own] if own else []


def zig_compiler(target: str = "native") -> list[str]:
    """Return the command of ziglang's C compiler for a target; an empty list if not installed."""
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target]
    return command if importlib.util.find_spec("ziglang") else []


def c_compiler() -> list[str]:
    """Return the command of any C compiler for this machine; an empty list without one."""
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
    """Return ``names.h``: the FMU's scalar variables, its token and FMI version."""
    description = describe(fmu)
    rows, time = [], 0xFFFFFFFF
    for variable in description.variables.values():
        if variable.causality == "independent":
            time = variable.valueReference
        elif variable.type in TYPES and not variable.dimensions:
            flags = variable.causality in ("parameter", "input"), variable.variability == "fixed"
            limits = c_literal(variable.min or "-inf"), c_literal(variable.max or "inf")
            kind = f"'{TYPES[variable.type]}'"
            cells = [f'"{variable.name}"', f"{variable.valueReference}u", kind]
            cells += [*(str(int(flag)) for flag in flags), *limits]
            rows.append("    {" + ", ".join(cells) + "},")
    version = f"#define FMI_VERSION {description.fmi_version[0]}"
    defines = ["#include <math.h>", f'#define TOKEN "{description.guid}"']
    defines += [f"#define TIME_REFERENCE {time}u", version, f"#define MODEL_{description.name}"]
    return "\n".join([*defines, "static const Name NAMES[] = {", *rows, "};", ""])


def c_literal(text: str) -> str:
    value = float(text)
    return repr(value).replace("inf", "INFINITY") if math.isinf(value) else value.hex()


def compile_against(
    fmu: Path,
    folder: Path,
    programs: Iterable[Path],
    options: Sequence[str],
    command: Sequence[str] = (),
) -> Path:
    """Compile C files that include ``version.h`` against an FMU; return the program's path."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "names.h").write_text(names_header(fmu), encoding="utf-8")
    version = f"fmi{describe(fmu).fmi_version[0]}"
    for name, content in native_form.fmi_headers(version).items():
        (folder / name).write_bytes(content)
    target = folder / f"{version}.exe"
    windows = any("windows" in word for word in command)
    libraries = [] if windows else ["-ldl", "-lpthread", "-lm"]
    compiler = command or c_compiler() or ["cc"]
    command = [*compiler, *WARNINGS, *options, f"-I{folder}", f"-I{HERE}"]
    files = [HERE / "importer.c", *programs]
    run_compiler([*command, "-o", target, *files, *libraries], folder)
    return target


def compile_importer(
    version: str,
    fmu: Path,
    folder: Path,
    command: Sequence[str] = (),
    options: Sequence[str] = ("-O1", "-g"),
) -> Path:
    """Compile the importer of an FMI version for an FMU; return the program's path."""
    parts = ("modes", "fuzz", f"fuzz{version[-1]}")
    return compile_against(fmu, folder, [HERE / f"{part}.c" for part in parts], options, command)


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


def importer_with_sanitizer(
    version: str, model: str, exported: Path, folder: Path, sanitizer: Sequence[str]
) -> Importer:
    """Compile importer, shim and kernel of a model with a sanitizer in all; return the importer."""
    path, name = exported / version / f"{model}.fmu", forms.MODELS[model]
    program = compile_importer(
        version, path, folder / "importer", options=("-O1", "-g", *sanitizer)
    )
    command = (*(c_compiler() or ["cc"]), "-fPIC", "-g", "-ffp-contract=off", *sanitizer)
    optimised = (*command, "-c", "-O2", "-DINLINE=inline")
    kernel = compile_object(optimised, kernel_c_source(name), "kernel with a sanitizer")
    token, shim = native_form.native_fmu_guid(name, version), native_form.shim_sources(version)
    header = model_header(sources.load_model(name), token, sources.model_digest(name))
    files = {**shim, **native_form.fmi_headers(version), "model.h": header, "kernel.o": kernel}
    place = folder / "shim"
    place.mkdir()
    for file, content in files.items():
        (place / file).write_bytes(content)
    parts = [file for file in files if file.endswith((".c", ".o"))]
    shared = ("-shared", "-fvisibility=hidden", "-O1", "-o", "rebuilt.so")
    run_compiler([*command, *shared, *parts], place)
    return Importer(program, place / "rebuilt.so", version)
