"""Commands that begin with a stored result take its structure, or say that it is another."""

import functools
import json

import pytest
import xarray as xr

import orchestrate
from orchestrate.model import Structure

BEAM = Structure.from_file("beam")
STORED = BEAM.replace(e=0.65)
HERTZ = ("--over", "hz", "--limits", "14:18")
COMMANDS = {
    "branch": HERTZ,
    "border": ("--over", "hz,e", "--limits", "14:18,0.6:0.8"),
    "manifold": (),
}


@pytest.fixture
def path(tmp_path):
    """Return a file whose attributes are those of a branch of the beam along the frequency."""
    attributes = {name: float(value) for name, value in STORED.parameters().items()}
    call = {"call": "branch(...)", "over": "frequency", "identity": json.dumps({"question": {}})}
    path = tmp_path / "stored.nc"
    data = xr.Dataset({"stable": ("point", [1])}, attrs={**attributes, **call})
    data.to_netcdf(path)
    return path


@pytest.fixture
def asked(monkeypatch):
    """Return a list to which each question of a command is added, which is not computed."""
    questions = []

    def unanswered(function):
        @functools.wraps(function)
        def ask_only(structure, **question):
            questions.append((structure, question))
            raise RuntimeError("not computed")

        return ask_only

    for command in COMMANDS:
        monkeypatch.setattr(orchestrate, command, unanswered(getattr(orchestrate, command)))
    return questions


@pytest.mark.parametrize("command", COMMANDS)
def test_the_structure_is_that_of_the_file(ask, path, asked, command):
    done = ask(command, "--start", path, *COMMANDS[command])
    ((structure, _),) = asked
    assert structure == STORED
    assert done.out == ""


@pytest.mark.parametrize("command", COMMANDS)
def test_another_structure_is_taken_and_said_in_one_line(ask, path, asked, command):
    said = f"--start {path} was computed for another structure: "
    for options, structure, difference in (
        (("--set", "e=0.6"), STORED.replace(e=0.6), "e = 0.65 there, 0.6 here"),
        (("--structure", "beam"), BEAM, "e = 0.65 there, 0.7 here"),
        (("--structure", "paper"), Structure(), "m1 = 1.5 there, 1 here"),
    ):
        done = ask(command, "--start", path, *COMMANDS[command], *options)
        assert asked.pop()[0] == structure
        (line,) = done.out.splitlines()
        assert line.startswith(said + difference)
    same = ("--structure", "beam", "--set", "e=0.65")
    assert ask(command, "--start", path, *COMMANDS[command], *same).out == ""


@pytest.mark.parametrize("command", ["branch", "manifold"])
def test_without_a_file_it_is_the_paper_s_as_before(ask, asked, command):
    limits = ("--limits", "2.4:2.8") if command == "branch" else ()
    done = ask(command, "--eta", "2.5", *limits)
    ((structure, question),) = asked
    assert structure == Structure() and question["start"] is None
    assert done.out == ""


def test_an_orbit_begins_with_one_that_is_stored(ask, tmp_path):
    """Of two orbits at this frequency the unstable one, which a search from rest does not find."""
    first, near = tmp_path / "first.nc", tmp_path / "near.nc"
    short = ("--plot", "none", "--store")
    ask("orbit", "--eta", "3.0", *short, first).success()
    done = ask("orbit", "--eta", "3.01", "--guess", first, *short, near).success()
    assert done.out.startswith("unstable") and xr.load_dataset(near).attrs["period"] == 1
    ask("orbit", "--eta", "3", "--guess", tmp_path / "no.nc").complaint("--guess", "no such file")


def test_a_file_without_a_structure_is_refused(ask, tmp_path):
    path = tmp_path / "other.nc"
    xr.Dataset({"x": ("t", [1.0])}, attrs={"call": "analyse(...)"}).to_netcdf(path)
    done = ask("branch", "--start", path, *HERTZ)
    done.complaint(
        f"--start {path}", "a dataset over t, without a structure", "expected an orbit or"
    )


def test_the_explorer_draws_branches_over_the_diagram_of_their_structure(
    ask, path, monkeypatch, tmp_path
):
    pages = []

    def write(data, **options):
        pages.append(data)
        raise RuntimeError("not written")

    monkeypatch.setattr("orchestrate.explorer.page.explore", write)
    shown = ("explore", "--no-open", "--branches", path)
    assert ask(*shown).out == ""
    other = ask(*shown, "--structure", "paper").out
    assert pages == [STORED, Structure()]
    assert other.startswith(f"--branches {path} was computed for another structure: m1 = 1.5")
    ask("explore", path, "--structure", "paper", "--no-open").complaint("expected one of them")
