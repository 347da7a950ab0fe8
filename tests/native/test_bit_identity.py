"""Pure Python, its compiled form, native FMI 2.0 and native FMI 3.0 give the same bits, each in a
process of its own, through chaos.
"""

import pytest

from ..fmu.driver import PROGRAMS
from ..fmu.programs.driver import COMMON, STATE, harmonic, open_fmu
from ..fresh import run_fresh
from ..sparing import ordinary


def run(fmu, tmp_path, end, count, values, **options):
    tmp_path.mkdir()
    arguments = (fmu, end, count, values, COMMON)
    found, done = run_fresh(PROGRAMS, "bits.simulate", *arguments, cwd=tmp_path, **options)
    assert "Traceback" not in done.stderr
    return found


@pytest.mark.parametrize("eta", ordinary([1.13, 2.9]))
def test_same_bits_in_every_form(fmus, tmp_path, eta):
    """More than 1,000 impacts: were the last bit different once, the numbers would soon have
    nothing in common.
    """
    values, end = {**harmonic(eta), "e": 0.7, "d1": 0.01, "d2": 0.01}, 6144.0
    forms = {
        "pure Python": run(fmus["fmi2-python"], tmp_path / "pure", end, 64, values, pure=True),
        "compiled": run(fmus["fmi2-python"], tmp_path / "compiled", end, 64, values),
        "fmi2": run(fmus["fmi2"], tmp_path / "fmi2", end, 64, values),
        "fmi3": run(fmus["fmi3"], tmp_path / "fmi3", end, 64, values),
    }
    compiled = {
        name: any("kernel-" in path for path in form.pop("mapped")) for name, form in forms.items()
    }
    assert compiled == {"pure Python": False, "compiled": True, "fmi2": False, "fmi3": False}
    reference = forms.pop("pure Python")["rows"]
    assert float.fromhex(reference[-1][COMMON.index("impact_count")]) > 1000
    for name, form in forms.items():
        for k, (row, expected) in enumerate(zip(form["rows"], reference, strict=True)):
            different = [
                output for output, a, b in zip(COMMON, row, expected, strict=True) if a != b
            ]
            assert not different, f"{name}, step {k}"


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
    second.free()
    third.free()
