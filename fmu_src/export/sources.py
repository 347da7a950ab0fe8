"""Find the source files an FMU is made of: what a module imports, read from its syntax tree."""

from __future__ import annotations

import ast
import functools
import re
import threading
from importlib import import_module
from pathlib import Path

from ..runtime.table import Model
from .archive import content_hash, read_folder
from .errors import CannotExport

ROOT = Path(__file__).resolve().parents[1]
Files = dict[str, bytes]  # contents by name
AT_IMPORT = read_folder(ROOT)  # what this process runs, since it imports the rest later
parsing = threading.Lock()  # Python 3.11 mixes up syntax trees of two threads
IMPORT = re.compile(r"^[ \t]*((?:from [.\w]+ )?import (?:\([^)]*\)|[\w.,* \t]+))", re.MULTILINE)


def load_model(folder: str) -> Model:
    model = import_module(f"{ROOT.name}.models.{folder}.model").MODEL
    assert isinstance(model, Model)
    return model


def read_sources(*names: str) -> Files:
    return {name: (ROOT / name).read_bytes() for name in names}


def import_closure(*names: str) -> Files:
    """Return modules and all that they import from ``fmu_src``, with the packages they lie in."""
    found: Files = {}
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.update(read_sources(name))
            waiting += imported_files(name, found[name])
    return found


@functools.cache
def imported_files(name: str, source: bytes) -> tuple[str, ...]:
    """Return the files below ``fmu_src`` that run when a module is imported, or called."""
    package = name.split("/")[:-1]
    found = ["/".join([*package[:depth], "__init__.py"]) for depth in range(len(package) + 1)]
    for node in import_statements(source):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = package[: len(package) + 1 - node.level]
            base += node.module.split(".") if node.module else []
            for alias in node.names:
                found.append(module_file(*base, alias.name) or module_file(*base))
                if not found[-1]:
                    raise FileNotFoundError(f"{name}: {ast.unparse(node)} leads to no file")
    return tuple(found)


def import_statements(source: bytes) -> list[ast.stmt]:
    """Return a module's import statements, nested ones too: a tree of the rest takes long."""
    text = "\n".join(IMPORT.findall(source.decode()))
    return parse(text).body


def parse(source: str) -> ast.Module:
    with parsing:
        return ast.parse(source)


@functools.cache
def module_file(*parts: str) -> str:
    for name in ("/".join(parts) + ".py", "/".join([*parts, "__init__.py"])):
        if (ROOT / name).is_file():
            return name
    return ""


def model_sources(folder: str) -> Files:
    """Return variable table, texts and kernel of a model: all that decides its numbers."""
    return import_closure(f"models/{folder}/model.py")


def model_digest(folder: str) -> str:
    """Return the content_hash of a model, by which native forms know each other's saved states."""
    return content_hash(model_sources(folder))


def text_files(folder: str) -> Files:
    """Return what people read in a model's FMU: page, pictures, reference results, licence."""
    shared = ROOT / "models"
    names = [path.name for path in sorted(shared.iterdir()) if path.suffix in (".in", ".txt")]
    found = read_folder(shared / folder, f"models/{folder}/")
    own = {name: content for name, content in found.items() if not name.endswith(".py")}
    return {**own, **read_sources(*(f"models/{name}" for name in names))}


def require_unedited_sources() -> None:
    """Raise if a source was edited since this process began: the FMU would be made of both."""
    now = read_folder(ROOT)
    edited = sorted(name for name in {*AT_IMPORT, *now} if AT_IMPORT.get(name) != now.get(name))
    if edited:
        place = ROOT / edited[0]
        raise CannotExport(f"{place} was edited since this process began: expected a new process")


def exporter_files(name: str) -> Files:
    return {**import_closure(name), **read_folder(ROOT / "runtime" / "native", "runtime/native/")}
