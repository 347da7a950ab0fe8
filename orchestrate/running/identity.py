"""What a stored result answers: the question with all its parameters, the FMUs, and the code.

Three things decide the numbers of a result. Where one of them has changed, a stored result does
not answer the question any more, and :func:`difference` says what has changed.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Protocol

from .job import Job

PACKAGE = Path(__file__).resolve().parents[1]
ROOT = PACKAGE.name
NUMBERLESS = ("running", "cli", "figures")  # packages that decide no number
DIGITS = 16


class Fmu(Protocol):
    """What is asked of an FMU's description."""

    @property
    def path(self) -> Path:
        """Its file."""

    @property
    def name(self) -> str:
        """Its model name."""

    @property
    def guid(self) -> str:
        """Its GUID, or instantiation token."""

    @property
    def fmi_version(self) -> str:
        """Such as 3.0."""


Identity = dict[str, Any]


def identity_of(job: Job, fmus: Mapping[str, Fmu], known: Mapping[str, Identity]) -> Identity:
    """What a job's result answers.

    Parameters
    ----------
    job : Job
    fmus : mapping
        By model name.
    known : mapping
        Identities of the jobs it needs, by name.
    """
    found: Identity = {
        "question": {"kind": type(job).__name__, **job.parameters()},
        "fmu": {model: fmus[model].guid for model in job.models},
        "code": code_of(type(job).__module__),
    }
    if job.needs():
        found["from"] = {name: fingerprint(known[name]) for name in job.needs()}
    return normal(found)


def normal(identity: Identity) -> Identity:
    """An identity as it comes back from disk."""
    found: Identity = json.loads(json.dumps(identity))
    return found


def fingerprint(identity: Identity) -> str:
    """A short name for an identity."""
    return hashlib.sha256(json.dumps(identity, sort_keys=True).encode()).hexdigest()[:DIGITS]


def difference(found: Identity, wanted: Identity) -> str:
    """Where two identities differ, as a phrase; empty where they do not."""
    for part in sorted(set(found) | set(wanted), key=lambda name: (name != "question", name)):
        line = first_difference(found.get(part), wanted.get(part), "")
        if line and part == "code":
            return f"{changed(found.get(part) or {}, wanted.get(part) or {})} changed since"
        if line:
            return f"made by another FMU: {line}" if part == "fmu" else line
    return ""


def same_question(found: Identity, wanted: Identity) -> bool:
    """Whether two identities differ in code and FMU at the most."""
    return found.get("question") == wanted.get("question")


def changed(found: Mapping[str, str], wanted: Mapping[str, str]) -> str:
    """Modules that differ, by their files."""
    names = sorted(name for name in {*found, *wanted} if found.get(name) != wanted.get(name))
    shown = ", ".join(f"{name.replace('.', '/')}.py" for name in names[:3])
    return shown if len(names) <= 3 else f"{shown} and {len(names) - 3} more"


def first_difference(a: Any, b: Any, name: str) -> str:
    """The first place where two parts of an identity differ."""
    if a == b:
        return ""
    if isinstance(a, dict) and isinstance(b, dict):
        for key in sorted({*a, *b}):
            line = first_difference(a.get(key), b.get(key), key)
            if line:
                return line
    return f"{name} = {json.dumps(a)} there, {json.dumps(b)} here"


# -- the code that makes a result -----------------------------------------------------------------


def code_of(module: str) -> dict[str, str]:
    """Digests of the modules that a module of this package depends on, itself included."""
    found: dict[str, str] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        path = source_of(name)
        if name in found or path is None or name.split(".")[1:2] in [[p] for p in NUMBERLESS]:
            continue
        found[name], imported = read_source(path, name)
        waiting += imported
    return dict(sorted(found.items()))


def source_of(module: str) -> Path | None:
    """The file of a module of this package; None for all others and the package's own face."""
    parts = module.split(".")
    if parts[0] != ROOT or len(parts) == 1:
        return None
    path = PACKAGE.joinpath(*parts[1:])
    for file in (path.with_suffix(".py"), path / "__init__.py"):
        if file.is_file():
            return file
    return None


@functools.cache
def read_source(path: Path, module: str) -> tuple[str, tuple[str, ...]]:
    """Digest of a source file, and the names that it imports."""
    source = path.read_bytes().replace(b"\r\n", b"\n")
    beside = path.with_suffix(".c")  # what the module has compiled
    own = source + (beside.read_bytes().replace(b"\r\n", b"\n") if beside.is_file() else b"")
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    names = tuple(dict.fromkeys(imported_names(ast.parse(source), package)))
    return hashlib.sha256(own).hexdigest()[:DIGITS], names


def imported_names(tree: ast.AST, package: str) -> Iterator[str]:
    """Absolute names of what a module imports, wherever in it, and of the packages around."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield from prefixes(alias.name)
        elif isinstance(node, ast.ImportFrom):
            parts = package.split(".")
            base = parts[: len(parts) - node.level + 1] if node.level else []
            stem = ".".join([*base, *([node.module] if node.module else [])])
            for alias in node.names:
                yield from prefixes(f"{stem}.{alias.name}")


def prefixes(name: str) -> Iterator[str]:
    """``a``, ``a.b`` and ``a.b.c`` of ``a.b.c``: importing the last imports all."""
    parts = name.split(".")
    for count in range(1, len(parts) + 1):
        yield ".".join(parts[:count])
