"""The pythonfmu form of a model: the Python kernel inside, with its compiled form beside it where
one can be made.

Two FMUs, or an FMU and its host, share modules of the same name in one process. So everything
embedded lies in one package under a content-hashed name, the script bears the hash too, and
pythonfmu builds in a process of its own.
"""

import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import pythonfmu

from ..runtime.compiled import LIBRARIES
from .archive import fingerprint, guid_of, read_folder, write_archive
from .compile_kernel import compile_objects
from .documentation import documentation_files
from .linking import NoCompiler, link_all, say_pure_python
from .model_description import fmi2_xml

ROOT = Path(__file__).resolve().parents[1]
RUNTIME = (
    "__init__.py",
    "kernels/__init__.py",
    "models/__init__.py",
    *(f"runtime/{name}.py" for name in ("__init__", "table", "slave", "compiled")),
)
MODEL_FILES = ("__init__.py", "variables.py", "model.py")
SCRIPT = '''"""The slave of {name}; the class has to be defined here, all else is in the package."""

from pythonfmu.fmi2slave import Fmi2Slave

from {package}.runtime.slave import Slave, keep
from {package}.models.{folder}.model import MODEL

keep(globals())  # pythonfmu runs this script, then releases its namespace, which it only borrowed


class {name}(Slave, Fmi2Slave):
    """{description}."""

    model = MODEL
    fingerprint = "{digest}"
'''
BUILD = """
import sys
from pythonfmu.builder import FmuBuilder
script, package, target = sys.argv[1:]
FmuBuilder.build_FMU(script, dest=target, project_files=[package])
"""


def kernel_sources(kernel):
    """Files of a kernel, and those of other kernels that it takes (``from ..OTHER.MODULE import
    ...``), by their path below ``fmu_src``.
    """
    files = read_folder(ROOT / "kernels" / kernel, f"kernels/{kernel}/")
    text = b"\n".join(files.values()).decode()
    for other, module in sorted(
        set(re.findall(r"^from \.\.(\w+)\.(\w+) import ", text, flags=re.M))
    ):
        files.update(
            {
                f"kernels/{other}/{name}": (ROOT / "kernels" / other / name).read_bytes()
                for name in ("__init__.py", f"{module}.py")
            }
        )
    return files


def embedded_sources(kernel, folder):
    """Files of the embedded package, by their path in it."""
    files = {name: (ROOT / name).read_bytes() for name in RUNTIME}
    files.update(
        {
            f"models/{folder}/{name}": (ROOT / "models" / folder / name).read_bytes()
            for name in MODEL_FILES
        }
    )
    files.update(kernel_sources(kernel))
    return files


def source_digest(kernel, folder):
    """Fingerprint of all that decides the numbers; the GUID is made of it."""
    sources = embedded_sources(kernel, folder)
    return fingerprint(
        {**sources, "pythonfmu": pythonfmu.__version__.encode(), "script": SCRIPT.encode()}
    )


def exporters():
    """Files of the exporters: a change of theirs makes another FMU too."""
    return {**read_folder(ROOT / "export", "export/"), **read_folder(ROOT / "runtime", "runtime/")}


def guid(kernel, folder):
    """The GUID an FMU of the present sources bears."""
    return guid_of(fingerprint({**exporters(), "sources": source_digest(kernel, folder).encode()}))


def export(model, kernel, folder, target):
    """Write ``target/NAME.fmu``.

    Parameters
    ----------
    model : Model
    kernel, folder : str
        Packages below ``fmu_src``: the kernel's and the model's.
    target : Path

    Returns
    -------
    Path
        The FMU.
    """
    sources = embedded_sources(kernel, folder)
    digest = source_digest(kernel, folder)
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as scratch:
        files = run_pythonfmu(model, folder, sources, digest, Path(scratch))
    files["modelDescription.xml"] = fmi2_xml(model, guid(kernel, folder))
    files.update(documentation_files(model, ROOT / "models" / folder, digest))
    path = Path(target) / f"{model.name}.fmu"
    write_archive(path, files)
    return path


def run_pythonfmu(model, folder, sources, digest, scratch):
    """Let pythonfmu put script, package and its own binaries together; returns the archive's files."""
    package = scratch / "source" / f"fmu_{digest[:12]}"
    for name, content in sources.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_bytes(content)
    try:
        entry = (b"#define REFRESH\n" if model.refresh else b"") + (
            ROOT / "runtime" / "native" / "library.c"
        ).read_bytes()
        objects = compile_objects(f"fmu_src.models.{folder}.model")
        libraries = link_all(objects, {"library.c": entry})
        for platform, library in LIBRARIES.values():
            if platform in libraries:
                (package / library).write_bytes(libraries[platform])
    except NoCompiler as reason:
        say_pure_python(reason)
    script = scratch / "source" / f"{model.name}_{digest[:12]}.py"
    text = SCRIPT.format(
        name=model.name,
        package=package.name,
        folder=folder,
        description=model.description,
        digest=digest,
    )
    script.write_text(text, encoding="utf-8")
    built = scratch / "built.fmu"
    command = [sys.executable, "-c", BUILD, str(script), str(package), str(built)]
    done = subprocess.run(command, cwd=scratch, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(
            f"pythonfmu could not build {model.name}: {(done.stderr.strip().splitlines() or ['no reason given'])[-1]}"
        )
    with zipfile.ZipFile(built) as archive:
        return {
            name: archive.read(name)
            for name in archive.namelist()
            if not name.endswith("/") and "__pycache__" not in name
        }
