"""The native FMUs through the project's own importers in C: FMPy's numbers, no Python, many
instances, threads, a million steps.
"""

import random
import re
import subprocess

import pytest

from fmu_src.kernels.oscillator import memory as at
from tools.importers import Importer, compile_importer, unpack_binary, zig_compiler

from .slave import COMMON, harmonic, slave

# bytes before the numbers of a serialised state, and numbers before the memory
HEADER, HEAD = 64, 3


def slot(index):
    """Offset of a slot of the memory in a serialised state."""
    return HEADER + 8 * (HEAD + index)


def uneven_times(end):
    draw = random.Random(2)
    return sorted({0.0, end, *(draw.uniform(0.0, end) for _ in range(300))})


@pytest.mark.parametrize(
    "values",
    [{}, {**harmonic(1.13), "e": 0.9, "m2": 1.7, "d1": 0.03}, {"bonded": True}],
    ids=["defaults", "chaos", "bonded"],
)
def test_numbers_are_those_of_fmpy(importer, fmus, values):
    times = uneven_times(300.0)
    found = importer.simulate(COMMON, times, **values)
    with slave(fmus[importer.version]) as fmu:
        fmu.start(**values)
        expected = [fmu.get(*COMMON)]
        for time in times[1:]:
            fmu.step(time)
            expected.append(fmu.get(*COMMON))
    assert [[cell.hex() for cell in row] for row in found] == [
        [float(cell).hex() for cell in row] for row in expected
    ]
    assert bool(values.get("bonded")) == (found[-1][COMMON.index("impact_count")] == 0.0)


def test_there_is_no_python_in_the_process(importer):
    linked = subprocess.run(["ldd", str(importer.library)], capture_output=True, text=True).stdout
    assert {line.split()[0].rsplit("/", 1)[-1] for line in linked.splitlines()} <= {
        "linux-vdso.so.1",
        "libc.so.6",
        "ld-linux-x86-64.so.2",
    }
    mapped = {
        line.rsplit("/", 1)[-1]
        for line in importer.run("maps").stdout.splitlines()
        if line.startswith("/")
    }
    assert importer.library.name in mapped
    assert not [name for name in mapped if "python" in name.lower()]
    system = {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "ld-linux-x86-64.so.2"}
    assert mapped - {importer.library.name, importer.program.name} <= system


def test_importer_compiled_by_ziglang(fmus, importer, tmp_path):
    """What is compiled where the machine has no C compiler; and another compiler's eye on the
    importer.
    """
    if zig_compiler() is None:
        pytest.skip("ziglang is not installed")
    other = Importer(
        compile_importer(importer.version, fmus[importer.version], tmp_path, zig_compiler()),
        importer.library,
        importer.version,
    )
    times = uneven_times(300.0)
    assert other.simulate(COMMON, times, **harmonic(1.13)) == importer.simulate(
        COMMON, times, **harmonic(1.13)
    )
    assert "FAILURES 0" in other.run("hostile").stdout


def test_hostile_calls_are_refused_and_change_nothing(importer):
    done = importer.run("hostile")
    assert int(re.search(r"CHECKS (\d+) FAILURES 0", done.stdout).group(1)) > 30000


def test_a_thousand_instances_and_four_threads(importer):
    importer.run("many", 1000, 40, 4000)


def test_a_million_small_steps(importer):
    done = importer.run("million", 1_000_000)
    assert int(re.search(r"IMPACTS (\d+)", done.stdout).group(1)) > 200


def test_speed_of_a_step_without_impact(importer):
    """Under 0.3 us of processor time is wanted and found on a machine of 2.6 GHz; the bound is
    wide, the numbers are printed.
    """
    found = dict(re.findall(r"SPEED (.*) ([\d.]+) ns", importer.run("speed", 50_000).stdout))
    print(importer.version, found)
    for kind in ("bonded", "flight", "flight, x_rel_max off"):
        assert float(found[kind]) < 900.0


