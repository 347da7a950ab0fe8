"""A structure's clearance: the state at rest, and answers through the FMU."""

import numpy as np
import pytest

import orchestrate
from orchestrate import Structure


def test_preload_and_place_at_rest():
    """Both springs pull with the preload, and the faces touch."""
    pressed = Structure(k1=2.0, k2=6.0, clearance=-0.4)
    x1, x2 = pressed.at_rest
    assert pressed.preload == pytest.approx(0.4 * 12.0 / 8.0)
    assert (-2.0 * x1, 6.0 * x2) == pytest.approx((pressed.preload, pressed.preload))
    assert x2 - x1 + pressed.clearance == pytest.approx(0.0, abs=1e-16)
    for open_structure in (Structure(), Structure(clearance=0.4)):
        assert open_structure.preload == 0.0
        assert [str(x) for x in open_structure.at_rest] == ["0.0", "0.0"]  # no negative zero


def test_a_bonded_structure_keeps_and_ignores_it():
    bonded = Structure(clearance=-0.4).as_bonded()
    assert (bonded.clearance, bonded.gap_offset, bonded.preload) == (-0.4, 0.0, 0.0)
    assert bonded.as_delaminated() == Structure(clearance=-0.4)


@pytest.mark.parametrize("clearance", [0.3, -0.3])
def test_answers_through_the_fmu_keep_the_gap(clearance):
    """Gaps, contact, accelerations and states that go on: by the equations of motion."""
    structure = Structure(clearance=clearance, e=0.4)
    motion = orchestrate.simulate(structure, frequency=0.7, amplitude=1.5, periods=12, points=300)
    gap = motion.x2 - motion.x1 + clearance
    assert np.allclose(motion.x_rel, gap, rtol=0.0, atol=1e-14) and motion.x_rel.min() >= 0.0
    touching = motion.in_contact.values.astype(bool)
    assert motion.x_rel.values[touching] == pytest.approx(0.0, abs=0.0)
    pull_1 = structure.k1 * motion.x1 + structure.d1 * motion.v1
    pull_2 = structure.k2 * motion.x2 + structure.d2 * motion.v2
    assert motion.a1_abs.values == pytest.approx(
        (motion.contact_force + pull_1).values / -structure.m1, abs=1e-12
    )
    assert motion.a2_abs.values == pytest.approx(
        (pull_2 - motion.contact_force).values / -structure.m2, abs=1e-12
    )
    assert motion.sizes["impact"] > 3
    assert touching.any() == (clearance < 0.0)
