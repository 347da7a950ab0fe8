"""Identity of a result, by which a stale one is known: question, parameters, FMUs and code.

These three decide the numbers of a result. If one of them has changed, a stored result does
not answer the question any more, and :func:`describe_difference` says what has changed.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fmu_src.export.sources import import_statements

from .job import Job

if TYPE_CHECKING:
    from ..fmu.description import Description

PACKAGE = Path(__file__).resolve().parents[1]
ROOT = PACKAGE.name
KERNELS = ["fmu_src", "kernels"]  # of Python that runs besides the FMUs
PACKAGES_WITHOUT_NUMBERS = ("running", "cli", "show")  # packages that do not affect any number
DIGITS = 16  # hexadecimal, of a digest: short to read, and equal by chance in 2^-64


Identity = dict[str, Any]


def identity_of(job: Job, fmus: Mapping[str, Description]) -> Identity:
    identity: Identity = {
        "question": {"kind": type(job).__name__, **job.parameters()},
        "fmu": {model: fmus[model].guid for model in job.models},
        "code": digests_of_code(type(job).__module__),
    }
    restored: Identity = json.loads(json.dumps(identity))  # as it reads back from a file
    return restored


def describe_difference(stored: Identity, current: Identity) -> str:
    for part in sorted({*stored, *current}, key=lambda name: (name != "question", name)):
        line = describe_first_difference(stored.get(part), current.get(part), "")
        if line and part == "code":
            modules = format_changed_modules(stored.get(part) or {}, current.get(part) or {})
            return f"{modules} changed since"
        if line:
            return f"made by another FMU: {line}" if part == "fmu" else line
    return ""


def format_changed_modules(stored: Mapping[str, str], current: Mapping[str, str]) -> str:
    names = sorted(name for name in {*stored, *current} if stored.get(name) != current.get(name))
    shown = ", ".join(f"{name.replace('.', '/')}.py" for name in names[:3])
    return shown if len(names) <= 3 else f"{shown} and {len(names) - 3} more"


def describe_first_difference(stored: Any, current: Any, name: str) -> str:
    if stored == current:
        return ""
    if isinstance(stored, dict) and isinstance(current, dict):
        for key in sorted({*stored, *current}):
            line = describe_first_difference(stored.get(key), current.get(key), key)
            if line:
                return line
    return f"{name} = {json.dumps(stored)} there, {json.dumps(current)} here"


# -- the code that makes a result -----------------------------------------------------------------


@functools.cache
def digests_of_code(module: str) -> dict[str, str]:
    """Return digests, by name, of a package's module and of all modules that it imports in turn."""
    digests: dict[str, str] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        path = source_file(name)
        if path is not None and name not in digests:
            digests[name], imported = read_digest_and_imports(path, name)
            waiting += imported
    return dict(sorted(digests.items()))


@functools.cache
def source_file(module: str) -> Path | None:
    """Return the file of a module that may affect numbers; None of any other."""
    parts = module.split(".")
    is_ours = parts[:2] == KERNELS or (parts[0] == ROOT and len(parts) > 1)
    if not is_ours or parts[1] in PACKAGES_WITHOUT_NUMBERS:
        return None
    path = PACKAGE.parent.joinpath(*parts)
    for file in (path.with_suffix(".py"), path / "__init__.py"):
        if file.is_file():
            return file
    return None


@functools.cache
def read_digest_and_imports(path: Path, module: str) -> tuple[str, tuple[str, ...]]:
    """Return the digest of a Python file (with its C file) and the module names that it imports."""
    files = path, path.with_suffix(".c")  # what the module has compiled
    texts = [one.read_bytes().replace(b"\r\n", b"\n") for one in files if one.is_file()]
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    names = tuple(dict.fromkeys(imported_names(texts[0], package)))
    return hashlib.sha256(b"".join(texts)).hexdigest()[:DIGITS], names


def imported_names(source: bytes, package: str) -> Iterator[str]:
    """Yield the absolute names that a module imports anywhere, and of the packages around them."""
    for node in import_statements(source):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield from dotted_prefixes(alias.name)
        elif isinstance(node, ast.ImportFrom):
            parts = package.split(".")
            base = parts[: len(parts) - node.level + 1] if node.level else []
            prefix = ".".join([*base, *([node.module] if node.module else [])])
            for alias in node.names:
                yield from dotted_prefixes(f"{prefix}.{alias.name}")


def dotted_prefixes(name: str) -> Iterator[str]:
    """Yield a dotted name and its parents, shortest first: ``a``, ``a.b``, ``a.b.c``."""
    parts = name.split(".")
    for count in range(1, len(parts) + 1):
        yield ".".join(parts[:count])
