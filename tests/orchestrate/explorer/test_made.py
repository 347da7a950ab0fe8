"""What a page is made of, and what it refuses."""

import re

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate.errors import InputError
from orchestrate.explorer import sweep_data
from orchestrate.explorer.page import explore
from orchestrate.explorer.sweep_data import read_sweep
from orchestrate.running.store import load_result

from ..elements import Elements


def test_the_page_is_one_small_file_without_network(page):
    text = page.read_text(encoding="utf-8")
    assert page.stat().st_size < 1_500_000
    assert not re.search(r'(?:src|href)="(?!data:|#|\$)', text)
    assert not re.search(r"\b(?:fetch|XMLHttpRequest|WebSocket|cookie|localStorage)\b", text)
    assert set(re.findall(r"https?://[^\s\"'`]+", text)) <= {"http://www.w3.org/2000/svg"}


MARKUP = "</script></p><script>window.forged = 1</script><img src=x onerror='window.forged = 2'>"


@pytest.fixture(scope="module")
def forged(swept, tmp_path_factory):
    """A page of a file whose every text is markup."""
    path = tmp_path_factory.mktemp("forged") / "page.html"
    kept = ("start", "direction", "bonded")
    texts = {name for name, value in swept.attrs.items() if isinstance(value, str)} - {*kept}
    assert {"source", "fmu_model", "fmu_guid", "call"} <= texts
    return explore(swept.assign_attrs(dict.fromkeys(texts, MARKUP)), output=path)


def test_what_a_file_says_is_text_on_its_page_and_no_markup(page, forged):
    clean, other = (Elements(path.read_text(encoding="utf-8")) for path in (page, forged))
    assert other.tags == clean.tags and other.tags.count("script") == 5
    assert not any(name.startswith("on") for name in other.attributes)
    assert MARKUP not in forged.read_text(encoding="utf-8")


def test_no_script_of_a_file_runs_and_none_that_is_added_to_its_page(chromium, forged):
    chromium.open(forged)
    assert MARKUP in chromium.run("return document.querySelector('footer').textContent")
    for add in (
        "const one = document.createElement('script'); one.textContent = 'window.forged = 3';"
        "document.body.append(one)",
        "document.body.insertAdjacentHTML('beforeend', '<img src=x onerror=\"forged = 4\">')",
    ):
        chromium.run(add)
    chromium.run("setTimeout(() => { window.later = true; }, 300)")
    chromium.until("return window.later")
    assert chromium.run("return window.forged ?? null") is None
    assert len(chromium.console()) >= 2  # what the policy has kept from running


def test_what_is_no_sweep_along_the_frequency_is_refused(tmp_path):
    structure = orchestrate.Structure()
    over = orchestrate.sweep(
        structure, over="e", values=[0.3, 0.4], eta=1.2, transient=5, samples=5
    )
    listed = orchestrate.sweep(structure, eta=[1.2, 1.1], direction="given", transient=5, samples=5)
    for wrong in (xr.Dataset(), over, listed):
        with pytest.raises(InputError, match="expected a r"):
            explore(wrong, output=tmp_path / "page.html")
    with pytest.raises(InputError, match="is a folder; expected a file"):
        explore(output=tmp_path)
    damaged = xr.Dataset(attrs={"over": "eta"})
    with pytest.raises(InputError, match="branches: a part is missing .*stable.*; expected"):
        explore(output=tmp_path / "page.html", branches=damaged)
    with pytest.raises(InputError, match="branches: a dataset over nothing; expected"):
        explore(output=tmp_path / "page.html", branches=xr.Dataset())
    assert not list(tmp_path.glob("*.html"))


def test_a_sweep_before_a_wall_under_forces_is_read_with_them(exported):
    """Held along the frequency: one that changes is refused, and so is a box at rest."""
    structure = orchestrate.Structure(wall=True, clearance=0.2, stroke=0.5)
    pushes = {"box_acceleration": 0.1, "force1": 0.3}
    asked = {"frequency": [1.1, 1.2], "transient": 2, "samples": 3, "progress": False}
    found = read_sweep(orchestrate.sweep(structure, amplitude=0.5, **asked, **pushes))
    assert (found.structure, found.pushes) == (structure, {**pushes, "force2": 0.0})
    assert found.level == ("mm", 500.0)
    for wrong in ({"amplitude": 0.5, "force1": [0.3, 0.4]}, {"amplitude": 0.0, "force1": 0.3}):
        name = "force1" if wrong["amplitude"] else "amplitude"
        with pytest.raises(InputError, match=f"{name} = .*: the explorer does not know it yet"):
            read_sweep(orchestrate.sweep(structure, **asked, **wrong))


WRONG = (
    *(("m1", "heavy"), ("m1", np.array([1.0, 2.0])), ("tolerance", 0.0), ("transient", 0.5)),
    *(("samples", np.nan), ("start", "[a, b, c, d]"), ("start", "[0.0]"), ("bonded", 2.0)),
    ("direction", "both"),
)


@pytest.mark.parametrize(("name", "value"), WRONG)
def test_a_file_with_a_wrong_attribute_is_refused_in_one_line(swept, tmp_path, name, value):
    with pytest.raises(InputError, match="expected"):
        explore(swept.assign_attrs({name: value}), output=tmp_path / "page.html")
    assert not list(tmp_path.iterdir())


ANEW = "the kernel has changed: make Figure 6 of the explorer anew, python -m tools.figure6_states"


def test_figure_6_comes_from_the_present_kernel():
    assert sweep_data.is_from_current_kernel(load_result(sweep_data.FILE)), ANEW


@pytest.mark.parametrize("first", [0, 1100, 2850, 7896])  # chaos at 1100 and 2850
def test_figure_6_is_replayed_from_where_its_responses_begin(exported, first):
    given = load_result(sweep_data.FILE)
    few = given.isel(eta=slice(first, first + 5))
    found = sweep_data.first_sweep(orchestrate.Structure())
    start = found.numbers[3 * found.count :].reshape(-1, 4)[first]
    swept = orchestrate.sweep(
        orchestrate.Structure(), eta=few.eta.values, start=start, direction="up", progress=False
    )
    for name in ("end_state", "impacts_per_period", "frequency", "amplitude"):
        assert swept[name].values.tobytes() == few[name].values.tobytes(), ANEW
