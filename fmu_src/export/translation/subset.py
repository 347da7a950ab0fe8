"""Read off the kernels' Python what the translation needs to know beforehand."""

from __future__ import annotations

import ast
import functools
import inspect
import io
import sys
import textwrap
import tokenize
from collections.abc import Sequence
from types import FunctionType, ModuleType

from ..sources import parse

Block = list[ast.stmt]


@functools.cache
def parse_function(function: FunctionType) -> tuple[ast.FunctionDef, int, str]:
    lines, first = inspect.getsourcelines(function)
    source = textwrap.dedent("".join(lines))
    tree = parse(source).body[0]
    assert isinstance(tree, ast.FunctionDef)
    return tree, first, source


def comments_of(source: str) -> dict[int, str]:
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    kind = tokenize.COMMENT
    return {token.start[0]: token.string.lstrip("# ") for token in tokens if token.type == kind}


@functools.cache
def writes_memory(function: FunctionType) -> bool:
    """Return whether a function assigns to a slot, or calls a function that does."""
    tree, _, _ = parse_function(function)
    nodes = list(ast.walk(tree))
    if any(isinstance(n, ast.Subscript) and isinstance(n.ctx, ast.Store) for n in nodes):
        return True
    module = sys.modules[function.__module__]
    called = [resolve_name(module, ast.unparse(n.func)) for n in nodes if isinstance(n, ast.Call)]
    others = [thing for thing in called if isinstance(thing, FunctionType) and thing != function]
    return any(writes_memory(other) for other in others)


def resolve_name(module: ModuleType, name: str) -> object:
    thing: object = module
    for part in name.split("."):
        thing = getattr(thing, part, None)
    return thing


@functools.cache
def imported_names(module: ModuleType) -> dict[str, tuple[str, str]]:
    """Return module and name that each imported name was defined under."""
    known: dict[str, tuple[str, str]] = {}
    if not getattr(module, "__file__", "").endswith(".py"):  # written in C, as math
        return known
    for node in parse(inspect.getsource(module)).body:
        if isinstance(node, ast.ImportFrom) and node.level:
            package = module.__name__.split(".")[: -node.level]
            source = ".".join([*package, *([node.module] if node.module else [])])
            known.update({one.asname or one.name: (source, one.name) for one in node.names})
    return known


def original_definition(module: ModuleType, name: str) -> tuple[ModuleType, str]:
    """Return the module and the name under which a constant was defined."""
    if name in imported_names(module):
        source, original = imported_names(module)[name]
        return original_definition(sys.modules[source], original)
    return module, name


def names_in(node: ast.AST) -> set[str]:
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}


def targets_of(statement: ast.stmt) -> list[ast.expr]:
    if isinstance(statement, ast.AugAssign):
        return [statement.target]
    if not isinstance(statement, ast.Assign):
        return []
    return [
        part
        for target in statement.targets
        for part in (target.elts if isinstance(target, ast.Tuple) else [target])
    ]


def assigned_targets_in(block: Block) -> list[ast.expr]:
    inside = [part for statement in block for part in ast.walk(statement)]
    statements = [part for part in inside if isinstance(part, ast.stmt)]
    return [target for statement in statements for target in targets_of(statement)]


def can_declare(statement: ast.stmt, name: str) -> bool:
    if not isinstance(statement, ast.Assign) or name in names_in(statement.value):
        return False
    return any(isinstance(one, ast.Name) and one.id == name for one in targets_of(statement))


def owner_blocks(body: Block) -> dict[str, Block]:
    """Return the innermost block that holds all uses, of each variable that is assigned."""
    paths: dict[str, list[list[Block]]] = {}
    assigned: set[str] = set()

    def visit(block: Block, path: list[Block]) -> None:
        for statement in block:
            for child in ast.iter_child_nodes(statement):
                if not isinstance(child, ast.stmt):
                    for name in names_in(child):
                        paths.setdefault(name, []).append([*path, block])
            assigned.update(t.id for t in targets_of(statement) if isinstance(t, ast.Name))
            for part in ("body", "orelse"):
                visit(getattr(statement, part, []), [*path, block])

    visit(body, [])
    return {name: innermost_shared_block(paths[name]) for name in sorted(assigned - {"_"})}


def innermost_shared_block(paths: Sequence[list[Block]]) -> Block:
    last = paths[0][0]
    for blocks in zip(*paths, strict=False):
        if any(block is not blocks[0] for block in blocks):
            break
        last = blocks[0]
    return last


def needs_temporaries(targets: Sequence[ast.expr], values: Sequence[ast.expr]) -> bool:
    """Return whether a value uses what a target before it is assigned: then all are kept first."""
    for place, target in enumerate(targets):
        for later in values[place + 1 :]:
            if isinstance(target, ast.Name) and target.id in names_in(later):
                return True
            reads = any(isinstance(part, (ast.Subscript, ast.Call)) for part in ast.walk(later))
            if isinstance(target, ast.Subscript) and reads:
                return True
    return False
