"""What a command takes for granted, and what somebody hardly means: said in one line."""

import re
from pathlib import Path

import pytest

import orchestrate
from orchestrate import Structure
from orchestrate.cli import notes
from orchestrate.model import toml_files

SETS = Path(orchestrate.__file__).parent / "model" / "sets"

HALVES = ("--set", "f1=42", "--set", "f2=55")
MASSES = ("--set", "m1=1.5", "--set", "m2=1.2")
ZETAS = ("--set", "zeta1=0.007", "--set", "zeta2=0.007")
SHAKEN = ("--hz", "42", "--g", "0.3")
SHORT = ("--periods", "2", "--plot", "none")


def said(ask, *options, shaken=SHAKEN):
    """What simulate prints, and its complaints."""
    done = ask("simulate", *options, *shaken, *SHORT)
    assert done.code == 0, done.err
    return done.out, done.complaints


def test_what_is_not_set_of_a_beam_is_said(ask):
    out, complaints = said(ask, *HALVES)
    assert complaints == []
    for word in (
        "m1 = 1 kg",
        "m2 = 1 kg",
        "zeta1 = 0.5 %",
        "e = 0.7",
        "only the ratio of the masses acts",
    ):
        assert word in out, out
    assert "assumed, as in the set paper" in out
    whole = (*HALVES, *MASSES, *ZETAS, "--set", "e=0.6")
    assert "assumed" not in said(ask, *whole)[0]
    line = said(ask, "--set", "f1=42", "--set", "kappa=2", *MASSES, *ZETAS)[0].splitlines()[0]
    assert line.endswith("the set paper: e = 0.7 (--set)")
    assert "m1 =" not in said(ask, *HALVES, "--set", "mu=0.8")[0]


def test_the_structure_file_is_read_once(ask, tmp_path, monkeypatch):
    """It was parsed again for what it leaves out."""
    read, read_text = [], toml_files.read_text
    monkeypatch.setattr(toml_files, "read_text", lambda *of: read.append(of) or read_text(*of))
    path = tmp_path / "beam.toml"
    path.write_text((SETS / "beam.toml").read_text(encoding="utf-8"), encoding="utf-8")
    said(ask, "--structure", path)
    assert len(read) == 1


def test_one_mass_before_a_stop_is_said_by_half_1(ask, tmp_path):
    stop = ("wall=true", "f1=12", "zeta1=1%", "clearance=0.3mm")
    words = [word for one in stop for word in ("--set", one)]
    out, complaints = said(ask, *words, shaken=("--hz", "11", "--g", "0.1"))
    assert complaints == [] and re.search(r"[1-9]\d* impacts", out)
    assert out.startswith("assumed, as in the set paper: m1 = 1 kg, e = 0.7 (--set)\n")
    alike = ("f=12", "zeta=1%", "clearance=0.3mm", "wall=true")
    same = said(ask, *(w for one in alike for w in ("--set", one)), shaken=("--hz", "11", "--g=.1"))
    assert same[0].splitlines()[:-1] == out.splitlines()[:-1]
    (tmp_path / "stop.toml").write_text("[structure]\nwall = true\nf_hz = 12\nzeta = 0.01\n")
    options = ("--structure", tmp_path / "stop.toml", "--set", "zeta=2%", "--set", "e=0.5")
    assert said(ask, *options, shaken=("--hz", "11", "--g", "0.1"))[1] == []


def test_numbers_may_have_their_units(ask, tmp_path):
    """To the bit as without."""
    plain = ("clearance=-2e-5", "zeta1=0.007", "f1=42", "m1=1.5")
    written = ("clearance=-20um", "zeta1=0.7%", "f1=42 Hz", "m1=1.5kg")
    names = set()
    for settings in (plain, written, ("clearance=-0.02 mm", *written[1:])):
        options = [word for setting in settings for word in ("--set", setting)]
        done = ask("simulate", *HALVES[2:], *options, *SHAKEN, *SHORT).success()
        names.add(done.out.splitlines()[-1].partition(": ")[0])
    assert len(names) == 1


@pytest.mark.parametrize("setting", ["clearance=2in", "zeta1=0.7mm", "e=70%", "clearance=mm"])
def test_other_units_are_refused(ask, setting):
    done = ask("simulate", "--set", setting, *SHAKEN)
    done.complaint(f"--set {setting}", "is not a number; expected one")


