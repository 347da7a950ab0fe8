"""All models under calls drawn at random, in every build that watches memory; and how much of the
shim all hostile tests together reach.
"""

import hashlib
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from fmu_src.export import forms
from tools import importers

from ..sparing import ordinary
from .conftest import VERSIONS
from .test_memory_checks import VALGRIND, needs_valgrind

HERE = Path(__file__).parent
MODELS = tuple(forms.MODELS)
SECONDS = int(os.environ.get("FUZZ_SECONDS", "600"))  # of the coverage-guided fuzzer, each
CORPUS = Path(os.environ["FUZZ_CORPUS"]) if "FUZZ_CORPUS" in os.environ else None  # kept there
SHIM = ("core.c", "fmi2.c", "fmi3.c", "fmi3_absent.c")


PAIRS = [
    pytest.param((version, model), marks=[pytest.mark.slow] * (model != "MotorShaker"))
    for version in VERSIONS
    for model in MODELS
]


@pytest.fixture(scope="module", params=PAIRS, ids="-".join)
def importer_of_model(request, exported, fmus, tmp_path_factory):
    """The importer compiled for a model in an FMI version, and the FMU's own binary."""
    version, model = request.param
    if importers.own_compiler() is None:
        pytest.skip("there is no C compiler")
    path, folder = exported / version / f"{model}.fmu", tmp_path_factory.mktemp("model")
    program = importers.compile_importer(version, path, folder / "importer")
    return importers.Importer(program, importers.unpack_binary(path, version, folder), version)


def seeds(version):
    """Inputs that the fuzzer has found to take different ways, in hexadecimal digits."""
    return (HERE / "corpus" / f"{version}.txt").read_text().split()


@pytest.mark.parametrize("count", ordinary([100, 300]))
def test_calls_drawn_at_random_are_survived(importer_of_model, count):
    """And each that is refused has a message."""
    done = importer_of_model.run("random", 7, count)
    assert int(re.search(r"CHECKS (\d+) FAILURES 0", done.stdout).group(1)) > 7 * count


@pytest.mark.parametrize("every", ordinary([3, 1]))
def test_what_the_fuzzer_found_is_survived(importer_of_model, every):
    """Its kept inputs, in the FMU's own binary."""
    lines = seeds(importer_of_model.version)[::every]
    done = importer_of_model.run("replay", text="\n".join(lines))
    assert f"PLAYED {len(lines)}\n" in done.stdout and " FAILURES 0" in done.stdout


def test_a_drive_in_many_instances_threads_and_steps(importer_of_model):
    """What the oscillator is put through elsewhere; hostile calls and forged states."""
    if importer_of_model.library.stem == "TwoMassImpactOscillator":
        pytest.skip("in test_importers")
    done = importer_of_model.run("hostile")
    assert int(re.search(r"CHECKS (\d+) FAILURES 0", done.stdout).group(1)) > 30_000
    importer_of_model.run("many", 50, 40, 200)
    importer_of_model.run("million", 50_000)
    done = importer_of_model.run("forge")
    assert int(re.search(r"TAKEN (\d+)\n.* FAILURES 0", done.stdout).group(1)) > 500


@needs_valgrind
@pytest.mark.slow
def test_no_leak_and_no_error_under_valgrind(importer_of_model):
    for mode in (
        ("hostile",),
        ("random", 3, 200),
        ("many", 20, 40, 200),
        ("million", 2000, "under valgrind"),
    ):
        done = importer_of_model.run(*mode, under=VALGRIND, timeout=1800)
        assert "FAILURES 0" in done.stdout and done.stderr == ""


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("sanitizer", [importers.SANITIZE, ("-fsanitize=thread",)], ids=["a", "t"])
def test_no_error_with_sanitizers_in_the_shim(exported, fmus, tmp_path, version, model, sanitizer):
    """Address, undefined behaviour and leaks; or threads."""
    importer = importers.importer_with_sanitizer(version, model, exported, tmp_path, sanitizer)
    for mode in (
        ("hostile",),
        ("random", 5, 2000),
        ("many", 50, 40, 400),
        ("million", 20_000, "checked"),
        ("forge",),
    ):
        done = importer.run(*mode, timeout=1800)
        assert "FAILURES 0" in done.stdout and done.stderr == ""


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("gcov") is None, reason="gcov is not installed")
@pytest.mark.parametrize("version", VERSIONS)
def test_the_hostile_tests_reach_the_whole_shim(exported, fmus, tmp_path, version):
    """More than 95 % of lines and of branches taken, all models together; the rest is printed."""
    lines, branches, left = {}, {}, []
    for model in MODELS:
        folder = tmp_path / model
        importer = importers.importer_with_sanitizer(
            version, model, exported, folder, ("--coverage",)
        )
        importer.run("random", 11, 4000, timeout=1800)
        importer.run("many", 50, 40, 400)
        importer.run("forge")
        importer.run("hostile")
        if model == "TwoMassImpactOscillator":
            importer.run("simulate", "x1", "e=0.5", times=[0.0, 1.0])
            importer.run("corrupt", 64, "nan")
        for unit in importers.shim_files(version):
            importers.read_coverage(folder / "shim", unit, lines, branches)
    for found, what in ((lines, "lines"), (branches, "branches")):
        left += [key for key, taken in found.items() if not taken]
        share = sum(found.values()) / len(found)
        print(f"{version}: {what} {100 * share:.1f} % of {len(found)}")
        assert share > 0.95, left
    print("\n".join(map(str, left)))


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("clang") is None, reason="clang is not installed")
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("version", VERSIONS)
def test_a_coverage_guided_fuzzer_finds_nothing(exported, fmus, tmp_path, version, model):
    """libFuzzer with its sanitizers in the shim, for FUZZ_SECONDS (600 by default) each."""
    path, guards = exported / version / f"{model}.fmu", "address,undefined"
    folder, number = tmp_path / "fuzzer", version[-1]
    importers.compile_importer(version, path, folder)  # leaves the headers there
    library = importers.rebuild_shim(
        version,
        tmp_path / "shim",
        importers.kernel_objects(model),
        (f"-fsanitize=fuzzer-no-link,{guards}", "-fno-sanitize-recover=all"),
        forms.MODELS[model],
        ("clang",),
    )
    units = [importers.HERE / f"{unit}.c" for unit in ("importer", f"fuzz{number}", "fuzz")]
    options = ["-std=gnu11", "-O1", "-g", f"-fsanitize=fuzzer,{guards}", f"-I{folder}"]
    command = [
        "clang",
        *options,
        HERE / "fuzzer.c",
        f"-I{importers.HERE}",
        *units,
        "-ldl",
        "-lm",
        "-o",
        "fuzzer",
    ]
    importers.run_compiler(command, folder)
    corpus = CORPUS / f"{version}-{model}" if CORPUS else folder / "corpus"
    corpus.mkdir(parents=True, exist_ok=True)
    for line in seeds(version):
        (corpus / hashlib.sha1(bytes.fromhex(line)).hexdigest()).write_bytes(bytes.fromhex(line))
    limits = [f"-max_total_time={SECONDS}", "-max_len=512", "-timeout=60", "-print_final_stats=1"]
    done = subprocess.run(
        ["./fuzzer", corpus, *limits],
        cwd=folder,
        env={**os.environ, "FMU_BINARY": str(library)},
        capture_output=True,
        text=True,
    )
    print("\n".join(done.stderr.splitlines()[-12:]))
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]
