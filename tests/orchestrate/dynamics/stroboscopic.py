"""The FMU's own stroboscopic map, and its derivative by differences: no equation of ours."""

import numpy as np

from orchestrate.fmu import OSCILLATOR, STATE, EventInstance, find_or_export, start_motion


def after(instance, point, start, periods=1):
    """State some periods after a start, in an instance that is there."""
    start_motion(instance, *point, start)
    instance.step(0.0, periods * point.excitation.period)
    return np.array(instance.get(*STATE))


def flown(structure, excitation, states, periods=1):
    """States of the FMU some periods after states at phase 0."""
    ends = []
    with EventInstance(find_or_export(OSCILLATOR).path) as instance:
        for state in np.atleast_2d(states):
            start_motion(instance, structure, excitation, state)
            instance.record_impacts(0.0, periods * excitation.period)
            ends.append(instance.read("x1", "x2", "v1", "v2").copy())
    return np.array(ends)


def assert_multipliers(found, structure, excitation, periods=1, within=1e-5):
    """An orbit's multipliers are eigenvalues of the map's derivative there."""
    omega, state = structure.omega, found.state.values[0]
    scale = np.array([1.0, 1.0, omega, omega])
    scale *= excitation.amplitude or excitation.length(structure)
    moving = slice(0, 4, 2 if structure.wall else 1)
    steps = 1e-6 * np.diag(scale)[moving]
    ends = [flown(structure, excitation, state + sign * steps, periods) for sign in (1.0, -1.0)]
    columns = (ends[0] - ends[1])[:, moving]
    seen = np.append(
        np.linalg.eigvals(columns.T / scale[moving, None] / 2e-6), [0.0] * structure.wall
    )
    for multiplier in found.multipliers.values @ [1.0, 1.0j]:
        assert np.abs(seen - multiplier).min() < within * max(1.0, np.abs(seen).max())
