"""Export the native form: the kernel compiled ahead of time, with a C shim over the variable
table.
"""

from __future__ import annotations

from dataclasses import replace
from importlib import resources
from pathlib import Path

from ..runtime.table import BOOLEAN, REAL, Model
from .archive import guid_of_files, write_archive
from .compiler import link_for_platforms
from .description_fmi2 import fmi2_xml
from .description_fmi3 import fmi3_xml
from .documentation import documentation_files
from .errors import require_package
from .model_header import model_header
from .platforms import binary_files, default_platforms
from .source_code import c_file_names, kernel_c_source, sources_folder
from .sources import (
    ROOT,
    Files,
    exporter_files,
    load_model,
    model_digest,
    model_sources,
    require_unedited_sources,
    text_files,
)

SHARED = ("names.h", "core.h", "core.c", "self_test.c")
HEADERS = {
    "fmi2": ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    "fmi3": ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}
NO_PREFIX = b"#define fmi2FullName(name) name\n"
STANDARD_PREFIX = b"""\
#if defined(FMI2_FUNCTION_PREFIX) && !defined(FMI2_OVERRIDE_FUNCTION_PREFIX)
#define fmi2Paste(a, b) a##b
#define fmi2PasteB(a, b) fmi2Paste(a, b)
#define fmi2FullName(name) fmi2PasteB(FMI2_FUNCTION_PREFIX, name)
#else
#define fmi2FullName(name) name
#endif
"""


def shim_sources(version: str) -> Files:
    names = *SHARED, f"{version}.c"
    return {name: (ROOT / "runtime" / "native" / name).read_bytes() for name in names}


def fmi_headers(version: str) -> Files:
    """Return the standard's C headers, which come with FMPy: its FMI 2.0 may lack the prefix."""
    require_package("fmpy", "brings the C headers of the FMI standard")
    folder = resources.files("fmpy") / "c-code"
    headers = {name: (folder / name).read_bytes() for name in HEADERS[version]}
    for name, text in headers.items():
        if b"defined(FMI2_FUNCTION_PREFIX)" not in text:
            headers[name] = text.replace(NO_PREFIX, STANDARD_PREFIX)
    return headers


def native_fmu_guid(folder: str, form: str) -> str:
    """Return the GUID: a hash of sources and texts, and of the exporters that make the FMU."""
    kind = form.replace("-", " ")
    model = {"sources": model_digest(folder).encode(), "version": kind.encode()}
    return guid_of_files({**exporter_files("export/native_form.py"), **text_files(folder), **model})


def plain_model(model: Model) -> Model:
    """Return a model as its plain form describes it.

    - Only scalars, without the states kept inside a step: tools' lists of variables stay short,
      and what stumbles over arrays or clocks has none to stumble over.
    - Only Real outputs, for importers that read every output as Real.
    - An excitation of the model's own by tunable parameters: importers that write 0 to inputs left
      open would stop it.

    Names and value references stay.
    """
    variables = []
    for v in model.variables:
        if v.name in model.excitation:
            v = replace(v, causality="parameter", variability="tunable", initial="exact")
        elif v.causality == "output" and v.type != REAL:
            low, high = (0.0, 1.0) if v.type == BOOLEAN else (v.minimum, v.maximum)
            v = replace(v, type=REAL, unit="1", minimum=low, maximum=high)
        if not v.series and v.name != model.series_count:
            variables.append(v)
    return replace(model, variables=tuple(variables), arrays=(), clock=None)


def export(folder: str, form: str, target: Path, platforms: tuple[str, ...] | None = None) -> Path:
    """Write the model's FMU; forms with ``-sources`` have no binaries, but for that sources."""
    model, digest = load_model(folder), model_digest(folder)
    version, token = form[:4], native_fmu_guid(folder, form)
    header = {"model.h": model_header(model, token, digest, real_outputs="-plain" in form)}
    shim = {**shim_sources(version), **fmi_headers(version), **header}
    described = plain_model(model) if "-plain" in form else model
    kernel = kernel_c_source(folder)
    sources = {**shim, "kernel.c": kernel}
    files = sources_folder(model.name, version, sources)
    files["modelDescription.xml"] = (
        fmi2_xml(described, token, sources=c_file_names(sources))  # FMI 3.0 has a file of them
        if version == "fmi2"
        else fmi3_xml(described, token)
    )
    if not form.endswith("-sources"):
        made = link_for_platforms(platforms or default_platforms(), model.name, kernel, shim)
        files.update(binary_files(version, model.name, made))
    files.update(documentation_files(folder, digest, form, described.variables))
    python = {k: v for k, v in model_sources(folder).items() if k.startswith("kernels/")}
    files.update({f"documentation/{name}": content for name, content in python.items()})
    require_unedited_sources()
    path = target / f"{model.name}.fmu"
    write_archive(path, files)
    return path
