"""Forces on the masses, gravity, a wall and a stroke in Python: against an independent solver and
closed forms; what does not know them refuses them by name.
"""

from __future__ import annotations

import numpy as np
import pytest

import orchestrate
from orchestrate import Excitation, Structure
from orchestrate.response.questions import Point
from orchestrate.response.response_loop import traits_of_point

from ...fmu.event_driven import Motion

OWN = Structure(m1=0.8, m2=1.1, k1=5.0, k2=7.5, d1=0.3, d2=0.4, e=0.6, clearance=0.05)
WALL = Structure.one_mass(m=0.8, k=5.0, d=0.3, e=0.6, clearance=0.05)
KINDS = {
    "two masses": OWN,
    "pressed": OWN.replace(clearance=-0.05),
    "wall": WALL,
    "pressed wall": WALL.replace(clearance=-0.05),
    "play": OWN.replace(stroke=0.15),
    "wall and play": WALL.replace(stroke=0.15),
}
BOX = {"frequency": 2.3, "amplitude": 0.1}
PUSHES = {"box_acceleration": -0.3, "force1": 0.4}
QUICK = {"progress": False, "jobs": 1}
FAR = OWN.replace(clearance=50.0)

pytestmark = pytest.mark.usefixtures("exported")


def solver(structure, phase=0.0):
    """The motion from rest by the independent solver, with what pushes."""
    wall = structure.wall
    pushes = {"box_acceleration": PUSHES["box_acceleration"], "force1_amplitude": PUSHES["force1"]}
    values = structure.parameters() | {f"box_{name}": value for name, value in BOX.items()} | pushes
    values |= {"phase_start": phase}
    return Motion(values | {"force2_amplitude": 0.0 if wall else -0.2})


def pushes_of(structure):
    return PUSHES | ({} if structure.wall else {"force2": -0.2})


