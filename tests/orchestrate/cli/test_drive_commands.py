"""The weak drive at the command line: what its commands answer, and what they say of mistakes."""

from __future__ import annotations

import re
import zipfile
from argparse import Namespace

import numpy as np
import pytest
import xarray as xr

from orchestrate import Drive, Structure, couple
from orchestrate.cli import capture, drive_branch, jump_voltages
from orchestrate.cli import couple as couple_command
from orchestrate.figures import weak_drive

from .test_results import shows_something

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


def test_couple(ask, folder):
    done = ask("couple", "--eta0", "1.4:1.41", "--rate", "2e-4", *SHORT).success()
    bonded, delaminated = results(folder)
    assert bonded.startswith("couple_quick_") and delaminated.endswith("_delaminated")
    data = results(folder)[delaminated]
    assert data.sizes["revolution"] > 10
    assert abs(data.attrs["missing_over_motor_work"]) < 2e-6
    assert done.out.count("jump up none") == 2
    (picture,) = folder.glob("*.png")
    assert shows_something(picture)


def test_jumps_have_a_picture_of_their_own(ask, folder, tmp_path):
    ask("couple", "--eta0", "1.4:1.41", "--rate", "2e-4", *SHORT, "--plot", "none").success()
    runs = {name.rpartition("_")[2]: data for name, data in results(folder).items()}
    arguments, place = Namespace(drive="quick"), tmp_path / "couple_quick.nc"
    assert couple_command.draw_jumps(arguments, runs, place, ("png",), fresh=True) == []
    for data in runs.values():
        data.jumps[:], data.jump_time[:] = data.voltage[-5], data.time[-5]
    (picture,) = couple_command.draw_jumps(arguments, runs, place, ("png",), fresh=True)
    assert picture.name == "couple_quick_jumps.png" and shows_something(picture)


def test_another_question_has_another_file(ask, folder):
    for rate in ("4e-4", "2e-4"):
        options = ("--only", "bonded", "--plot", "none", "--rate", rate)
        ask("couple", "--eta0", "1.4:1.41", *options, *SHORT).success()
    assert len(results(folder)) == 2 and not list(folder.glob("*.png"))


def test_a_jump_is_reported_with_where_the_ramp_shows_it(ask, folder):
    options = ("--eta0", "1.55:1.65", "--rate", "2e-4", "--one-way", "--plot", "none")
    done = ask("couple", *options, *SHORT).success()
    jumps = re.findall(r"jump up at (\S+) \+- (\S+) V .*, shown at (\S+) V", done.out)
    assert len(jumps) == 2
    for (value, error, shown), fold in zip(jumps, (1.58310, 1.56970), strict=True):
        assert abs(float(value) - fold) <= float(error) + 1e-4 < 3e-4
        assert 1.59 < float(shown) < 1.64


def test_a_jump_s_fold_is_added_where_branches_are_known():
    made = {"jumps": 1.5, "jump_low": 1.4999, "jump_high": 1.5001, "ramp_voltage": 1.52}
    at = xr.Dataset(made | {"decided": "by held voltages"}, {"jump": "up 2"})
    text = "jump up 2 at 1.50000 +- 0.00010 V (eta0 = 3.00000), shown at 1.5200 V by the ramp"
    assert couple_command.format_jump(at, 0.5) == text
    assert couple_command.format_jump(at, 0.5, 1.5) == f"{text}; its branch has a fold at 1.5000 V"


def test_the_fold_of_a_jump_is_the_one_that_crosses_the_resonance():
    """Made-up for ``quick``: a ramp jumps twice, first to a motion below the resonance."""
    system = Structure.from_file("quick"), Drive.from_file("quick")
    motions = [(1.0, 1.0, 1), (1.35, 1.1, 1), (1.3, 1.15, 0), (1.2, 1.2, 0), (1.3, 1.24, 1)]
    motions += [(1.6, 1.3, 1), (1.5, 1.34, 0), (1.4, 1.38, 0), (1.5, 1.45, 1), (1.7, 1.69, 1)]
    folds = [("fold", 1.36, 1.12), ("fold", 1.19, 1.21), ("fold", 1.61, 1.31), ("fold", 1.39, 1.39)]
    made = made_branch(motions, folds)
    assert couple_command.folds_crossed(made, *system) == {
        ("bonded", "up"): 1.61,
        ("bonded", "down"): 1.39,
    }
    low = made.isel(point=slice(6)).isel(bifurcation=slice(2))
    assert couple_command.folds_crossed(low, *system) == {}
    assert couple_command.folds_crossed(None, *system) == {}


