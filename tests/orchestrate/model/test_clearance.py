"""A structure's clearance: the state at rest, and answers through the FMU."""

import pytest

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
