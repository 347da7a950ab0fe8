"""Small changes of the sources, each of which a fast test must notice."""

from __future__ import annotations

import ast
import os
import random
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TREES = ("fmu_src", "orchestrate", "tests", "tools", "pyproject.toml", "docs", "README.md")
KERNEL = "fmu_src/kernels/oscillator"
TESTS = {  # which fast tests know a module
    f"{KERNEL}/{name}.py": f"tests/kernels/oscillator/test_{test}.py"
    for name, test in (
        *(("hermite", "roots"), ("roots", "roots"), ("impact", "impact"), ("contact", "contact")),
        *(("series", "series"), ("motion", "motion"), ("response", "response")),
        *(("event_function", "event_function"), ("excitation", "excitation")),
        *(("maximum", "maximum"), ("stepper", "stepper"), ("outputs", "outputs")),
        *(("nodes", "nodes"), ("secular", "secular"), ("restore", "restore")),
    )
} | {
    "fmu_src/kernels/numerics/elementary.py": "tests/kernels/numerics/test_elementary.py",
    "orchestrate/response/multiplicity.py": "tests/orchestrate/response/test_multiplicity.py",
    "orchestrate/response/peaks.py": "tests/orchestrate/response/test_peaks.py",
    "orchestrate/dynamics/clusters.py": "tests/orchestrate/dynamics/test_clusters.py",
    "orchestrate/weak_drive/averaged.py": "tests/orchestrate/weak_drive/test_averaged.py",
    "orchestrate/weak_drive/extremes.py": "tests/orchestrate/weak_drive/test_extremes.py",
}
ALL = ("tests/kernels/oscillator", "tests/kernels/numerics")
OTHER: dict[type[ast.AST], type[ast.AST]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.And: ast.Or,
    ast.Or: ast.And,
}
PATIENCE = 600.0  # s; who takes longer is noticed too


def mutable_nodes(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield the nodes of a syntax tree that can be mutated: number in a walk, and how."""
    for number, node in enumerate(ast.walk(tree)):
        if isinstance(node, (ast.BinOp, ast.AugAssign)) and type(node.op) in OTHER:
            yield number, "operator"
        elif isinstance(node, ast.Compare) and type(node.ops[0]) in OTHER:
            yield number, "comparison"
        elif isinstance(node, ast.BoolOp):
            yield number, "logic"
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            yield number, "sign"
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
            yield number, "number"


def mutate_node(tree: ast.AST, number: int) -> str:
    """Mutate a node of a syntax tree in place; return a text on where and what."""
    node = list(ast.walk(tree))[number]
    before = ast.unparse(node)
    if isinstance(node, (ast.BinOp, ast.AugAssign, ast.BoolOp)):
        node.op = OTHER[type(node.op)]()  # type: ignore[assignment]
    elif isinstance(node, ast.Compare):
        node.ops[0] = OTHER[type(node.ops[0])]()  # type: ignore[call-overload]
    elif isinstance(node, ast.UnaryOp):
        node.op = ast.UAdd()
    elif isinstance(node, ast.Constant):
        node.value = node.value + 1 if isinstance(node.value, int) else 1.01 * node.value + 1e-3
    return f"line {node.lineno}: {before} -> {ast.unparse(node)}"  # type: ignore[attr-defined]


def make_mutant(source: str, chance: random.Random) -> tuple[str, str]:
    """Return a source with one mutation, and the mutation's description."""
    tree = ast.parse(source)
    note = mutate_node(tree, chance.choice(list(mutable_nodes(tree)))[0])
    return ast.unparse(ast.fix_missing_locations(tree)), note


def copy_tree(folder: Path) -> Path:
    """Copy sources and tests, to be mutated; return the copy's folder."""
    for name in TREES:
        source = ROOT / name
        if source.is_dir():
            ignored = shutil.ignore_patterns("__pycache__", "*.png")
            shutil.copytree(source, folder / name, ignore=ignored)
        else:
            shutil.copy(source, folder / name)
    return folder


def is_noticed(folder: Path, tests: tuple[str, ...]) -> bool:
    """Run the tests on a mutant; return whether one fails or does not end."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:cacheprovider"]
    surroundings = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        done = subprocess.run(
            [*command, *tests],
            cwd=folder,
            env=surroundings,
            capture_output=True,
            timeout=PATIENCE,
        )
    except subprocess.TimeoutExpired:
        return True
    return done.returncode != 0


@pytest.mark.slow
@pytest.mark.budget(1)  # mutants
def test_mutants_are_noticed(seed, budget, tmp_path):
    """Survivors are listed, no failures: a bound that is larger, a step that is shorter give the
    same root later, not another one. But most have to be noticed.
    """
    chance, survived = random.Random(seed), []
    folder = copy_tree(tmp_path / "copy")
    for _ in range(budget):
        name = chance.choice(list(TESTS))
        source = (ROOT / name).read_text("utf-8")
        changed, note = make_mutant(source, chance)
        (folder / name).write_text(changed, "utf-8")
        noticed = is_noticed(folder, (TESTS[name],))
        if not noticed and name.startswith("fmu_src"):
            noticed = is_noticed(folder, (*ALL, f"--ignore={TESTS[name]}"))
        (folder / name).write_text(source, "utf-8")
        survived += [] if noticed else [f"{name}, {note}"]
    print("\n".join(["survived:", *survived]))
    assert len(survived) <= max(1, budget // 5)


def test_a_mutant_is_another_program():
    source = "def f(x):\n    return x + 1.5 if x < 2 else -x\n"
    mutants = {make_mutant(source, random.Random(seed))[0] for seed in range(60)}
    assert source not in mutants and len(mutants) == 5
    assert "def f(x):\n    return x - 1.5 if x < 2 else -x" in mutants
