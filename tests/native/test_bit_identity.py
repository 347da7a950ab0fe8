"""All forms give the same bits, each in a process of its own, through chaos."""

import pytest

from ..fmu import driver
from ..fmu.programs.driver import COMMON, STATE, harmonic, open_fmu
from ..sparing import ordinary


def run(fmu, folder, end, count, values, **options):
    folder.mkdir()
    return driver.run("runs.simulate", fmu, end, count, values, COMMON, cwd=folder, **options)


@pytest.mark.parametrize("eta", ordinary([1.13, 2.9]))
def test_same_bits_in_every_form(fmus, tmp_path, eta):
    """Were the last bit different once, the numbers would soon have nothing in common."""
    values, end = {**harmonic(eta), "e": 0.7, "d1": 0.01, "d2": 0.01}, 6144.0
    pure = run(fmus["fmi2-python"], tmp_path / "pure", end, 64, values, pure=True)
    forms = {form: run(fmus[form], tmp_path / form, end, 64, values) for form in fmus}
    compiled = [any("kernel-" in path for path in one["mapped"]) for one in (pure, *forms.values())]
    assert list(forms) == ["fmi2-python", "fmi2", "fmi3"]
    assert compiled == [False, True, False, False]
    assert float.fromhex(pure["rows"][-1][COMMON.index("impact_count")]) > 1000
    for form, found in forms.items():
        assert found["rows"] == pure["rows"], form


def test_a_state_saved_by_one_native_form_goes_on_in_the_other(fmus):
    second, third = open_fmu(fmus["fmi2"]), open_fmu(fmus["fmi3"])
    for one in (second, third):
        one.start(**harmonic(1.13))
    second.step(512.0)
    third.restore(*second.save())
    assert third.get(*STATE) == second.get(*STATE)
    for one in (second, third):
        one.step(1024.0)
    assert third.get(*COMMON) == second.get(*COMMON)