def test_what_is_undecided_is_told_and_drawn(ask, folder):
    """So fast a ramp does not tell, and voltages are hardly held."""
    options = ("--eta0", "1.5:1.75", "--rate", "2e-3", "--one-way", "--only", "bonded")
    done = ask("couple", *options, "--hold", "300", "--step", "0.4").success()
    assert "jump up undecided" in done.out and "a longer --hold may" in done.out
    (data,) = results(folder).values()
    assert data.decided.values.tolist() == ["undecided", ""]
    title = weak_drive.draw({"bonded": data}).axes[0].get_title(loc="left")
    assert title == "bonded: jump up undecided"


def test_a_motor_of_one_s_own(ask, folder, motor):
    """Volts and seconds; voltages from a file; both kinds of controllers."""
    own = ("couple", "--drive", motor, "--only", "delaminated")
    volts = ("--voltage", "5:5.2", "--volt-rate", "0.2", "--one-way", "--settle", "20")
    ask(*own, *volts).success()
    course = motor.with_name("course.csv")
    course.write_text("time,voltage\n0,4\n1,5\n1,6\n2,6\n")
    ask(*own, "--course", course).success()
    constant = ("--voltage", "6.5", "--duration", "1.5")
    strong = ("--voltage", "12", "--duration", "1.5")
    held = ask(*own, *strong, "--speed-control", "120").success()
    assert "a controller sets the voltage" in held.out and "beyond the resonance from" in held.out
    ask(*own, *constant, "--speed-gradient", "--low", "0.5").success()
    found = results(folder)
    assert len(found) == 4 and len(list(folder.glob("*.png"))) == 4
    assert any(abs(float(data.voltage[-1]) - 6.0) < 1e-9 for data in found.values())


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
    quick = ("--count", "2", "--tolerance", "0.05", "--step", "0.2")
    done = ask("capture", "--eta0", "1.5:1.6", *quick, "--only", "delaminated").success()
    assert "delaminated: passes from 1.5" in done.out
    over = ("--over", "rotor_inertia", "--values", "800,1400", "--only", "bonded")
    done = ask("capture", "--voltage", "1.45:1.6", *quick, *over).success()
    assert "bonded, rotor_inertia = 1400: passes from" in done.out
    assert len(results(folder)) == 2
    assert all(shows_something(picture) for picture in folder.glob("*.png"))


def test_what_a_capture_does_not_know_is_said(ask, folder):
    options = ("--count", "2", "--time", "100", "--step", "0.2", "--only", "bonded")
    done = ask("capture", "--eta0", "1.5:1.6", *options).success()
    assert "no border: of the voltages tried 0 pass, 0 are captured, 2 are undecided" in done.out
    assert "  at 1.5, 1.6 V undecided: the speed had not settled; give a longer --time" in done.out
    assert all(shows_something(picture) for picture in folder.glob("*.png"))


def test_a_border_that_is_not_to_be_trusted(capsys):
    """Made-up: an interval that undecided starts have left, above the fold."""
    data = xr.Dataset(
        {
            "passes": ("voltage", [0, 0, 1]),
            "decision": ("voltage", ["converged", "undecided", "converged"]),
            "passage_time": ("voltage", [np.nan, np.nan, 5.0]),
            "border": ((), 1.525, {"tolerance": 1e-4}),
            **{"border_low": 1.49, "border_high": 1.56, "fold": 1.45, "above_fold": 1.0},
            **{"speed_low": 1.25, "speed_high": 1.55},
        },
        {"voltage": [1.4, 1.5, 1.6]},
    )
    capture.print_result("bonded", data)
    border, undecided, warning = capsys.readouterr().out.splitlines()
    assert border == (
        "bonded: captured up to 1.49000 V, passes from 1.56000 V on, in at most 5 s as tried; "
        "1.25 rad/s below, 1.55 rad/s beyond; undecided between"
    )
    assert undecided.startswith("  at 1.5 V undecided")
    assert "warning: that is above the fold at 1.45000 V" in warning
    sure = data.assign(border_low=1.52496, border_high=1.52504, above_fold=0.0)
    capture.print_result("bonded", sure.isel(voltage=[0, 2]))
    (border,) = capsys.readouterr().out.splitlines()
    text = (
        "bonded: passes from 1.52500 V on (+- 4e-05 V), in at most 5 s as tried; 1.25 rad/s below"
    )
    assert border == f"{text}, 1.55 rad/s beyond"


