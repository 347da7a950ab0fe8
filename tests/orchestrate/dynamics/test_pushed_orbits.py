"""Orbits and branches with forces and gravity, against the FMU's own map and its sweeps."""

import numpy as np
import pytest

import orchestrate
from orchestrate.dynamics.bifurcation_kinds import Kind
from orchestrate.errors import InputError
from orchestrate.model import Excitation, Structure
from orchestrate.response.questions import Point

from ...draws import draw_structure
from .stroboscopic import after, differences
from .test_branches import values

QUICK = {"progress": False, "jobs": 1}
PUSHES = "box_acceleration", "force1", "force2"


def draw_of_kind(random, kind):
    """A structure of 3 kg and 7 rad/s and its excitation, with pushes of the size of the box's own.

    Its restitution may decrease with the closing speed; it may be against a wall, in a play, or
    both: the other end within reach.
    """
    drawn, eta = draw_structure(random)
    units = {"m": 3.0, "k": 3.0 * 49.0, "d": 3.0 * 7.0}
    names = [f"{quantity}{mass}" for quantity in units for mass in (1, 2)]
    structure = drawn.replace(**{name: units[name[0]] * drawn.get(name) for name in names})
    structure = structure.replace(e_slope=float(random.choice([0.0, 0.1])))
    sizes = random.uniform(-1.5, 1.5, 3) * 49.0 * [1.0, structure.m1, structure.m2]
    pushes = dict(zip(PUSHES, map(float, sizes), strict=True))
    structure = structure.replace(wall="wall" in kind)
    if structure.wall:
        pushes["force2"] = 0.0
    if "play" in kind:
        near = max(0.0, structure.clearance)
        structure = structure.replace(stroke=near + float(10.0 ** random.uniform(-1.0, 0.5)))
    box = {"frequency": eta * structure.omega, "amplitude": 0.0 if "rest" in kind else eta**-2.0}
    return structure, {**box, **pushes}


KINDS = {  # how many orbits, and the kinds of nodes among them
    **{"two masses": (10, {0, 1, 2}), "box at rest": (2, {0}), "wall": (8, {0, 1, 2})},
    **{"play": (8, set(range(6))), "wall and play": (6, {0, 1, 2, 3})},
}


@pytest.mark.parametrize("kind", KINDS)
def test_orbits_of_random_structures_are_those_of_the_fmus_own_map(instances, kind):
    """States after a period to 1e-10, multipliers by differences; permanent contact among them."""
    random, nodes, compared = np.random.default_rng(6), set(), 0
    while compared < KINDS[kind][0]:
        structure, excitation = draw_of_kind(random, kind)
        try:
            short = {"transient": 200, "search": 60}
            found = orchestrate.orbit(structure, **excitation, **short, **QUICK)
        except InputError as reason:
            assert "no orbit found" in str(reason)
            continue
        point, state = Point(structure, Excitation(**excitation)), found.state.values[0]
        assert found.fmu_same_impacts
        multipliers = found.multipliers.values @ [1.0, 1.0j]
        away = after(instances[0], point, state) - state
        largest = max(1.0, np.abs(multipliers).max())
        assert np.abs(away).max() < 1e-10 * point.displacement_unit * largest
        nodes |= set(found.node_kind.values.tolist())
        gap = state[1] - state[0] + structure.gap_offset
        if min(gap, (structure.stroke or np.inf) - gap) > 1e-2 and found.node_kind.size:
            # in contact at phase 0 there is no neighbour beyond
            seen = np.linalg.eigvals(differences(instances[0], point, state))
            seen = np.append(seen, [0.0] * structure.wall)
            for multiplier in multipliers:
                assert np.abs(seen - multiplier).min() < 1e-6 * max(1.0, np.abs(seen).max())
            compared += 1
    assert nodes >= KINDS[kind][1]


OPEN = Structure.nondimensional(e=0.7, D=0.02, clearance=0.3)


def test_sweeps_change_where_a_branch_with_a_force_folds_and_doubles():
    asked = {"force1": 0.4, "longest": 0.3, **QUICK}
    along = orchestrate.branch(OPEN, eta=1.2, over="eta", limits=(1.1, 1.31), **asked)
    (flip,), (fold,) = values(along, Kind.FLIP), values(along, Kind.FOLD)
    etas = np.array([1.2, 1.13, flip + 4e-3, flip - 4e-3])
    run = {"direction": "given", "transient": 900, "samples": 40, "force1": 0.4, **QUICK}
    assert orchestrate.sweep(OPEN, eta=etas, **run).multiplicity.values.tolist() == [1, 1, 1, 2]
    last = along.isel(point=np.flatnonzero(along.stable & (along.eta > 1.28))[-1])
    etas = np.append(fold - (fold - float(last.eta)) * np.array([1.0, 0.5, 0.2]), fold + 1e-4)
    run |= {"start": last.state.values[0]}
    gaps = orchestrate.sweep(OPEN, eta=etas, **run).xi_rel_max.values
    steps = np.abs(np.diff(gaps))
    assert steps[:-1].max() < 0.1 * steps[-1]
    start = orchestrate.orbit(OPEN, eta=flip, force1=0.41, **QUICK)
    along = orchestrate.branch(
        OPEN, start=start, over="force1", limits=(0.38, 0.42), longest=0.3, **QUICK
    )
    assert values(along, Kind.FLIP) == pytest.approx([0.4], abs=1e-9)
    assert along.force1.values.min() == 0.38 and along.eta.values == pytest.approx(flip)


def test_a_branch_goes_on_with_impacts_at_the_outer_end_of_a_play():
    """Where a flight touches it; the border over the stroke is where the gap just fills it."""
    play = Structure.one_mass(m=1.0, k=1.0, d=0.1, e=0.6, clearance=0.2, stroke=2.5)
    box, along = {"frequency": 1.6, "amplitude": 0.0}, {"over": "force1", "longest": 0.3, **QUICK}
    start = orchestrate.orbit(play, **box, force1=1.2, **QUICK)
    first = orchestrate.branch(play, start=start, limits=(1.0, 2.5), **along)
    (touching,) = values(first, Kind.TOUCHING)
    other = orchestrate.branch(play, start=first, switch=0, limits=(1.0, 2.5), **along)
    assert set(first.node_kind.values.ravel()) == {0}
    assert first.attrs["last_end"] == "grazing of a flight"
    assert set(other.node_kind.values.ravel()) == {0, 3} and other.fmu_same_impacts[1:].all()
    assert other.force1[0] == pytest.approx(touching, abs=1e-9)
    limits = ((1.0, 2.5), (2.2, 2.8))
    along["over"] = ("force1", "stroke")
    curve = orchestrate.border(play, start=first, bifurcation=0, **along, limits=limits)
    assert np.abs(curve.xi_rel_max - curve.stroke / curve.force1).max() < 1e-13
    last = first.isel(point=-1).state.values[0]
    asked = {**box, "start": last, "transient": 100, "periods": 20, **QUICK}
    below, above = (
        orchestrate.simulate(play, **asked, force1=touching + away) for away in (-0.01, 0.01)
    )
    assert below.sizes["impact"] == 20 < above.sizes["impact"]