@pytest.mark.parametrize("kind", KINDS)
def test_simulate_is_the_motion_of_an_independent_solver(kind):
    structure = KINDS[kind]
    short = {"periods": 4, "points": 25, "phase": 0.4}
    motion = orchestrate.simulate(structure, **BOX, **pushes_of(structure), **short)
    exact = solver(structure, 0.4)
    rows, felt = [], []
    for time in motion.time.values:
        x1, v1, x2, v2 = exact.run(time).state
        rows.append([x1, x2, v1, v2])
        one, two = exact.accelerations(time, (x1, v1, x2, v2))
        if exact.mode == "contact":
            one = two = np.average([one, two], weights=exact.share)
        felt.append(np.add([one, two], exact.box(time)))
    found = np.array([motion[name].values for name in ("x1", "x2", "v1", "v2")]).T
    np.testing.assert_allclose(found, rows, atol=1e-8)
    np.testing.assert_allclose(motion.impact_time, exact.impacts, rtol=1e-8)
    assert len(exact.impacts) >= 3
    found = np.array([motion.a1_abs.values, motion.a2_abs.values]).T
    np.testing.assert_allclose(found, felt, atol=1e-6)
    np.testing.assert_allclose(motion.a2 + motion.box_acceleration, motion.a2_abs, atol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_sweep_and_map_have_the_samples_of_that_motion(kind):
    """From rest, both directions of a chain apart: its second value begins where the first ends."""
    structure, asked = KINDS[kind], {"transient": 2, "samples": 4}
    found = orchestrate.sweep(structure, **BOX, **pushes_of(structure), **asked, **QUICK)
    exact, gaps = solver(structure), []
    for period in range(3, 7):
        exact.run(period * 2.0 * np.pi / BOX["frequency"])
        gaps.append(exact.gap(0.0, exact.state))
    length = BOX["amplitude"] * BOX["frequency"] ** 2 / structure.omega**2
    np.testing.assert_allclose(found.xi_rel.values[0] * length, gaps, atol=1e-8)
    values = [PUSHES["force1"], 0.1]
    over = {**pushes_of(structure), "force1": values}
    chain = orchestrate.sweep(structure, **BOX, **over, **asked, direction="given", **QUICK)
    assert (chain.xi_rel.values[0] == found.xi_rel.values[0]).all()
    assert chain.force1.values.tolist() == values
    plane = orchestrate.map(structure, **BOX, **over, e=[0.6, 0.7], transient=60, **QUICK)
    assert plane.xi_rel_max.dims == ("force1", "e") and (plane.xi_rel_max > 0.0).all()


def test_apart_the_response_to_forces_and_gravity_is_linear():
    """Without box motion too: the static deflection and a harmonic, in units of the former."""
    w, force, gravity = BOX["frequency"], 0.4, -0.3
    reach = force / abs(complex(FAR.k1 - FAR.m1 * w * w, FAR.d1 * w))
    sag = 0.3 * FAR.m1 / FAR.k1
    asked = {"frequency": [w], "amplitude": 0.0, "force1": force}
    one = orchestrate.sweep(FAR, **asked, box_acceleration=gravity, **QUICK)
    assert float(one.x1_max[0]) == pytest.approx(sag + reach, rel=1e-4)
    assert float(one.x2_max[0]) == pytest.approx(0.3 * FAR.m2 / FAR.k2, rel=1e-9)
    unit = max(force / FAR.k1, 0.3 / FAR.omega**2)
    assert float(one.xi1_max[0]) == pytest.approx((sag + reach) / unit, rel=1e-4)
    both = orchestrate.resonance(FAR, **asked, direction="up", transient=200, **QUICK)
    masses, springs = FAR.m1 + FAR.m2, FAR.k1 + FAR.k2
    glued = force / abs(complex(springs - masses * w * w, (FAR.d1 + FAR.d2) * w))
    assert both.x1_max.values.ravel() == pytest.approx([glued, reach], rel=1e-4)
    assert "threshold_amplitude" not in both
    lines = orchestrate.spectra(
        FAR, **asked, periods=8, points=64, highest=8.0, **QUICK
    ).acceleration
    felt = lines.isel(frequency=0).sel(order=1.0)
    assert felt.sel(mass=1, kind="delaminated").item() == pytest.approx(reach * w * w, rel=1e-6)
    assert felt.sel(mass=1, kind="sampled").item() == pytest.approx(reach * w * w, rel=1e-6)
    assert felt.sel(mass=2, kind="bonded").item() == pytest.approx(glued * w * w, rel=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_attractors_basins_and_sections_agree(kind):
    """By orbits with forces and gravity, at a wall and at both ends of a stroke."""
    structure = KINDS[kind]
    asked = {**BOX, **pushes_of(structure), **QUICK}
    found = orchestrate.attractors(structure, **asked, starts=6).isel(frequency=0)
    orbit = orchestrate.orbit(structure, **asked, guess=found.state.values[0])
    assert found.multiplier[0] == pytest.approx(np.hypot(*orbit.multipliers.values.T).max())
    assert orbit.fmu_same_impacts and orbit.stable
    plane = {"x": ("x_rel", 0.0, 0.2, 4), "y": ("v_rel", -0.5, 0.5, 3)}
    basin = orchestrate.basin(structure, **asked, **plane)
    outside = basin.attractor_of.values == -1
    assert (outside == (basin.x_rel.values > (structure.stroke or 1.0))).all()
    assert basin.multiplicity.values.tolist() == found.multiplicity.values.tolist()
    section = orchestrate.poincare(structure, **asked, periods=8, at="impacts")
    assert section.x_rel.isin([0.0, structure.stroke]).all() and section.sizes["point"] >= 8
    assert (section.x_rel == 0.15).any() == bool(structure.stroke)


def test_releases_from_both_ends_of_a_play_are_those_of_the_fmu():
    play = OWN.replace(stroke=0.15, e=0.1)
    asked = {"frequency": 0.5, "amplitude": 1.0, **pushes_of(play), **QUICK}
    section = orchestrate.poincare(play, **asked, periods=4, at="releases")
    assert (section.x_rel == 0.0).any() and (section.x_rel > 0.149).any()
    assert section.v_rel.values == pytest.approx(0.0, abs=1e-12)
    period = 2.0 * np.pi / 0.5
    motion = orchestrate.simulate(play, **asked, transient=500, periods=4, points=4000)
    ends = motion.time[1:][np.diff(motion.in_contact.astype(int)) < 0].values
    times = section.time.values - 500.0 * period + float(motion.time[0])
    assert np.abs(times - ends).max() < 1.01 * period / 4000.0


@pytest.mark.parametrize("kind", ["wall", "play"])
def test_shaken_motions_are_those_of_an_independent_solver(kind):
    """Under a sine whose frequency rises, beside it gravity and harmonic forces; and a knock."""
    structure = KINDS[kind]
    forces = {name: value for name, value in pushes_of(structure).items() if "force" in name}
    sine = orchestrate.SweptSine(first=0.3, last=0.5, duration=5.0, acceleration=0.6)
    knock = orchestrate.Hammer(peak=-4.0, width=0.4, at=1.0, duration=5.0)
    for signal in (sine, knock):
        given = {"accuracy": 1e-10, "sample_rate": 8.0, "progress": False}
        data = orchestrate.shake(structure, signal, **given, **pushes_of(structure), frequency=2.3)
        pieces, values = signal.pieces(1e-10), structure.parameters() | {"box_frequency": 2.3}
        values |= {f"{name}_amplitude": value for name, value in forces.items()}
        exact = Motion(values | {"box_acceleration": PUSHES["box_acceleration"]})
        if signal is sine:
            exact.acceleration = lambda t, pieces=pieces: float(pieces(np.array([t]))[0])
        else:
            harmonic = exact.force
            exact.force = lambda n, t, harmonic=harmonic, pieces=pieces: (
                harmonic(n, t) + (float(pieces(np.array([t]))[0]) if n == 1 else 0.0)
            )
            exact.longest *= 0.3
        box, rows, felt = data.box_acceleration.values, [], []
        for time in data.time.values:
            y = exact.run(time).state
            rows.append(y[[0, 2, 1, 3]])
            felt.append(exact.box(time))
        states = data[["x1", "x2", "v1", "v2"]].to_array().values.T
        assert len(exact.impacts) == data.sizes["impact"] > 3
        assert np.abs(states - rows).max() < 1e-7
        assert box == pytest.approx(np.array(felt), abs=1e-7)
        force = data.force1.values - forces["force1"] * np.sin(2.3 * data.time.values)
        assert np.abs(force).max() == pytest.approx(0.0 if signal is sine else 4.0, abs=0.4)
        free = data.in_contact.values == 0
        loads = data.force1 - structure.k1 * data.x1 - structure.d1 * data.v1
        assert data.a1_abs.values[free] == pytest.approx(loads.values[free] / structure.m1)


def test_impacts_have_to_come_only_where_that_is_known():
    touching = {"frequency": [2.3], "amplitude": 5.0, **QUICK}
    box = Excitation(frequency=2.3, amplitude=5.0)
    assert traits_of_point(Point(OWN, box))[-1] == 1.0
    for structure, pushed in ((OWN, box.replace(force1=0.1)), (WALL, box), (KINDS["play"], box)):
        assert traits_of_point(Point(structure, pushed))[-1] == 0.0
    assert (orchestrate.sweep(OWN, **touching).impacts_per_period > 0.0).all()


@pytest.mark.parametrize("e", [0.0, 0.7])
@pytest.mark.parametrize("wall", [False, True])
def test_chains_over_clearance_and_stroke_go_on_inside_the_gap(wall, e):
    """Ends at a face go on there, within rounding, and those beyond a smaller stroke at its end."""
    structure = (Structure.one_mass(stroke=2.0) if wall else Structure(stroke=2.0)).replace(e=e)
    asked = {"eta": 1.3, "transient": 20, "samples": 8, "direction": "both", **QUICK}
    for over in ({"clearance": np.linspace(-1.0, 2.0, 31)}, {"stroke": np.linspace(0.1, 3.0, 31)}):
        ((name, values),) = over.items()
        found = orchestrate.sweep(structure, over=name, values=values, **asked)
        gaps, stroke = found.xi_rel_max.values, values if name == "stroke" else 2.0
        assert (gaps >= 0.0).all() and (gaps <= np.multiply(stroke, 1.0 + 1e-14)).all()
