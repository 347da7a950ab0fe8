"""TOML files: what is written is read, units are said by the key, the shipped sets are exact."""

import math

import pytest
from hypothesis import HealthCheck, given, settings

from orchestrate.errors import InputError
from orchestrate.model import SETS, Drive, Excitation, Shaker, Structure, read, resolve_path, write

from .strategies import DRIVES, SHAKERS, STRUCTURES, WITH_FORCES

KINDS = {Structure: "structure", Excitation: "excitation", Drive: "drive"}


@pytest.fixture
def file(tmp_path):
    def put(text):
        path = tmp_path / "mine.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return put


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=25)
@given(STRUCTURES, WITH_FORCES, DRIVES, SHAKERS)
def test_what_is_written_is_read(tmp_path, structure, excitation, drive, shaker):
    every = {"structure": structure, "excitation": excitation, "drive": drive, "shaker": shaker}
    path = write(tmp_path / "all.toml", **every)
    assert read(path) == every
    for kind, name in (*KINDS.items(), (Shaker, "shaker")):
        assert kind.from_file(str(path)) == every[name]


def test_resolve(tmp_path):
    assert resolve_path("paper") == SETS["paper"]
    path = write(tmp_path / "a.toml", structure=Structure())
    assert resolve_path(path) == resolve_path(str(path)) == path
    with pytest.raises(InputError, match="bean: no such file; expected .*did you mean beam"):
        resolve_path("bean")
    with pytest.raises(InputError, match="a folder"):
        resolve_path(tmp_path)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", Structure()),
        ("e = 0.3", Structure(e=0.3)),
        ("m1 = 2\nk1 = 8.0", Structure(m1=2.0, k1=8.0)),
        ("mu = 0.5\nD = 0.02", Structure.nondimensional(mu=0.5, D=0.02)),
        ("D1 = 0.1\nD2 = 0.2", Structure.nondimensional(D1=0.1, D2=0.2)),
        ("kappa = 2\nm1 = 3\nbonded = true", Structure.nondimensional(kappa=2, m1=3, bonded=True)),
        ("omega_rad_s = 75\nm1 = 1.5", Structure.nondimensional(omega=75, m1=1.5)),
        ("omega_hz = 12.0", Structure.nondimensional(omega=2.0 * math.pi * 12.0)),
        ("omega_rpm = 720", Structure.nondimensional(omega=2.0 * math.pi * 720.0 / 60.0)),
        ('preload = "20 um"', Structure.nondimensional(clearance=-2e-5)),
    ],
)
def test_structures(file, text, expected):
    assert Structure.from_file(file(f"[structure]\n{text}\n")) == expected


@pytest.mark.parametrize(
    ("text", "frequency", "amplitude"),
    [
        ("frequency_rad_s = 90\namplitude = 0.002", 90.0, 0.002),
        ("frequency_hz = 15\namplitude = 0.002", 2.0 * math.pi * 15.0, 0.002),
        ("frequency_rpm = 900\namplitude = 0.002", 2.0 * math.pi * 15.0, 0.002),
        ("frequency_rad_s = 10\nacceleration_g = 2", 10.0, 2.0 * 9.80665 / 100.0),
        ("eta = 1.5", 112.5, 1.0 / 2.25),
        ("eta = 1.5\namplitude = 0.002", 112.5, 0.002),
        ("eta = 1.5\nacceleration_g = 0.5", 112.5, 0.5 * 9.80665 / 112.5**2),
        ('frequency_hz = "15 Hz"\namplitude = "2 mm"', 2.0 * math.pi * 15.0, 0.002),
        ('frequency_rad_s = 10\nacceleration_g = "2g"', 10.0, 2.0 * 9.80665 / 100.0),
    ],
)
def test_excitations(file, text, frequency, amplitude):
    path = file(f"[structure]\nomega_rad_s = 75\n\n[excitation]\n{text}\nphase = 0.5\n")
    found = Excitation.from_file(path)
    assert math.isclose(found.frequency, frequency, rel_tol=1e-15)
    assert math.isclose(found.amplitude, amplitude, rel_tol=1e-15)
    assert found.phase == 0.5


UNBALANCE = "unbalance_mass = 0.025\nunbalance_radius = 0.02\n"
MOTOR = f"{UNBALANCE}rotor_inertia = 5e-5\nmotor_constant = 0.06\narmature_resistance = 12.0\n"
BOX = "[box]\nbox_mass = 5.5\nbox_stiffness = 309.375\nbox_damping = 4.125\n"
SHEET = f"[motor]\nrated_voltage = 12.0\nstall_torque = 0.06\n{UNBALANCE}{{more}}\n\n{BOX}"
HALVES = """
[structure]\nm1 = 1.5\nm2 = 1.2\nf1_hz = 42.0\nf2_hz = 55.0\nzeta1 = "0.7 %"\nzeta2 = 0.01\ne = 0.6
"""


@pytest.mark.parametrize(
    "more",
    [
        "no_load_speed_rad_s = 200.0\nrotor_inertia = 4e-5",
        "no_load_speed_hz = 31.830988618379067\nmechanical_time_constant = 0.1333333333",
    ],
)
def test_a_motor_by_its_datasheet(file, more):
    """The motor of `beam`, whose inertia has the unbalance in it."""
    drive = Drive.from_file(file(SHEET.format(more=more)))
    expected = Drive.from_file("beam").parameters()
    assert drive.parameters() == pytest.approx(expected, rel=1e-9)