def test_two_versions_in_one_process_do_not_meet(fmus, importer_of, tmp_path):
    """Loaded together, each FMU calls its own kernel and helpers: symbols are hidden."""
    one, other = importer_of("fmi2"), importer_of("fmi3")
    times = uneven_times(100.0)
    alone = one.simulate(COMMON, times, **harmonic(1.13))
    together = Importer(one.program, one.library, "fmi2").run(
        "simulate",
        ",".join(COMMON),
        *(f"{name}={value.hex()}" for name, value in harmonic(1.13).items()),
        times=times,
        env={"LD_PRELOAD": str(unpack_binary(fmus["fmi3"], "fmi3", tmp_path))},
    )
    rows = [
        [float.fromhex(cell) for cell in line.split()]
        for line in together.stdout.splitlines()
        if not line.startswith("CHECKS")
    ]
    assert rows == alone
    assert other.simulate(COMMON, times, **harmonic(1.13)) == alone


@pytest.mark.slow
def test_a_step_that_cannot_finish_ends_with_a_message(importer):
    """Ten million evaluations, and no more."""
    done = importer.run("simulate", "x1", "box_frequency=1e30", times=[0.0, 1.0], success=False)
    assert done.returncode == 2
    assert "cannot finish" in done.stderr


BODY = [
    (at.SAMPLE_COUNT, "1e6"),  # would write a million numbers into room for 200
    (at.SAMPLE_COUNT, "nan"),
    (at.M1, "-1"),
    (at.E, "5"),
    (at.BOX_AMPLITUDE, "inf"),
    (at.TIME, "inf"),
    (at.TIME, "nan"),
]
HIDDEN = [
    (at.MODE, "77"),
    (at.X1, "nan"),
    (at.ORIGIN, "nan"),
    (at.IMPACT_COUNT, "-5"),
    (at.END_KIND, "nan"),
]


@pytest.mark.parametrize(("index", "value"), BODY + HIDDEN)
def test_a_damaged_state_is_refused(importer, index, value):
    assert importer.run("corrupt", slot(index), value).stdout.startswith("REFUSED")


@pytest.mark.parametrize(("index", "value"), BODY)
def test_a_forged_state_with_a_value_out_of_range_is_refused(importer, index, value):
    assert importer.run("corrupt", slot(index), value, "sealed").stdout.startswith("REFUSED")


def test_no_forged_state_crashes(importer):
    """Made by somebody who knows the checksum: wrong in, wrong out, but the process lives."""
    assert (
        int(re.search(r"TAKEN (\d+)\n.* FAILURES 0", importer.run("forge").stdout).group(1)) > 1000
    )


@pytest.mark.parametrize("number", [0, 1, 2])
@pytest.mark.parametrize("value", ["nan", "inf"])
@pytest.mark.parametrize("sealed", [(), ("sealed",)], ids=["damaged", "forged"])
def test_a_head_that_is_no_number_is_refused(importer, number, value, sealed):
    assert importer.run("corrupt", HEADER + 8 * number, value, *sealed).stdout.startswith("REFUSED")


@pytest.mark.parametrize(
    ("number", "value"),
    [(0, "-1"), (0, "4.5"), (0, "1e300"), (0, "64"), (2, "-1"), (2, "0.5"), (2, "4"), (2, "1e300")],
)
def test_a_forged_phase_or_flag_is_refused(importer, number, value):
    assert importer.run("corrupt", HEADER + 8 * number, value, "sealed").stdout.startswith(
        "REFUSED"
    )


@pytest.mark.parametrize("d1", [0.0, 0.005, 0.0099])
def test_a_start_at_rest_with_less_damping_on_mass_1_gets_going(importer, d1):
    """Contact from rest: the event function and its first derivative vanish at the start."""
    assert importer.simulate(["x_rel"], [0.0, 0.05, 400.0], d1=d1)[-1][0] >= 0.0
