"""Slots follow one another; variable tables and memories of the kernels agree."""

import pytest

from fmu_src.kernels.electrodynamic_shaker import memory as coil
from fmu_src.kernels.motor_shaker import memory as shaker
from fmu_src.kernels.oscillator import memory as oscillator
from fmu_src.models.electrodynamic_shaker import variables as coil_table
from fmu_src.models.motor_shaker import variables as motor_shaker_table
from fmu_src.models.oscillator import variables as oscillator_table

TABLES = (oscillator_table, motor_shaker_table, coil_table)
MODELS = [(m, t.VARIABLES) for m, t in zip((oscillator, shaker, coil), TABLES, strict=True)]
PROMISED = {  # given out before: saved states and other people's scripts rely on them
    **{"m1": 0, "e": 6, "box_amplitude": 15, "x1": 21, "x_rel_max": 40, "sample_count": 42},
    **{"x1_sample[1]": 43, "x2_sample[1]": 243, "v1_sample[1]": 443, "v2_sample[200]": 842},
    **{"evaluations": 843, "evaluation_limit": 844, "clearance": 845, "e_slope": 846},
    **{"sticking_energy": 847, "a2_max": 852, "force1_amplitude": 853, "force2_amplitude": 854},
    **{"force1": 855, "force1_3": 858, "force2": 859, "force2_3": 862},
    **{"wall": 863, "stroke": 864, "impact_side": 865},
}


@pytest.mark.parametrize(("memory", "variables"), MODELS)
def test_value_references_are_places_in_the_table_and_slots(memory, variables):
    assert [variable.slot for variable in variables] == list(range(len(variables)))
    assert len(variables) == memory.TIME
    for variable in variables:
        if "[" not in variable.name:
            assert getattr(memory, variable.name.upper()) == variable.slot


def test_promised_value_references():
    places = {variable.name: variable.slot for variable in oscillator_table.VARIABLES}
    found = {name: places[name] for name in PROMISED}
    assert found == PROMISED
