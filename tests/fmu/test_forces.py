"""Forces on the masses, a wall in place of mass 2, a play with two ends: what must always hold; and
whole motions against an independent event-driven solution, with inputs that change on the way (some
of them in ``tests/kernels/oscillator/test_motion.py``).
"""

import itertools

import numpy as np
import pytest

from fmu_src.kernels.oscillator import memory

from ..kernels.oscillator.kernel import DEFAULTS, advanced, set_inputs, started
from .driver import FMUS
from .event_driven import CONTACT, CUBICS, Motion
from .programs.driver import Refused, harmonic, open_fmu
from .test_motion import STATE, structure

WALL = {"wall": True, "x2_start": 0.0, "v2_start": 0.0}
PLAY = {"stroke": 1.0}
HARMONIC = "harmonic forces and gravity"
KINDS = {
    **{HARMONIC: {"box_acceleration": -0.3}, "two masses": {}},
    **{"wall": WALL, "play": PLAY, "wall and play": {**WALL, **PLAY}},
}
SIZES = (1.0, 0.1, 0.02, 0.003)  # of a cubic's value and derivatives
FORCES = {
    **{"force1_amplitude": 0.4, "force2_amplitude": -0.3, "force1": 0.1, "force1_1": -0.02},
    **{"force2": 0.05, "force2_1": 0.02, "force2_2": -0.002, "force2_3": 1e-4},
}


def some_forces(rng, half, kind=""):
    """A force on a half: harmonic, constant, a cubic, or some of these."""
    if kind == HARMONIC:
        return {f"force{half}_amplitude": float(rng.uniform(-1, 1)), f"force{half}": 0.0}
    sizes = dict(zip(CUBICS[half], SIZES, strict=True)) | {f"force{half}_amplitude": 1.0}
    return {n: float(rng.integers(2) * size * rng.uniform(-1, 1)) for n, size in sizes.items()}


def drawn(kind, seed, periods):
    """A structure, with a restitution that decreases with the speed in half of them, the inputs
    that are set at some times, and when its motion ends.

    Forces and cubics of the box, some from the start and others later: they jump, and so does the
    force of a contact.
    """
    rng = np.random.default_rng((65, seed))
    values = structure(seed) | some_forces(rng, 1, kind) | some_forces(rng, 2, kind) | KINDS[kind]
    values["clearance"] *= seed % 3 > 0
    values["e_slope"] = (0.0, 0.5, 0.0, 2.0)[seed % 4]
    values["box_amplitude"] *= seed % 5 > 0
    if values.get("wall") and values["clearance"] < values["x1_start"]:
        values["x1_start"] = 0.0
    if "stroke" in values:
        gap = values["x2_start"] - values["x1_start"] + max(values["clearance"], 0.0)
        values["stroke"] = max(gap, values["clearance"]) + float(rng.choice([0.1, 0.3, 1.0]))
    stop, changes = periods * 2.0 * np.pi / values["box_frequency"], []
    for time in stop * np.sort(rng.uniform(0.05, 0.95, 0 if kind == HARMONIC else 3)):
        inputs = some_forces(rng, int(rng.integers(1, 3)))
        if rng.random() < 0.3:
            inputs |= {"box_acceleration": float(rng.uniform(-0.5, 0.5)), "box_jerk": 0.05}
        changes.append((float(time), inputs))
    return values, changes, stop


def play(f, values, changes, stop, *names):
    f.reset().start(**values)
    for time, inputs in changes:
        f.step(time).set(**inputs)
    return f.step(stop).get(*names)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_many_motions_are_those_of_an_independent_solver(kind):
    """All that are regular: one that starts or is driven a little otherwise leads as near."""
    regular, f = 0, open_fmu(FMUS["fmi3"])
    for seed in range(200):
        values, changes, stop = drawn(kind, seed, 3)
        motion = Motion(values)
        motion.longest *= 0.1  # no graze is stepped over
        for time, inputs in changes:
            motion.run(time).set(**inputs)
        motion.run(stop)
        names, size = (*STATE, "impact_count", "in_contact"), motion.size
        moved = {**values, "v1_start": values["v1_start"] - 1e-9 * size}
        moved["force1"] += 1e-9 * values["k1"] * size
        end, other = (play(f, v, changes, stop, *names) for v in (values, moved))
        if np.abs(np.subtract(end[:4], other[:4])).max() > 1e-7 * size or end[4] != other[4]:
            continue
        regular += 1
        apart = np.abs(np.subtract(end[:4], motion.state)).max() / size
        found = (apart < 1e-9, end[4], bool(end[5]))
        assert found == (True, len(motion.impacts), motion.mode == CONTACT), (seed, apart)
    assert regular > 100


@pytest.mark.parametrize("kind", KINDS)
def test_all_forms_and_the_pure_kernel_give_the_same_bits(kind):
    """With inputs that jump, their times among them, saved and restored on the way."""
    for seed in range(2):
        values, changes, stop = drawn(kind, seed, 3)
        m = started(**values)
        for time, inputs in changes:
            set_inputs(advanced(m, time), **inputs)
        advanced(m, stop)
        for path in FMUS.values():
            f = open_fmu(path).start(**values)
            for time, inputs in changes:
                f.step(time).set(**inputs)
                f.restore(*f.save())
            names = f.step(stop).output_names
            assert f.get(*names) == [m[getattr(memory, name.upper())] for name in names]


