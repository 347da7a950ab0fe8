"""What a drive may answer to a step by the standard, and what becomes of the run."""

import re
import warnings
import zipfile
from dataclasses import replace

import numpy as np
import pytest

import orchestrate
from orchestrate.errors import FmuError
from orchestrate.weak_drive import cosimulate

from .drives import exciter
from .drives.linear import draw

STRUCTURE = orchestrate.Structure(m1=0.5, m2=0.4, k1=300.0, k2=420.0, d1=0.4, d2=0.5, e=0.6)
START = (0.0, 0.02, 0.0, 0.0)
RUN = {"start": START, "duration": 0.2, "step": 0.01, "estimate": False, "progress": False}
AT = 0.1  # when the drives do what they do
DRIVE = draw(2)  # with direct feedthrough
ENDED = "the FMU Linear ended the simulation at t = 0.1 s: the emergency stop was pressed"
pytestmark = pytest.mark.usefixtures("exported")


def run(folder, does="NOTHING", fmi=3, has_states=False, **more):
    drive = replace(DRIVE, fmi=fmi, does=does, has_states=has_states)
    more = {"connect": drive.connect, "parameters": drive.parameters, **RUN, **more}
    return orchestrate.cosimulate(STRUCTURE, drive.write(folder), **more)


@pytest.fixture(params=[2, 3])
def form(request, here):
    return request.param


@pytest.mark.usefixtures("here")
def test_the_first_acceleration_is_that_under_the_force(tmp_path):
    found = run(tmp_path, duration=0.02)
    force = STRUCTURE.k2 * START[1]
    assert float(found.box_acceleration[0]) == pytest.approx(DRIVE.d[0] * force, rel=1e-12)


@pytest.mark.parametrize("does", ["ENDS", "ENDS_AFTER"])
def test_a_drive_that_ends_the_simulation_leaves_what_was_reached(
    tmp_path, form, does, monkeypatch
):
    """In steps of 0.01 s: it ends before the step after 0.1 s, or with the one that ends there;
    in one chunk or several.
    """
    more = {"estimate": True, "record": [DRIVE.names[3]], "has_states": True}
    whole = run(tmp_path, fmi=form, **more)
    for size in (10_000, 4):
        monkeypatch.setattr(cosimulate.CosimulateJob, "chunk_size", size)
        with pytest.warns(UserWarning, match=re.escape(ENDED)):
            found = run(tmp_path, does, form, **more)
        assert found.attrs["ended"] == ENDED and whole.attrs["ended"] == "at the duration"
        assert found.time.values.tolist() == whole.time.values[:11].tolist()
        for name in ("x1", "box_acceleration", "coupling_error", DRIVE.names[3]):
            assert found[name][:-1].values.tobytes() == whole[name][:10].values.tobytes(), name
        assert found.impact_time.max() <= AT < whole.impact_time.max()
    with pytest.raises(FmuError, match=r"ended the simulation at t = 0 s: .*, in its first step"):
        run(tmp_path, "ENDS", form, step=0.2)


REFUSED = {
    "DISCARDS": "discarded its step from t = 0.1 s to 0.11 s: coil too hot",
    "DISCARDS_SILENTLY": "discarded its step from t = 0.1 s to 0.11 s: it logged no cause",
    "RETURNS_EARLY": r"its step from t = 0.1 s to 0.11 s \(it came to 0.105 s\)",
    "FAILS": "^fuse blown$",
}


@pytest.mark.parametrize("does", REFUSED)
def test_what_ends_a_run_is_said_with_its_cause(tmp_path, form, does):
    with pytest.raises(FmuError, match=REFUSED[does]) as raised:
        run(tmp_path, does, form)
    assert "\n" not in str(raised.value)


def test_a_discarded_step_is_halved_where_the_drive_can_go_back(tmp_path, form):
    """Into quarters here: as in a run with a quarter of the step; the points of time stay."""
    found = run(tmp_path, "DISCARDS_LONG", form, has_states=True)
    coarse = run(tmp_path, fmi=form, has_states=True)
    fine = run(tmp_path, fmi=form, has_states=True, step=2.5e-3).isel(time=slice(None, None, 4))
    assert found.time.values.tobytes() == coarse.time.values.tobytes()
    for name in ("x1", "x2", "box_acceleration"):
        errors = [abs(one[name].values - fine[name].values).max() for one in (found, coarse)]
        assert errors[0] < 1e-6 * errors[1]
    for does, has_states in (("DISCARDS", True), ("DISCARDS_LONG", False)):
        with pytest.raises(FmuError, match="coil too hot"):
            run(tmp_path, does, form, has_states=has_states)


