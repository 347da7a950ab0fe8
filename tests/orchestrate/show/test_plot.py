"""``orchestrate.plot``: the right picture for each answer, and for answers that belong together."""

import pytest
import xarray as xr
from matplotlib.figure import Figure

import orchestrate
from orchestrate import InputError, plot
from orchestrate.show.kinds import DRAW

from . import made


def answer(kind: str, **attributes) -> xr.Dataset:
    """An answer that says what it is, and nothing else."""
    return xr.Dataset(attrs={"question": kind, **attributes})


@pytest.fixture
def drawn(monkeypatch):
    """What was drawn with what."""
    calls = {}
    for kind in ("simulate", "sweep"):

        def draw(*parts, _kind=kind, **more):
            calls[_kind] = parts, more
            return Figure()

        monkeypatch.setitem(DRAW, kind, draw)
    return calls


def test_a_slide_and_what_is_not_whole():
    curves = made.curves(False)
    width, height = plot(curves, size="16:9").get_size_inches()
    assert width / height == pytest.approx(16.0 / 9.0)
    with pytest.raises(InputError, match="size = 16x9: expected W:H"):
        plot(curves, size="16x9")
    with pytest.raises(InputError, match="varies over nothing; expected 1 of them"):
        plot(curves.isel(eta=0))


def test_the_bonded_structure_beside_it_in_any_order(drawn):
    both = [answer("simulate", bonded=flag) for flag in (1, 0)]
    for answers in (both, both[::-1]):
        plot(*answers)
        (main,), more = drawn["simulate"]
        assert main is both[1] and more["bonded"] is both[0]


def test_branches_over_a_sweep(drawn):
    sweep, branch = answer("sweep"), answer("branch")
    plot(branch, sweep, branch)
    parts, more = drawn["sweep"]
    assert parts == (sweep,) and list(map(id, more["overlay"])) == [id(branch), id(branch)]


@pytest.mark.parametrize(("kind", "part"), [("couple", "ramps"), ("simulate", "jumps")])
def test_a_part_that_there_is_not_is_refused(kind, part):
    with pytest.raises(InputError, match=f"part='{part}' of {kind}; expected 'jumps' of couple"):
        plot(answer(kind), part=part)


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
