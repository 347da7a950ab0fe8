"""The native form of a model: kernel compiled ahead of time, a generic C shim over the variable
table, nothing else in the binary.
"""

import functools
import math
from importlib import resources
from pathlib import Path

from .archive import fingerprint, guid_of, write_archive
from .compile_kernel import compile_objects
from .documentation import documentation_files
from .linking import PLATFORMS, link_all
from .model_description import fmi2_native_xml
from .model_description3 import ARRAY_BASE, CLOCK_REFERENCE, fmi3_xml
from .pythonfmu_form import ROOT, embedded_sources, exporters, kernel_sources

HEADERS = {
    "fmi2": ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    "fmi3": ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}
SHIM = {
    "fmi2": ("core.h", "core.c", "fmi2.c"),
    "fmi3": ("core.h", "core.c", "fmi3.c", "fmi3_absent.c"),
}
XML = {"fmi2": fmi2_native_xml, "fmi3": fmi3_xml}


def c_string(text):
    """A C string literal."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


def c_number(value):
    """A C floating-point literal, to the last bit."""
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return float(value).hex()


def c_variable(model, variable):
    """One row of the C variable table."""
    slots = {v.name: v.slot for v in model.variables}
    minimum = -math.inf if variable.minimum is None else variable.minimum
    maximum = math.inf if variable.maximum is None else variable.maximum
    cells = [
        c_string(variable.name),
        c_string(variable.unit),
        c_string(variable.range_text()),
        variable.type.upper(),
        str(int(variable.calculated)),
        str(int(variable.fixed)),
        c_number(variable.start),
        c_number(minimum),
        c_number(maximum),
        str(variable.input_derivatives),
        str(slots[variable.derivative]) if variable.derivative else "-1",
        str(int(bool(variable.series))),
    ]
    return "    {" + ", ".join(cells) + "},"


def model_header(model, token, digest):
    """``model.h``: the variable table, sizes and messages for the shim."""
    highest = max(model.messages)
    inputs = [
        f"orders 1 to {v.input_derivatives} of {v.name}"
        for v in model.variables
        if v.input_derivatives
    ]
    outputs = [v.name for v in model.variables if v.derivative]
    slots = {v.name: v.slot for v in model.variables}
    arrays = [f"    {{{slots[array.first]}, {array.size}}}," for array in model.arrays]
    lines = [
        "/* Generated from the variable table. */",
        "#include <math.h>",
        f"#define MODEL_TOKEN {c_string(token)}",
        f"#define STATE_MAGIC {c_string('vibroimpact state ' + digest)}",
        f"#define MEMORY_SIZE {model.memory_size}",
        f"#define SKIP_FIRST {model.written_only[0]}",
        f"#define SKIP_COUNT {model.written_only[1]}",
        f"#define TIME_SLOT {model.time_slot}",
        f"#define STOP_SLOT {model.stop_slot}",
        f"#define VARIABLE_COUNT {len(model.variables)}u",
        f"#define REFRESH {int(model.refresh is not None)}",
        f"#define EVENT_CLOCK {int(model.clock is not None)}",
        f"#define EVENT_COUNT_SLOT {slots[model.clock.counter] if model.clock else 0}",
        f"#define CLOCK_REFERENCE {CLOCK_REFERENCE}u",
        f"#define ARRAY_BASE {ARRAY_BASE}u",
        f"#define ARRAY_COUNT {len(arrays)}u",
        f"#define MESSAGE_COUNT {highest + 1}",
        f"#define INPUT_DERIVATIVES {c_string(', '.join(inputs) or 'none')}",
        f"#define OUTPUT_DERIVATIVES {c_string(', '.join(outputs) or 'none')}",
        "typedef enum { REAL, INTEGER, BOOLEAN } Type;",
        "typedef struct { const char *name, *unit, *range; Type type; int calculated, fixed; double start, minimum, maximum;",
        "                 int input_derivatives, derivative, element; } Variable;",
        "static const Variable VARIABLES[] = {",
        *[c_variable(model, variable) for variable in model.variables],
        "};",
        "typedef struct { unsigned first, size; } Array;",
        "static const Array ARRAYS[] = {",
        *(arrays or ["    {0, 0},"]),
        "};",
        "static const char *const MESSAGES[] = {",
        *[f"    [{code}] = {c_string(text)}," for code, text in sorted(model.messages.items())],
        "};",
    ]
    return ("\n".join(lines) + "\n").encode()


def shim_sources(version):
    """C sources of the shim for an FMI version."""
    folder = ROOT / "runtime" / "native"
    return {name: (folder / name).read_bytes() for name in SHIM[version]}


def fmi_headers(version):
    """The standard's C headers, which come with FMPy."""
    folder = resources.files("fmpy") / "c-code"
    return {name: (folder / name).read_bytes() for name in HEADERS[version]}


def source_digest(kernel, folder):
    """Fingerprint of kernel and model: states saved by one native form can be read by the other."""
    return fingerprint(
        {
            k: v
            for k, v in embedded_sources(kernel, folder).items()
            if not k.startswith("runtime/slave")
        }
    )


def guid(kernel, folder, version):
    """The GUID (instantiation token) of the native form: of the sources, and of the exporters that
    make the FMU from them.
    """
    return guid_of(
        fingerprint(
            {
                **exporters(),
                "version": version.encode(),
                "sources": source_digest(kernel, folder).encode(),
            }
        )
    )


def export(model, kernel, folder, target, version):
    """Write ``target/NAME.fmu``.

    Parameters
    ----------
    model : Model
    kernel, folder : str
        Packages below ``fmu_src``: the kernel's and the model's.
    target : Path
    version : str
        ``"fmi2"`` or ``"fmi3"``.

    Returns
    -------
    Path
        The FMU.

    Raises
    ------
    NoCompiler
        Where no binary can be made.
    """
    token, digest = guid(kernel, folder, version), source_digest(kernel, folder)
    objects = compile_objects(f"fmu_src.models.{folder}.model")
    sources = {
        **shim_sources(version),
        **fmi_headers(version),
        "model.h": model_header(model, token, digest),
    }
    files = {"modelDescription.xml": XML[version](model, token)}
    for name, binary in link_all(objects, sources).items():
        platform = PLATFORMS[name]
        files[f"binaries/{getattr(platform, version)}/{model.name}{platform.suffix}"] = binary
    files.update(documentation_files(model, ROOT / "models" / folder, digest))
    files.update(
        {f"documentation/{name}": content for name, content in kernel_sources(kernel).items()}
    )
    path = Path(target) / f"{model.name}.fmu"
    write_archive(path, files)
    return path


export_fmi3 = functools.partial(export, version="fmi3")
export_fmi2 = functools.partial(export, version="fmi2")
