"""Responses that have no impact yet and must have some: nothing about them is decided.

Just above the level at which the linear response opens or touches, a transient reaches it late. The
state repeats meanwhile, within any tolerance, and "repeated, no impacts" was the answer.
"""

import numpy as np
import pytest

import orchestrate
from orchestrate import Structure
from orchestrate.fmu import OSCILLATOR, EventInstance, find_or_export, start_motion
from orchestrate.model import Excitation
from orchestrate.model.outcomes import UNDECIDED
from orchestrate.response.questions import Point
from orchestrate.response.response_loop import traits_of_point

pytestmark = pytest.mark.usefixtures("exported")
QUIET = {"progress": False}


def structure_with(clearance, mu, kappa, D, e):
    return Structure.nondimensional(mu=mu, kappa=kappa, D=D, e=e).replace(clearance=clearance)


# found at random, above the level by 1.3e-4 and 9e-4: the first impacts
# are after 400 and 1034 periods
OPEN = structure_with(158.5250916911655, 0.7453078198, 1.2806512774, 0.0031118812, 0.5173482384)
PRESSED = structure_with(-1.0, 1.727345805404961, 1.7254582457096772, 0.00104989248, 0.8458916725)
CASES = [(OPEN, 0.9995066730201216, None), (PRESSED, 0.9997454727152408, 1.9303019879146677)]


def place_of(structure, eta, amplitude):
    unit = Excitation.nondimensional(eta, structure)
    excitation = unit if amplitude is None else unit.replace(amplitude=amplitude)
    asked = {"frequency": excitation.frequency, "amplitude": excitation.amplitude}
    return asked, excitation


@pytest.mark.parametrize("case", CASES)
def test_without_its_impacts_nothing_is_decided(case):
    structure, (asked, excitation) = case[0], place_of(*case)
    with EventInstance(find_or_export(OSCILLATOR).path) as instance:
        start_motion(instance, structure, excitation)
        late = instance.record_impacts(0.0, 3000.0 * excitation.period).time / excitation.period
    assert len(late) and late[0] > 399.0
    swept = orchestrate.sweep(structure, **asked, transient=250, samples=60, **QUIET)
    assert float(swept.impacts_per_period.squeeze()) == 0.0
    assert int(swept.multiplicity_decided.squeeze()) == UNDECIDED
    axes = {"frequency": [asked["frequency"], 2.0], "amplitude": [excitation.amplitude, 3.0]}
    mapped = orchestrate.map(structure, **axes, transient=250, longest=0, **QUIET)
    assert int(mapped.multiplicity_decided[0, 0]) == UNDECIDED


@pytest.mark.parametrize(
    ("numbers", "frequency", "above"),
    [
        ((2.2377, 1.9017, 0.002134, 0.563394), 0.921523, 1e-7),
        ((1.682877, 0.727029, 0.001105, 0.811389), 0.657125, 1e-8),
    ],
)
def test_attractors_without_their_impacts_are_not_periodic(numbers, frequency, above):
    """States repeat to the last digits that are compared, whatever the number of periods."""
    structure = structure_with(1.0, *numbers)
    level = orchestrate.contact_threshold(structure, frequency=frequency)
    amplitude = float(level.threshold_amplitude[0]) * (1.0 + above)
    found = orchestrate.attractors(
        structure, frequency=frequency, amplitude=amplitude, starts=4, **QUIET
    )
    words = found.decided_by.attrs["flag_meanings"].split()
    codes, impacts = (found[name].values.ravel() for name in ("decided_by", "impacts_per_period"))
    said = {words[int(code)] for code in codes[impacts == 0.0]}
    assert "undecided" in said and said <= {"undecided", "irregular"}


@pytest.mark.parametrize("structure", [OPEN, PRESSED])
def test_the_level_itself_is_not_exceeded(structure):
    for frequency in np.linspace(0.3, 2.0, 40) * structure.omega:
        level = orchestrate.contact_threshold(structure, frequency=frequency)
        at = Excitation(frequency=frequency, amplitude=float(level.threshold_amplitude[0]))
        assert not traits_of_point(Point(structure, at))[-1]
        above = at.replace(amplitude=at.amplitude * (1.0 + 1e-9))
        assert traits_of_point(Point(structure, above))[-1]
