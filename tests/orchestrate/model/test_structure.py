"""A structure in SI units and by the paper's numbers: both ways, scaled, changed, refused."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from orchestrate import model
from orchestrate.errors import InputError
from orchestrate.model import Drive, Excitation, Structure
from orchestrate.model.ranges import ADDED

from .strategies import DRIVES, EXCITATIONS, NUMBERS, RATIO, SCALE, SHAKERS, SMALL, STRUCTURES


def near(value, expected):
    return math.isclose(value, expected, rel_tol=1e-12)


def test_the_operations_of_the_paper_s_sweeps():
    """To the last bit what sweeps by the paper's numbers have always given to the FMU."""
    structure = Structure.nondimensional(e=0.3, D=0.013, mu=0.7, kappa=1.3)
    expected = {"m1": 1.0, "m2": 0.7, "k1": 1.0, "k2": 1.3, "d1": 2.0 * 0.013}
    rest = {"d2": 2.0 * 0.013 * 0.7, "e": 0.3, "gamma": 3.6515e-4, "bonded": False, "wall": False}
    assert structure.parameters() == {**expected, **rest, **dict.fromkeys(ADDED, 0.0)}


def test_the_formulas_of_the_paper():
    structure = Structure(m1=2.0, m2=3.0, k1=8.0, k2=10.0, d1=0.4, d2=0.9)
    assert (structure.omega, structure.mu, structure.kappa) == (2.0, 1.5, 1.25)
    assert near(structure.D1, 0.4 / (2.0 * 2.0 * 2.0))
    assert near(structure.D2, 0.9 / (2.0 * 2.0 * 3.0))
    assert near(structure.D3, 1.3 / (2.0 * 2.0 * 5.0))
    omegas = [math.sqrt(k / m) / 2.0 for k, m in ((8.0, 2.0), (10.0, 3.0), (18.0, 5.0))]
    found = [structure.omega_1, structure.omega_2, structure.omega_3]
    assert all(map(near, found, omegas))


@given(st.tuples(STRUCTURES, EXCITATIONS, DRIVES, SHAKERS))
def test_repr_can_be_evaluated(described):
    assert all(eval(repr(one), vars(model)) == one for one in described)


@given(NUMBERS, st.sampled_from(["mu", "kappa", "D1", "D2"]), SMALL)
def test_replacing_a_number_changes_that_number_alone(numbers, name, value):
    before = Structure.nondimensional(**numbers)
    after = before.replace(**{name: value})
    for other in ("mu", "kappa", "D1", "D2", "e", "gamma", "omega", "m1"):
        expected = value if other == name else before.get(other)
        assert near(after.get(other), expected), other
    assert (before.label() == after.label()) == (before == after)


@given(STRUCTURES, STRUCTURES)
def test_labels_of_different_structures_differ(one, other):
    assert (one.label() == other.label()) == (one == other)


@pytest.mark.parametrize(
    ("good", "quantity"),
    [(one, q) for one in (Structure(), Drive.from_file("beam")) for q in one.quantities.values()],
)
def test_ranges_are_the_fmu_s(good, quantity):
    name, minimum, maximum = quantity.name, quantity.minimum, quantity.maximum
    for value in (minimum, maximum):
        assert getattr(good.replace(**{name: value}), name) == value
    below, above = np.nextafter(minimum, -math.inf), np.nextafter(maximum, math.inf)
    for value in (below, above, math.nan, math.inf, -math.inf, 10**400, "1"):
        with pytest.raises(InputError, match=f"^{name} = .*expected .* <= {name} <= "):
            good.replace(**{name: value})


@pytest.mark.filterwarnings("ignore:.* of critical damping")
@given(SCALE, SCALE, SMALL, SMALL, RATIO, RATIO)
def test_halves_to_si_and_back(m1, m2, f1, f2, zeta1, zeta2):
    """Each half alone is the damped oscillator of its frequency and damping ratio."""
    halves = {"f1": f1, "f2": f2, "zeta1": zeta1, "zeta2": zeta2}
    structure = Structure.from_halves(m1=m1, m2=m2, **halves)
    for name, value in halves.items():
        assert near(structure.get(name), value), name
    for f, zeta, m, k, d in ((f1, zeta1, m1, "k1", "d1"), (f2, zeta2, m2, "k2", "d2")):
        roots = np.roots([m, structure.get(d), structure.get(k)])
        assert near(abs(np.prod(roots)), (2.0 * math.pi * f) ** 2)
        assert math.isclose(-roots.sum().real, 4.0 * math.pi * f * zeta, rel_tol=1e-9)
    assert near(structure.D2, zeta2 * f2 / f1)


