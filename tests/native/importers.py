"""The project's importers in C, compiled against an FMU, and the FMU's shim rebuilt with checks
inside.
"""

import importlib.util
import math
import shutil
import subprocess
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path

import fmpy

from fmu_src.export import native_form, sources
from fmu_src.export.model_header import model_header
from fmu_src.kernels.shaker import memory as shaker

HERE = Path(__file__).parent
TYPES = {"Real": "R", "Float64": "R", "Integer": "I", "Int32": "I", "Boolean": "B"}
FOLDERS = {"fmi2": ("linux64", "win64"), "fmi3": ("x86_64-linux", "x86_64-windows")}
SANITIZE = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer")
WARNINGS = ("-std=gnu11", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function")


def own_compiler():
    """The machine's C compiler, as a command; None where there is none."""
    own = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    return [own] if own else None


def ziglang(target="native"):
    """The C compiler of ziglang, as a command; None where it is not installed."""
    return (
        [sys.executable, "-m", "ziglang", "cc", "-target", target]
        if importlib.util.find_spec("ziglang")
        else None
    )


def compiler():
    """A C compiler for this machine, as a command; None where there is none."""
    return own_compiler() or ziglang()


def run_compiler(command, folder):
    """Compile, or show what the compiler said."""
    done = subprocess.run([*map(str, command)], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-4000:]


def binary(fmu, version, folder, windows=False):
    """The FMU's binary, unpacked; returns its path."""
    suffix = ".dll" if windows else ".so"
    with zipfile.ZipFile(fmu) as archive:
        return Path(
            archive.extract(f"binaries/{FOLDERS[version][windows]}/{fmu.stem}{suffix}", folder)
        )


def names_header(fmu):
    """``names.h`` from the FMU's model description: what the importer knows of the FMU."""
    description = fmpy.read_model_description(str(fmu))
    rows, time = [], 0xFFFFFFFF
    for variable in description.modelVariables:
        if variable.causality == "independent":
            time = variable.valueReference
        if variable.type not in TYPES or variable.dimensions or variable.causality == "independent":
            continue
        settable = variable.causality in ("parameter", "input")
        limits = [c_double(variable.min, -math.inf), c_double(variable.max, math.inf)]
        cells = [
            f'"{variable.name}"',
            f"{variable.valueReference}u",
            f"'{TYPES[variable.type]}'",
            str(int(settable)),
        ]
        rows.append(
            "    {" + ", ".join([*cells, str(int(variable.variability == "fixed")), *limits]) + "},"
        )
    token = description.guid or description.instantiationToken
    defines = ["#include <math.h>", f'#define TOKEN "{token}"', f"#define TIME_REFERENCE {time}u"]
    is_shaker = description.modelName == "MotorShaker"
    defines += ["#define MOTOR_SHAKER"] * is_shaker
    first, end = (shaker.RATES, shaker.STATE) if is_shaker else (0, 0)
    defines += [f"#define SCRATCH_FIRST {first}", f"#define SCRATCH_COUNT {end - first}"]
    return "\n".join([*defines, "static const Name NAMES[] = {", *rows, "};", ""])


def c_double(text, otherwise):
    """A number of the model description as a C literal."""
    value = otherwise if text is None else float(text)
    return repr(value).replace("inf", "INFINITY") if math.isinf(value) else value.hex()


def compile_importer(version, fmu, folder, command=None, options=("-O1", "-g")):
    """Compile the importer of an FMI version for an FMU; returns its path."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "names.h").write_text(names_header(fmu), encoding="utf-8")
    for name, content in native_form.fmi_headers(version).items():
        (folder / name).write_bytes(content)
    number = version[-1]
    parts = ("importer", "fuzz", "hostile", "arguments")
    sources = [*(HERE / f"{part}{number}.c" for part in parts), HERE / "modes.c", HERE / "fuzz.c"]
    target = folder / f"importer{number}.exe"
    windows = any("windows" in word for word in command or ())
    libraries = [] if windows else ["-ldl", "-lpthread", "-lm"]
    run_compiler(
        [
            *(command or compiler()),
            *WARNINGS,
            *options,
            f"-I{folder}",
            "-o",
            target,
            *sources,
            *libraries,
        ],
        folder,
    )
    return target


def units(version):
    """The shim's C files."""
    return [name for name in native_form.shim_sources(version) if name.endswith(".c")]


def rebuild_shim(version, folder, objects, options=SANITIZE, model="oscillator", command=None):
    """The FMU's binary again, from its own C sources and kernel, with other options; returns its
    path.
    """
    folder.mkdir(parents=True, exist_ok=True)
    token = native_form.guid(model, version)
    header = model_header(sources.load_model(model), token, sources.model_digest(model))
    files = {**native_form.shim_sources(version), **native_form.fmi_headers(version)}
    files |= {"model.h": header, "kernel.o": objects["x86_64-linux"]}
    for name, content in files.items():
        (folder / name).write_bytes(content)
    target = folder / "rebuilt.so"
    fixed = ("-shared", "-fPIC", "-fvisibility=hidden", "-g", "-O1", "-ffp-contract=off")
    command = [
        *(command or compiler()),
        *fixed,
        *options,
        "-o",
        target,
        *units(version),
        "kernel.o",
    ]
    run_compiler(command, folder)
    return target


@dataclass(frozen=True)
class Importer:
    """A compiled importer and the binary it loads."""

    program: Path
    library: Path
    version: str

    def run(self, *arguments, under=(), times=(), text="", timeout=300, success=True, env=None):
        """Run a mode, with times or a text as its standard input; returns the completed process."""
        command = [*under, self.program, self.library, *arguments]
        text += "".join(f"{float(time).hex()}\n" for time in times)
        done = subprocess.run(
            [*map(str, command)],
            input=text,
            capture_output=True,
            text=True,
            timeout=timeout,
            env=env,
        )
        if success:
            assert done.returncode == 0, (
                f"exit code {done.returncode}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}"
            )
        return done

    def simulate(self, names, times, under=(), **values):
        """Outputs at each of ``times``, the first one being the start: a list of lists of float."""
        settings = [f"{name}={float(value).hex()}" for name, value in values.items()]
        done = self.run("simulate", ",".join(names), *settings, under=under, times=times)
        return [
            [float.fromhex(cell) for cell in line.split()]
            for line in done.stdout.splitlines()
            if not line.startswith("CHECKS")
        ]
