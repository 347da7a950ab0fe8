"""The communication grid does not matter, amplitudes scale, masses never pass through each other,
momentum and energy are kept.
"""

import pytest

from .driver import run


@pytest.mark.parametrize(
    ("eta", "more"),
    [
        (0.4, {}),
        (1.13, {}),
        (2.9, {}),
        (1.13, {"clearance": 0.25}),
        (1.13, {"clearance": -0.25, "e_slope": 0.3}),
    ],
)
def test_communication_grid_does_not_matter(fmu, tmp_path, eta, more):
    """At eta = 1.13 the motion is chaotic: a difference in the last bit would have grown to one in
    the first digits.
    """
    found = run("guarantees.grids", fmu, eta, 512, more, cwd=tmp_path)
    reference = found.pop("one step")
    assert reference["impact_count"] > 100
    for name, outputs in found.items():
        assert outputs == reference, name


@pytest.mark.parametrize("clearance", [0.0, 0.25, -0.25])
def test_communication_grid_does_not_matter_after_inputs_changed(fmu, tmp_path, clearance):
    """The same with inputs that change at common points of time, a constant acceleration among
    them.
    """
    program = "guarantees.communication_grid_does_not_matter_after_inputs_changed"
    found = run(program, fmu, clearance, cwd=tmp_path)
    assert found[0]["impact_count"] > 15
    assert found[0] == found[1] == found[2]


def test_cubic_inputs_run_on_over_steps(fmu, tmp_path):
    """Until one of them is set, to whatever value; in every form, after a restored state too."""
    found, cubic, untouched = run("guarantees.cubic_inputs_run_on_over_steps", fmu, cwd=tmp_path)
    assert found[0] == found[1] == found[2]
    assert found[0][2] == cubic
    assert found[0][1] != untouched


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
    whole, parts = run(
        "guarantees.steps_of_a_period_end_where_one_step_ends",
        fmu,
        values,
        periods,
        pieces,
        cwd=tmp_path,
    )
    assert parts == pytest.approx(whole, abs=1e-9)


@pytest.mark.parametrize(
    ("clearance", "e_slope"), [(0.0, 0.0), (0.3, 0.0), (-0.3, 0.7), (0.0, 0.7)]
)
def test_amplitudes_scale_to_the_last_bit(fmu, tmp_path, clearance, e_slope):
    """Displacements, velocities and forces times 2^n, energies times 4^n, times over length times
    2^-n; times, counts and the paper's xi as they were.
    """
    program = "guarantees.amplitudes_scale_to_the_last_bit"
    found = run(program, fmu, clearance, e_slope, cwd=tmp_path)
    reference = found.pop("0")
    assert reference["impact_count"] > 40
    unchanged = {
        "xi1",
        "xi2",
        "xi_rel",
        "phase",
        "in_contact",
        "impact_count",
        "impact_time",
        "contact_count",
        "evaluations",
    }
    for n, outputs in found.items():
        scale = 2.0 ** int(n)
        expected = {
            name: value * (1.0 if name in unchanged else scale) for name, value in reference.items()
        }
        expected["impact_energy"] = reference["impact_energy"] * scale**2
        assert outputs == expected, n


@pytest.mark.parametrize("clearance", [0.0, 0.3, -0.3])
def test_masses_never_pass_through_each_other(fmu, tmp_path, clearance):
    """x_rel >= 0 at dense and random points, and within a few roundings of every impact, where it
    is as small as it gets.
    """
    lowest, nearest, largest_near, impacts = run(
        "guarantees.masses_never_pass_through_each_other", fmu, clearance, cwd=tmp_path
    )
    assert impacts > 10
    assert lowest >= 0.0
    assert nearest >= 0.0
    assert largest_near < 1e-12


@pytest.mark.parametrize(
    ("values", "contacts"),
    [
        ({"m2": 3.0, "box_frequency": 1.13}, False),
        ({"m1": 5.0, "m2": 0.4, "k2": 0.9, "e": 0.3, "box_frequency": 2.9}, False),
        # a plastic impact begins a contact at full speed
        ({"m2": 3.0, "e": 0.0, "k2": 0.7, "d2": 0.05, "box_frequency": 0.8}, True),
        ({"m2": 3.0, "box_frequency": 1.13, "clearance": 0.4}, False),
        ({"m2": 3.0, "e": 0.0, "box_frequency": 0.8, "clearance": -0.2}, True),
        ({"m2": 3.0, "e": 0.9, "box_frequency": 1.13, "e_slope": 0.8}, False),
    ],
)
def test_momentum_is_kept_at_impacts_and_starts_of_contact(fmu, tmp_path, values, contacts):
    found = run("guarantees.impacts", fmu, values, cwd=tmp_path)
    m1, m2, e = values.get("m1", 1.0), values["m2"], values.get("e", 0.7)
    slope = values.get("e_slope", 0.0)
    assert len(found) > 8
    assert any(begun for *_, begun in found) == contacts
    for u1, u2, v1, v2, closing, _ in found:
        size = m1 * abs(u1 - v1)
        assert size > 1e-3  # something is exchanged
        assert m1 * v1 + m2 * v2 == pytest.approx(m1 * u1 + m2 * u2, abs=5e-7)
        assert closing == pytest.approx(u1 - u2, abs=5e-7)
        assert v2 - v1 == pytest.approx(e * closing / (1.0 + slope * closing), abs=5e-7)
