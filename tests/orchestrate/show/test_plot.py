"""``orchestrate.plot``: the right picture for each answer, and for answers that belong together."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import orchestrate
from orchestrate import Drive, InputError, Structure, plot
from orchestrate.show.kinds import DRAW

PAPER = Structure.nondimensional()
QUIET = {"progress": False}


@pytest.fixture(scope="module")
def simulated():
    return [orchestrate.simulate(s, eta=1.2, periods=5) for s in (PAPER.as_bonded(), PAPER)]


@pytest.fixture(scope="module")
def continued():
    sweep = orchestrate.sweep(PAPER, eta=np.arange(2.6, 2.7, 0.02), transient=50, samples=8)
    return sweep, orchestrate.branch(PAPER, eta=2.62, over="eta", limits=(2.6, 2.7), **QUIET)


@pytest.fixture(scope="module")
def driven():
    quick, drive = Structure.from_file("quick"), Drive.from_file("quick")
    question = {"voltage": (1.2, 1.25), "rate": 1e-2, **QUIET}
    return [orchestrate.couple(s, drive, **question) for s in (quick.as_bonded(), quick)]


@pytest.fixture
def drawn(monkeypatch):
    """What was drawn with what."""
    calls = {}
    for kind in ("branch", "simulate", "sweep", "couple"):

        def draw(*parts, _kind=kind, **more):
            calls[_kind] = parts, more
            return Figure()

        monkeypatch.setitem(DRAW, kind, draw)
    return calls


def test_a_slide_and_what_is_not_whole(simulated, continued):
    width, height = plot(simulated[1], size="16:9").get_size_inches()
    assert width / height == pytest.approx(16.0 / 9.0)
    with pytest.raises(InputError, match="size = 16x9: expected W:H"):
        plot(simulated[1], size="16x9")
    with pytest.raises(InputError, match="varies over nothing; expected 1 of them"):
        plot(continued[0].isel(eta=0))


def test_the_bonded_structure_beside_it_in_any_order(simulated, drawn):
    bonded, delaminated = simulated
    for answers in (simulated, simulated[::-1]):
        plot(*answers)
        (main,), more = drawn["simulate"]
        assert main is delaminated and more["bonded"] is bonded


def test_branches_over_a_sweep(continued, drawn):
    sweep, branch = continued
    plot(branch, sweep, branch)
    parts, more = drawn["sweep"]
    assert parts == (sweep,) and list(map(id, more["overlay"])) == [id(branch), id(branch)]


@pytest.mark.parametrize(("which", "part"), [(slice(None), "ramps"), (slice(0), "jumps")])
def test_a_part_that_there_is_not_is_refused(driven, simulated, which, part):
    answers = driven[which] or simulated
    with pytest.raises(InputError, match=rf"part='{part}' of \w+; expected 'jumps' of couple"):
        plot(*answers, part=part)


def test_all_public_questions_are_drawn_or_known_to_have_no_picture():
    public = {name for name in orchestrate.__all__ if name.islower()}
    named = {"track_orders": "orders"}  # what an analysis calls itself
    # an orbit is drawn as a motion begun on it, a passage with its waterfall; records are analysed
    assert {name for name in public if named.get(name, name) not in DRAW} == {
        *("couple_all", "impact_statistics", "orbit", "passage", "plot", "waterfall", "write_ssp"),
        *("__version__", "channels", "measure", "record", "read_record", "write_record"),
        *("read_curve", "resonance_curve"),
        *("detect_all", "report", "basin_entropy", "record_of_run", "halves", "to_dataframe"),
    }


@pytest.mark.parametrize("given", [3, xr.Dataset(), None])
def test_what_is_no_answer(given):
    with pytest.raises(InputError, match="cannot plot"):
        plot(given)