def test_passage(ask, folder):
    options = ("--eta0", "1.55:1.65", "--rate", "2e-4", "--around", "60", "--one-way", *SHORT)
    done = ask("passage", *options, "--revolutions", "4", "--only", "delaminated").success()
    assert done.out.count("jump up at 1.569") == 1 and "around jumps" in done.out
    (picture,) = folder.glob("*.png")
    assert shows_something(picture)


@pytest.mark.slow
def test_jump_voltages(ask, folder):
    options = ("--eta0", "1.5:1.66", "--rate", "4e-4,3e-4", "--one-way", "--jobs", "1", *SHORT)
    done = ask("jump-voltages", *options).success()
    assert "in V, at rate 0" in done.out and "nan" not in done.out
    (data,) = results(folder).values()
    assert data.jumps.attrs["units"] == "V"
    assert shows_something(next(folder.glob("*.png")))


@pytest.mark.slow
def test_drive_branch(ask, folder):
    options = ("--speed", "1.29:1.32", "--longest", "0.3", "--jobs", "1")
    done = ask("drive-branch", *options).success()
    assert "bonded: fold at 1.583" in done.out and "the jump up of a slow ramp" in done.out
    assert shows_something(next(folder.glob("*.png")))


def test_a_jump_that_no_ramp_has_and_an_undecided_one(capsys):
    """Made-up: a jump up of one of two structures, an undecided one down."""
    each = {"structure": ["bonded", "delaminated"], "jump": ["up", "down"]}
    decided = [["by held voltages", "undecided"], ["by the record"] * 2]
    jumps, errors = [[1.5, np.nan], [np.nan] * 2], [[1e-4, np.nan], [np.nan] * 2]
    made = {"jumps": jumps, "standard_error": errors, "decided": decided}
    data = xr.Dataset({name: (tuple(each), values) for name, values in made.items()}, each)
    jump_voltages.print_result(data, directions=("up", "down"))
    _, up, down, hint = capsys.readouterr().out.splitlines()
    assert up.split() == ["up", "1.50000", "+-", "0.00010", "none"]
    assert down.split() == ["down", "undecided", "none"] and "drive-branch" in hint
    jump_voltages.print_result(data, directions=("up",))
    assert "drive-branch" not in capsys.readouterr().out


def made_branch(motions, bifurcations):
    """A branch of one leg, by voltage, speed and whether it is stable, and its bifurcations."""
    along = {"structure": ["bonded"], "leg": ["from below"]}
    names = ("voltage", "speed", "stable")
    made = {
        name: ((*along, "point"), np.array(column)[None, None])
        for name, column in zip(names, zip(*motions, strict=True), strict=True)
    }
    made["revolutions"] = xr.ones_like(xr.DataArray(made["speed"][1], dims=(*along, "point")))
    made["end"] = (tuple(along), [["limit"]])
    columns = {
        "structure": ["bonded"] * len(bifurcations),
        "revolutions": [1.0] * len(bifurcations),
    }
    names = ("kind", "voltage", "speed")
    columns |= dict(zip(names, map(list, zip(*bifurcations, strict=True)), strict=True))
    made |= {f"bifurcation_{name}": ("bifurcation", column) for name, column in columns.items()}
    return xr.Dataset(made, along)


def test_stationary_motions_are_told_with_what_they_mean(capsys):
    """Made-up: a branch with two folds, and one change of stability that was not located."""
    motions = [(1.0, 0.8, 0), (1.2, 0.9, 1), (1.4, 1.0, 1), (1.3, 1.1, 0), (1.2, 1.2, 0)]
    motions += [(1.35, 1.3, 1), (1.5, 1.4, 1)]
    drive_branch.print_result(made_branch(motions, [("fold", 1.41, 1.03), ("fold", 1.19, 1.22)]))
    up, down, end, count, change = capsys.readouterr().out.splitlines()
    meaning = "the jump up of a slow ramp, at rate 0, to 1.34 rad/s"
    assert up == f"bonded: fold at 1.41000 V, 1.03 rad/s: {meaning}"
    assert down.endswith("1.22 rad/s: the jump down of a slow ramp, at rate 0")
    nowhere = "these branches have no stable motion at 1.19000 V to jump to"
    assert end == f"bonded, a slow ramp down: {nowhere}"
    assert "7 motions, 4 of them stable; it reaches the end of the range" in count
    assert change.startswith("  stability changes near 0.8 rad/s too, not located")


