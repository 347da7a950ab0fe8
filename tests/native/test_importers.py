"""The native FMUs through the importer in C: numbers, instances, threads, calls in any order."""

import random
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests import importers

from ..fmu.driver import PAIRS
from ..fmu.programs.driver import COMMON, harmonic, open_fmu
from ..sparing import ordinary

HERE = Path(__file__).parent
VALGRIND = ("valgrind", "-q", "--error-exitcode=9", "--leak-check=full")
VALGRIND += ("--errors-for-leak-kinds=all", "--show-leak-kinds=all")
SANITIZERS = {"address": importers.SANITIZE, "thread": ("-fsanitize=thread",)}
RANDOM = ("random", 7, 100)


def uneven_times(end):
    draw = random.Random(2)
    return sorted({0.0, end, *(draw.uniform(0.0, end) for _ in range(300))})


def clean(done):
    """No check failed, and no tool that watches has anything to say."""
    assert " FAILURES 0" in done.stdout
    assert done.stderr == ""


@pytest.mark.parametrize(
    "values", [{**harmonic(1.13), "e": 0.9, "m2": 1.7, "d1": 0.03}, {"bonded": True}]
)
def test_numbers_are_those_of_fmpy(importer, fmus, values):
    times = uneven_times(200.0)
    found = importer.simulate(COMMON, times, **values)
    with open_fmu(fmus[importer.version]) as f:
        f.start(**values)
        expected = [f.get(*COMMON), *(f.step(time).get(*COMMON) for time in times[1:])]
    assert found == expected
    assert bool(values.get("bonded")) == (found[-1][COMMON.index("impact_count")] == 0.0)


def test_two_versions_in_one_process_do_not_meet(fmus, importer_of, tmp_path):
    """Loaded together, each FMU calls its own kernel and helpers: symbols are hidden."""
    one, other = importer_of("fmi2"), importer_of("fmi3")
    times = uneven_times(100.0)
    alone = one.simulate(COMMON, times, **harmonic(1.13))
    preload = {"LD_PRELOAD": str(importers.unpack_binary(fmus["fmi3"], "fmi3", tmp_path))}
    settings = importers.settings(harmonic(1.13))
    together = one.run("simulate", ",".join(COMMON), *settings, times=times, env=preload)
    assert importers.read_rows(together.stdout) == alone
    assert other.simulate(COMMON, times, **harmonic(1.13)) == alone


def test_a_thousand_instances_and_four_threads(importer):
    importer.run("many", 1000, 40, 4000)


@pytest.fixture(scope="module", params=ordinary(PAIRS, PAIRS[3:4]), ids="-".join)
def importer_of_model(request, importer_of):
    return importer_of(*request.param)


def seeds(version):
    """Inputs that the fuzzer has found to take different ways, in hexadecimal digits."""
    return (HERE / "corpus" / f"{version}.txt").read_text().split()


@pytest.mark.parametrize("every", ordinary([5, 1]))
def test_calls_in_any_order_are_survived(importer_of_model, every):
    """Drawn at random, and the fuzzer's kept inputs; each that is refused has a message."""
    count = 300 // every
    done = importer_of_model.run("random", 7, count)
    assert int(re.search(r"CHECKS (\d+) FAILURES 0", done.stdout).group(1)) > 7 * count
    lines = seeds(importer_of_model.version)[::every]
    done = importer_of_model.run("replay", text="\n".join(lines))
    assert f"PLAYED {len(lines)}\n" in done.stdout
    clean(done)
    importer_of_model.run("many", 50, 40, 200)


@pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed")
@pytest.mark.slow
def test_no_leak_and_no_error_under_valgrind_at_length(importer_of_model):
    for mode in (("random", 3, 200), ("many", 100, 40, 400)):
        clean(importer_of_model.run(*mode, under=VALGRIND, timeout=1800))


@pytest.mark.slow  # the ordinary run has valgrind
@pytest.mark.parametrize("sanitizer", SANITIZERS)
@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
def test_no_error_with_sanitizers_in_the_shim(exported, fmus, tmp_path, pair, sanitizer):
    """Address, undefined behaviour and leaks; or threads."""
    options = SANITIZERS[sanitizer]
    if not importers.own_compiler_command():
        pytest.skip("no C compiler of the machine's own: ziglang's sanitizers load from no library")
    (tmp_path / "empty.c").write_text("int main(void) { return 0; }\n")
    command = [*importers.own_compiler_command(), *options, "empty.c", "-o", "empty"]
    if subprocess.run([*map(str, command)], cwd=tmp_path, capture_output=True).returncode:
        pytest.skip("the compiler has no such sanitizer")
    importer = importers.importer_with_sanitizer(*pair, exported, tmp_path, options)
    clean(importer.run(*RANDOM, timeout=1800))
    clean(importer.run("many", 100, 40, 1000, timeout=1800))