@given(STRUCTURES, SMALL)
def test_a_half_s_frequency_keeps_its_damping_ratio_and_the_other_half(structure, f):
    other = structure.replace(f2=f)
    assert near(other.f2, f) and math.isclose(other.zeta2, structure.zeta2, rel_tol=1e-9)
    assert (other.m1, other.k1, other.d1) == (structure.m1, structure.k1, structure.d1)
    assert other.m2 == structure.m2


@pytest.mark.filterwarnings("ignore:.* of critical damping")
@given(SCALE, SMALL, RATIO, SMALL, SMALL)
def test_layers_together_are_the_beam_that_was_measured(mass, f, zeta, h1, h2):
    structure = Structure.from_bonded(mass=mass, f=f, zeta=zeta, thicknesses=(h1, h2))
    m, k, d = (structure.get(x + "1") + structure.get(x + "2") for x in "mkd")
    assert near(m, mass) and near(math.sqrt(k / m), 2.0 * math.pi * f)
    assert near(d, 2.0 * zeta * math.sqrt(k * m))
    # Timoshenko and Gere: k of E b h^3/12, m of b h
    assert near(structure.f2 / structure.f1, h2 / h1)


LAYERS = {"mass": 1.0, "f": 10.0}
WRONG = ((0.0, 1.0), (1.0, -2.0), (1.0,), 3.0, (1.0, math.nan))  # thicknesses
H = "thicknesses = .*expected two numbers > 0"


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: Structure(bonded="yes"), "^bonded = 'yes'"),
        (lambda: Structure(wall=1.0), "^wall = 1.0"),
        (lambda: Structure(stroke=0.1, clearance=0.2), "stroke = 0.1 m: .* clearance = 0.2 m"),
        (lambda: Structure.nondimensional(mu=0.0), "mu = 0.0: expected 1e-24 <= mu"),
        (lambda: Structure.nondimensional(D2="a"), "D2 = 'a': expected a number"),
        (lambda: Structure.nondimensional(mu=1e15, D=1e11), "mu = 1e?.*D = 1.*d2 = 2e.26"),
        (lambda: Structure().replace(omega=1e15), "omega = 1.*k1 = 1e.30"),
        (lambda: Structure().replace(kapa=2.0), "kapa: .*kappa"),
        (lambda: Structure().replace(mu=1.0, m2=2.0), "mu and m2: expected one of them"),
        (lambda: Structure().replace(D=1.0, D1=2.0), "D and D1: expected one of them"),
        (lambda: Structure().replace(e=2.0), "e = 2.0: expected 0 <= e <= 1"),
        (lambda: Structure().get("gama"), "gama: .*gamma"),
        (lambda: Structure(d1=0.3).get("D"), "D: D1 = 0.15 and D2 = 0.005"),
        (lambda: Structure.from_halves(m1=1, m2=1, f1=3, f2=4, zeta=0.1), "zeta: .*zeta1"),
        (lambda: Structure.one_mass(f1=42.0), "f1: no parameter here"),
        (lambda: Structure.one_mass(f=3.0, k=50.0), "f1 and k1: expected one of them"),
        *((lambda h=h: Structure.from_bonded(**LAYERS, thicknesses=h), H) for h in WRONG),
    ],
)
def test_refusals(call, words):
    with pytest.raises(InputError, match=words):
        call()


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


ETA = st.floats(1e-3, 1e3)


@given(ETA, STRUCTURES)
def test_with_eta_lengths_are_metres(eta, structure):
    excitation = Excitation.nondimensional(eta, structure)
    assert excitation.length(structure) == 1.0
    assert math.isclose(excitation.eta(structure), eta, rel_tol=1e-15)


@given(EXCITATIONS, STRUCTURES)
def test_length_is_a_eta_squared(excitation, structure):
    expected = excitation.amplitude * (excitation.frequency / structure.omega) ** 2
    assert math.isclose(excitation.length(structure), expected, rel_tol=1e-14)


@pytest.mark.parametrize("natural", [1.0, math.sqrt(1.2), math.sqrt(1.1)])
@pytest.mark.parametrize("detuning", [0.0, 0.9e-6, 1.1e-6])
@pytest.mark.parametrize("damping", [0.0, 0.9e-6, 1.1e-6])
def test_no_periodic_response_is_looked_for_at_a_resonance_without_damping(
    natural, detuning, damping
):
    structure = Structure.nondimensional(D=damping * natural)
    excitation = Excitation(frequency=natural * (1.0 + detuning), amplitude=0.5)
    if math.hypot(detuning, damping) < 1e-6:
        with pytest.raises(InputError, match=f"frequency = {excitation.frequency!r} rad/s"):
            excitation.check(structure)
    else:
        excitation.check(structure)
    excitation.replace(amplitude=0.0).check(structure)
