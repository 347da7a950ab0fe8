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


def test_a_sweep_over_the_clearance_goes_on_from_the_last_state():
    """A preload that just holds, then one that does not: the response is that of the value alone,
    and a sweep in both directions agrees where nothing is bistable.
    """
    structure = Structure(d1=0.4, d2=0.5, e=0.2)
    values = np.linspace(-0.6, 0.6, 7)
    found = orchestrate.sweep(
        structure,
        **{"over": "clearance", "values": values, "frequency": 0.6, "amplitude": 1.0},
        **{"direction": "both", "transient": 60, "samples": 8},
    )
    up, down = found.sel(direction="up"), found.sel(direction="down")
    assert up.xi_rel_max.values == pytest.approx(down.xi_rel_max.values, rel=1e-9, abs=1e-12)
    alone = orchestrate.simulate(
        structure.replace(clearance=values[4]),
        frequency=0.6,
        amplitude=1.0,
        transient=60,
        periods=1,
    )
    scale = 1.0 * 0.6**2
    assert float(up.xi_rel_max[4]) == pytest.approx(float(alone.x_rel.max()) / scale, rel=1e-3)
    assert up.xi_rel_max[0] == 0.0 and up.x1_max[0] > 0.3  # pressed shut, about x1 = -F/k1
