"""Forces of anybody's drive on the halves, with a box that moves and one at rest."""

import numpy as np
import pytest
from pythonfmu import FmuBuilder

import orchestrate
from orchestrate.errors import InputError
from orchestrate.fmu import OSCILLATOR, Instance, find_or_export

from .drives import exciter

HALVES = orchestrate.Structure(m1=0.5, m2=0.4, k1=30.0, k2=42.0, d1=0.4, d2=0.5, e=0.6)
SHAKEN = {"box_acceleration": "acc", "box_velocity": "vel", "box_force": "pull"}
PUSHED = {"force1": "push", "force2": "-millinewtons[mN]"}
RATE, FORCES, DURATION = 9.0, (2.0, 1.5), 2.8  # rad/s, N: a minus turns the second one; s
CASES = {  # the box's amplitude
    "a box that moves": (HALVES, {**SHAKEN, **PUSHED}, 0.02),
    "a box at rest": (HALVES.replace(clearance=0.01), PUSHED, 0.0),
}
pytestmark = pytest.mark.usefixtures("exported")


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    folder = tmp_path_factory.mktemp("exciter")
    return FmuBuilder.build_FMU(exciter.__file__, dest=folder, project_files=[])


@pytest.mark.parametrize("case", CASES)
def test_the_motion_is_that_under_these_forces(drive, case):
    """Of third order; they are the FMU's own harmonic loads here."""
    structure, connect, amplitude = CASES[case]
    pushes = {f"force{half}_amplitude": force for half, force in enumerate(FORCES, 1)}
    box = {"box_frequency": RATE, "box_amplitude": amplitude}
    with Instance(find_or_export(OSCILLATOR).path) as instance:
        instance.initialize(**structure.parameters(), **box, **pushes)
        instance.step(0.0, DURATION)
        exact = np.array(instance.get("x1", "x2"))
        (impacts,) = instance.get("impact_count")
    errors, asked = [], {"duration": DURATION, "connect": connect, "progress": False}
    for step in (0.02, 0.01):
        found = orchestrate.cosimulate(structure, drive, step=step, **asked)
        errors.append(np.abs(exact - [found.x1[-1], found.x2[-1]]).max())
        assert found.sizes["impact"] == impacts > 3
    assert errors[1] < 1e-5 * np.abs(found.x1).max() and errors[0] > 6.0 * errors[1]
    assert errors[1] < 3.0 * float(found.coupling_error.max()) < 1e-4
    for name, force in zip(PUSHED, FORCES, strict=True):
        expected = force * np.sin(RATE * found.time.values)
        np.testing.assert_allclose(found[name].values, expected, atol=1e-3)


WRONG = {
    "no name of ours": ({**SHAKEN, "force3": "push"}, HALVES),
    "box_force is missing": ({"box_acceleration": "acc", "force1": "push"}, HALVES),
    "a motion of the box is missing": ({"box_force": "pull", "force1": "push"}, HALVES),
    "causality": ({**SHAKEN, "force1": "pull"}, HALVES),
    "no structure that it acts on": ({"box_acceleration": "acc", "force2": "push"}, None),
}


@pytest.mark.parametrize("words", WRONG)
def test_what_cannot_push_is_refused_in_one_line(drive, words):
    connect, structure = WRONG[words]
    with pytest.raises(InputError, match=words) as error:
        orchestrate.cosimulate(structure, drive, connect=connect, duration=0.1, step=0.01)
    assert "\n" not in str(error.value)
