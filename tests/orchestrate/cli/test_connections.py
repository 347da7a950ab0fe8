"""Drives that cannot be connected as the command has it: a line each, and nothing written."""

import zipfile

import pytest

from orchestrate import cli
from tests.orchestrate.weak_drive.drives.linear import draw

A, F = "box_acceleration=acc", "box_force=force"
RUN = ("--duration", "0.1", "--step", "0.01", "--plot", "none")
NAMED = '<UnitDefinitions><Unit name="fathom"/></UnitDefinitions>'  # without a base unit
NAMES = ("force", "command", "acc", "pos", "vel")


@pytest.fixture(scope="module")
def drives(exported, tmp_path_factory):
    """FMUs by what is odd about them."""
    folder = tmp_path_factory.mktemp("drives")
    drive = draw(0)
    plain = type(drive)(drive.a, drive.b, drive.c, drive.d, NAMES).write(folder, "plain")
    millimetres = '<Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>'
    newtons = '<Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit>'
    known, variables = (
        f"<UnitDefinitions>{millimetres}{newtons}</UnitDefinitions>",
        "<ModelVariables>",
    )
    varies = 'canHandleVariableCommunicationStepSize="true"'
    changes = {
        "units": {
            variables: f"{known}{variables}",
            **{'name="acc"': 'name="acc" unit="mm"', 'name="force"': 'name="force" unit="N"'},
        },
        "strange": {variables: f"{NAMED}{variables}", 'name="acc"': 'name="acc" unit="fathom"'},
        "single": {'<Float64 name="acc"': '<Float32 name="acc"'},
        "internal": {varies: f'{varies} fixedInternalStepSize="0.01"'},
        "equal": {varies: varies.replace("true", "false")},
        "exchange": {"CoSimulation modelId": "ModelExchange modelId", varies: ""},
        "first": {'fmiVersion="3.0"': 'fmiVersion="1.0"'},
        "unbound": {'modelIdentifier="linear"': 'modelIdentifier="other"'},
    }
    with zipfile.ZipFile(plain) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    for name, replaced in changes.items():
        text = files["modelDescription.xml"].decode()
        for old, new in replaced.items():
            assert old in text
            text = text.replace(old, new)
        with zipfile.ZipFile(folder / f"{name}.fmu", "w") as archive:
            for path, content in files.items():
                archive.writestr(path, text if path == "modelDescription.xml" else content)
    (folder / "column.csv").write_text("time,volts\n0,1\n1,two\n")
    return folder


BOTH = f"--connect {A} {F}"
BAD = {  # a drive, options, and what the line says
    "nothing": ("plain", "", "connect: a motion of the box is missing"),
    "no force": ("plain", f"--connect {A}", "and box_force"),
    "no name": ("plain", f"--connect box_acceleration= {F}", "box_acceleration="),
    "input as motion": ("plain", f"--connect box_acceleration=command {F}", "causality input"),
    "one variable twice": ("plain", f"{BOTH} box_force_1=force", "force is connected twice"),
    "unit": ("units", BOTH, "acc of the FMU Linear is in mm"),
    "unit that is not known": ("strange", BOTH, "state it, as --unit acc=m/s2"),
    "unit of nothing": ("plain", f"{BOTH} --unit acc=fathom", "units: acc = 'fathom'; expected"),
    "unit of another kind": ("plain", f"{BOTH} --unit acc=N", "acc of the FMU Linear is in N"),
    "single precision": ("single", BOTH, "double precision"),
    "parameter that is not": ("plain", f"{BOTH} --parameter p30=1", "did you mean p"),
    "input that is not": ("plain", f"{BOTH} --input volts=1", "no variable 'volts'"),
    "input of no numbers": ("plain", f"{BOTH} --input command=column.csv", "line 3"),
    "a rest of a step": ("equal", f"{BOTH} --step 0.03", "takes only steps of one length"),
    "half an internal step": ("internal", BOTH, "expected a multiple of 0.02 s, half of"),
    "a start through itself": ("plain", f"{BOTH} --start 1,0,0,0", "start"),
    "no co-simulation": ("exchange", BOTH, "co-simulation"),
    "FMI 1.0": ("first", BOTH, "first.fmu"),
    "no binary": ("unbound", BOTH, "no binary for this machine"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_connected_is_a_line(drives, tmp_path, monkeypatch, capsys, name):
    fmu, options, words = BAD[name]
    monkeypatch.chdir(drives)
    line = ["cosimulate", "--structure", "beam", "--drive", f"{fmu}.fmu", *RUN]
    code = cli.main([*line, *options.split(), "--output", str(tmp_path / "results")])
    done = capsys.readouterr()
    text = done.err.splitlines()[-1] if done.err else ""
    assert code == 2 and text.startswith("error: ") and words in text, (code, done.err)
    assert "Traceback" not in done.err and done.err.count("error:") == 1
    assert not list(tmp_path.iterdir())


def test_the_list_says_why_a_connection_is_proposed(drives, capsys):
    assert cli.main(["cosimulate", "--drive", str(drives / "units.fmu"), "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("likely: --connect "))
    reasons = dict(line.split(":") for line in lines[at + 1 :])
    assert reasons == {
        "  box_velocity      vel": " a name like it",
        "  box_position      acc": " output in mm",
        "  box_force         force": " input in N and a name like it",
    }


def test_a_drive_runs_without_a_structure(drives, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    line = ["cosimulate", "--structure", "none", "--drive", str(drives / "plain.fmu"), *RUN]
    assert cli.main([*line, "--connect", A, "--input", "command=1"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "no structure: the drive alone for 0.1 s"
    assert lines[1].startswith("acceleration of the box: ")
    assert len(list((tmp_path / "results").glob("cosimulate_plain_none_*.nc"))) == 1
    for more, words in ((["--set", "m1=2"], "--set: --structure none has"), ([], "has no struct")):
        assert cli.main([*line, "--connect", A, F, *more]) == 2
        assert words in capsys.readouterr().err
