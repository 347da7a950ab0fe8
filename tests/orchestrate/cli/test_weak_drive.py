"""The weak drive at the command line: what its commands print and draw."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
import xarray as xr

from orchestrate import Drive, Structure, couple
from orchestrate.cli import weak_drive
from orchestrate.show import weak_drive as figures

from .test_responses import shows_something

MOTOR = """
[structure]
m1 = 1.5
m2 = 1.5
k1 = 8437.5
k2 = 10125.0
d1 = 4.5
d2 = 4.5
e = 0.7

[motor]
unbalance_mass = 0.03
unbalance_radius = 0.02
rotor_inertia = 6e-5
motor_constant = 0.06
armature_resistance = 14.0
armature_inductance = 0.002

[box]
box_mass = 5.0
box_stiffness = 300.0
box_damping = 4.0
"""
SHORT = ("--step", "0.2", "--settle", "30")


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "results"


@pytest.fixture
def motor(tmp_path):
    """A file with a structure, a motor and a box of one's own."""
    path = tmp_path / "motor.toml"
    path.write_text(MOTOR)
    return path


def results(folder, ending="nc"):
    """The datasets in a folder, by name."""
    return {path.stem: xr.load_dataset(path) for path in sorted(folder.glob(f"*.{ending}"))}


def cells(text):
    """The cells of a printed table, by the words that a row begins with."""
    rows = (line.split("  ") for line in text.splitlines() if line.startswith("  "))
    parts = [[cell.strip() for cell in row if cell.strip()] for row in rows]
    return {tuple(row[:2]): row[2:] for row in parts}


@pytest.mark.slow
def test_couple_tells_jumps_beside_where_the_ramp_shows_them(ask, folder):
    options = ("--eta0", "1.55:1.65", "--rate", "2e-4", "--one-way", "--only", "delaminated")
    done = ask("couple", *options, *SHORT).success()
    table = cells(done.out)
    voltage, eta0, shown, _ = table["delaminated", "up"]
    value, error = map(float, voltage.split(" +- "))
    assert abs(value - 1.56970) <= error + 1e-4 < 3e-4
    assert float(eta0) == pytest.approx(value, abs=1e-5) and 1.59 < float(shown) < 1.64
    assert table["delaminated", "down"] == ["none", "the voltage does not fall"]
    ((name, data),) = results(folder).items()
    assert name.startswith("couple_quick_") and name.endswith("_delaminated")
    assert abs(data.attrs["missing_over_motor_work"]) < 2e-6
    pictures = sorted(folder.glob("*.png"))
    assert len(pictures) == 2 and pictures[1].stem == f"{pictures[0].stem}_jumps"
    assert all(map(shows_something, pictures))


def test_what_is_undecided_is_printed_and_titled(ask, folder):
    """So fast a ramp does not tell, and the voltage stays constant only for a short time."""
    options = ("--eta0", "1.5:1.75", "--rate", "2e-3", "--one-way", "--only", "bonded")
    short = ("--hold", "300", "--step", "0.4", "--plot", "none")
    done = ask("couple", *options, *short).success()
    word, reason = cells(done.out)["bonded", "up"]
    assert word == "undecided" and "a longer --hold may" in reason
    (data,) = results(folder).values()
    assert data.decided.values.tolist() == ["undecided", ""]
    title = figures.draw_ramps({"bonded": data}).axes[0].get_title(loc="left")
    assert title == "bonded: jump up undecided"


def test_a_motor_of_one_s_own(ask, folder, motor):
    """Volts and seconds; voltages from a file; both kinds of controllers."""
    options = "couple --structure beam --set clearance=20um --only delaminated --drive"
    own = (*options.split(), motor)
    volts = ("--voltage", "5:5.2", "--volt-rate", "0.2", "--one-way", "--settle", "20")
    ask(*own, *volts, "--plot", "none").success()
    course = motor.with_name("course.csv")
    course.write_text("time,voltage\n0,4\n1,5\n1,6\n2,6\n")
    ask(*own, "--course", course).success()
    constant = ("--voltage", "6.5", "--duration", "1.5")
    strong = ("--voltage", "12", "--duration", "1.5")
    held = ask(*own, *strong, "--speed-control", "120", "--plot", "none").success()
    assert "a controller sets the voltage" in held.out and "beyond the resonance from" in held.out
    ask(*own, *constant, "--speed-gradient", "--low", "0.5", "--plot", "none").success()
    found = results(folder)
    assert len(found) == 4 and len(list(folder.glob("*.png"))) == 1
    assert any(abs(float(data.voltage[-1]) - 6.0) < 1e-9 for data in found.values())
    assert all(name.startswith("couple_motor_beam_") for name in found)
    command = weak_drive.Couple(drive=motor, structure="beam")
    title = command.picture_title(found)
    assert title.startswith("motor, beam: $f_1$ = 11.94 Hz") and "clearance 20 µm" in title


def test_a_voltage_that_falls_first_is_said(ask):
    short = ("--rate", "4e-4", "--hold", "0", "--step", "0.4", "--settle", "9", "--one-way")
    options = ("--only", "bonded", *short, "--plot", "none")
    assert "the voltage falls first" in ask("couple", "--eta0", "1.41:1.4", *options).success().out
    assert "falls first" not in ask("couple", "--eta0", "1.4:1.41", *options).success().out


