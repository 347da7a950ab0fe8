"""Electrodynamic shakers: from a data sheet and from files, refusals, and what their FMU makes of
them.
"""

import cmath
import math

import pytest

from orchestrate.fmu import ELECTRODYNAMIC_SHAKER, Instance, find_or_export
from orchestrate.model import Shaker, read
from orchestrate.model.toml_files import SHAKERS

SHEET = {
    **{"rated_force": 100.0, "moving_mass": 0.2, "force_factor": 10.0, "coil_resistance": 2.0},
    **{"suspension_resonance": 39.0, "amplifier_power": 150.0, "travel": 0.014},
}


def test_a_data_sheet():
    shaker = Shaker.from_datasheet(**SHEET, payload=0.4, damping_ratio=0.1)
    assert shaker.force_factor * shaker.current_limit == 100.0
    assert 0.5 * shaker.voltage_limit * shaker.current_limit == pytest.approx(150.0)
    assert shaker.travel_limit == 0.007
    assert shaker.table_mass == pytest.approx(0.6)
    assert shaker.resonance == pytest.approx(39.0 / math.sqrt(3.0))
    bare = Shaker.from_datasheet(**SHEET, damping_ratio=0.1)
    assert bare.resonance == pytest.approx(39.0)
    critical = 2.0 * math.sqrt(bare.suspension_stiffness * bare.table_mass)
    assert bare.suspension_damping == pytest.approx(0.1 * critical)
    loaded = bare.replace(table_mass=bare.table_mass + 0.4)
    assert loaded.replace(suspension_damping=1.0) == shaker.replace(suspension_damping=1.0)


@pytest.mark.parametrize("name", SHAKERS)
def test_the_sets_give_their_rated_force(exported, name):
    """A sine at eight times the resonance, by the FMU with the set's parameters, reaches the rated
    force and no more; the sets are bare tables, with nothing else in their files.
    """
    assert list(read(name)) == ["shaker"]
    shaker = Shaker.from_file(name)
    frequency, forces, limited = 8.0 * 2.0 * math.pi * shaker.resonance, [], set()
    period, amplitude = 2.0 * math.pi / frequency, shaker.voltage_limit
    with Instance(find_or_export(ELECTRODYNAMIC_SHAKER).path) as fmu:
        fmu.initialize(0.0, **shaker.parameters())
        for k in range(10 * 64):
            time = k * period / 64
            turn = amplitude * cmath.exp(1j * frequency * time)
            cubic = [((1j * frequency) ** n * turn).imag for n in range(4)]
            names = ("command", "command_1", "command_2", "command_3")
            fmu.set(**dict(zip(names, cubic, strict=True)))
            fmu.step(time, time + period / 64)
            force, acts = fmu.get("coil_force", "limited")
            forces.append(abs(force))
            limited.add(bool(acts))
    assert max(forces) == pytest.approx(float(name[7:].replace("kN", "e3").strip("N")))
    assert limited == {False, True}