@pytest.mark.parametrize("more", [FORCES, {**FORCES, "wall": True, "clearance": 0.1}])
def test_what_enters_through_forces_is_in_the_momentum(fmu, more):
    """The impulse on the box is what box and forces give the masses, less what they keep."""
    values = {"m1": 1.2, "m2": 0.7, "box_amplitude": 0.6, "box_frequency": 1.13, **more}
    f, points = open_fmu(fmu).start(**values), np.polynomial.legendre.leggauss(20)
    heavy = (values["m1"],) if "wall" in more else (values["m1"], values["m2"])
    motion = Motion({**DEFAULTS, "x1_start": 0.0, "x2_start": 0.0, **values})
    for begin, end in itertools.pairwise((0.0, 0.001, 1.5, 8.0, 8.01, 30.0)):
        nodes = np.linspace(begin, end, 50)
        halves, middles = 0.5 * np.diff(nodes), 0.5 * (nodes[1:] + nodes[:-1])
        t = (np.outer(halves, points[0]) + middles[:, None]).ravel()
        w = np.outer(halves, points[1]).ravel()
        given = sum(motion.force(k, t) - m * motion.box(t) for k, m in enumerate(heavy, 1))
        before = f.get("x1", "v1", "x2", "v2")
        f.step(end)
        after = f.get("x1", "v1", "x2", "v2")
        kept = sum(m * (after[2 * k + 1] - before[2 * k + 1]) for k, m in enumerate(heavy))
        moved = sum(m * (after[2 * k] - before[2 * k]) for k, m in enumerate(heavy))
        last = sum(m * after[2 * k + 1] for k, m in enumerate(heavy))
        impulse, moment = f.get("box_impulse", "box_impulse_moment")
        assert impulse == pytest.approx(np.sum(w * given) - kept, abs=1e-12)
        expected = np.sum(w * (t - begin) * given) + moved - (end - begin) * last
        assert moment == pytest.approx(expected, abs=1e-11)
    assert f.one("impact_count") > 5


@pytest.mark.parametrize("more", [{}, {"wall": True}, FORCES])
@pytest.mark.parametrize("e", [0.0, 0.6])
def test_both_ends_of_a_play(fmu, e, more):
    """The gap stays between them, steps know the largest one, and masses stay at either end."""
    values = {**harmonic(0.7), **more, "e": e, "stroke": 1.0, "clearance": 0.3, "d1": 0.1}
    f, sides, count = open_fmu(fmu).start(**values), [set(), set()], 0
    for k in range(1, 1500):
        gap, largest = f.step(k / 16).get("x_rel", "x_rel_max")
        assert 0.0 <= gap <= largest <= 1.0
        touching, struck, now = f.get("contact_side", "impact_side", "impact_count")
        assert bool(touching) == f.one("in_contact")
        assert gap == {0: gap, 1: 0.0, 2: 1.0}[touching]
        assert now == count or struck > 0
        count = now
        sides[0].add(touching)
        sides[1].add(struck)
    assert sides[1] >= {1, 2} and (e > 0.0 or sides[0] > {0})
    assert e > 0.0 or "wall" not in more or sides[0] == {0, 1, 2}


def test_a_start_at_the_outer_end(fmu):
    """At rest against it, pressed by a force; a play that displacements dwarf is refused."""
    values = {"box_amplitude": 0.0, "stroke": 0.25, "clearance": 0.25, "force2": 0.5}
    f = open_fmu(fmu).start(**values)
    assert f.get("in_contact", "contact_side", "x_rel", "x2") == [1, 2, 0.25, 0.0]
    assert f.one("contact_force") == pytest.approx(0.25)
    f.step(3.0).set(force2=-0.5).step(3.5)
    assert f.get("in_contact", "contact_side", "impact_side") == [0, 0, 0]
    assert 0.0 < f.one("x_rel") < 0.25
    narrow = open_fmu(fmu).start(stroke=1e-9, **harmonic(1.1))
    with pytest.raises(Refused, match="stroke = 1e-09 m"):
        narrow.step(100.0)


@pytest.mark.parametrize("kind", KINDS)
def test_peaks_are_those_of_a_dense_look(fmu, kind):
    """The largest gap and the impulse of many short steps are those of one, too."""
    values = drawn(kind, 7, 3)[0]
    dense, whole = (open_fmu(fmu).start(**values, peaks_on=on) for on in (False, True))
    motion, names = Motion(values), ("x1_max", "x2_max", "a1_max", "a2_max", "x_rel_max")
    for k in range(1, 40):
        rows, steps = [], []
        whole.step(0.25 * k)
        for i in range(1, 65):
            t = 0.25 * (k - 1) + i / 256
            *state, touch, gap = dense.step(t).get(*STATE, "in_contact", "x_rel")
            steps.append(dense.get("x_rel_max", "box_impulse"))
            pair = motion.accelerations(t, state)
            if touch:
                share = motion.share
                pair = [sum(m * a for m, a in zip(share, pair, strict=True)) / sum(share)] * 2
            spatial = [abs(a + motion.box(t)) for a in pair]
            rows.append([abs(state[0]), abs(state[2]), *spatial, gap])
        largest, impulses = np.array(steps).T
        whole_step = whole.get("x_rel_max", "box_impulse")
        assert whole_step == pytest.approx([largest.max(), impulses.sum()], abs=1e-12)
        top, found = np.max(rows, axis=0), np.array(whole.get(*names))
        assert (found >= top - 1e-12).all(), (k, found, top)
        one_impact = whole.one("impact_count") == dense.one("impact_count")
        assert one_impact and (found <= top + 0.1 * np.maximum(1.0, top)).all(), (k, found, top)
