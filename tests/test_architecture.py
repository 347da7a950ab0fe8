"""The house in order: each floor knows only those below it, dynamic imports counted.

An import is seen wherever it stands: at the top, inside a function, by ``import_module``, or as the
name of a module of ours in a string (``python -m ...``, an entry point). An import by a name that
is put together at run time cannot be read, so it is not allowed outside the places named here.
"""

import ast
import functools
import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
OURS = ("fmu_src", "orchestrate", "tools")
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
    "constants": set(),
    "errors": set(),
    "flags": set(),
    "lazy": set(),
    "version": set(),
    "files": {"errors"},
    "reader_child": {"errors"},
    "reader_process": {"errors"},
    "temporary": {"files"},
    "units": {"constants", "errors"},
    "model": GROUND - {"model"},
    "fmu": GROUND,
    "running": GROUND,
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
    | {"__init__", "dynamics", "laboratory", "weak_drive", "diagnosis", "show", "paper"}
    | {"explorer"},
    "__main__": {"cli", "errors"},
}
PARTS: dict[str, set[str]] = {  # and of fmu_src
    "kernels.numerics": set(),
    "kernels.oscillator": {"kernels.numerics"},
    "kernels.motor_shaker": {"kernels.numerics"},
    "kernels.electrodynamic_shaker": {"kernels.numerics"},
    "kernels.deviations": {"kernels.numerics", "kernels.oscillator"},
    "kernels.orbits": {"kernels.numerics", "kernels.oscillator"},
    "runtime": set(),
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
    """Syntax tree of a source file."""
    return ast.parse((ROOT / file).read_text(encoding="utf-8"), file)


def module_name(file: str) -> str:
    """Dotted name of a source file's module."""
    return file.removesuffix("i").removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def called(node: ast.AST) -> str:
    """Name of the function in a call."""
    if not isinstance(node, ast.Call):
        return ""
    return getattr(node.func, "attr", getattr(node.func, "id", ""))


def docstrings(tree: ast.AST) -> set[ast.AST]:
    """The nodes that are docstrings."""
    found: set[ast.AST] = set()
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and isinstance(body[0], ast.Expr):
            found.add(body[0].value)
    return found


def imports(tree: ast.Module, file: str) -> Iterator[str]:
    """Absolute names of all that a file imports, wherever and however."""
    package = file.split("/")[:-1]
    texts = docstrings(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            stem = ".".join([*base, *([node.module] if node.module else [])])
            yield from (f"{stem}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Constant) and node not in texts:
            yield from named(node.value)
        if called(node) in ("import_module", "__import__"):
            yield from dynamic(node)  # type: ignore[arg-type]


def named(value: object) -> Iterator[str]:
    """The module of ours that a string names, as in ``-m orchestrate.cli`` or an entry point."""
    name = value.partition(":")[0] if isinstance(value, str) else ""
    words = name.split(".")
    if (
        len(words) > 1
        and words[0] in (*OURS, "tests")
        and all(word.isidentifier() for word in words)
    ):
        yield name


def dynamic(call: ast.Call) -> Iterator[str]:
    """What ``import_module`` imports; ``?`` where that cannot be read."""
    argument = call.args[0] if call.args else None
    yield argument.value if isinstance(argument, ast.Constant) else "?"


@functools.cache
def imports_of(file: str) -> frozenset[str]:
    """Absolute names of all that a source file imports."""
    return frozenset(imports(tree_of(file), file))


def uses(file: str, package: str) -> bool:
    """Whether a file imports a package."""
    names = imports_of(file)
    return any(name == package or name.startswith(f"{package}.") for name in names)


def users(package: str) -> set[str]:
    """The files that import a package."""
    return {file for file in FILES if uses(file, package)}


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
        "def k():\n    'orchestrate.paper'\n"
    )
    found = set(imports(ast.parse(text), "orchestrate/show/x.py"))
    expected = {"a.b", "c.d", "orchestrate.e.f", "orchestrate.show.g", "i", "j", "?"}
    assert found == expected | {"orchestrate.cli"}
    assert len(FILES) > 80


def expect_none(wrong: Callable[[str], object], files: Iterable[str] = FILES) -> None:
    """Fail with what is wrong in each of the files."""
    assert {file: found for file in files if (found := wrong(file))} == {}


@pytest.mark.parametrize(("root", "below"), [("orchestrate", FLOORS), ("fmu_src", PARTS)])
def test_a_floor_knows_only_those_below(root, below):
    def too_high(file):
        mine = part_of(module_name(file))
        known = {part_of(n) for n in imports_of(file) if n.split(".")[0] == root}
        return known - below.get(mine, set()) - {mine, "" if root == "fmu_src" else mine}

    expect_none(too_high, [file for file in FILES if file.startswith(f"{root}/")])


def test_the_fmus_know_nothing_of_their_use():
    assert not {file for file in users("orchestrate") if file.startswith("fmu_src/")}


def test_tests_are_known_to_tests_alone():
    """What tests and tools share lies below ``tools``."""
    assert users("tests") == {"tools/c_host.py"}  # the benchmark's host is an importer of tests


def test_the_sources_of_the_fmus_are_known_in_eight_places():
    found = {file for file in users("fmu_src") if file.startswith("orchestrate/")}
    access = {f"orchestrate/fmu/{name}.py" for name in ("c_library", "exported", "webassembly")}
    rules = {"orchestrate/response/multiplicity.py", "orchestrate/dynamics/closed_form.py"}
    identity = "orchestrate/running/identity.py"
    assert found == {
        *access,
        *rules,
        identity,
        "orchestrate/model/ranges.py",
        "orchestrate/version.py",
    }


PAGE = {  # modules of the explorer's page by what they are for; a new one needs a decision
    "drawing and sound": {
        *("animation", "audio", "basin_view", "chart", "diagram_view", "motion_view", "overlay"),
        *("pen", "picture", "scale", "theme", "waveform"),
    },
    "units of a structure that is entered": {"excitation", "structure", "units"},
    "calls of the compiled loops": {"coupled", "kernel", "model"},
    "what is asked, in which order": {
        *("basin", "diagram", "motion", "payload", "regions", "requests", "response", "tasks"),
        *("worker", "worker_pool"),
    },
    "input, words and files": {
        *("app", "basin_panel", "caption", "command", "controls", "diagram_input", "drive_panel"),
        *("field", "files", "inspector", "link", "main", "opening", "player", "saving", "shaking"),
        *("response_words", "tables", "tour_panel"),
    },
}
FUNCTIONS_OF_PAGE = {  # of Math: axes, dots, swinging box, clicks, natural frequencies
    **{"scale": {"log", "log10"}, "diagram": {"log10"}, "animation": {"sin"}},
    **{"waveform": {"sqrt", "exp", "sin"}, "structure": {"sqrt"}},
    "diagram_view": {"sqrt"},
}
PRODUCTS = {  # how many products, quotients and powers: places in arrays, axes, starts, units
    **{"app": 10, "basin": 14, "basin_panel": 6, "caption": 10, "command": 21, "controls": 3},
    **{"coupled": 7, "diagram": 13, "diagram_input": 3, "drive_panel": 13, "inspector": 2},
    **{"kernel": 32, "model": 7, "motion": 3, "opening": 5, "payload": 5, "player": 5},
    **{"regions": 5, "requests": 3, "response": 2, "shaking": 6, "tables": 6, "tasks": 3},
    **{"response_words": 8},
}
COMMENT_OR_TEXT = re.compile(r"/\*[\s\S]*?\*/|//[^\n]*|\"[^\"\n]*\"")
MATHEMATICS = re.compile(r"\bMath\.(?!abs|ceil|floor|max|min|PI|round|sign)(\w+)")
PARAMETERS = re.compile(r"\b(?:m1|m2|k1|k2|d1|d2|gamma|e_slope)\b|\.clearance\b")
OF_STATES = re.compile(r"\bstates?\[[^\]]*\]\s*[-+*/]|[-+*/]\s*(?:\w+\.)?states?\[")
EXPORTS = re.compile(r"\bcalls\b|\.exports\b")
PRODUCT = re.compile(r"[\w)\]](?<!yield)(?<!function)(?<!import)\s*[*/%]{1,2}\s*(?=[\w(])")


def model_arithmetic(name: str, source: str) -> set[str]:
    """What a module of the page may not have: arithmetic of the model.

    - Functions of Math beyond rounding and comparison, but for axes, sound and units.
    - Parameters of the structure, but where units are: no equation of motion does without.
    - Sums and products of states, but where they are drawn.
    - Functions of the compiled loops, but where they are called for all others.
    - More products than are counted, but where units are and where something is drawn.
    """
    code = COMMENT_OR_TEXT.sub("", source)
    drawing, units, calls = list(PAGE.values())[:3]
    found = set(MATHEMATICS.findall(code)) - FUNCTIONS_OF_PAGE.get(name, set())
    for rule, allowed in ((PARAMETERS, units), (OF_STATES, drawing), (EXPORTS, calls)):
        found |= set() if name in allowed else set(rule.findall(code))
    products = PRODUCT.findall(code)
    too_many = name not in drawing | units and len(products) > PRODUCTS.get(name, 0)
    return found | (set(products) if too_many else set())


def modules_of_page() -> dict[str, str]:
    folder = ROOT / "orchestrate/explorer/page"
    return {file.stem: file.read_text(encoding="utf-8") for file in folder.glob("*.js")}


def test_the_page_computes_nothing_of_the_model():
    texts = modules_of_page()
    named = [name for names in PAGE.values() for name in names]
    assert sorted(named) == sorted(texts)
    found = {name: model_arithmetic(name, text) for name, text in texts.items()}
    assert {name: wrong for name, wrong in found.items() if wrong} == {}


@pytest.mark.parametrize(
    "line",
    [
        "const swing = Math.hypot(stiffness - mass * square, damping * frequency);",
        "const force = -(s.k1 * x1 + s.d1 * v1) / s.m1;",
        "const { k1, m1 } = structure;",
        "const gap = states[4 * i + 1] - states[4 * i];",
        "const preload = Math.max(0, -structure.clearance);",
        "instance.library.calls.begin(instance.own, task, 0);",
        "const energy = 0.5 * mass * speed * speed;",
        "const speed = (next - last) / step;",
    ],
)
def test_arithmetic_of_the_model_is_seen(line):
    """Inserted in any module that neither draws nor converts units."""
    drawing, units, calls = list(PAGE.values())[:3]
    for name, text in modules_of_page().items():
        if name not in drawing | units | calls:
            assert model_arithmetic(name, f"{text}\n{line}"), name
            assert not model_arithmetic(name, f'{text}/** {line} */ const text = "s.k1 * x";')


def test_imports_can_be_read():
    assert {file for file in FILES if "?" in imports_of(file)} <= DYNAMIC


def test_a_package_of_others_is_known_in_one_place():
    for package, places in ONLY_IN.items():
        assert [file for file in users(package) if not file.startswith(places)] == [], package


MODULES = {module_name(file): file for file in FILES}


def imported_files(file: str) -> set[str]:
    """Files of ours that a file imports anywhere, for the type checker alone too."""
    names = (name if name in MODULES else name.rpartition(".")[0] for name in imports_of(file))
    return {MODULES[name] for name in names if name in MODULES} - {file}


def circles(graph: dict[str, set[str]]) -> list[set[str]]:
    """Groups of nodes of which each is reached from every other of the group."""

    def reached(start: str) -> set[str]:
        seen: set[str] = set()
        waiting = [start]
        while waiting:
            new = graph[waiting.pop()] - seen
            seen |= new
            waiting += new
        return seen

    beyond = {node: reached(node) for node in graph}
    groups = {
        frozenset(other for other in beyond[node] if node in beyond[other])
        for node in graph
        if node in beyond[node]
    }
    return [set(group) for group in groups]


def test_no_files_import_each_other_in_a_circle():
    graph = {file: imported_files(file) for file in FILES}
    assert "orchestrate/errors.py" in graph["orchestrate/cli/__init__.py"]
    assert circles(graph) == []


def test_families_of_commands_do_not_know_each_other():
    families = {"responses", "dynamics", "weak_drive", "laboratory", "diagnosis", "pages"}
    for family in families:
        file = f"orchestrate/cli/{family}.py"
        names = {n.split(".")[2] for n in imports_of(file) if ".cli." in n}
        assert not names & families, file


def test_a_kernel_imports_math_and_its_own_modules_alone():
    for file in FILES:
        if file.startswith("fmu_src/kernels/"):
            names = imports_of(file)
            assert all(n == "math" or n.startswith("fmu_src.kernels.") for n in names), file


def definitions(tree: ast.AST) -> Iterator[ast.AST]:
    """Public functions, methods and classes, those inside functions left out."""
    stack: list[ast.AST] = [tree]
    while stack:
        parent = stack.pop()
        for node in ast.iter_child_nodes(parent):
            if isinstance(node, ast.ClassDef):
                stack.append(node)
            if not isinstance(node, (*FUNCTIONS, ast.ClassDef)) or node.name.startswith("_"):
                continue
            if ast.get_docstring(node) or node.name not in OVERRIDDEN or not is_derived(parent):
                yield node


OVERRIDDEN = {  # methods of base classes: that of a derived class has the same docstring
    *("items", "count", "dataset", "call_text", "get_state", "set_state"),
    *("voltage", "trend", "duration", "begin", "point", "limits", "usual_rate"),
    *("ask", "summary", "draw", "words", "has_picture"),
    *("label", "description", "frequency", "phase", "level", "location_tolerances"),
}


def is_derived(node: ast.AST) -> bool:
    """Whether a class has a base of our own."""
    bases = [ast.unparse(base) for base in getattr(node, "bases", [])]
    return not {"ABC", "NamedTuple", "Protocol"} >= set(bases)


FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


@functools.cache
def functions_of(file: str) -> list[ast.FunctionDef | ast.AsyncFunctionDef]:
    """All functions of a file."""
    return [node for node in ast.walk(tree_of(file)) if isinstance(node, FUNCTIONS)]


def code_lines(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Lines of a function's body below its docstring."""
    first = node.body[1:2] if ast.get_docstring(node) is not None else node.body
    return (node.end_lineno or 0) - first[0].lineno + 1 if first else 0


def test_functions_are_short():
    expect_none(lambda file: [n.name for n in functions_of(file) if code_lines(n) > 45])


def test_modules_classes_and_the_public_face_have_docstrings():
    """An internal function whose name says it all needs none."""

    def bare(file):
        tree = tree_of(file)
        face = [node for node in tree.body if getattr(node, "name", None) in PUBLIC]
        needed = [n for n in definitions(tree) if isinstance(n, ast.ClassDef)]
        needed += definitions(ast.Module(face, []))
        names = [node.name for node in needed if not ast.get_docstring(node)]
        return names + ["the module"] * (not ast.get_docstring(tree))

    expect_none(bare)


def described(docstring: str | None) -> list[str] | None:
    """Names in the ``Parameters`` section of a numpydoc docstring, None without one."""
    lines = (docstring or "").splitlines()
    heads = zip(lines[:-1], lines[1:], strict=True)
    begin = next(
        (i for i, (a, b) in enumerate(heads) if a == "Parameters" and b.startswith("---")), None
    )
    if begin is None:
        return None
    names: list[str] = []
    for line, after in zip(lines[begin + 2 :], [*lines[begin + 3 :], ""], strict=True):
        if after.startswith("---"):
            break
        if line and not line.startswith(" "):
            names += [name.strip().lstrip("*") for name in line.split(" : ")[0].split(",")]
    return names


def is_made(value: ast.AST | None) -> bool:
    """Whether a dataclass's field is no argument: ``field(init=False)``."""
    words = value.keywords if isinstance(value, ast.Call) else []
    return any(word.arg == "init" and ast.unparse(word.value) == "False" for word in words)


def taken(node: ast.AST) -> list[str]:
    """Names of the arguments of a function or a constructor, or of a dataclass's fields."""
    if isinstance(node, ast.ClassDef):
        own = [part for part in node.body if isinstance(part, FUNCTIONS)]
        made = next((part for part in own if part.name == "__init__"), None)
        if made is None:
            fields = (part for part in node.body if isinstance(part, ast.AnnAssign))
            fields = (part for part in fields if not is_made(part.value))
            return [part.target.id for part in fields if isinstance(part.target, ast.Name)]
        node = made
    given = node.args  # type: ignore[attr-defined]
    every = [*given.posonlyargs, *given.args, *filter(None, [given.vararg])]
    every += [*given.kwonlyargs, *filter(None, [given.kwarg])]
    return [argument.arg for argument in every if argument.arg not in ("self", "cls")]


FACE = (ROOT / "orchestrate" / "__init__.pyi").read_text(encoding="utf-8")
PUBLIC = set(re.findall(r" as (\w+)$", FACE, re.MULTILINE)) | {"Running", "ExcitationSignal"}


def test_described_parameters_are_the_arguments():
    def wrong(file):
        nodes = [(n, described(ast.get_docstring(n))) for n in definitions(tree_of(file))]
        return [n.name for n, names in nodes if names is not None and names != taken(n)]

    expect_none(wrong)


PACKAGES = sorted(
    file
    for file in FILES
    if file.startswith(("orchestrate/", "fmu_src/")) and file.endswith("__init__.py")
)


def listed_modules(file: str) -> list[str] | None:
    """Modules in the table of a package's docstring; None where there is no table."""
    text = ast.get_docstring(tree_of(file)) or ""
    if not re.search(r"^=+  =+\nmodule +\S", text, re.MULTILINE):
        return None
    return re.findall(r"^:mod:`\.(\w+)` ", text, re.MULTILINE)


def test_tables_of_modules_are_complete():
    tables = {file: modules for file in PACKAGES if (modules := listed_modules(file)) is not None}
    assert len(tables) >= 10
    for file, modules in tables.items():
        folder = (ROOT / file).parent
        there = {path.stem for path in folder.glob("*.py")} - {"__init__"}
        there |= {path.parent.name for path in folder.glob("*/__init__.py")}
        assert sorted(modules) == sorted(there)
