"""The house in order: each floor knows only those below it, dynamic imports counted.

An import is seen wherever it stands: at the top, inside a function, by ``import_module``, or as the
name of a module of ours in a string (``python -m ...``, an entry point). An import by a name that
is put together at run time cannot be read, so it is not allowed outside the places named here.
"""

import ast
import functools
import inspect
import re
from collections.abc import Iterable, Iterator

import pytest

import orchestrate
from tests import ROOT

OURS = ("fmu_src", "orchestrate", "tools")
MODULE = re.compile(rf"({'|'.join(OURS)}|tests)(\.\w+)+")
FILES = sorted(
    path.relative_to(ROOT).as_posix()
    for name in OURS
    for path in (ROOT / name).rglob("*.py*")
    if path.suffix in (".py", ".pyi")
)
GROUND = {"constants", "errors", "files", "flags", "lazy", "temporary", "units", "version"}
GROUND |= {"model", "reader_child", "reader_process"}
BELOW_ANSWERS = GROUND | {"fmu", "running"}
FLOORS: dict[str, set[str]] = {  # what each package of orchestrate may know beside itself
    **dict.fromkeys(("constants", "errors", "flags", "lazy", "version"), set()),
    **dict.fromkeys(("files", "reader_child", "reader_process"), {"errors"}),
    "temporary": {"files"},
    "units": {"constants", "errors"},
    **dict.fromkeys(("model", "fmu"), GROUND),
    "running": GROUND | {"fmu"},
    "response": BELOW_ANSWERS,
    "dynamics": BELOW_ANSWERS | {"response"},
    "laboratory": BELOW_ANSWERS | {"response", "weak_drive"},
    "diagnosis": BELOW_ANSWERS | {"response", "laboratory"},
    "weak_drive": BELOW_ANSWERS | {"response", "dynamics"},
    "show": GROUND | {"running"},
    "paper": BELOW_ANSWERS | {"__init__", "response", "dynamics", "weak_drive", "show"},
    "__init__": BELOW_ANSWERS
    | {"response", "dynamics", "laboratory", "diagnosis", "weak_drive", "show"},
    "explorer": BELOW_ANSWERS | {"response", "dynamics", "laboratory", "weak_drive"},
    "cli": BELOW_ANSWERS
    | {"__init__", "dynamics", "laboratory", "weak_drive"}
    | {"diagnosis", "show", "paper", "explorer"},
    "__main__": {"cli", "errors"},
}
PARTS: dict[str, set[str]] = {  # and of fmu_src
    **dict.fromkeys(("kernels.numerics", "runtime"), set()),
    "kernels.oscillator": {"kernels.numerics"},
    "kernels.motor_shaker": {"kernels.numerics"},
    "kernels.electrodynamic_shaker": {"kernels.numerics"},
    "kernels.deviations": {"kernels.numerics", "kernels.oscillator"},
    "kernels.orbits": {"kernels.numerics", "kernels.oscillator"},
    "models": {"kernels.oscillator", "kernels.motor_shaker", "runtime", "version"}
    | {"kernels.electrodynamic_shaker"},
    "export": {"runtime", "kernels.repetition", "kernels.linear_response"}
    | {"kernels.numerics", "kernels.deviations", "kernels.orbits"},
}
DYNAMIC = {"orchestrate/__init__.py", "orchestrate/reader_child.py", "fmu_src/export/sources.py"}
ONLY_IN = {  # packages of others, and the one place of ours that may know them
    "fmpy": "orchestrate/fmu/",
    "matplotlib": ("orchestrate/show/", "tools/pictures/"),
    "loky": "orchestrate/running/",
    "distributed": "orchestrate/running/",
    "sqlite3": "orchestrate/running/",
    "tqdm": "orchestrate/running/",
    "argparse": "tools/",
    "cyclopts": "orchestrate/cli/",
    "platformdirs": "orchestrate/fmu/",
    "pythonfmu": ("fmu_src/export/", "fmu_src/runtime/"),
    "ziglang": "fmu_src/export/",
    "pyuff": "orchestrate/laboratory/",
}


@functools.cache
def tree_of(file: str) -> ast.Module:
    return ast.parse((ROOT / file).read_text(encoding="utf-8"), file)


@functools.cache
def nodes_of(file: str) -> list[ast.AST]:
    return list(ast.walk(tree_of(file)))


