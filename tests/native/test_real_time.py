"""The C inside the FMUs on a real-time target: what it takes, what it never does, and its bits."""

import re
from pathlib import Path

import pytest

from tests.real_time import footprint, targets

from ..fmu.driver import MODELS, OSCILLATOR, PAIRS, path_of
from ..sparing import ordinary

HERE = Path(__file__).parent
MANUAL = HERE.parents[1] / "docs" / "real_time.md"
WARNINGS = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Wvla", "-Werror")
# what C's library has to have: nothing of it is a file, a lock or a clock
LIBRARY = {"calloc", "malloc", "free", "sqrt", "fabs", "snprintf", "strtod", "strtol"} | {
    *("memcmp", "memcpy", "memset", "memmove"),
    *("strchr", "strcmp", "strcpy", "strlen", "strncat", "strncmp", "strpbrk"),
}
OF_A_STEP = {"sqrt", "fabs", "memcpy", "memset", "memmove"}


def needs(*programs):
    absent = targets.missing_programs(*programs)
    return pytest.mark.skipif(bool(absent), reason=f"expected {', '.join(absent)} on this machine")


@pytest.fixture(scope="module")
def folders(fmus, tmp_path_factory):
    assert fmus
    place = tmp_path_factory.mktemp("sources")
    return {(v, m): targets.unpack(path_of(m, v), place / v / m) for v, m in PAIRS}


@needs("gcc")
def test_nothing_is_allocated_after_instantiation(folders, tmp_path):
    """In event mode with early return, with chattering; inputs set, some refused; a reset.

    FMI 2.0 has the same core.
    """
    flags = "-O0", "-fno-builtin-malloc", "-DCOUNT_ALLOCATIONS", "-DSTEPS=10000", "-DFREQUENCY=0.3"
    result = targets.run_on_desktop(folders["fmi3", OSCILLATOR], tmp_path, *flags)
    assert result["allocated"] == "2"  # the instance, and its name
    assert result["later"] == "0"
    assert int(result["impacts"]) > 1000


@needs("gcc")
@pytest.mark.parametrize("pair", ordinary(PAIRS, PAIRS[3:4]), ids="-".join)
def test_no_function_calls_itself_and_a_step_nothing_that_allocates_waits_or_writes(folders, pair):
    graph, version = footprint.call_graph(folders[pair], "gcc", "-O0"), pair[0]
    called = [name for name in graph.sizes if re.search(rf"\b{version}\w+$", name)]
    assert f"{version}DoStep" in called
    for name in graph.sizes:
        assert graph.stack_bytes(name) < 32768
    assert graph.library_functions(f"{version}DoStep", footprint.MESSAGES) <= OF_A_STEP
    everything = set().union(*(graph.library_functions(name) for name in graph.sizes))
    plain = {name.removeprefix("__builtin_") for name in everything}
    assert plain <= {*LIBRARY, footprint.INDIRECT}


@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
def test_no_compiler_warns(folders, pair):
    compilers = [name for name in ("gcc", "clang") if not targets.missing_programs(name)]
    if not compilers:
        pytest.skip("expected gcc or clang on this machine")
    for compiler in compilers:
        files = targets.c_files(folders[pair])
        targets.run_command(compiler, *WARNINGS, "-fsyntax-only", *files)


@pytest.mark.slow
@needs("gcc", "nm")
def test_sources_of_several_fmus_share_no_name(folders, tmp_path):
    """By the prefix of the standard's headers, all of them can be linked into one program."""
    for version, model in (("fmi2", OSCILLATOR), ("fmi3", MODELS[1])):
        define = f"-D{version.upper()}_FUNCTION_PREFIX=Own_"
        for file in targets.c_files(folders[version, model]):
            made = tmp_path / f"{version}-{file.stem}.o"
            targets.run_command("gcc", "-O0", *targets.BITS, define, "-c", file, "-o", made)
            names = targets.run_command("nm", "-g", "--defined-only", made).split()[2::3]
            assert names and all(name.startswith("Own_") for name in names), file.name


@needs("gcc")
@pytest.mark.parametrize("version", ["fmi2", "fmi3"])
def test_messages_name_calls_without_the_prefix(folders, version):
    file = folders[version, OSCILLATOR] / f"{version}.c"
    define = f"-D{version.upper()}_FUNCTION_PREFIX=Own_"
    text = targets.run_command("gcc", "-E", define, file)
    assert f'"{version}SetTime"' in text and '"Own_' not in text


def stated(machine, what):
    """A number of bytes in the manual's table of stack and memory."""
    text = MANUAL.read_text("utf-8")
    head = next(line for line in text.splitlines() if line.startswith("| bytes |"))
    column = [cell.strip() for cell in head.split("|")].index(machine)
    (row,) = (line for line in text.splitlines() if line.startswith(f"| {what} |"))
    return int(row.split("|")[column].replace(",", ""))


@pytest.mark.slow
@pytest.mark.parametrize("machine", footprint.MACHINES)
def test_the_manual_states_the_stack(folders, machine):
    """As upper bounds, by the call graph, for another version of the compiler too."""
    compiler, *flags = footprint.MACHINES[machine]
    if targets.missing_programs(compiler):
        pytest.skip(f"expected {compiler} on this machine")
    graph = footprint.call_graph(folders["fmi3", OSCILLATOR], compiler, *flags, "-O2")
    for what, name in footprint.CALLS.items():
        bound = stated(machine, what)
        assert 0.6 * bound < graph.stack_bytes(name) <= bound, what


@pytest.mark.slow
@needs("gcc")
def test_the_manual_states_the_memory(folders, tmp_path):
    """Of an instance, as the program prints it; the trajectory is the one of the bare targets."""
    result = targets.run_on_desktop(folders["fmi3", OSCILLATOR], tmp_path, "-O0")
    assert int(result["impacts"]) > 4000
    assert int(result["instance"]) == stated("x86-64", "an instance")
    text = MANUAL.read_text("utf-8")
    assert result["hash"] in text and f"{int(result['impacts']):,} impacts" in text


def same_motion(one, other):
    return all(one[key] == other[key] for key in ("impacts", "hash", "x1", "x2", "v1", "v2"))


@pytest.mark.slow
@needs("gcc", *targets.TOOLS["Cortex-M7"])
@pytest.mark.parametrize("optimisation", ["-O2", "-O3"])
def test_a_bare_cortex_m7_has_the_bits_of_the_desktop(folders, optimisation, tmp_path):
    """And takes the stack and the memory that the manual states."""
    folder = folders["fmi3", OSCILLATOR]
    result = targets.run_on_cortex_m7(folder, tmp_path, optimisation)
    assert same_motion(result, targets.run_on_desktop(folder, tmp_path))
    if optimisation == "-O2":
        assert int(result["instance"]) == stated("Cortex-M7", "an instance")
        assert int(result["stack"]) <= stated("Cortex-M7", "a step") + 1024  # main's own
        assert int(result["code"]) <= stated("Cortex-M7", "the program") < int(result["code"]) * 1.1


@pytest.mark.slow
@needs("gcc", *targets.TOOLS["RISC-V 64"])
@pytest.mark.parametrize("standard", [targets.BITS, ("-std=gnu99",), ("-ffp-contract=fast",)])
def test_riscv_has_the_bits_of_the_desktop(folders, standard, tmp_path):
    """gcc fuses there unless it is told not to: the sources tell it themselves."""
    folder = folders["fmi3", OSCILLATOR]
    result = targets.run_on_riscv64(folder, tmp_path, standard=standard)
    assert same_motion(result, targets.run_on_desktop(folder, tmp_path))