def test_titles_name_set_volts_and_rates():
    """Made-up answers; what a picture's title says of them."""
    each = {"structure": ["bonded", "delaminated"], "jump": ["up", "down"]}
    rates = np.array([2.5e-5, 1e-4])
    at_rates = np.array([1.59, 1.61])[:, None, None] * np.ones((1, 2, 2))
    made = {
        "voltage": (("rate", *each), at_rates),
        "jumps": (tuple(each), np.full((2, 2), 1.58)),
        "standard_error": (tuple(each), np.full((2, 2), np.nan)),
    }
    ramps = xr.Dataset(made, {"rate": rates, **each})
    figure = jump_voltages.draw_result(ramps, "quick", (1.2, 1.65))
    title = "quick: 1.2 V to 1.65 V, 2.5e-05 V/s to 0.0001 V/s, and at rate 0"
    assert figure.get_suptitle() == title
    along = {"structure": ["bonded"], "leg": ["from below"]}
    names = ("speed", "voltage", "amplitude")
    motions = {name: ((*along, "point"), np.array([[[1.1, 1.3, 1.2]]])) for name in names}
    motions["stable"] = ((*along, "point"), np.ones((1, 1, 3), dtype=bool))
    for name in ("structure", "kind", "voltage", "speed", "amplitude"):
        motions[f"bifurcation_{name}"] = ("bifurcation", np.zeros(0))
    figure = drive_branch.draw_result(xr.Dataset(motions, along), "beam")
    assert figure.get_suptitle() == "beam: stationary motions, held by 1.1 V to 1.3 V"


def test_the_weak_drive_as_a_package(ask, tmp_path):
    path = tmp_path / "weak_drive.ssp"
    for options, state in (((), "delaminated"), (("--only", "bonded"), "bonded")):
        assert ask("couple", "--ssp", path, *options).code == 0
        description = zipfile.ZipFile(path).read("SystemStructure.ssd").decode()
        assert "with a bonded" in description if state == "bonded" else state in description
    ask("couple", "--ssp", "/nowhere/x.ssp").complaint("/nowhere/x.ssp", code=1)


