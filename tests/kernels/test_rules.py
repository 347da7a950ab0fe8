"""Rules on the source that let the kernel compile as it stands and give the same bits anywhere."""

import ast
import builtins
from pathlib import Path

import pytest

from fmu_src import kernels

FOLDER = Path(kernels.__file__).parent
# which runs at import only
SOURCES = sorted({*FOLDER.rglob("*.py")} - {FOLDER / "numerics" / "slots.py"})
PARSED = [ast.parse(path.read_text("utf-8"), feature_version=(3, 9)) for path in SOURCES]
TREES = pytest.mark.parametrize(
    "tree", PARSED, ids=[f"{path.parent.name}-{path.stem}" for path in SOURCES]
)
EXACT = {"sqrt", "floor"}  # what IEEE 754 fixes to the last bit
CALLABLE = {"abs", "min", "max", "range", "float", "int"}


def functions(tree):
    return [node for node in tree.body if isinstance(node, ast.FunctionDef)]


def test_there_is_a_kernel():
    assert len(SOURCES) >= 10


@TREES
def test_only_exact_functions_are_called(tree):
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "math":
            assert node.attr in EXACT, node.attr
    # what runs at import makes tables, of which compiled code gets the numbers
    for node in (node for function in functions(tree) for node in ast.walk(function)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            assert ast.unparse(node.func.value) == "math"
        elif isinstance(node, ast.Call) and hasattr(builtins, ast.unparse(node.func)):
            assert ast.unparse(node.func) in CALLABLE, ast.unparse(node.func)


@TREES
def test_nothing_outside_the_memory_is_kept(tree):
    for node in tree.body:
        documented = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        assert documented or isinstance(
            node, (ast.Import, ast.ImportFrom, ast.Assign, ast.FunctionDef)
        )
    for function in functions(tree):
        for node in ast.walk(function):
            if isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store):
                assert ast.unparse(node.value) in ("m",), ast.unparse(node)
            if isinstance(node, ast.Attribute):
                assert isinstance(node.ctx, ast.Load), ast.unparse(node)