def module_name(file: str) -> str:
    return file.removesuffix("i").removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def imports(nodes: Iterable[ast.AST], file: str) -> Iterator[str]:
    """Absolute names of all that a file imports, ``?`` where that cannot be read."""
    package = file.split("/")[:-1]
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            stem = ".".join([*base, *([node.module] if node.module else [])])
            yield from (f"{stem}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Constant):
            name = node.value.partition(":")[0] if isinstance(node.value, str) else ""
            if MODULE.fullmatch(name):
                yield name  # as in ``-m orchestrate.cli`` or an entry point
        elif isinstance(node, ast.Call):
            called = getattr(node.func, "attr", getattr(node.func, "id", ""))
            if called in ("import_module", "__import__"):
                argument = node.args[0] if node.args else None
                yield argument.value if isinstance(argument, ast.Constant) else "?"


@functools.cache
def imports_of(file: str) -> frozenset[str]:
    return frozenset(imports(nodes_of(file), file))


def users(package: str) -> set[str]:
    return {f for f in FILES if any(f"{n}.".startswith(f"{package}.") for n in imports_of(f))}


def part_of(name: str) -> str:
    """The floor, or the part of ``fmu_src``, that a dotted name of ours belongs to."""
    root, *rest = name.split(".")
    if root == "orchestrate":
        return rest[0] if rest and rest[0] in FLOORS else "__init__"
    if rest[:1] == ["kernels"]:
        return ".".join(rest[:2])
    return rest[0] if rest else ""


def test_the_reader_of_imports_sees_all_kinds():
    text = (
        "import a.b\nfrom c import d\nfrom ..e import f\nfrom . import g\n"
        "def h():\n    import i\n    __import__('j')\n    import_module(f'k.{a}')\n"
        "COMMAND = ['-m', 'orchestrate.cli']\nENTRY = 'orchestrate.cli:main'\n"
    )
    found = set(imports(ast.walk(ast.parse(text)), "orchestrate/show/x.py"))
    expected = {"a.b", "c.d", "orchestrate.e.f", "orchestrate.show.g", "i", "j", "?"}
    assert found == expected | {"orchestrate.cli"}


@pytest.mark.parametrize(("root", "below"), [("orchestrate", FLOORS), ("fmu_src", PARTS)])
def test_a_floor_knows_only_those_below(root, below):
    for file in FILES:
        mine = part_of(module_name(file))
        if file.startswith(f"{root}/"):
            known = {part_of(n) for n in imports_of(file) if n.split(".")[0] == root}
            assert known <= below.get(mine, set()) | {mine, "" if root == "fmu_src" else mine}, file


def test_running_knows_fmus_by_their_type_alone():
    for file in (file for file in FILES if file.startswith("orchestrate/running/")):
        body = tree_of(file).body
        parts = [one for one in body if not ast.unparse(one).startswith("if TYPE_CHECKING:")]
        nodes = (node for one in parts for node in ast.walk(one))
        assert not {n for n in imports(nodes, file) if n.startswith("orchestrate.fmu.")}, file


def test_who_knows_the_sources_of_the_fmus_and_the_tests():
    assert not {file for file in users("orchestrate") if file.startswith("fmu_src/")}
    assert users("tests") == {"tools/benchmark.py"}  # its host in C is an importer of tests
    assert {file for file in users("fmu_src") if file.startswith("orchestrate/")} == {
        *(f"orchestrate/fmu/{name}.py" for name in ("c_library", "exported", "webassembly")),
        *("orchestrate/response/multiplicity.py", "orchestrate/dynamics/closed_form.py"),
        *("orchestrate/running/identity.py", "orchestrate/model/ranges.py"),
        "orchestrate/version.py",
    }


def test_a_package_of_others_is_known_in_one_place():
    for package, places in ONLY_IN.items():
        assert [file for file in users(package) if not file.startswith(places)] == [], package
    assert {file for file in FILES if "?" in imports_of(file)} <= DYNAMIC


def test_no_files_import_each_other_in_a_circle():
    modules = {module_name(file): file for file in FILES}
    graph = {}
    for file in FILES:
        names = (name if name in modules else name.rpartition(".")[0] for name in imports_of(file))
        graph[file] = {modules[name] for name in names if name in modules} - {file}
    assert "orchestrate/errors.py" in graph["orchestrate/cli/__init__.py"]
    while free := {file for file, known in graph.items() if not known & graph.keys()}:
        graph = {file: known for file, known in graph.items() if file not in free}
    assert not graph


def test_families_of_commands_do_not_know_each_other():
    families = {"responses", "dynamics", "weak_drive", "laboratory", "diagnosis", "pages"}
    for family in families:
        names = imports_of(f"orchestrate/cli/{family}.py")
        assert not {n.split(".")[2] for n in names if ".cli." in n} & families, family


def test_a_kernel_imports_math_and_its_own_modules_alone():
    for file in FILES:
        if file.startswith("fmu_src/kernels/"):
            names = imports_of(file)
            assert all(n == "math" or n.startswith("fmu_src.kernels.") for n in names), file


# Modules of the explorer's page that draw or make sounds, or convert the units of a structure; all
# others ask the compiled kernel, and compute nothing of the model.
DRAWING = {
    *("animation", "audio", "basin_view", "chart", "diagram_view", "motion_view", "overlay"),
    *("pen", "picture", "scale", "theme", "waveform"),
}
UNITS = {"excitation", "structure", "units"}
OF_MODEL = (
    r"\bMath\.(?!abs|ceil|floor|log10|max|min|PI|round|sign|sqrt)\w+",
    r"\b(?:m1|m2|k1|k2|d1|d2|gamma|e_slope)\b|\.clearance\b",
    r"\bstates?\[[^\]]*\]\s*[-+*/]|[-+*/]\s*(?:\w+\.)?states?\[",
)


def model_arithmetic(source: str) -> list[str]:
    """Functions of Math, parameters of the structure and sums of states in a module of the page."""
    code = re.sub(r"/\*[\s\S]*?\*/|//[^\n]*|\"[^\"\n]*\"", "", source)
    return [found for rule in OF_MODEL for found in re.findall(rule, code)]


def test_the_page_computes_nothing_of_the_model():
    pages = {file.stem: file for file in (ROOT / "orchestrate/explorer/page").glob("*.js")}
    assert pages.keys() > DRAWING | UNITS
    for name in pages.keys() - DRAWING - UNITS:
        assert model_arithmetic(pages[name].read_text(encoding="utf-8")) == [], name
    for line in ("Math.hypot(a, b)", "-(s.k1 * x1) / s.m1", "states[4 * i + 1] - states[4 * i]"):
        assert model_arithmetic(line) and not model_arithmetic(f"/** {line} */")


FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


def test_functions_are_short():
    for file in FILES:
        for node in (node for node in nodes_of(file) if isinstance(node, FUNCTIONS)):
            body = node.body[1:] if ast.get_docstring(node) is not None else node.body
            assert not body or node.end_lineno - body[0].lineno < 45, f"{file}: {node.name}"


def test_modules_and_classes_have_docstrings():
    """An internal function whose name says it all needs none."""
    for file in FILES:
        tree = tree_of(file)
        classes = (node for node in tree.body if isinstance(node, ast.ClassDef))
        for node in (tree, *classes):
            name = getattr(node, "name", "")
            assert name.startswith("_") or ast.get_docstring(node), f"{file}: {name}"


@pytest.mark.parametrize("name", orchestrate.__all__)
def test_the_described_parameters_of_the_public_face_are_its_arguments(name):
    one = getattr(orchestrate, name)
    if callable(one) and not (isinstance(one, type) and issubclass(one, Exception)):
        text = inspect.cleandoc(one.__doc__)
        section = re.search(r"^Parameters\n-+\n(.*?)(?=^\w+\n---|\Z)", text, re.M | re.S)
        heads = re.findall(r"^(\S.*?)(?: : .*)?$", section[1], re.M) if section else []
        described = [each.lstrip("*") for head in heads for each in head.split(", ")]
        has_none = isinstance(one, type) and not section  # a class may have attributes instead
        assert has_none or described == list(inspect.signature(one).parameters)


def test_tables_of_modules_are_complete():
    tables = 0
    for file in FILES:
        text = ast.get_docstring(tree_of(file)) or ""
        if file.endswith("__init__.py") and re.search(r"^=+  =+\nmodule +\S", text, re.MULTILINE):
            folder, tables = (ROOT / file).parent, tables + 1
            there = {path.stem for path in folder.glob("*.py")} - {"__init__"}
            there |= {path.parent.name for path in folder.glob("*/__init__.py")}
            listed = re.findall(r"^:mod:`\.(\w+)` ", text, re.MULTILINE)
            assert sorted(listed) == sorted(there), file
    assert tables >= 10
