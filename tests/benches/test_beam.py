"""The beam of finite elements against closed forms and published frequencies."""

import numpy as np
import pytest

from tests.benches.beam import DelaminatedBeam, intact_frequency
from tests.benches.integrator import integrate
from tests.benches.lumped import TURN, Faces

from ..sparing import ordinary

PUBLISHED = {  # clamped-clamped, delaminated in the middle of span and thickness: Wang, Liu and
    # Gibby (1982), Della and Shu (2005), as tabled by Erdelyi and Hashemi (2016): modes 1 and 2
    **{0.1: (22.37, 60.76), 0.2: (22.36, 55.97), 0.3: (22.24, 49.00)},
    **{0.4: (21.83, 43.87), 0.5: (20.88, 41.45), 0.6: (19.29, 40.93)},
}


def dimensionless(beam, count):
    """Frequencies times the square of the length over sqrt(EI/m)."""
    frequency, shapes, _ = beam.modes(count)
    whole = beam.section(1.0)
    return frequency * beam.length**2 / np.sqrt(whole.bending / whole.mass), shapes


@pytest.mark.parametrize("both", [False, True])
def test_an_intact_beam_has_the_closed_frequencies(both):
    beam = DelaminatedBeam(first=0.0, last=0.0, clamped_both=both)
    roots = (4.73004074, 7.85320462, 10.9956078) if both else (1.87510407, 4.69409113, 7.85475744)
    frequencies, _ = dimensionless(beam, 3)
    assert frequencies == pytest.approx(np.square(roots), rel=1e-4)
    assert beam.modes(1)[0][0] / TURN == pytest.approx(intact_frequency(beam), rel=1e-6)


@pytest.mark.parametrize("length", ordinary(PUBLISHED, [0.2, 0.5]))
def test_a_delaminated_beam_has_the_published_frequencies(length):
    """Modes in which the layers move alike, which the published ones are: of equal layers.

    The published methods differ among each other by 0.25 % in the second mode.
    """
    beam = DelaminatedBeam(
        clamped_both=True, share=0.5, elements=60, first=0.5 - length / 2, last=0.5 + length / 2
    )
    frequencies, shapes = dimensionless(beam, 6)
    upper, lower = (beam.deflection_rows(shapes, layer, beam.nodes) for layer in (1, 2))
    alike = np.abs(upper - lower).max(axis=0) < 1e-6 * np.abs(upper).max(axis=0)
    assert frequencies[alike][:2] == pytest.approx(PUBLISHED[length], rel=2.5e-3)


def test_a_delamination_at_the_free_end_makes_two_beams():
    """Delaminated over nearly all its length: cantilevers of their own thickness."""
    beam = DelaminatedBeam(first=0.002, last=1.0, share=0.4, elements=60)
    whole = intact_frequency(beam)
    frequencies = beam.modes(2)[0] / TURN
    assert frequencies == pytest.approx([0.4 * whole, 0.6 * whole], rel=1e-2)


def test_accelerometers_are_where_the_first_mode_moves_as_a_mass_on_a_spring():
    beam = DelaminatedBeam(first=0.0, last=0.0)
    system = beam.system(Faces(), zeta=0.05, modes=1)
    f = float(system.frequency[0]) / TURN
    step, steps = 1e-5, 60_000
    base = np.sin(TURN * f * 0.5 * step * np.arange(2 * steps + 1))
    moved = integrate(system, base, step).acceleration[0, -5000:]
    assert moved.max() == pytest.approx(np.hypot(1.0, 1.0 / 0.1), rel=1e-3)


def test_equal_layers_never_part():
    beam = DelaminatedBeam(first=0.4, last=1.0, elements=20, share=0.5)
    base = 4.0 * np.sin(TURN * 38.0 * 0.5e-5 * np.arange(20_001))
    assert integrate(beam.system(Faces(), modes=8), base, 1e-5).largest_gap.max() < 1e-9
