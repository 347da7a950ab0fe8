"""The house in order: imports flow one way, files and functions stay short, docstrings name what is there."""

import ast

import pytest

from .command import ROOT

FILES = sorted(path.relative_to(ROOT).as_posix() for folder in ("fmu_src", "orchestrate") for path in (ROOT / folder).rglob("*.py"))
LONGEST_FILE, LONGEST_FUNCTION = 250, 45
OPEN: dict = {}  # known, to be repaired


def files(rule):
    """All source files as test parameters, the known exceptions marked."""
    marks = {file: pytest.mark.xfail(strict=True, reason=reason) for (broken, file), reason in OPEN.items() if broken == rule}
    return [pytest.param(file, marks=marks.get(file, ())) for file in FILES]


def tree_of(file):
    """Syntax tree of a source file."""
    return ast.parse((ROOT / file).read_text(encoding="utf-8"), file)


def imports(tree, file):
    """Absolute names of all that a file imports, wherever in it."""
    package = file.removesuffix(".py").split("/")[:-1]
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            stem = ".".join([*base, *([node.module] if node.module else [])])
            found |= {f"{stem}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) in ("import_module", "__import__"):
            found |= {argument.value for argument in node.args if isinstance(argument, ast.Constant)}
    return found


def uses(file, *packages):
    """Whether a file imports one of the packages."""
    return any(name == package or name.startswith(package + ".") for name in imports(tree_of(file), file) for package in packages)


def users(*packages):
    """List the files that import one of the packages."""
    return {file for file in FILES if uses(file, *packages)}


def test_the_reader_of_imports_sees_all_kinds():
    tree = ast.parse("import a.b\nfrom c import d\nfrom ..e import f\nfrom . import g\ndef h():\n    import i\n    __import__('j')\n")
    assert imports(tree, "orchestrate/figures/x.py") == {"a.b", "c.d", "orchestrate.e.f", "orchestrate.figures.g", "i", "j"}
    assert len(FILES) > 30


def test_only_build_sees_the_sources_of_the_fmus():
    assert {file for file in users("fmu_src") if file.startswith("orchestrate/")} == {"orchestrate/build.py"}


def test_the_fmus_know_nothing_of_their_use():
    assert {file for file in users("orchestrate") if file.startswith("fmu_src/")} == set()


def test_only_fmu_py_sees_fmpy():
    assert users("fmpy") == {"orchestrate/fmu.py"}


def test_only_figures_see_matplotlib():
    assert users("matplotlib", "pylab")
    assert all(file.startswith("orchestrate/figures/") for file in users("matplotlib", "pylab"))


def test_only_export_sees_pythonfmu():
    assert users("pythonfmu")
    assert all(file.startswith(("fmu_src/export/", "fmu_src/runtime/")) for file in users("pythonfmu"))


KERNELS = {
    "fmu_src/kernels/numerics/": (),
    "fmu_src/kernels/oscillator/": ("fmu_src.kernels.oscillator.", "fmu_src.kernels.numerics."),
    "fmu_src/kernels/shaker/": ("fmu_src.kernels.shaker.", "fmu_src.kernels.numerics."),
}


@pytest.mark.parametrize(("file", "allowed"), [(file, allowed) for folder, allowed in KERNELS.items() for file in FILES if file.startswith(folder)])
def test_a_kernel_imports_math_and_itself_only(file, allowed):
    """And the elementary functions, which they share."""
    names = imports(tree_of(file), file)
    assert all(name == "math" or name.startswith(allowed) or f"{name}." in allowed for name in names), names
    assert not any(isinstance(node, ast.ImportFrom) and not node.level for node in ast.walk(tree_of(file)))  # the package is renamed in the FMU


def test_numbers_know_nothing_of_pictures_and_commands():
    names = ("sweep", "poincare", "store", "fmu", "orbit", "trace", "flow", "lyapunov", "curves", "attractors", "jobs")
    names += ("channel", "coupling", "ledger", "weakdrive", "averaged", "driveresult", "spectra", "ssp")
    below = {f"orchestrate/{name}.py" for name in names}
    assert below <= set(FILES)
    assert not below & users("orchestrate.figures", "orchestrate.commands", "orchestrate.campaign", "orchestrate.build")


def test_build_is_no_package():
    assert (ROOT / "build").is_dir()
    packages = {path.parent.name for path in ROOT.glob("*/__init__.py")}
    assert {"fmu_src", "orchestrate"} <= packages <= {"fmu_src", "orchestrate", "tests"}


@pytest.mark.parametrize("file", FILES)
def test_files_are_short(file):
    assert len((ROOT / file).read_text(encoding="utf-8").splitlines()) <= LONGEST_FILE


def definitions(tree, kinds):
    """Public functions, methods and classes, those inside functions left out."""
    stack = [tree]
    while stack:
        for node in ast.iter_child_nodes(stack.pop()):
            if isinstance(node, ast.ClassDef):
                stack.append(node)
            if isinstance(node, kinds) and not node.name.startswith("_"):
                yield node


FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


@pytest.mark.parametrize("file", files("short functions"))
def test_functions_are_short(file):
    lengths = {node.name: node.end_lineno - node.lineno + 1 for node in ast.walk(tree_of(file)) if isinstance(node, FUNCTIONS)}
    assert {name: length for name, length in lengths.items() if length > LONGEST_FUNCTION} == {}


@pytest.mark.parametrize("file", FILES)
def test_all_that_is_public_has_a_docstring(file):
    tree = tree_of(file)
    assert ast.get_docstring(tree), "the module has none"
    assert [node.name for node in definitions(tree, (*FUNCTIONS, ast.ClassDef)) if not ast.get_docstring(node)] == []


def described(docstring):
    """Names in the ``Parameters`` section of a numpydoc docstring, None without one."""
    lines = (docstring or "").splitlines()
    begin = next((i for i, line in enumerate(lines[:-1]) if line == "Parameters" and lines[i + 1].startswith("---")), None)
    if begin is None:
        return None
    names = []
    for line, after in zip(lines[begin + 2 :], [*lines[begin + 3 :], ""], strict=True):
        if after.startswith("---"):
            break
        if line and not line.startswith(" "):
            names += [name.strip().lstrip("*") for name in line.split(" : ")[0].split(",")]
    return names


def taken(node):
    """Names of the arguments of a function, or of a class's constructor."""
    if isinstance(node, ast.ClassDef):
        node = next(part for part in node.body if isinstance(part, FUNCTIONS) and part.name == "__init__")
    given = node.args
    every = [*given.posonlyargs, *given.args, *filter(None, [given.vararg]), *given.kwonlyargs, *filter(None, [given.kwarg])]
    return [argument.arg for argument in every if argument.arg not in ("self", "cls")]


def test_the_reader_of_docstrings():
    text = "Idea.\n\nParameters\n----------\na, b : int\n    Two.\n*c : str\n\nReturns\n-------\nd : int\n"
    assert described(text) == ["a", "b", "c"]
    assert described("Idea.") is None


@pytest.mark.parametrize("file", files("parameters"))
def test_described_parameters_are_the_arguments(file):
    nodes = [node for node in definitions(tree_of(file), (*FUNCTIONS, ast.ClassDef)) if described(ast.get_docstring(node)) is not None]
    wrong = {node.name: (described(ast.get_docstring(node)), taken(node)) for node in nodes}
    assert {name: pair for name, pair in wrong.items() if pair[0] != pair[1]} == {}
