"""Small changes of the sources, each of which a fast test must notice."""

import ast
import os
import random
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
TREES = ("fmu_src", "orchestrate", "tests", "tools", "pyproject.toml", "docs", "README.md")
KERNELS = ("kernels/oscillator", "kernels/numerics")
FOLDERS = {  # of sources and of the fast tests that know them
    **{f"fmu_src/{part}": f"tests/{part}" for part in KERNELS},
    **{f"orchestrate/{part}": f"tests/orchestrate/{part}" for part in ("response", "dynamics")},
    "orchestrate/weak_drive": "tests/orchestrate/weak_drive",
}
FILES = {
    f"{source}/{name}.py": f"{tests}/test_{name}.py"
    for source, tests in FOLDERS.items()
    for name in ("roots", "impact", "contact", "series", "motion", "response", "event_function")
    + ("excitation", "maximum", "stepper", "outputs", "nodes", "secular", "restore", "elementary")
    + ("multiplicity", "peaks", "clusters", "averaged", "extremes")
    if (ROOT / source / f"{name}.py").exists() and (ROOT / tests / f"test_{name}.py").exists()
}
PAIRS = ((ast.Add, ast.Sub), (ast.Mult, ast.Div), (ast.Lt, ast.LtE), (ast.Gt, ast.GtE))
PAIRS += ((ast.Eq, ast.NotEq), (ast.And, ast.Or))
OTHER = {one: other for pair in PAIRS for one, other in (pair, pair[::-1])}
PATIENCE = 600.0  # s; who takes longer is noticed too


def mutate(node: Any) -> bool:
    """Change an operator, a sign or a number of a syntax tree in place; return whether it did."""
    if isinstance(node, ast.BinOp | ast.AugAssign | ast.BoolOp) and type(node.op) in OTHER:
        node.op = OTHER[type(node.op)]()
    elif isinstance(node, ast.Compare) and type(node.ops[0]) in OTHER:
        node.ops[0] = OTHER[type(node.ops[0])]()
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        node.op = ast.UAdd()
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
        node.value = node.value + 1 if isinstance(node.value, int) else 1.01 * node.value + 1e-3
    else:
        return False
    return True


def make_mutant(source: str, chance: random.Random) -> tuple[str, str]:
    """Return a source with one mutation, and the mutation's description."""
    tree = ast.parse(source)
    nodes: list[Any] = list(ast.walk(tree))
    chance.shuffle(nodes)
    for node in nodes:
        before = ast.unparse(node)
        if mutate(node):
            note = f"line {node.lineno}: {before} -> {ast.unparse(node)}"
            return ast.unparse(ast.fix_missing_locations(tree)), note
    raise ValueError(source)


def copy_tree(folder: Path) -> Path:
    """Copy sources and tests, to be mutated; return the copy's folder."""
    folder.mkdir()
    for name in TREES:
        copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
        copy(ROOT / name, folder / name)
    return folder


def is_noticed(folder: Path, tests: tuple[str, ...]) -> bool:
    """Run the tests on a mutant; return whether one fails or does not end."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:cacheprovider"]
    more = {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    options: Any = {"cwd": folder, "env": {**os.environ, **more}, "capture_output": True}
    try:
        done = subprocess.run([*command, *tests], **options, timeout=PATIENCE)
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
        name = chance.choice(list(FILES))
        source = (ROOT / name).read_text("utf-8")
        changed, note = make_mutant(source, chance)
        (folder / name).write_text(changed, "utf-8")
        noticed = is_noticed(folder, (FILES[name],))
        if not noticed and name.startswith("fmu_src"):
            noticed = is_noticed(
                folder, (*(f"tests/{part}" for part in KERNELS), f"--ignore={FILES[name]}")
            )
        (folder / name).write_text(source, "utf-8")
        survived += [] if noticed else [f"{name}, {note}"]
    print("\n".join(["survived:", *survived]))
    assert len(survived) <= max(1, budget // 5)


def test_a_mutant_is_another_program():
    source = "def f(x):\n    return x + 1.5 if x < 2 else -x\n"
    mutants = {make_mutant(source, random.Random(seed))[0] for seed in range(60)}
    assert source not in mutants and len(mutants) == 5
    assert "def f(x):\n    return x - 1.5 if x < 2 else -x" in mutants
