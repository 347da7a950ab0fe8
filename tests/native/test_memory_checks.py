"""Every byte accounted for: valgrind over the FMU's own binary, sanitizers in its shim built anew
from the C sources.
"""

import shutil

import pytest

from tools import importers

from ..sparing import ordinary

VALGRIND = (
    "valgrind",
    "-q",
    "--error-exitcode=9",
    "--leak-check=full",
    "--errors-for-leak-kinds=all",
    "--show-leak-kinds=all",
)
MODES = [("hostile",), ("many", 20, 40, 200), ("million", 4000, "under valgrind")]


def clean(done):
    assert "FAILURES 0" in done.stdout
    assert done.stderr == ""


needs_valgrind = pytest.mark.skipif(
    shutil.which("valgrind") is None, reason="valgrind is not installed"
)


@needs_valgrind
@pytest.mark.parametrize("mode", ordinary(MODES, MODES[1:]), ids=lambda mode: mode[0])
def test_no_leak_and_no_error_under_valgrind(importer, mode):
    clean(importer.run(*mode, under=VALGRIND))


@needs_valgrind
def test_valgrind_sees_the_same_bits(importer):
    """The kernel needs no more than what valgrind's processor has: no fused multiply-add, no 80-bit
    numbers.
    """
    names, times, values = ["x1", "x2", "impact_count"], [0.0, 50.0, 200.0], {"box_frequency": 1.13}
    assert importer.simulate(names, times, under=VALGRIND, **values) == importer.simulate(
        names, times, **values
    )


@needs_valgrind
@pytest.mark.slow
def test_no_leak_and_no_error_under_valgrind_at_length(importer):
    clean(importer.run("many", 1000, 40, 4000, under=VALGRIND, timeout=1800))
    clean(importer.run("million", 1_000_000, "under valgrind", under=VALGRIND, timeout=1800))


@pytest.fixture(params=ordinary(["fmi3", "fmi2"]))
def checked(request, fmus, kernel_objects, tmp_path_factory, sanitizer):
    """Importer and rebuilt binary with a sanitizer in both."""
    version = request.param
    folder = tmp_path_factory.mktemp("checked")
    program = importers.compile_importer(
        version, fmus[version], folder / "importer", options=("-O1", "-g", *sanitizer)
    )
    return importers.Importer(
        program,
        importers.rebuild_shim(version, folder / "shim", kernel_objects, sanitizer),
        version,
    )


@pytest.fixture
def sanitizer(request, tmp_path):
    """Options of a sanitizer, checked to work here."""
    if importers.own_compiler() is None:
        pytest.skip(
            "no C compiler of the machine's own: ziglang's sanitizers do not load from a library"
        )
    (tmp_path / "empty.c").write_text("int main(void) { return 0; }\n")
    try:
        importers.run_compiler(
            [*importers.own_compiler(), *request.param, "empty.c", "-o", "empty"], tmp_path
        )
        importers.Importer(tmp_path / "empty", "", "").run()
    except AssertionError as reason:
        pytest.skip(f"the compiler has no such sanitizer: {reason}")
    return request.param


@pytest.mark.parametrize(
    "sanitizer", [importers.SANITIZE], indirect=True, ids=["address,undefined"]
)
def test_no_error_with_sanitizers_in_the_shim(checked):
    """A thousand instances and a million steps too; leaks are counted as a process ends."""
    clean(checked.run("hostile"))
    clean(checked.run("many", 1000, 40, 1000))
    clean(checked.run("million", 1_000_000))


@pytest.mark.parametrize("sanitizer", [("-fsanitize=thread",)], indirect=True, ids=["thread"])
def test_threads_do_not_meet(checked):
    clean(checked.run("many", 100, 40, 4000))


def test_no_number_is_cast_that_has_no_integer(fmus, kernel_objects, tmp_path):
    if importers.c_compiler() is None:
        pytest.skip("there is no C compiler")
    program = importers.compile_importer("fmi2", fmus["fmi2"], tmp_path / "importer")
    # traps: no library of the sanitizer is needed
    options = ("-fsanitize=float-cast-overflow", "-fsanitize-undefined-trap-on-error")
    library = importers.rebuild_shim("fmi2", tmp_path / "shim", kernel_objects, options)
    importers.Importer(program, library, "fmi2").run("hostile")
