"""The weak drive at the command line: motors of one's own, jumps, packages."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
import xarray as xr

from orchestrate import Drive, Structure, couple
from orchestrate.cli import weak_drive
from orchestrate.model.toml_files import write

from .test_commands import shows_something


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
    drive = Drive.from_file("beam").replace(unbalance_mass=0.03, armature_inductance=0.002)
    motor, none = write(tmp_path / "motor.toml", drive=drive), ("--plot", "none")
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


def test_branches_and_what_changes_along_them_are_shown():
    """Made-up: one whose stability changes unnoticed, one with a located fold, one that is none."""
    sides = {"structure": ["bonded", "delaminated"], "leg": ["from below", "from above"]}
    voltage = np.array(
        [[[1.0, 2.0, 3.0], [1.0, np.nan, np.nan]], [[4.0, 5.0, np.nan], [np.nan] * 3]]
    )
    stable = np.array([[[1, 0, 0], [1, 0, 0]], [[1, 0, 0], [0, 0, 0]]])
    points = {"voltage": voltage, "speed": 10.0 * voltage, "stable": stable}
    data = xr.Dataset({n: ((*sides, "point"), values) for n, values in points.items()}, sides)
    data = data.assign(end=(tuple(sides), [["limit", "most points"], ["fold", ""]]))
    row = {"structure": "delaminated", "kind": "fold", "voltage": 4.5, "speed": 45.0}
    data = data.assign({f"bifurcation_{n}": ("bifurcation", [x]) for n, x in row.items()})
    lines = [" ".join(line.split()) for line in weak_drive.DriveBranch().summary_lines(data)]
    assert lines[2] == "delaminated fold 4.5 45" and "jump-voltages" in lines[3]
    title = "structure leg motions stable ends by voltage speed unlocated changes of stability near"
    assert lines[4].startswith(title)
    assert lines[5:8] == [
        "bonded from below 3 1 limit 3.00000 30 10 rad/s",
        "bonded from above 1 1 most points 1.00000 10",
        "delaminated from below 2 1 fold 5.00000 50",
    ]
    assert lines[8:] == ["most points: a larger --most goes on"]


def test_a_jump_that_is_undecided_is_shown_so():
    each = {"structure": ["bonded", "delaminated"], "jump": ["up", "down"]}
    decided = [["by held voltages", "undecided"], ["by held voltages"] * 2]
    jumps, errors = [[1.5, np.nan], [np.nan] * 2], [[1e-4, np.nan], [np.nan] * 2]
    made = {"jumps": jumps, "standard_error": errors, "decided": decided}
    data = xr.Dataset({name: (tuple(each), values) for name, values in made.items()}, each)
    _, up, down, *_, hint = weak_drive.JumpVoltages().summary_lines(data)
    assert up.split() == ["bonded", "up", "1.50000", "+-", "0.0001", "by", "held", "voltages"]
    assert down.split() == ["bonded", "down", "none", "undecided"] and "drive-branch" in hint
