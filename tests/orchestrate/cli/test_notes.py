"""From which numbers on a user is asked whether they are meant: each just inside, just outside."""

import logging
import warnings
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from orchestrate import Structure
from orchestrate.cli import notes

TURN = 2.0 * np.pi
BEAM = Structure.from_halves(m1=1.5, m2=1.2, f1=40.0, f2=50.0, zeta1=0.01, zeta2=0.01, e=0.5)
PRESSED = BEAM.replace(clearance=-2e-5)


def said(ask, caplog):
    """What is warned of and noted."""
    with warnings.catch_warnings(record=True) as caught, caplog.at_level(logging.WARNING):
        warnings.simplefilter("always")
        list(ask() or ())
    words = [str(one.message) for one in caught] + [one.getMessage() for one in caplog.records]
    return " ".join(words)


def frequency_notes(hertz, **options):
    arguments = SimpleNamespace(structure="mine", set=[], **options)
    return lambda: notes.print_frequency_notes(arguments, BEAM, {"frequency": TURN * hertz})


@pytest.mark.parametrize(
    ("ratio", "far"), [(24.9, False), (25.1, True), (1 / 24.9, False), (1 / 25.1, True)]
)
def test_frequencies_far_from_the_structures(caplog, ratio, far):
    assert ("are far from it" in said(frequency_notes(ratio * 40.0), caplog)) == far


@pytest.mark.parametrize(
    ("radians", "asked"), [(40 / 1.09, True), (40 / 1.11, False), (50 / 0.91, True), (56.0, False)]
)
def test_radians_that_would_fit_as_hertz(caplog, radians, asked):
    """Within a tenth of one of the structure's own frequencies in the other unit."""
    told = said(frequency_notes(radians / TURN, frequency=f"{radians:g}"), caplog)
    assert ("own frequencies are 40 and 50 Hz; is --hz meant?" in told) == asked


@pytest.mark.parametrize(("times", "doubted"), [(199.0, False), (201.0, True)])
def test_a_clearance_that_is_hardly_meant(caplog, times, doubted):
    given = {"frequency": np.array([TURN * 20.0]), "level": np.array([1.0])}
    given["level"] = notes.threshold_over_level(PRESSED, given) / times
    told = said(lambda: notes.clearance_notes(PRESSED, given, xr.Dataset()), caplog)
    assert (f"{times:.3g} times what this level moves" in told) == doubted


@pytest.mark.parametrize(("mass", "heavy"), [(19.9, False), (20.1, True)])
def test_a_heavy_half_of_a_beam(mass, heavy):
    assert bool(notes.heavy_mass_note(BEAM.replace(m2=mass))) == heavy
