"""What the outputs mean: definitions at a point, exact integrals and largest gap over a step."""

import math

import numpy as np
import pytest

from .programs.driver import open_fmu

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
        assert [row["xi1"], row["xi2"], row["xi_rel"]] == pytest.approx(
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


def test_paper_displacements_are_zero_without_excitation(fmu):
    """Where a eta = 0: zero, not a division by zero."""
    for still in ({"box_amplitude": 0.0}, {"box_frequency": 0.0}):
        f = open_fmu(fmu).start(x1_start=-1.0, **still).step(1.0)
        assert f.get("xi1", "xi2", "xi_rel") == [0.0] * 3


STEPS = [
    {},
    {"box_acceleration": 0.1},
    {"box_frequency": 1.13, "box_acceleration": -0.2, "m2": 2.0},
    {"force1_amplitude": 0.2, "force2_amplitude": -0.3, "force1": 0.1, "force2_1": 1e-3},
    {"force1_amplitude": 0.2, "force1_2": 1e-4, "wall": True, "clearance": -0.05},
    {"box_frequency": 1.13, "stroke": 0.4},
]


@pytest.mark.parametrize("more", STEPS)
def test_what_belongs_to_a_step_is_exact(fmu, more):
    """Impulse, its moment and the largest gap of long steps, with many impacts in them, against
    small ones put together.
    """
    whole, parts = (open_fmu(fmu).start(**{**VALUES, **more}) for _ in range(2))
    names = ("box_force", "box_impulse", "box_impulse_moment", "x_rel", "x_rel_max")
    step = 2.0**-6
    for size in (0.25, 3.0, 17.0, 40.0):
        begin, rows = whole.time, []
        whole.step(begin + size)
        while parts.time < begin + size:
            here, force = parts.time, parts.one("box_force")
            rows.append([here - begin, force, *parts.step(here + step).get(*names)])
        since, before, after, impulses, moments, gaps, largests = np.array(rows).T
        impulse, moment, largest, gap = whole.get(*names[1:3], "x_rel_max", "x_rel")
        assert impulse == pytest.approx(np.sum(impulses), abs=1e-11)
        assert moment == pytest.approx(np.sum(moments + since * impulses), abs=1e-9)
        # the trapezoidal rule knows nothing of impacts: a wall has their impulses too; dampers make
        # the force jump there by d * jump, for less than a step
        if "wall" not in more:
            assert impulse == pytest.approx(np.sum(0.5 * step * (before + after)), abs=2e-3)
        assert largest == pytest.approx(np.max(largests), abs=1e-13)
        assert np.max(gaps) - 1e-14 <= largest <= np.max(gaps) + 1e-3
        assert largest >= gap - 1e-14


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
