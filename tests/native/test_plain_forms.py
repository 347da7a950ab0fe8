"""The plain forms: scalars alone, for tools that stumble over arrays, clocks or long lists."""

import fmpy
import pytest
from fmpy.validation import validate_fmu

from fmu_src.export import forms
from fmu_src.export.platforms import this_machine

from .conftest import VERSIONS
from .slave import COMMON, harmonic, slave


@pytest.fixture(scope="module")
def plain_fmus(tmp_path_factory, fmus):
    """The oscillator's plain FMUs by FMI version."""
    build = tmp_path_factory.mktemp("plain")
    name = "TwoMassImpactOscillator"
    return {v: forms.export(name, f"{v}-plain", build, (this_machine(),)) for v in VERSIONS}


@pytest.mark.parametrize("version", VERSIONS)
def test_a_plain_form_has_scalars_alone(plain_fmus, version):
    found = fmpy.read_model_description(str(plain_fmus[version]))
    kinds = {variable.type for variable in found.modelVariables}
    assert kinds == {"Real", "Integer", "Boolean"} or kinds == {"Float64", "Int32", "Boolean"}
    assert not any(v.dimensions or "[" in v.name for v in found.modelVariables)
    assert 40 < len(found.modelVariables) < 45
    assert not getattr(found.coSimulation, "hasEventMode", False)
    assert validate_fmu(str(plain_fmus[version])) == []
    assert found.guid == forms.guid("TwoMassImpactOscillator", f"{version}-plain")


@pytest.mark.parametrize("version", VERSIONS)
def test_a_plain_form_has_the_same_bits(plain_fmus, fmus, version):
    rows = []
    for path in (plain_fmus[version], fmus[version]):
        with slave(path) as fmu:
            fmu.start(**harmonic(1.13)).step(512.0)
            rows.append(fmu.get(*COMMON))
    assert rows[0] == rows[1]
