"""The weak drive at the command line: motors of one's own, jumps, packages."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
import xarray as xr

from orchestrate import Drive, Structure, couple
from orchestrate.cli import weak_drive

from .test_commands import shows_something

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


def results(folder):
    """The datasets in a folder, by name."""
    return {path.stem: xr.load_dataset(path) for path in sorted(folder.glob("*.nc"))}


@pytest.mark.slow
def test_couple_tells_jumps_beside_where_the_ramp_shows_them(ask, tmp_path):
    folder = tmp_path / "results"
    options = ("--eta0", "1.55:1.65", "--rate", "2e-4", "--one-way", "--only", "delaminated")
    out = ask("couple", *options, "--step", "0.2", "--settle", "30").success().out
    up, down = (
        next(line for line in out.splitlines() if line.startswith(f"  {way}")).split()
        for way in ("up", "down")
    )
    value, error, eta0, shown = map(float, (up[1], up[3], up[4], up[5]))
    assert abs(value - 1.56970) <= error + 1e-4 < 3e-4
    assert eta0 == pytest.approx(value, abs=1e-5) and 1.59 < shown < 1.64
    assert down[1] == "none" and " ".join(down).endswith("the voltage does not fall")
    ((name, data),) = results(folder).items()
    assert name.startswith("couple_quick_") and name.endswith("_delaminated")
    assert abs(data.attrs["missing_over_motor_work"]) < 2e-6
    pictures = sorted(folder.glob("*.png"))
    assert len(pictures) == 2 and pictures[1].stem == f"{pictures[0].stem}_jumps"
    assert all(map(shows_something, pictures))


def test_a_motor_of_one_s_own(ask, tmp_path):
    """Volts and seconds; voltages from a file; both kinds of controllers; as a package."""
    motor, none = tmp_path / "motor.toml", ("--plot", "none")
    motor.write_text(MOTOR)
    own = ("couple", "--structure", "beam", "--set", "clearance=20um", "--drive", motor)
    own = (*own, "--only", "delaminated")
    ramp = ("--voltage", "5:5.2", "--volt-rate", "0.2", "--one-way", "--settle", "20")
    ask(*own, *ramp, *none).success()
    course = motor.with_name("course.csv")
    course.write_text("time,voltage\n0,4\n1,5\n1,6\n2,6\n")
    ask(*own, "--course", course).success()
    strong = ("--voltage", "12", "--duration", "1.5", *none)
    held = ask(*own, *strong, "--speed-control", "120").success()
    assert "a controller sets the voltage" in held.out
    assert "speed stays beyond the resonance: " in held.out
    ask(*own, *strong, "--speed-gradient", "--low", "0.5").success()
    found = results(tmp_path / "results")
    assert len(found) == 4 and len(list((tmp_path / "results").glob("*.png"))) == 1
    assert any(abs(float(data.voltage[-1]) - 6.0) < 1e-9 for data in found.values())
    assert all(name.startswith("couple_motor_beam_") for name in found)
    title = weak_drive.Couple(drive=motor, structure="beam").picture_title(found)
    assert title.startswith("motor, beam: $f_1$ = 11.94 Hz") and "clearance 20 µm" in title
    path = tmp_path / "weak_drive.ssp"
    for options, state in (((), "delaminated"), (("--only", "bonded"), "with a bonded")):
        assert ask("couple", "--ssp", path, *options).code == 0
        assert state in zipfile.ZipFile(path).read("SystemStructure.ssd").decode()
    ask("couple", "--ssp", "/nowhere/x.ssp").complaint("/nowhere/x.ssp", code=1)


def test_a_motor_by_its_datasheet(ask, tmp_path):
    """The torque line through no-load speed and stall torque, in place of the set's constants."""
    sheet = ("--rated-voltage", "2", "--no-load-rpm", "16", "--stall-torque", "60")
    constant = ("--voltage", "2", "--duration", "60", "--only", "bonded", "--plot", "none")
    ask("couple", *sheet, *constant).success()
    (data,) = results(tmp_path / "results").values()
    speed = 2.0 * np.pi * 16.0 / 60.0
    line = {"motor_constant": 2.0 / speed, "armature_resistance": (2.0 / speed) * 2.0 / 60.0}
    drive, structure = Drive.from_file("quick").replace(**line), Structure.from_file("quick")
    expected = couple(structure.as_bonded(), drive, voltage=2.0, duration=60.0, progress=False)
    assert np.array_equal(data.speed, expected.speed) and data.sizes["revolution"] > 10


def test_a_jump_that_is_undecided_is_shown_so():
    each = {"structure": ["bonded", "delaminated"], "jump": ["up", "down"]}
    decided = [["by held voltages", "undecided"], ["by held voltages"] * 2]
    jumps, errors = [[1.5, np.nan], [np.nan] * 2], [[1e-4, np.nan], [np.nan] * 2]
    made = {"jumps": jumps, "standard_error": errors, "decided": decided}
    data = xr.Dataset({name: (tuple(each), values) for name, values in made.items()}, each)
    _, up, down, *_, hint = weak_drive.JumpVoltages().summary_lines(data)
    assert up.split() == ["bonded", "up", "1.50000", "+-", "0.0001", "by", "held", "voltages"]
    assert down.split() == ["bonded", "down", "none", "undecided"] and "drive-branch" in hint
