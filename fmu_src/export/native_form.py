"""The native form: the kernel compiled ahead of time, a C shim over the variable table, no more."""

from __future__ import annotations

from collections.abc import Callable
from importlib import resources
from pathlib import Path

from ..runtime.table import Model
from .archive import guid_of, write_archive
from .compile_kernel import compile_objects
from .description_fmi2 import fmi2_xml
from .description_fmi3 import fmi3_xml
from .documentation import documentation_files
from .errors import require
from .linking import link_all
from .model_header import model_header
from .platforms import PLATFORMS
from .sources import Files, exporters, load, model_digest, model_sources, read

HEADERS = {
    "fmi2": ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    "fmi3": ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}
SHIM = {
    "fmi2": ("core.h", "core.c", "fmi2.c"),
    "fmi3": ("core.h", "core.c", "fmi3.c", "fmi3_absent.c"),
}
XML: dict[str, Callable[[Model, str], bytes]] = {"fmi2": fmi2_xml, "fmi3": fmi3_xml}


def shim_sources(version: str) -> Files:
    """C sources of the shim for an FMI version."""
    found = read(*(f"runtime/native/{name}" for name in SHIM[version]))
    return {Path(name).name: content for name, content in found.items()}


def fmi_headers(version: str) -> Files:
    """The standard's C headers, which come with FMPy."""
    require("fmpy", "brings the C headers of the FMI standard")
    folder = resources.files("fmpy") / "c-code"
    return {name: (folder / name).read_bytes() for name in HEADERS[version]}


def guid(folder: str, version: str) -> str:
    """The GUID: of the sources, and of the exporters that make the FMU from them."""
    model = {"sources": model_digest(folder).encode(), "version": version.encode()}
    return guid_of({**exporters("export/native_form.py"), **model})


def export(folder: str, version: str, target: Path) -> Path:
    """Write ``target/NAME.fmu``.

    Parameters
    ----------
    folder : str
        The model's, below ``fmu_src/models``.
    version : str
        ``"fmi2"`` or ``"fmi3"``.
    target : Path

    Returns
    -------
    Path
        The FMU.

    Raises
    ------
    CannotExport
        Where no binary can be made.
    """
    model, token, digest = load(folder), guid(folder, version), model_digest(folder)
    header = {"model.h": model_header(model, token, digest)}
    units = {**shim_sources(version), **fmi_headers(version), **header}
    files = {"modelDescription.xml": XML[version](model, token)}
    for name, binary in link_all(compile_objects(folder), units).items():
        platform = PLATFORMS[name]
        place = f"binaries/{platform.folders[version]}/{model.name}{platform.suffix}"
        files[place] = binary
    files.update(documentation_files(folder, digest))
    kernel = {k: v for k, v in model_sources(folder).items() if k.startswith("kernels/")}
    files.update({f"documentation/{name}": content for name, content in kernel.items()})
    path = target / f"{model.name}.fmu"
    write_archive(path, files)
    return path
