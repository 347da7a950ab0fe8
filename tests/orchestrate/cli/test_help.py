"""What the command line says of itself: it starts at once, and its examples can be typed."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from orchestrate import cli
from orchestrate.cli.grammar import parse_values

from .commands import ROOT

COMMANDS = (
    *(
        "build",
        "simulate",
        "shake",
        "cosimulate",
        "analyse",
        "diagnose",
        "resonance",
        "spectra",
        "sweep",
        "map",
        "lyapunov",
        "attractors",
    ),
    *(
        "basin",
        "orbit",
        "manifold",
        "branch",
        "border",
        "couple",
        "capture",
        "passage",
        "jump-voltages",
    ),
    *("drive-branch", "explore", "report", "paper"),
)


def help_of(*arguments):
    with pytest.raises(SystemExit) as ended:
        cli.main([*arguments, "--help"])
    assert ended.value.code == 0


def test_help_lists_commands_and_shipped_sets(capsys):
    help_of()
    out, err = capsys.readouterr()
    assert err == "" and out.startswith("usage: ")
    listed = [line.split()[0] for line in out.splitlines() if line.startswith(" ") and line.strip()]
    assert {*COMMANDS, "paper", "quick", "beam"} <= set(listed)


@pytest.mark.parametrize("called", ["/usr/bin/vibroimpact", "/somewhere/orchestrate/__main__.py"])
@pytest.mark.parametrize("command", COMMANDS)
def test_examples_can_be_typed_as_they_stand(capsys, monkeypatch, command, called):
    monkeypatch.setattr(sys, "argv", [called])
    help_of(command)
    program = "vibroimpact" if called.endswith("vibroimpact") else "python -m orchestrate"
    text = capsys.readouterr().out
    assert text.startswith(f"usage: {program} {command}")
    examples = [line.strip() for line in text.splitlines() if line.startswith(f"  {program} ")]
    assert examples
    for example in examples:
        words = example.removeprefix(program).split("   ")[0].split()
        arguments = cli.make_parser().parse_args(cli.join_negative_values(words))
        assert callable(arguments.run)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_quantity_is_defined(capsys, command):
    help_of(command)
    text = capsys.readouterr().out
    for formula in (
        *("omega = sqrt(k1/m1)", "eta = Omega/omega", "mu = m2/m1, kappa = k2/k1"),
        *("D1 = d1/(2 omega m1)", "xi = x/(a eta^2)", "gamma  ", "tau = omega t"),
    ):
        assert formula in text


def test_it_starts_at_once():
    command = [sys.executable, "-m", "orchestrate", "--help"]
    times = []
    for _ in range(3):  # of the processor: a busy machine does not count
        begin = os.times()
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        end = os.times()
        times.append(end.children_user + end.children_system)
        times[-1] -= begin.children_user + begin.children_system
        if times[-1] < 0.5:
            return
    pytest.fail(f"it took {min(times):.2f} s")


def test_what_is_slow_is_loaded_when_it_is_needed():
    code = "import sys, orchestrate.cli; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    loaded = set(done.stdout.split())
    assert not loaded & {"numpy", "xarray", "scipy", "matplotlib", "fmpy", "netCDF4", "loky"}


def test_the_default_range_has_7901_values_and_both_ends():
    etas, is_range = parse_values("--eta", "0.1:8.0:0.001")
    assert is_range and (len(etas), etas[0], etas[-1]) == (7901, 0.1, 8.0)
    assert list(etas) == [float(f"{n / 1000:.3f}") for n in range(100, 8001)]


@given(st.integers(1, 10**7), st.integers(1, 10**5), st.integers(0, 300))
def test_a_range_has_its_decimal_values_exactly(first, step, count):
    def text(n):
        return f"{n // 10000}.{n % 10000:04d}"

    grid = [text(first + k * step) for k in range(count + 1)]
    found, _ = parse_values("--eta", f"{grid[0]}:{grid[-1]}:{text(step)}")
    assert found == tuple(map(float, grid))


def test_build(capsys, tmp_path, monkeypatch):
    (tmp_path / "folder").write_text("mine")
    code = cli.main(["build", "--folder", str(tmp_path / "folder")])
    assert code == 2 and "expected a folder that can be written" in capsys.readouterr().err
    for made in ("build", "build_libraries", "build_web_kernels"):
        monkeypatch.setattr(
            f"orchestrate.access.{made}", lambda folder, *_, **__: [tmp_path / "folder"]
        )
    assert cli.main(["build"]) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'folder'}  0 kB\n" * 3


def test_build_for_targets_that_compile(capsys, tmp_path):
    """FMUs without binaries, and nothing else; in other places than those to be run."""
    assert cli.main(["build", "--folder", str(tmp_path), "--sources-only"]) == 0
    made = sorted(path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.*"))
    names = ("ElectrodynamicShaker", "MotorShaker", "TwoMassImpactOscillator")
    assert made == [f"{form}-sources/{name}.fmu" for form in ("fmi2", "fmi3") for name in names]
    assert capsys.readouterr().out.count(" kB\n") == 6
    code = cli.main(["build", "--sources-only", "--platforms", "all"])
    assert code == 2 and "--platforms" in capsys.readouterr().err