def test_inputs_as_cubics_go_on_in_halves_of_a_discarded_step():
    """The house's shaker discards long steps, under a limit of its evaluations."""
    times = np.linspace(0.0, 0.2, 21)
    command = {"command": (times, 3.0 * np.sin(30.0 * times))}
    more = {"inputs": command, "duration": 0.2, "estimate": False, "progress": False}
    shaker, ends = orchestrate.Shaker.from_file("shaker_1kN"), []
    for step, limit in ((0.01, {"evaluation_limit": 30}), (0.005, {}), (0.01, {})):
        found = orchestrate.cosimulate(STRUCTURE, shaker, step=step, parameters=limit, **more)
        ends.append([float(found[name][-1]) for name in ("x1", "box_acceleration")])
    assert ends[0] == pytest.approx(ends[1], rel=1e-6)
    assert ends[0] != pytest.approx(ends[2], rel=1e-4)


@pytest.mark.parametrize(("does", "words"), [("WARNS", "coil is warm"), ("WARNS_SILENTLY", "step")])
def test_a_warning_is_shown_once_and_the_run_goes_on(tmp_path, form, does, words):
    with warnings.catch_warnings(record=True) as shown:
        warnings.simplefilter("always")
        found = run(tmp_path, does, form, estimate=True)
    (text,) = [str(one.message) for one in shown if "warns" in str(one.message)]
    assert text.startswith("the FMU Linear warns: ") and words in text
    assert found.attrs["drive_warnings"] == text
    whole = run(tmp_path, fmi=form, estimate=True)
    assert found.x1.values.tobytes() == whole.x1.values.tobytes()


def test_a_process_of_its_own_keeps_python_modules_of_one_name_apart(tmp_path):
    """As of two versions of pythonfmu: the second run has its own, of a box at rest."""
    from pythonfmu import FmuBuilder

    with pytest.warns(UserWarning, match="the FMU Linear warns: coil is warm"):
        assert len(run(tmp_path, "WARNS").time) == 21
    first = FmuBuilder.build_FMU(exciter.__file__, dest=tmp_path, project_files=[])
    second = tmp_path / "second.fmu"
    with zipfile.ZipFile(first) as old, zipfile.ZipFile(second, "w") as new:
        for name in old.namelist():
            new.writestr(name, old.read(name).replace(b"9.0, 0.02", b"9.0, 0.0"))
    own = {**RUN, "start": None, "connect": {"box_acceleration": "acc", "box_force": "pull"}}
    moved = [orchestrate.cosimulate(STRUCTURE, one, **own).x1 for one in (first, second)]
    assert abs(moved[1]).max() < 1e-9 * abs(moved[0]).max()


@pytest.mark.usefixtures("here")
def test_units_by_name_are_converted_and_can_be_stated(tmp_path):
    """An acceleration in mm/s2 by the name alone, or without any and stated: the motion in SI."""
    expected = run(tmp_path)
    thousand = replace(DRIVE, c=1e3 * DRIVE.c, d=1e3 * DRIVE.d)
    path = thousand.write(tmp_path, "thousand")
    named = replace(thousand, unit="mm/s2").write(tmp_path, "named")
    own = {"parameters": thousand.parameters, "connect": DRIVE.connect, **RUN}
    name = DRIVE.connect["box_acceleration"]
    in_brackets = {**DRIVE.connect, "box_acceleration": f"{name}[mm/s2]"}
    stated = {"units": {DRIVE.names[2]: "mm/s2"}}
    for drive, more in ((named, {}), (path, stated), (path, {"connect": in_brackets})):
        found = orchestrate.cosimulate(STRUCTURE, drive, **{**own, **more})
        assert found.x1.values == pytest.approx(expected.x1.values, abs=1e-12)
