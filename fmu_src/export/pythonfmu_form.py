"""Export the pythonfmu form: the Python kernel inside, with its compiled form where there is a
compiler.

Two FMUs, or an FMU and its host, share modules of the same name in one process. So everything
embedded lies in one package under a content-hashed name, the script bears the hash too, and
pythonfmu builds in a process of its own (``python -m fmu_src.export.pythonfmu_form SCRIPT PACKAGE
TARGET``).
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path

from ..runtime.compiled import LIBRARIES
from ..runtime.table import Model
from .archive import content_hash, guid_of_files, write_archive
from .compiler import link_for_platforms, own_compiler_command, warn_once
from .description_fmi2 import PYTHON, fmi2_xml
from .documentation import documentation_files
from .errors import EXTRA, CannotExport, require_package
from .platforms import PLATFORMS, platform_of_this_machine
from .self_test import has_right_bits
from .source_code import kernel_c_source
from .sources import (
    ROOT,
    Files,
    exporter_files,
    import_closure,
    load_model,
    read_sources,
    require_unedited_sources,
    text_files,
)

PYTHONFMU = "0.7.0"  # the slave works around what this version does, see there
SCRIPT = "runtime/script.py.in"


def embedded_sources(folder: str) -> Files:
    return import_closure(f"models/{folder}/model.py", "runtime/slave.py")


def source_digest(folder: str) -> str:
    """Return the content_hash of all that runs in the FMU; the GUID is made of it."""
    more = {**read_sources(SCRIPT), "pythonfmu": PYTHONFMU.encode()}
    return content_hash({**embedded_sources(folder), **more})


def pythonfmu_guid(folder: str) -> str:
    sources = {"sources": source_digest(folder).encode()}
    return guid_of_files(
        {**exporter_files("export/pythonfmu_form.py"), **text_files(folder), **sources}
    )


def export(folder: str, target: Path) -> Path:
    require_package("pythonfmu", "puts the FMU together")
    found = metadata.version("pythonfmu")
    if found != PYTHONFMU:
        raise CannotExport(f"pythonfmu is {found}: expected {PYTHONFMU}, as in {EXTRA}")
    model, digest = load_model(folder), source_digest(folder)
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as scratch:
        script, package = write_sources(Path(scratch) / "source", folder, digest)
        for name, library in compile_libraries(folder, model).items():
            (package / name).write_bytes(library)
        files = build_with_pythonfmu(script, package, Path(scratch) / "built.fmu")
    files["modelDescription.xml"] = fmi2_xml(model, pythonfmu_guid(folder), PYTHON)
    files.update(documentation_files(folder, digest, "fmi2-python", model.variables))
    require_unedited_sources()
    path = target / f"{model.name}.fmu"
    write_archive(path, files)
    return path


def write_sources(target: Path, folder: str, digest: str) -> tuple[Path, Path]:
    """Write the script and the package that pythonfmu puts into an FMU; return their paths."""
    model, package = load_model(folder), target / f"fmu_{digest[:12]}"
    for name, content in embedded_sources(folder).items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_bytes(content)
    script = target / f"{model.name}_{digest[:12]}.py"
    named = {"name": model.name, "description": model.description, "digest": digest}
    text = (ROOT / SCRIPT).read_text("utf-8")
    script.write_text(text.format(package=package.name, folder=folder, **named), "utf-8")
    return script, package


def compile_libraries(folder: str, model: Model) -> Files:
    optional = {"REFRESH": model.refresh, "COAST": model.coast}
    known = "".join(f"#define {name}\n" for name, entry in optional.items() if entry).encode()
    entry = known + (ROOT / "runtime" / "native" / "library.c").read_bytes()
    try:
        platforms = [platform for platform, _ in LIBRARIES.values()]
        kernel = kernel_c_source(folder)
        made = link_for_platforms(platforms, "kernel", kernel, {"library.c": entry})
        require_right_bits(model, made)
    except CannotExport as reason:
        warn_once(f"the FMUs of the form fmi2-python will run in pure Python: {reason}")
        return {}
    return {library: made[name] for name, library in LIBRARIES.values() if name in made}


def require_right_bits(model: Model, made: Mapping[str, bytes]) -> None:
    """Check the bits of a kernel by the machine's own compiler: native forms check themselves."""
    name = platform_of_this_machine()
    if name not in made or not own_compiler_command(name):
        return
    with tempfile.TemporaryDirectory(prefix="vibroimpact-", ignore_cleanup_errors=True) as place:
        library = Path(place) / f"kernel{PLATFORMS[name].suffix}"
        library.write_bytes(made[name])
        if not has_right_bits(model, library):
            raise CannotExport("the machine's own C compiler changes the kernel's last digits")


def build_with_pythonfmu(script: Path, package: Path, built: Path) -> Files:
    command = [sys.executable, "-m", __name__, str(script), str(package), str(built)]
    done = subprocess.run(command, cwd=ROOT.parent, capture_output=True, text=True)
    if done.returncode != 0:
        reason = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
        raise RuntimeError(f"pythonfmu could not build {script.stem}: {reason}")
    with zipfile.ZipFile(built) as archive:
        names = [name for name in archive.namelist() if not name.endswith("/")]
        return {name: archive.read(name) for name in names if "__pycache__" not in name}


if __name__ == "__main__":
    from pythonfmu.builder import FmuBuilder

    FmuBuilder.build_FMU(sys.argv[1], dest=sys.argv[3], project_files=[sys.argv[2]])