def test_nothing_is_said_of_a_set_or_a_file_as_it_is(ask, tmp_path):
    path = tmp_path / "beam.toml"
    path.write_text("[structure]\nm1 = 1.0\nm2 = 1.0\nf1_hz = 4\nf2_hz = 5\nzeta1 = 0\nzeta2 = 0\n")
    for source in ("beam", path):
        out = said(ask, "--structure", source, "--set", "e=0.5", shaken=("--hz", "5", "--g", "1"))[
            0
        ]
        assert "assumed" not in out
    assert "assumed: e = 0.7" in said(ask, "--structure", path, *HALVES)[0]


def test_a_file_of_frequencies_needs_the_masses(ask, tmp_path):
    path = tmp_path / "beam.toml"
    path.write_text("[structure]\nf1_hz = 42\nf2_hz = 55\nzeta1 = 0.007\nzeta2 = 0.007\n")
    ask("simulate", "--structure", path, *SHAKEN).complaint("structure.m1", "missing", "m1, m2")


def test_a_file_of_ratios_with_a_motor_needs_a_mass(ask, tmp_path):
    path = tmp_path / "beam.toml"
    text = (SETS / "beam.toml").read_text(encoding="utf-8")
    _, _, drive = text.partition("[motor]")
    path.write_text(f"[structure]\nomega_hz = 11.9\nmu = 1\n\n[motor]{drive}")
    ask("jump-voltages", "--drive", path).complaint("structure.m1: missing with omega_hz")
    assert Structure.from_file(SETS / "beam.toml").m1 == 1.5


@pytest.mark.parametrize("more", [(), ("--set", "m1=1.5"), ("--set", "mu=1")])
def test_a_motor_needs_the_masses(ask, more):
    done = ask("jump-voltages", *HALVES, *more)
    done.complaint("--set f1=42", "the motor feels the masses", "expected --set m1=KG")


def test_one_name_of_a_frequency_in_each_place(ask, tmp_path):
    done = ask(
        "simulate", "--set", "f1_hz=42", "--set", "f2=50", *SHAKEN, "--plot", "none"
    ).success()
    assert "zeta1 = 0.5 %" in done.out and "f2" not in done.out.splitlines()[0]
    path = tmp_path / "beam.toml"
    path.write_text("[structure]\nm1 = 1\nm2 = 1\nf1 = 42\nf2_hz = 55\nzeta1 = 0\nzeta2 = 0\n")
    ask("simulate", "--structure", path, *SHAKEN).complaint("structure.f1", "did you mean f1_hz")


DOUBTED = {  # options, and the words of the warning
    "--set zeta1=0.7 --hz 42": "zeta1 = 0.7 is 70 % | 0.7 % is 0.007",
    "--set clearance=-20 --hz 42": "clearance = -20 m | 20 um is 2e-5",
    "--frequency 42": "these are rad/s | is --hz meant?",
    "--hz 264": "these are Hz | is --frequency meant?",
    "--set zeta1=0.2 --set clearance=-2e-5 --hz 42": "",
    "--set clearance=1.5e-3 --hz 42": "",
    "--frequency 270": "",
    "--hz 120": "",
    "--rpm 2500": "",
}


@pytest.mark.parametrize("options", DOUBTED)
def test_what_is_implausible_triggers_a_warning_in_one_line(ask, options):
    shaken = (*options.split(), "--g", "0.3")
    complaints = said(ask, *HALVES, *MASSES, shaken=shaken)[1]
    words = [word for word in DOUBTED[options].split(" | ") if word]
    assert len(complaints) == bool(words)
    assert all(word in complaints[0] for word in words)


def test_a_level_below_the_threshold_is_said(ask):
    quiet = ("--hz", "20", "--g", "0.001")
    for clearance, word in (("-2e-5", "opens at"), ("1.5e-3", "touches at")):
        setting = ("--set", f"clearance={clearance}")
        out = said(ask, *HALVES, *MASSES, *setting, shaken=quiet)[0]
        assert word in out and "times this level: from rest the response is linear" in out
        assert re.search(r"by [\d.]+ [mu]m, it first", out)
        assert "no impacts" in out
    loud = said(
        ask, *HALVES, *MASSES, "--set", "clearance=-2e-5", shaken=("--hz", "48", "--g", "3")
    )
    assert "is linear" not in loud[0] and "no impacts" not in loud[0]


