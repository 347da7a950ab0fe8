"""What the outputs mean: definitions at a point."""

import math

import pytest

from .programs.driver import open_fmu

XI = ("xi1", "xi2", "xi_rel")
VALUES = {"m1": 1.2, "m2": 0.8, "k1": 1.5, "k2": 2.0, "d1": 0.02, "d2": 0.05, "e": 0.6}
VALUES |= {"box_amplitude": 0.7, "box_frequency": 0.6}


def test_outputs_follow_their_definitions(fmu):
    """In flight and in contact."""
    f = open_fmu(fmu).start(phase_start=1.0, **VALUES)
    rows = [{"time": f.step(k / 16).time, **f.outputs()} for k in range(1, 1000)]
    m1, m2, k1, k2, d1, d2, e, a, frequency = VALUES.values()
    unit = a * frequency**2 * m1 / k1
    contacts = 0
    for row in rows:
        x1, x2, v1, v2 = row["x1"], row["x2"], row["v1"], row["v2"]
        assert row["x_rel"] == x2 - x1
        assert row["v_rel"] == pytest.approx(v2 - v1, abs=1e-14)
        scaled = [x1 / unit, x2 / unit, (x2 - x1) / unit]
        assert [row[name] for name in XI] == pytest.approx(scaled, rel=1e-12)
        pull = k1 * x1 + d1 * v1 + k2 * x2 + d2 * v2
        assert row["box_force"] == pytest.approx(pull, rel=1e-12, abs=1e-14)
        away = row["phase"] - 1.0 - frequency * row["time"]
        assert math.remainder(away, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-12)
        if row["in_contact"]:
            contacts += 1
            assert x1 == x2 and v1 == v2
            drive = a * frequency**2 * math.sin(row["phase"])
            together = (drive * (m1 + m2) - row["box_force"]) / (m1 + m2)
            # mass 1 has its spring, its damper, the drive and the other mass, which can only push
            pressed = m1 * drive - k1 * x1 - d1 * v1 - m1 * together
            assert row["contact_force"] == pytest.approx(pressed, abs=1e-12)
            assert row["contact_force"] >= 0.0
        else:
            assert row["contact_force"] == 0.0
    assert 20 < contacts < len(rows) - 20
    assert open_fmu(fmu).start(x_rel_max_on=False, **VALUES).step(2.5).one("x_rel_max") == 0.0
    for still in ({"box_amplitude": 0.0}, {"box_frequency": 0.0}):  # no division by zero
        assert open_fmu(fmu).start(x1_start=-1.0, **still).step(1.0).get(*XI) == [0.0] * 3
