"""The FMUs of the present sources: found, exported where missing or out of date, always whole."""

import shutil
import sys
from pathlib import Path

import pytest

from fmu_src.export.errors import EXTRA
from orchestrate.errors import InputError
from orchestrate.fmu import (
    FORMS,
    MODELS,
    MOTOR_SHAKER,
    OSCILLATOR,
    build,
    describe,
    exported,
    find_or_export,
    is_current_and_trusted,
    make_fmu_finder,
)

from .altered import altered_fmu

REASON = "ziglang, which compiles the kernel, is not installed: expected " + EXTRA


@pytest.fixture
def real(oscillator_in):
    return {form: oscillator_in(form) for form in FORMS}


@pytest.fixture
def maker(monkeypatch, real):
    """Stand in for the exporters: copies of the true FMUs, and a record of what was asked."""
    asked, without = [], set()

    def export(name, form, folder, platforms=None):
        asked.append((name, form, Path(folder)))
        if form in without:
            raise exported.CannotExport(REASON)
        target = Path(folder) / form / f"{name}.fmu"
        target.parent.mkdir(parents=True, exist_ok=True)
        if name != OSCILLATOR:
            return shutil.copy(find_or_export(name, form, exported.CLONE / "build").path, target)
        return shutil.copy(real[form], target)

    monkeypatch.setattr(exported.sources, "export", export)
    export.asked, export.without = asked, without
    return export


@pytest.fixture
def places(monkeypatch, tmp_path):
    """Put the default folder and that of the FMUs that came with the package elsewhere."""
    folder, shipped = tmp_path / "cache", tmp_path / "shipped"
    monkeypatch.setattr(exported, "default_folder", lambda: folder)
    monkeypatch.setattr(exported, "SHIPPED", shipped)
    return folder, shipped


def put(source, folder):
    target = folder / "fmi3" / f"{OSCILLATOR}.fmu"
    target.parent.mkdir(parents=True, exist_ok=True)
    return shutil.copy(source, target)


def test_what_is_missing_is_exported_once(maker, places):
    folder, _ = places
    for _ in range(2):
        assert find_or_export(OSCILLATOR).path == folder / "fmi3" / f"{OSCILLATOR}.fmu"
    assert maker.asked == [(OSCILLATOR, "fmi3", folder)]


def test_what_came_with_the_package_needs_no_export(maker, places, real):
    put(real["fmi3"], places[1])
    assert find_or_export(OSCILLATOR).path == places[1] / "fmi3" / f"{OSCILLATOR}.fmu"
    assert maker.asked == []


@pytest.mark.parametrize("damage", ["cut", "empty", "other", "stale"])
def test_what_is_damaged_or_out_of_date_is_made_anew(maker, places, real, damage):
    path = put(real["fmi3"], places[0])
    if damage == "cut":
        path.write_bytes(path.read_bytes()[:-3000])
    elif damage == "empty":
        path.write_bytes(b"")
    elif damage == "other":
        shutil.copy(find_or_export(MOTOR_SHAKER).path, path)
        maker.asked.clear()
    else:
        guid = describe(path).guid
        altered_fmu(real["fmi3"], path, instantiationToken=(guid, guid.replace("-", "0")))
    assert not is_current_and_trusted("fmi3", OSCILLATOR, places[0])
    assert find_or_export(OSCILLATOR).guid == describe(real["fmi3"]).guid
    assert (OSCILLATOR, "fmi3", places[0]) in maker.asked


@pytest.mark.skipif(sys.platform == "win32", reason="other permissions there")
@pytest.mark.parametrize("of_folder", [False, True])
def test_what_others_could_have_planted_in_the_cache_is_made_anew(
    maker, places, real, caplog, of_folder
):
    exported.log_once.cache_clear()
    path = put(real["fmi3"], places[0])
    part = path.parent if of_folder else path
    part.chmod(part.stat().st_mode | 0o002)
    for _ in range(2):
        assert find_or_export(OSCILLATOR).path == path
    assert maker.asked == [(OSCILLATOR, "fmi3", places[0])]
    assert caplog.text.count("others can write it or its folder") == 1
    part.chmod(part.stat().st_mode | 0o002)
    named = places[0] / ".." / places[0].name
    assert find_or_export(OSCILLATOR, folder=named).path.samefile(path)
    assert len(maker.asked) == 1, "a folder that is named is trusted"


def test_without_a_compiler_the_python_form_serves(maker, places, caplog):
    exported.log_once.cache_clear()
    maker.without.update({"fmi2", "fmi3"})
    for _ in range(2):
        assert find_or_export(OSCILLATOR).path == places[0] / "fmi2-python" / f"{OSCILLATOR}.fmu"
    assert caplog.text.count("no fmi3 FMU here, fmi2-python serves instead") == 1


def test_where_nothing_can_be_made_one_line_says_why(maker, places):
    maker.without.update(FORMS)
    with pytest.raises(InputError) as error:
        find_or_export(OSCILLATOR)
    assert REASON in str(error.value) and f"FMU {OSCILLATOR}: none matches" in str(error.value)


def test_an_own_fmu_is_taken_as_it_is(maker, tmp_path, real):
    guid = describe(real["fmi2"]).guid
    own = altered_fmu(real["fmi2"], tmp_path / "own.fmu", guid=(guid, "{mine}"))
    assert find_or_export(OSCILLATOR, fmu=own).guid == "{mine}"
    with pytest.raises(InputError, match=f"model {OSCILLATOR}; expected {MOTOR_SHAKER}"):
        find_or_export(MOTOR_SHAKER, fmu=own)
    assert maker.asked == []


MODEL, FORM = "expected one of TwoMassImpactOscillator", "expected one of fmi2-python, fmi2, fmi3"
REFUSED = {
    f"model Oscillator: {MODEL}": lambda: find_or_export("Oscillator"),
    f"form fmi4: {FORM}": lambda: find_or_export(OSCILLATOR, "fmi4"),
    f"model Shaker: {MODEL}": lambda: build(names=["Shaker"]),
    f"model Motor: {MODEL}": lambda: make_fmu_finder({"fmu": {"Motor": "a.fmu"}}),
    "FMU no.fmu: no such file; expected": lambda: make_fmu_finder({"fmu": "no.fmu"})(OSCILLATOR),
}


@pytest.mark.parametrize("words", REFUSED)
def test_refusals(maker, places, words):
    with pytest.raises(InputError) as error:
        REFUSED[words]()
    assert words in str(error.value)


def test_build_writes_all_that_can_be_made(maker, places, tmp_path, caplog, real):
    def names(**what):
        written = build(tmp_path / "out", **what)
        return {path.relative_to(tmp_path / "out").as_posix() for path in written}

    assert names() == {f"{form}/{model}.fmu" for form in FORMS for model in MODELS}
    maker.without.update({"fmi2", "fmi3"})
    assert names(names=[OSCILLATOR]) == {f"fmi2-python/{OSCILLATOR}.fmu"}
    assert caplog.text.count(REASON) == 2
    maker.without.update(FORMS)
    put(real["fmi3"], places[1])  # those of a wheel are copied
    assert names(names=[OSCILLATOR]) == {f"fmi3/{OSCILLATOR}.fmu"}
    with pytest.raises(InputError, match="cannot be made: ziglang"):  # other platforms than it has
        exported.build(tmp_path / "other", ["fmi3"], [OSCILLATOR], ["aarch64-linux"])