def test_one_mass_before_a_stop(file):
    text = 'wall = true\nf1_hz = 12\nzeta1 = "1 %"\nclearance = "0.3 mm"\nm1 = "150 g"'
    stop = read(file(f"[structure]\n{text}"))["structure"]
    own = text.replace("f1_hz", "f_hz").replace("zeta1", "zeta").replace("m1", "m")
    assert read(file(f"[structure]\n{own}"))["structure"] == stop
    same = Structure.one_mass(m=0.15, f=12.0, zeta="1 %", clearance=3e-4)
    assert stop.wall and (stop.f1, stop.zeta1) == (12.0, 0.01)
    for name in ("m1", "k1", "d1", "clearance"):
        assert stop.get(name) == same.get(name)


WRONG = [
    ("e = 0.7", "e = 0.7: outside of a section"),
    ("[struct]\ne = 0.7", "struct: .*structure?"),
    ("structure = 3", "structure = 3: expected a section"),
    ("[structure\ne = 1", "not readable as TOML.*line 1"),
    ("[S]m1 = 0.15 kg  # one", 'm1 = 0.15 kg: write m1 = "0.15 kg"'),
    ("[S]f1_hz = 46,5 Hz", 'f1_hz = 46,5 Hz: write f1_hz = "46.5 Hz"'),
    ("[S]k1 = 1e3 N/m", "k1 = 1e3 N/m: write k1 = 1e3"),
    ("[S]e = 0.7\ne = 0.3\n", "not readable as TOML.*line 3"),
    ("[S]kapa = 1.2", "structure.kapa = 1.2: .*kappa"),
    ("[S]e = 1.2", "structure.e = 1.2: expected 0 <= e <= 1"),
    ('[S]e = "0.7"', "structure.e = '0.7': expected a number"),
    ("[S]e = true", "structure.e = True: expected a number"),
    ('[S]bonded = "yes"', "structure.bonded = 'yes': expected true or false"),
    ("[S]mu = 1.0\nm2 = 1.0", "structure.mu = 1.0: given with m2"),
    ("[S]preload = -1e-5", "structure.preload = -1e-05 m: expected 0 <= preload"),
    ("[S]D1 = 0.1", "structure.D2: missing"),
    ("[S]omega_hz = 1\nomega_rpm = 60", "structure.omega_rpm = 60: conflicts with omega_hz"),
    ("[S]omega_hz = 1e15", "omega = 628.*k1 = 3.9.*expected 1e-24 <= k1"),
    (f"{HALVES}wall = true", "structure.m2 = 1.2: mass 2 is a wall"),
    ("[S]wall = true\nf1_hz = 12", "structure.zeta1: missing"),
    (HALVES.replace("f2_hz = 55.0", ""), "structure.f2_hz.*missing"),
    (HALVES.replace("f2_hz = 55.0", "k2 = 5.0"), "structure.k2 = 5.0: given with f1_hz"),
    ("[X]amplitude = 1", "frequency_hz"),
    ("[X]frequency_hz = 1", "amplitude, acceleration_g"),
    ("[X]frequency_hz = 1\neta = 1", "excitation.eta = 1: conflicts with frequency_hz"),
    ("[X]frequency_hz = 1\namplitude = -1", "excitation.amplitude = -1.0 m: expected 0 <="),
    ("[X]eta = 2", r"excitation.eta = 2: .*\[structure\]"),
    ("[S][X]eta = 0", "excitation.eta = 0.0: expected 1e-06 <= eta"),
    (f"[M]{MOTOR}", r"no section \[box\]"),
    (BOX, r"no section \[motor\]"),
    (f"[M]{BOX}", "motor.unbalance_mass: missing"),
    (f"[M]{MOTOR}[box]\nOmega_b = 1\nD_b = 0", "expected box_mass"),
    (SHEET.format(more="rotor_inertia = 1"), "expected one of no_load_speed_hz"),
    (SHEET.format(more="motor_constant = 1"), "motor.rated_voltage = 12.0.* given with motor_con"),
    ("[S]m1 = 1 # " + "x" * 70_000, "at most 65536"),
    ("[S]m1 = " + "[" * 10_000 + "]" * 10_000, "nested too deeply"),
]


@pytest.mark.parametrize(("text", "words"), WRONG, ids=[repr(text[:50]) for text, _ in WRONG])
def test_mistakes_are_one_line(file, text, words):
    for short, section in (("[S]", "structure"), ("[X]", "excitation"), ("[M]", "motor")):
        text = text.replace(short, f"[{section}]\n")
    path = file(text)
    with pytest.raises(InputError, match=words) as error:
        read(path)
    line = str(error.value)
    assert line.startswith(f"{path}: ") and "\n" not in line and len(line) < 600
    assert "expected" in line


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_not_described(file, kind):
    with pytest.raises(InputError, match=r"mine.toml: describes no \w+"):
        kind.from_file(file(""))