@pytest.mark.parametrize(("f1", "refused"), [("39", False), ("40", True), ("4.3", True)])
def test_one_half_without_the_other_is_refused_where_they_are_unlike(ask, f1, refused):
    asked = f"simulate --structure beam --hz 12 --g 0.02 --periods 2 --plot none --set f1={f1}"
    done = ask(*asked.split())
    assert done.code == (2 if refused else 0), done.err
    if refused:
        done.complaint(
            f"--set f1={f1}: f2 would be 13.08 Hz, as in the set beam; expected --set f2"
        )


@pytest.mark.parametrize(
    ("level", "warned"),
    [("--amplitude 49mm --hz 12", 0), ("--amplitude 51mm --hz 12", 1), ("--g 99 --hz 40", 0)]
    + [("--g 101 --hz 40", 1), ("--g 101,120 --hz 40", 1)],
)
def test_what_no_shaker_does_is_wondered_at_once(ask, level, warned):
    asked = f"resonance --structure beam {level} --transient 2 --samples 4 --plot none"
    done = ask(*asked.split())
    words = "warning: the box moves by up to ", "beyond what shakers do"
    assert done.code == 0 and sum(all(w in one for w in words) for one in done.complaints) == warned


@pytest.mark.parametrize(
    ("ratios", "far"), [((0.4, 0.49), 1), ((0.4, 0.51), 0), ((5.1, 9.0), 1), ((4.9, 9.0), 0)]
)
def test_voltages_far_from_the_resonance_are_wondered_at(recwarn, ratios, far):
    notes.warn_of_voltage("--voltage x", tuple(6.5 * ratio for ratio in ratios), 6.5)
    assert len(recwarn) == far
    assert not far or "omega with 6.5 V (eta0 = 1)" in str(recwarn[0].message)


@pytest.mark.parametrize(("mass", "note"), [("19.9", False), ("20.1", True), ("20.1kg", True)])
def test_heavy_masses_are_said_with_their_unit(ask, mass, note):
    masses = ("--set", f"m1={mass}", "--set", "m2=1.2")
    out, complaints = said(ask, *HALVES, *masses, *ZETAS)
    assert complaints == [] and ("masses are in kg" in out) == note


def test_grams_are_grams_and_ratios_have_no_mass(ask):
    light, whole = (
        ("--set", f"m1={m1}", "--set", f"m2={m2}") for m1, m2 in ((0.15, 0.12), ("150g", "120 g"))
    )
    names = {
        said(ask, *HALVES, *one, *ZETAS)[0].splitlines()[-1].partition(": ")[0]
        for one in (light, whole)
    }
    assert len(names) == 1
    ratios = ("--set", "m1=150", "--set", "k1=150", "--set", "k2=180", "--set", "m2=150")
    assert "kg" not in said(ask, *ratios, shaken=("--eta", "1.2"))[0]


def test_a_branch_over_the_frequency_takes_g_at_its_start(ask):
    asked = (
        "branch",
        "--structure",
        "beam",
        "--over",
        "hz",
        "--limits",
        "16.5:16.6",
        "--plot",
        "none",
    )
    out = ask(*asked, "--g", "0.02").success().out
    assert out.startswith(
        "--g 0.02: is --amplitude 1.82483e-05 at 16.5 Hz, constant along the branch"
    )
    same = ask(*asked, "--amplitude", "1.82483e-05").success().out
    assert same.splitlines()[:2] == out.splitlines()[1:3]


def test_an_amplitude_and_a_range_may_have_units(ask):
    """The same result, by its name, as in m."""
    names = set()
    for amplitude, values in (("2e-5", "0:2e-5:1e-5"), ("20um", "0:20um:0.01mm")):
        asked = ("--structure", "beam", "--over", "clearance", "--values", values, "--hz", "16")
        done = ask("sweep", *asked, "--amplitude", amplitude, "--transient", "5", "--plot", "none")
        names.add(done.success().out.splitlines()[-1].partition(": ")[0])
    assert len(names) == 1
    ask("sweep", "--hz", "16", "--amplitude", "20in").complaint(
        "--amplitude 20in: expected a length"
    )
