"""The communication grid does not matter, amplitudes scale, masses never pass through each other,
momentum and energy are kept.
"""

import json

import pytest

from .driver import run

# A dyadic grid: every time and every difference of two times is exact, so that all grids reach the
# very same point of time.
# The last step is common to all grids, so that what belongs to a step (impulse, its moment, largest
# gap) must agree too.
GRIDS = r"""
eta, end = float(sys.argv[2]), float(sys.argv[3])
last = end - 0.25
rng = random.Random(1)
ticks = int(last * 2**20)
grids = {
    "one step": [last],
    "a thousand steps": [last * k / 1024 for k in range(1, 1025)],
    "uneven": sorted({rng.randrange(1, ticks) * 2.0**-20 for _ in range(300)} | {last}),
    "clustered": sorted({2.0**-20, 2.0**-19, last - 2.0**-20, last} | {int(ticks * rng.random() ** 4 + 1.0) * 2.0**-20 for _ in range(50)}),
}
found = {}
for name, times in grids.items():
    f = open_fmu(PATH).start(**harmonic(eta))
    for time in [*times, end]:
        f.step(time)
    found[name] = f.outputs()
    f.free()
answer(found)
"""


@pytest.mark.parametrize("eta", [0.4, 1.13, 2.9])
def test_communication_grid_does_not_matter(fmu, tmp_path, eta):
    """At eta = 1.13 the motion is chaotic: a difference in the last bit would have grown to one in
    the first digits.
    """
    found = run(GRIDS, fmu, eta, 512, cwd=tmp_path)
    reference = found.pop("one step")
    assert reference["impact_count"] > 100
    for name, outputs in found.items():
        assert outputs == reference, name


def test_communication_grid_does_not_matter_after_inputs_changed(fmu, tmp_path):
    """The same with inputs that change at common points of time, a constant acceleration among
    them.
    """
    script = r"""
    changes = [(0.0, dict(box_frequency=1.13)), (20.0, dict(box_amplitude=0.5)), (41.5, dict(box_frequency=2.9, box_acceleration=0.05)),
               (60.25, dict(box_acceleration=0.0)), (96.0, {})]
    found = []
    for pieces in (1, 7, 256):
        f = open_fmu(PATH).start()
        for (begin, values), (end, _) in zip(changes, changes[1:]):
            f.set(**values)
            ticks = int((end - begin) * 2**20)
            for k in range(1, pieces + 1):
                f.step(begin + ticks * k // pieces * 2.0**-20)
            f.step(end + 0.0)
        found.append(f.outputs([n for n in f.output_names if n not in ("box_impulse", "box_impulse_moment", "x_rel_max")]))
    answer(found)
    """
    found = run(script, fmu, cwd=tmp_path)
    assert found[0]["impact_count"] > 20
    assert found[0] == found[1] == found[2]


STROBOSCOPIC = [
    ({"box_frequency": 5.720780758293891, "box_amplitude": 0.03055549976383381, "e": 0.3}, 59, 59),
    (
        {
            "box_frequency": 4.530369234871276,
            "box_amplitude": 0.04872286314565522,
            "e": 0.0,
            "gamma": 1e-3,
        },
        59,
        59,
    ),
    ({"d1": 100.0, "x1_start": -0.2, "x2_start": 0.3, "v1_start": -0.3, "v2_start": 0.6}, 1, 1024),
    ({"box_frequency": 1.13, "e": 0.3}, 60, 60),
]


@pytest.mark.parametrize(("values", "periods", "pieces"), STROBOSCOPIC)
def test_steps_of_a_period_end_where_one_step_ends(fmu, tmp_path, values, periods, pieces):
    """An importer's grid decides neither whether a step can be done; x_rel_max, which looks at each
    step, included.
    """
    script = r"""
    values, periods, pieces = json.loads(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
    size = 2.0 * math.pi / values.get("box_frequency", 0.4) * (periods / pieces)
    whole = open_fmu(PATH).start(**values).step(pieces * size)
    parts = open_fmu(PATH).start(**values)
    for k in range(1, pieces + 1):
        parts.step(k * size)
    answer([f.get("x1", "x2", "impact_count") for f in (whole, parts)])
    """
    whole, parts = run(script, fmu, json.dumps(values), periods, pieces, cwd=tmp_path)
    assert parts == pytest.approx(whole, abs=1e-9)