OF_ALL = [
    (["--drive", "rigg"], ["rigg", "no such file", "quick"]),
    (["--structure", "glued"], ["glued", "no such file"]),
    (["--set", "x=1"], ["x", "no parameter"]),
    (["--set", "motor_constant=0"], ["motor_constant = 0.0", "> 0"]),
    (["--fmu", "nowhere.fmu"], ["nowhere.fmu", "no such file"]),
    (["--jobs", "0"], ["jobs = 0"]),
    (["--format", "doc"], ["--format doc", "xlsx"]),
    (["--plot", "gif"], ["--plot gif", "png"]),
]
SHEET = ("--rated-voltage", "12", "--no-load-rpm", "3000")
DATASHEETS = [
    (SHEET[:2], ["--rated-voltage 12", "without --no-load-rpm", "--stall-torque together"]),
    (SHEET, ["--rated-voltage 12", "without --stall-torque", "expected"]),
    ([*SHEET, "--stall-torque", "0"], ["--stall-torque 0", "expected a number > 0"]),
    ([*SHEET, "--stall-torque", "nan"], ["--stall-torque nan", "expected a number > 0"]),
    ([*SHEET, "--stall-torque", "inf"], ["--stall-torque inf", "expected a number > 0"]),
    (
        [*SHEET, "--stall-torque", "1", "--set", "motor_constant=2"],
        ["--set motor_constant=2", "beside --rated-voltage", "one of them"],
    ),
]
VOLTAGES = [
    (["--eta0", "x:2"], ["--eta0 x:2", "FIRST:LAST"]),
    (["--eta0", "1:2", "--voltage", "1:2"], ["--eta0 and --voltage", "one of them"]),
    (["--step", "-0.1"], ["step = -0.1 s", "0.0001 <= step <= 1"]),
    (["--eta0", "1:1"], ["voltage"]),
]
SCHEDULES = [
    *VOLTAGES,
    (["--eta0", "nan:2"], ["voltage = nan V", "finite"]),
    (["--eta0", "1.2"], ["one voltage, 1.2 V", "--duration"]),
    (["--eta0", "1:2", "--duration", "3"], ["--duration", "one voltage"]),
    (["--voltage", "high"], ["--voltage high", "a number, or FIRST:LAST"]),
    (["--rate", "0"], ["--rate 0", "> 0"]),
    (["--rate", "nan"], ["--rate nan", "expected a number > 0"]),
    (["--rate", "1e-4,5e-5"], ["--rate 1e-4,5e-5", "expected one", "jump-voltages"]),
    (["--rate", "1e-4", "--volt-rate", "1"], ["--rate and --volt-rate"]),
    (["--volt-rate", "fast"], ["--volt-rate fast", "> 0"]),
    (["--rate", "1e-9", "--step", "1e-3"], ["steps", "at most 1e+09"]),
    (["--increment", "2"], ["increment = 2.0 V", "0 <= increment"]),
    (["--settle", "-1"], ["settle = -1.0 s", "0 <= settle"]),
    (["--course", "nowhere.csv"], ["nowhere.csv", "cannot be read"]),
    (["--course", "a.csv", "--eta0", "1:2"], ["--course and --eta0"]),
    (["--set", "armature_resistance=1e-3"], ["does not jump", "--eta0 or --voltage"]),
]
CONTROLS = [
    (["--speed-control", "1.5", "--speed-gradient"], ["--speed-control and --speed-gradient"]),
    (["--gain", "2"], ["--gain 2", "--speed-control with it"]),
    (["--low", "0.5"], ["--low 0.5", "--speed-gradient with it"]),
    (["--speed-control", "nan"], ["speed = nan", "finite"]),
    (["--speed-control", "1.5", "--gain", "-1"], ["gain = -1.0", "0 < gain"]),
    (["--speed-gradient", "--low", "2"], ["low = 2.0", "0 <= low <= 1"]),
]
CASES = {
    "couple": [
        *(*OF_ALL, *DATASHEETS, *SCHEDULES, *CONTROLS),
        (["--tolerance", "-1"], ["tolerance", ">= 0"]),
        (["--hold", "-1"], ["hold = -1.0 s", "0 <= hold"]),
    ],
    "passage": [
        *(*OF_ALL, *SCHEDULES, *CONTROLS),
        (["--around", "0"], ["around = 0.0 s", "0 < around"]),
        (["--revolutions", "0"], ["--revolutions 0", ">= 1"]),
    ],
    "capture": [
        *(*OF_ALL, *VOLTAGES, *CONTROLS),
        (["--over", "D"], ["--over and --values", "both"]),
        (["--over", "colour", "--values", "1,2"], ["colour", "no parameter"]),
        (["--over", "D", "--values", "a"], ["--values a", "not numbers"]),
        (["--count", "1"], ["count = 1", "from 2"]),
        (["--tolerance", "0"], ["tolerance = 0.0 V", "0 < tolerance"]),
        (["--time", "-1"], ["time = -1.0 s", "0 < time"]),
        (["--eta0", "1.5"], ["--eta0 1.5", "FIRST:LAST"]),
    ],
    "jump-voltages": [
        *(*OF_ALL, *VOLTAGES),
        (["--rate", "1:2:3"], ["--rate 1:2:3", "A,B,..., such as 1e-4,5e-5"]),
        (["--rate", "1e-4,-1"], ["--rate 1e-4,-1", "> 0"]),
        (["--eta0", "1.5"], ["--eta0 1.5", "FIRST:LAST"]),
        (["--settle", "-1"], ["settle = -1.0 s", "0 <= settle"]),
    ],
    "drive-branch": [
        *(*OF_ALL, *DATASHEETS[1:3]),
        (["--speed", "1"], ["--speed 1", "FIRST:LAST"]),
        (["--speed", "2:1"], ["speed = (2.0, 1.0)", "first < last"]),
        (["--longest", "0"], ["longest = 0.0", "<= longest <="]),
        (["--most", "1"], ["most = 1", "from 2 to"]),
        (["--steps", "3"], ["steps = 3", "from 16 to"]),
        (["--period", "0"], ["period = 0", "from 1 to"]),
    ],
}
MISTAKES = [(name, *case) for name, cases in CASES.items() for case in cases]


@pytest.mark.parametrize(
    ("command", "options", "words"),
    MISTAKES,
    ids=lambda value: value if isinstance(value, str) else " ".join(value),
)
def test_mistake(ask, tmp_path, command, options, words):
    done = ask(command, *options)
    assert done.out == ""
    done.complaint(*words)
    assert done.err.startswith("error: ")
    assert list(tmp_path.iterdir()) == []
