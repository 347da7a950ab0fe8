"""The level at which a pressed structure opens and an open one touches: against the FMU, and in the
resonance curves.
"""

import numpy as np
import pytest

import orchestrate
from orchestrate import Structure
from orchestrate.fmu import OSCILLATOR, Instance, find_or_export, start_motion
from orchestrate.model import Excitation

from ...sparing import ordinary

BISECTIONS = 60


def structure_and_frequency(seed):
    rng = np.random.default_rng((27, 5, seed))
    masses = {name: rng.uniform(0.3, 3.0) for name in ("m1", "m2", "k1", "k2")}
    dampers = {name: 10.0 ** rng.uniform(-3.0, 0.0) for name in ("d1", "d2")}
    clearance = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-6.0, 1.0)
    return Structure(**masses, **dampers, clearance=clearance), float(rng.uniform(0.2, 3.0))


def linear_state(structure, frequency):
    """Steady linear response per metre of the box's amplitude at phase 0, from the equations of
    motion: x1, x2, v1, v2; the masses as one where a preload presses them together.
    """
    w, s = frequency, structure

    def response(m, k, d):
        return w * w / (k / m - w * w + 1j * w * d / m)

    if s.clearance < 0.0:
        both = response(s.m1 + s.m2, s.k1 + s.k2, s.d1 + s.d2)
        pair = np.array([both, both])
    else:
        pair = np.array([response(s.m1, s.k1, s.d1), response(s.m2, s.k2, s.d2)])
    return np.concatenate([pair.imag, w * pair.real])  # of the imaginary part of e^{i w t}


def bisected(instance, structure, frequency):
    """Amplitude of the box between which and a part in 2^60 more the FMU's masses begin to part
    or to impact, from the linear response on.
    """
    at_one = linear_state(structure, frequency)
    at_rest = np.array([*structure.at_rest, 0.0, 0.0])
    period = 2.0 * np.pi / frequency

    def leaves(amplitude):
        state = at_rest + amplitude * at_one
        if state[1] - state[0] + structure.clearance < 0.0 < structure.clearance:
            return True
        excitation = Excitation(frequency=frequency, amplitude=amplitude)
        start_motion(instance, structure, excitation, state)
        if structure.clearance < 0.0 and not instance.get("in_contact")[0]:
            return True
        instance.step(0.0, 1.01 * period)
        count, contact = instance.get("impact_count", "in_contact")
        return bool(count) or (structure.clearance < 0.0 and not contact)

    low, high = 0.0, abs(structure.clearance)
    while not leaves(high):
        low, high = high, 2.0 * high
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if leaves(middle) else (middle, high)
    return 0.5 * (low + high)


@pytest.mark.parametrize("seed", ordinary(range(50), 6))
def test_the_fmu_opens_and_touches_at_the_threshold(exported, seed):
    structure, frequency = structure_and_frequency(seed)
    level = orchestrate.contact_threshold(structure, frequency=frequency)
    with Instance(find_or_export(OSCILLATOR).path) as instance:
        found = bisected(instance, structure, frequency)
    assert found == pytest.approx(float(level.threshold_amplitude[0]), rel=1e-9)
    assert level.event == ("opens" if structure.clearance < 0.0 else "touches")


def test_forms_and_limits():
    pressed = Structure(clearance=-0.25)
    by_eta = orchestrate.contact_threshold(pressed, eta=[0.5, 1.0])
    by_frequency = orchestrate.contact_threshold(pressed, frequency=[0.5, 1.0])
    assert np.array_equal(by_eta.threshold_amplitude, by_frequency.threshold_amplitude)
    squares = by_eta.frequency.values**2
    assert np.allclose(by_eta.threshold_acceleration, by_eta.threshold_amplitude * squares)
    assert orchestrate.contact_threshold(Structure(), eta=1.0).threshold_amplitude[0] == 0.0
    alike = Structure(k2=1.0, clearance=-0.25)
    assert orchestrate.contact_threshold(alike, eta=1.0).threshold_amplitude[0] == np.inf


def test_resonance_opens_where_the_level_is_above_the_threshold():
    """A preload that the box's level exceeds around the resonance alone."""
    pressed = Structure(d1=0.1, d2=0.15, clearance=-0.15)
    frequency = np.linspace(0.6, 1.6, 21)
    asked = {"frequency": frequency, "amplitude": 0.4 / frequency**2, "direction": "up"}
    data = orchestrate.resonance(pressed, **asked, transient=200, samples=10)
    level = orchestrate.contact_threshold(pressed, frequency=frequency)
    assert np.array_equal(data.threshold_amplitude, level.threshold_amplitude)
    opened = data.x_rel_max.sel(structure="delaminated").squeeze().values > 0.0
    above = data.amplitude.values > data.threshold_amplitude.values
    assert 0 < above.sum() < len(above) and np.array_equal(opened, above)


def fine_scan(structure, low, high):
    """Lowest acceleration on a grid that is dense around each natural frequency."""
    s = structure
    natural = np.sqrt([s.k1 / s.m1, s.k2 / s.m2, (s.k1 + s.k2) / (s.m1 + s.m2)])
    near = np.concatenate([[-1.0], -np.geomspace(1.0, 1e-9, 1000), np.geomspace(1e-9, 1.0, 1000)])
    points = np.concatenate([np.linspace(low, high, 5000), *(w * (1.0 + near) for w in natural)])
    points = np.unique(points[(points >= low) & (points <= high)])
    level = orchestrate.contact_threshold(structure, frequency=points).threshold_acceleration
    return float(level.min()), float(points[level.values.argmin()])


@pytest.mark.parametrize("seed", range(3))
def test_the_lowest_threshold_is_that_of_the_curve_not_of_the_grid(seed):
    """Asked for at its two ends alone, with a damping ratio of 1e-6 or a good part of 1."""
    structure, _ = structure_and_frequency(seed)
    damping = 10.0 ** np.random.default_rng(seed).uniform(-6.0, -0.5)
    structure = structure.replace(zeta1=damping, zeta2=0.7 * damping)
    low, high = 0.11, 7.3
    found = orchestrate.contact_threshold(structure, frequency=[low, high])
    level, place = float(found.lowest_threshold), float(found.lowest_threshold_frequency)
    scanned, near = fine_scan(structure, low, high)
    assert level <= scanned * (1.0 + 1e-12)
    assert level == pytest.approx(scanned, rel=1e-2)  # the scan misses the bottom by a little
    assert place == pytest.approx(near, rel=1e-3)
    there = orchestrate.contact_threshold(structure, frequency=place)
    assert float(there.threshold_acceleration[0]) == pytest.approx(level, rel=1e-12)
    assert low < place < high and level < 0.9 * float(found.threshold_acceleration.min())
