"""The communication grid does not matter, amplitudes scale, masses never pass through."""

import itertools
import math
import random

import pytest

from .programs.driver import harmonic, open_fmu

FORCES = {
    **{"force1_amplitude": 0.4, "force2_amplitude": -0.3, "force1": 0.1, "force2": 0.05},
    "force1_1": 1e-3,
}
CUBIC = {"box_acceleration": 0.1, "box_jerk": -0.03, "box_snap": 0.02, "box_crackle": -0.003}


def grids(end):
    """Communication grids to one end.

    All are dyadic: every time and every difference of two times is exact. The last step is common
    to all, so that what belongs to a step (impulse, its moment, largest gap) must agree too.
    """
    last, rng = end - 0.25, random.Random(1)
    ticks = int(last * 2**20)
    clustered = {int(ticks * rng.random() ** 4 + 1.0) * 2.0**-20 for _ in range(50)}
    return {
        "one step": [last, end],
        "a thousand steps": [*(last * k / 1024 for k in range(1, 1025)), end],
        "uneven": sorted({*(rng.randrange(1, ticks) * 2.0**-20 for _ in range(300)), last, end}),
        "clustered": sorted({2.0**-20, 2.0**-19, *clustered, last - 2.0**-20, last, end}),
    }


@pytest.mark.parametrize(
    ("eta", "more"),
    [
        (0.4, {}),
        (1.13, {}),
        (1.13, {"m1": 1.3, "k1": 2.1}),  # its unit of time is no power of two
        (1.13, {"clearance": 0.25, "k1": 1.1}),
        (1.13, {"clearance": -0.25, "e_slope": 0.3}),
        (1.13, {**FORCES, "m1": 0.7}),
        (1.13, {**FORCES, "wall": True, "clearance": 0.25, "m1": 1.3}),
        (2.9, {"wall": True, "clearance": -0.01}),
        (1.13, {"stroke": 0.4}),
        (0.4, {"stroke": 2.0, "clearance": 1.5, "wall": True, **FORCES}),
    ],
)
def test_communication_grid_does_not_matter(fmu, eta, more):
    """At eta = 1.13 the motion is chaotic: a difference in the last bit would have grown."""
    found = {}
    for name, times in grids(512.0).items():
        with open_fmu(fmu) as f:
            found[name] = f.start(**harmonic(eta), **more).at(*times).outputs()
    reference = found["one step"]
    assert reference["impact_count"] > 80
    assert [name for name, outputs in found.items() if outputs != reference] == []


