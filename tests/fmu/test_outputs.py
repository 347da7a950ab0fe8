"""What the outputs mean: definitions at a point, the largest gap over a step."""

import math

import pytest

from .programs.driver import open_fmu

XI = ("xi1", "xi2", "xi_rel")
VALUES = {"m1": 1.2, "m2": 0.8, "k1": 1.5, "k2": 2.0, "d1": 0.02, "d2": 0.05, "e": 0.6}
VALUES |= {"box_amplitude": 0.7, "box_frequency": 0.6}


def test_outputs_follow_their_definitions(fmu):
    """Differences, the paper's xi, force on the box, compressive force, phase: in flight and in
    contact.
    """
    f = open_fmu(fmu).start(phase_start=1.0, **VALUES)
    rows = [{"time": f.step(k / 16).time, **f.outputs()} for k in range(1, 1000)]
    m1, m2, k1, k2, d1, d2, e, a, frequency = VALUES.values()
    unit = a * frequency**2 * m1 / k1
    contacts = 0
    for row in rows:
        x1, x2, v1, v2 = row["x1"], row["x2"], row["v1"], row["v2"]
        assert row["x_rel"] == x2 - x1
        assert row["v_rel"] == pytest.approx(v2 - v1, abs=1e-14)
        assert [row[name] for name in XI] == pytest.approx(
            [x1 / unit, x2 / unit, (x2 - x1) / unit], rel=1e-12
        )
        assert row["box_force"] == pytest.approx(
            k1 * x1 + d1 * v1 + k2 * x2 + d2 * v2, rel=1e-12, abs=1e-14
        )
        assert math.remainder(
            row["phase"] - 1.0 - frequency * row["time"], 2.0 * math.pi
        ) == pytest.approx(0.0, abs=1e-12)
        if row["in_contact"]:
            contacts += 1
            assert x1 == x2 and v1 == v2
            drive = a * frequency**2 * math.sin(row["phase"])
            together = (drive * (m1 + m2) - row["box_force"]) / (m1 + m2)
            # mass 1 has its spring, its damper, the drive and the other mass, which can only push
            assert row["contact_force"] == pytest.approx(
                m1 * drive - k1 * x1 - d1 * v1 - m1 * together, abs=1e-12
            )
            assert row["contact_force"] >= 0.0
        else:
            assert row["contact_force"] == 0.0
    assert 20 < contacts < len(rows) - 20
    for still in ({"box_amplitude": 0.0}, {"box_frequency": 0.0}):  # no division by zero
        assert open_fmu(fmu).start(x1_start=-1.0, **still).step(1.0).get(*XI) == [0.0] * 3


def test_largest_gap_between_samples_is_found(fmu):
    """One step over a single summit of known height, and a step that ends before it; off, it stays
    0.
    """

    def largest(end, on=True):
        f = open_fmu(fmu).start(box_amplitude=0.0, d2=0.0, v2_start=2.0, x_rel_max_on=on)
        return f.step(end).get("x_rel_max", "x_rel")

    assert largest(2.5)[0] == pytest.approx(2.0 / math.sqrt(1.2), rel=1e-14)
    climbing, gap = largest(0.5)
    assert climbing == pytest.approx(gap, rel=1e-14)
    assert largest(2.5, on=False)[0] == 0.0
