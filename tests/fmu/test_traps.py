"""What pythonfmu 0.7.0 does to an FMU's user, measured, and that this FMU does not pass it on."""

import math
import re
from pathlib import Path

import pytest

from fmu_src.export import forms, pythonfmu_form, sources
from fmu_src.export.errors import CannotExport

from .driver import FMUS, OSCILLATOR, run
from .programs.driver import Refused, describe, harmonic, messages, open_fmu

PYTHON = FMUS["fmi2-python"]


def export_other_version(folder):
    """The uncompiled FMU of sources whose coefficient of restitution starts as another one."""
    read, place = Path.read_bytes, sources.ROOT / "models" / "oscillator" / "variables.py"

    def altered(path):
        text = read(path)
        return text.replace(b'"e", "1", 0.7', b'"e", "1", 0.25') if path == place else text

    def no_compiler(*_):
        raise CannotExport("not wanted here")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Path, "read_bytes", altered)
        patch.setattr(sources, "AT_IMPORT", sources.read_folder(sources.ROOT))
        patch.setattr(pythonfmu_form, "link_for_platforms", no_compiler)
        return forms.export(OSCILLATOR, forms.PYTHON_FORM, folder)


def test_two_versions_in_one_process_do_not_share_code(tmp_path):
    """Each has its own defaults, numbers and states, in whatever order they come."""
    changed = export_other_version(tmp_path)

    def numbers(path):
        f = open_fmu(path).start()
        return [f.one("e"), f.step(20.0).outputs()]

    mine, foreign, again = (numbers(path) for path in (PYTHON, changed, PYTHON))
    assert (mine[0], foreign[0]) == (0.7, 0.25)
    assert again == mine and numbers(changed) == foreign
    assert mine[1] != foreign[1]
    saved = open_fmu(PYTHON).start().step(1.0).save()
    with pytest.raises(Refused, match="FMU state: expected a state saved by this FMU"):
        open_fmu(changed).start().restore(*saved)


def test_host_with_modules_of_the_same_names(tmp_path):
    """An importer in Python keeps modules that are named as ours are; the FMU does not get them."""
    outputs, replaced, new = run("runs.host_with_modules_of_the_same_names", PYTHON, cwd=tmp_path)
    assert outputs == open_fmu(PYTHON).start(**harmonic(1.13)).step(200.0).outputs()
    assert replaced == []
    assert new
    # the only modules an FMU brings: pythonfmu's, and ours under names with a hash of their
    # contents
    for name in new:
        assert re.match(
            r"pythonfmu(\.|$)|fmu_[0-9a-f]{12}(\.|$)|TwoMassImpactOscillator_[0-9a-f]{12}$", name
        ), name


@pytest.mark.parametrize(
    "name", ["%s%n%s%n", "%d %100000d %p", "ü €", "", "a" * 2000, "two\nlines"]
)
def test_hostile_instance_names(fmu, name):
    """Names and texts end up in a printf format: a percent sign is a percent sign."""
    f = open_fmu(fmu, name=name)
    with pytest.raises(Refused, match="m1 = nan kg: expected 1e-24 <= m1 <= 1e"):
        f.set(m1=math.nan)
    assert f.reset().start().step(1.0).one("phase") == pytest.approx(0.4)


def test_a_step_too_short_to_advance_is_reported_once(fmu):
    """The one message of a good run, so "all messages" is no category on offer."""
    f, texts = open_fmu(fmu).start(1e9, **harmonic(1.13)), []
    names = [category.name for category in describe(fmu).logCategories]
    assert names == ["logStatusWarning", "logStatusError"]
    before = f.outputs()
    for _ in range(300):
        f.call("doStep", 1e9, 1e-9)
        texts += messages
    assert f.outputs() == before != f.step(1e9 + 1.0).outputs()
    (message,) = texts + messages
    for part in ("communicationStepSize = 1e-09 s", "1000000000.0 s", "expected a longer one"):
        assert part in message