def test_amplitudes_scale_to_the_last_bit(fmu, tmp_path):
    """Displacements, velocities and forces times 2^n, energies times 4^n; times, counts and the
    paper's xi as they were.
    """
    script = r"""
    starts = dict(x1_start=-0.375, x2_start=0.8125, v1_start=0.1, v2_start=-0.3)
    found = {}
    for n in (0, -40, 7, 60):
        scale = 2.0**n
        scaled = {name: value * scale for name, value in starts.items()}
        f = open_fmu(PATH).start(box_amplitude=0.7 * scale, box_frequency=1.13, m2=1.5, **scaled)
        f.step(250.0)
        f.step(256.0)
        found[n] = f.outputs()
    answer(found)
    """
    found = run(script, fmu, cwd=tmp_path)
    reference = found.pop("0")
    assert reference["impact_count"] > 50
    unchanged = {
        "xi1",
        "xi2",
        "xi_rel",
        "phase",
        "in_contact",
        "impact_count",
        "impact_time",
        "contact_count",
    }
    for n, outputs in found.items():
        scale = 2.0 ** int(n)
        expected = {
            name: value * (1.0 if name in unchanged else scale) for name, value in reference.items()
        }
        expected["impact_energy"] = reference["impact_energy"] * scale**2
        assert outputs == expected, n


def test_masses_never_pass_through_each_other(fmu, tmp_path):
    """x_rel >= 0 at dense and random points, and within a few roundings of every impact, where it
    is as small as it gets.
    """
    script = r"""
    rng = random.Random(2)
    lowest, near, impacts = math.inf, [], 0
    for eta, more in ((0.4, {}), (1.13, dict(m2=3.0)), (2.9, dict(e=0.1)), (0.4, dict(e=0.0))):
        first, second = (open_fmu(PATH).start(**harmonic(eta), **more) for _ in range(2))
        count = 0
        while first.time < 40.0:
            first.step(first.time + rng.uniform(0.0, 0.02))
            gap, instant, after = first.get("x_rel", "impact_time", "impact_count")
            lowest = min(lowest, gap)
            if after == count + 1:
                impacts += 1
                for time in (math.nextafter(instant, 0.0), instant, math.nextafter(instant, math.inf)):
                    if time > second.time:
                        near += second.step(time).get("x_rel")
            count = after
            second.step(first.time)
    answer([lowest, min(near), max(near), impacts])
    """
    lowest, nearest, largest_near, impacts = run(script, fmu, cwd=tmp_path)
    assert impacts > 30
    assert lowest >= 0.0
    assert nearest >= 0.0
    assert largest_near < 1e-12


IMPACTS = r"""
more = json.loads(sys.argv[2])
first, second = (open_fmu(PATH).start(**more) for _ in range(2))
found, count, contacts, instant = [], 0, 0, 0.0
h = 1e-9  # seconds before and after an impact: what springs do in the meantime is of this order
while first.time < 120.0 and len(found) < 40:
    first.step(first.time + 2.0**-6)
    after, contacts_after, instant_after, closing = first.get("impact_count", "contact_count", "impact_time", "impact_velocity")
    if after == count + 1 and instant_after - second.time > h and instant_after - instant > 1e-3 and instant_after + h < first.time:
        early = second.step(instant_after - h).get("v1", "v2")
        found.append([*early, *second.step(instant_after + h).get("v1", "v2"), closing, contacts_after - contacts])
        assert second.get("impact_count") == [after]
    second.step(first.time)
    count, contacts, instant = after, contacts_after, instant_after
answer(found)
"""


@pytest.mark.parametrize(
    ("values", "contacts"),
    [
        ({"m2": 3.0, "box_frequency": 1.13}, False),
        ({"m1": 5.0, "m2": 0.4, "k2": 0.9, "e": 0.3, "box_frequency": 2.9}, False),
        # a plastic impact begins a contact at full speed
        ({"m2": 3.0, "e": 0.0, "k2": 0.7, "d2": 0.05, "box_frequency": 0.8}, True),
    ],
)
def test_momentum_is_kept_at_impacts_and_starts_of_contact(fmu, tmp_path, values, contacts):
    found = run(IMPACTS, fmu, json.dumps(values), cwd=tmp_path)
    m1, m2, e = values.get("m1", 1.0), values["m2"], values.get("e", 0.7)
    assert len(found) > 8
    assert any(begun for *_, begun in found) == contacts
    for u1, u2, v1, v2, closing, _ in found:
        size = m1 * abs(u1 - v1)
        assert size > 1e-3  # something is exchanged
        assert m1 * v1 + m2 * v2 == pytest.approx(m1 * u1 + m2 * u2, abs=5e-7)
        assert closing == pytest.approx(u1 - u2, abs=5e-7)
        assert v2 - v1 == pytest.approx(e * closing, abs=5e-7)