@pytest.mark.slow
def test_a_motor_by_its_datasheet(ask, folder):
    """The torque line through no-load speed and stall torque, in place of the set's constants."""
    sheet = ("--rated-voltage", "2", "--no-load-rpm", "16", "--stall-torque", "60")
    constant = ("--voltage", "2", "--duration", "60", "--only", "bonded", "--plot", "none")
    ask("couple", *sheet, *constant).success()
    (data,) = results(folder).values()
    speed = 2.0 * np.pi * 16.0 / 60.0
    line = {"motor_constant": 2.0 / speed, "armature_resistance": (2.0 / speed) * 2.0 / 60.0}
    drive, structure = Drive.from_file("quick").replace(**line), Structure.from_file("quick")
    expected = couple(
        structure.as_bonded(), drive, voltage=2.0, duration=60.0, store=None, progress=False
    )
    assert np.array_equal(data.speed, expected.speed) and data.sizes["revolution"] > 10


def test_capture(ask, folder):
    quick = ("--count", "2", "--tolerance", "0.05", "--step", "0.2", "--only", "bonded")
    over = ("--over", "rotor_inertia", "--values", "800,1400")
    done = ask("capture", "--voltage", "1.45:1.6", *quick, *over).success()
    table = cells(done.out)
    assert table["bonded", "1400"][1:4] == ["1", "1", "0"]
    assert float(table["bonded", "800"][0].split()[0]) == pytest.approx(1.5375, abs=0.03)
    options = ("--count", "2", "--time", "100", "--step", "0.2", "--only", "bonded")
    done = ask("capture", "--eta0", "1.5:1.6", *options, "--plot", "none").success()
    assert cells(done.out)["bonded", "none"][:3] == ["0", "0", "2"]
    assert "1.5, 1.6 V undecided: the speed had not settled; give a longer --time" in done.out
    assert len(results(folder)) == 2
    assert all(shows_something(picture) for picture in folder.glob("*.png"))


def test_passage(ask, folder):
    options = ("--eta0", "1.55:1.65", "--rate", "2e-4", "--around", "60", "--one-way", *SHORT)
    done = ask("passage", *options, "--revolutions", "4", "--only", "delaminated").success()
    assert done.out.count("jump up at 1.569") == 1 and "around jumps" in done.out
    (picture,) = folder.glob("*.png")
    assert shows_something(picture)


def test_jump_voltages(ask, folder):
    options = ("--eta0", "1.5:1.66", "--rate", "4e-4,3e-4", "--one-way", "--jobs", "1", *SHORT)
    done = ask("jump-voltages", *options).success()
    assert "jump at rate 0" in done.out and "nan" not in done.out
    (data,) = results(folder).values()
    assert data.jumps.attrs["units"] == "V"
    assert shows_something(next(folder.glob("*.png")))


def test_drive_branch(ask, folder):
    options = ("--speed", "1.29:1.32", "--longest", "0.3", "--jobs", "1")
    done = ask("drive-branch", *options).success()
    assert cells(done.out)["bonded", "fold"][0].startswith("1.583")
    assert shows_something(next(folder.glob("*.png")))


def test_bifurcations_of_a_drive_are_listed_by_structure_and_voltage():
    at, names = "bifurcation", ["delaminated", "bonded", "bonded"]
    made = {
        "structure": names,
        "kind": ["fold"] * 3,
        "voltage": [1.5, 1.7, 1.6],
        "speed": [1.0] * 3,
    }
    data = xr.Dataset({f"{at}_{name}": (at, values) for name, values in made.items()})
    legs = {"voltage": [[[1.0]]], "speed": [[[1.0]]], "stable": [[[True]]]}
    data = data.assign(
        {name: (("structure", "leg", "point"), value) for name, value in legs.items()}
    )
    data["end"] = ("structure", "leg"), [["limit"]]
    data = data.assign_coords(structure=["bonded"], leg=["lowest speed"])
    listed = [line.split() for line in weak_drive.DriveBranch().summaries({"": data})][1:4]
    assert [row[:1] + row[2:3] for row in listed] == [
        ["bonded", "1.6"],
        ["bonded", "1.7"],
        ["delaminated", "1.5"],
    ]


def test_a_jump_that_no_ramp_has_and_an_undecided_one():
    """Made-up: a jump up of one of two structures, an undecided one down."""
    each = {"structure": ["bonded", "delaminated"], "jump": ["up", "down"]}
    decided = [["by held voltages", "undecided"], ["by held voltages"] * 2]
    jumps, errors = [[1.5, np.nan], [np.nan] * 2], [[1e-4, np.nan], [np.nan] * 2]
    made = {"jumps": jumps, "standard_error": errors, "decided": decided}
    data = xr.Dataset({name: (tuple(each), values) for name, values in made.items()}, each)
    _, up, down, hint = weak_drive.JumpVoltages().summary(data)
    assert up.split() == ["up", "1.50000", "+-", "0.00010", "none"]
    assert down.split() == ["down", "undecided", "none"] and "drive-branch" in hint
    assert len(list(weak_drive.JumpVoltages().summary(data.isel(jump=[0])))) == 2
    data.decided[:, 1] = ""  # the ramps went up alone, as by --one-way
    assert len(list(weak_drive.JumpVoltages().summary(data))) == 2


def test_the_weak_drive_as_a_package(ask, tmp_path):
    path = tmp_path / "weak_drive.ssp"
    for options, state in (((), "delaminated"), (("--only", "bonded"), "bonded")):
        assert ask("couple", "--ssp", path, *options).code == 0
        description = zipfile.ZipFile(path).read("SystemStructure.ssd").decode()
        assert "with a bonded" in description if state == "bonded" else state in description
    ask("couple", "--ssp", "/nowhere/x.ssp").complaint("/nowhere/x.ssp", code=1)
