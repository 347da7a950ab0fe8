"""The plain forms: scalars alone, for tools that stumble over arrays, clocks or long lists."""

import pytest
from fmpy.validation import validate_fmu

from fmu_src.export import forms
from fmu_src.export.platforms import platform_of_this_machine
from orchestrate.errors import InputError
from orchestrate.fmu import Instance
from orchestrate.response.response_loop import response_loop

from ..fmu.event_driven import CUBICS
from ..fmu.programs.driver import harmonic, open_fmu

pytestmark = pytest.mark.slow  # compiles; sources of a plain form run in test_source_code.py


@pytest.fixture
def plain(version, tmp_path):
    """The oscillator's plain FMU of an FMI version."""
    form = f"{version}-plain"
    return forms.export("TwoMassImpactOscillator", form, tmp_path, (platform_of_this_machine(),))


def test_an_importer_that_knows_real_alone_runs_a_plain_form(plain, fmus, version):
    """It writes 0 to all inputs, and reads all outputs as Real; their own types can be read too."""
    assert validate_fmu(str(plain)) == []
    with open_fmu(plain) as fmu, open_fmu(fmus[version]) as full:
        inputs = [v.name for v in fmu.variables.values() if v.causality == "input"]
        amplitudes = ("force1_amplitude", "force2_amplitude")
        assert inputs == [*CUBICS["box"], *amplitudes, *CUBICS[1], *CUBICS[2]]
        for name in ("box_amplitude", "box_frequency"):
            kind = fmu.variables[name]
            assert (kind.causality, kind.variability) == ("parameter", "tunable")
        fmu.start(**harmonic(1.13))
        full.start(**harmonic(1.13))
        assert not any(v.dimensions or "[" in v.name for v in fmu.variables.values())
        outputs = [name for name, v in fmu.variables.items() if v.causality == "output"]
        assert len({fmu.variables[name].type for name in outputs}) == 1
        assert {"in_contact", "impact_count", "contact_count", "evaluations"} < set(outputs)
        for time in (100.0, 200.0):
            fmu.set(**dict.fromkeys(inputs, 0.0))
            fmu.set(box_frequency=1.13)  # tunable
            fmu.step(time)
            full.step(time)
            assert fmu.get(*outputs) == full.get(*outputs)
        assert fmu.one("impact_count") > 10.0
        reference = [fmu.variables["impact_count"].valueReference]
        whole = fmu.fmu.getInt32 if fmu.third else fmu.fmu.getInteger
        assert whole(reference) == [full.one("impact_count")]
    with Instance(plain) as fmu, pytest.raises(InputError, match="x1_sample"):
        response_loop(fmu)  # which asks for states inside a step