@pytest.mark.parametrize(
    ("clearance", "stroke"), [(0.0, 0.0), (0.25, 0.0), (-0.25, 0.0), (0.25, 0.75)]
)
def test_communication_grid_does_not_matter_after_inputs_changed(fmu, clearance, stroke):
    """The inputs change at common points of time, a constant acceleration among them."""
    changes = [
        (0.0, {"box_frequency": 1.13}),
        (20.0, {"box_amplitude": 0.5}),
        (41.5, {"box_frequency": 2.9, "box_acceleration": 0.05}),
        (60.25, {"box_acceleration": 0.0, "force1": 0.02, "force1_2": 1e-4, "force2": -0.3}),
        (76.0, {"force2": 0.3, "force2_amplitude": 0.1}),
        (96.0, {}),
    ]
    found = []
    for pieces in (1, 7, 256):
        f = open_fmu(fmu).start(clearance=clearance, stroke=stroke)
        for (begin, values), (end, _) in itertools.pairwise(changes):
            ticks = int((end - begin) * 2**20)
            f.set(**values)
            f.at(*(begin + ticks * k // pieces * 2.0**-20 for k in range(1, pieces + 1)), end)
        found.append(f.motion())
    assert found[0]["impact_count"] > 15
    assert found[0] == found[1] == found[2]


def test_cubic_inputs_run_on_over_steps(fmu):
    """Until one is set, to whatever value; before or after a state was saved and restored."""
    found = []
    for pieces in (1, 7, 256):
        f = open_fmu(fmu).start(**harmonic(1.13), **CUBIC)
        for k in range(1, pieces + 1):
            f.step(int(8 * 2**20) * k // pieces * 2.0**-20).set(x_rel_max_on=True)  # no cubic's
        middle = f.motion()
        if pieces == 7:
            f = open_fmu(fmu).restore(*f.set(box_jerk=-0.03).save())
        else:
            f = open_fmu(fmu).restore(*f.save()).set(box_jerk=-0.03)
        f.at(*(8.0 + int(4 * 2**20) * k // pieces * 2.0**-20 for k in range(1, pieces + 1)))
        found.append([middle, f.motion(), f.get(*CUBIC)])
    assert found[0] == found[1] == found[2]
    assert found[0][2] == list(CUBIC.values())
    assert found[0][1] != open_fmu(fmu).start(**harmonic(1.13), **CUBIC).step(12.0).motion()


@pytest.mark.parametrize(
    ("clearance", "e_slope", "forces", "wall"),
    [
        *((0.0, 0.0, {}, False), (0.3, 0.0, {}, False), (-0.3, 0.7, {}, False)),
        *((0.0, 0.7, {}, False), (0.3, 0.0, FORCES, False), (-0.3, 0.1, FORCES, True)),
        *((0.3, 0.0, {"stroke": 1.6}, False), (0.3, 0.1, {**FORCES, "stroke": 0.75}, True)),
    ],
)
def test_amplitudes_scale_to_the_last_bit(fmu, clearance, e_slope, forces, wall):
    """Displacements times 2^n, energies times 4^n, times over length times 2^-n, else the same."""
    lengths = {"x1_start": -0.375, "x2_start": 0.8125, "clearance": clearance}
    lengths |= {"v1_start": 0.1, "v2_start": -0.3, "box_amplitude": 0.7, **forces}
    if wall:
        lengths |= {"x2_start": 0.0, "v2_start": 0.0}
    powers = dict.fromkeys(("xi1", "xi2", "xi_rel", "phase", "in_contact", "evaluations"), 0)
    powers |= dict.fromkeys(("impact_count", "impact_time", "contact_count"), 0)
    powers |= {"impact_side": 0, "contact_side": 0}
    powers |= {"impact_energy": 2, "sticking_energy": 2}
    reference = {}
    for n in (0, -40, 7, 60):
        scale = 2.0**n
        scaled = {name: value * scale for name, value in lengths.items()}
        f = open_fmu(fmu).start(
            box_frequency=1.13, m2=1.5, e_slope=e_slope / scale, wall=wall, **scaled
        )
        found = f.at(250.0, 256.0).outputs()
        reference = reference or found
        assert found == {
            name: value * scale ** powers.get(name, 1) for name, value in reference.items()
        }, n
    assert reference["impact_count"] > 40


@pytest.mark.parametrize(
    ("clearance", "wall"), [(0.0, False), (0.3, False), (-0.3, False), (-0.3, True), (0.2, True)]
)
def test_masses_never_pass_through_each_other(fmu, clearance, wall):
    """At dense and random points, and within a few roundings of every impact."""
    rng, gaps, near = random.Random(2), [], []
    for eta, more in ((0.4, {}), (1.13, {"m2": 3.0}), (2.9, {"e": 0.1}), (0.4, {"e": 0.0})):
        values = {**harmonic(eta), **more, "clearance": clearance, "wall": wall}
        first, second = (open_fmu(fmu).start(**values) for _ in range(2))
        count = 0
        while first.time < 20.0:
            first.step(first.time + rng.uniform(0.0, 0.02))
            gap, instant, after = first.get("x_rel", "impact_time", "impact_count")
            gaps.append(gap)
            if after == count + 1:
                around = (math.nextafter(instant, 0.0), instant, math.nextafter(instant, math.inf))
                near += [second.step(t).one("x_rel") for t in around if t > second.time]
            count = after
            second.step(first.time)
    assert len(near) > 10
    assert min(gaps) >= 0.0 <= min(near)
    assert max(near) < 1e-12
