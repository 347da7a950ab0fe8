"""FMPy's own simulation loop on the native FMUs: with and without event mode."""

import fmpy
import numpy as np

from ..fmu.programs.driver import harmonic

CHAOS = harmonic(1.13)
NAMES = ["x1", "x2", "v1", "v2", "impact_count", "impact_time"]


def simulate(path, **options):
    arguments = {
        "stop_time": 128.0,
        "output_interval": 0.25,
        "start_values": CHAOS,
        "output": NAMES,
        **options,
    }
    return fmpy.simulate_fmu(str(path), fmi_type="CoSimulation", **arguments)


def same(found, expected):
    """FMPy comes back to its grid by subtracting and adding times: the last bit of a time may
    differ, and the state's with it.
    """
    for name in NAMES:
        np.testing.assert_allclose(found[name], expected[name], rtol=0.0, atol=1e-11)
    assert np.array_equal(found["impact_count"], expected["impact_count"])
    assert np.array_equal(found["impact_time"], expected["impact_time"])


def test_simulation_is_the_same_with_and_without_event_mode(fmus):
    reference = simulate(fmus["fmi2"])
    assert reference["impact_count"][-1] > 20
    plain = simulate(fmus["fmi3"])
    assert all(np.array_equal(plain[name], reference[name]) for name in NAMES)
    # two rows at each event: before and after it
    ticking = simulate(fmus["fmi3"], use_event_mode=True)
    assert len(ticking) > len(plain)
    assert set(ticking["time"]) == set(plain["time"])
    _, last = np.unique(ticking["time"][::-1], return_index=True)
    same(ticking[::-1][last], reference)
    early = simulate(fmus["fmi3"], use_event_mode=True, early_return_allowed=True)
    place = [int(np.argmin(np.abs(early["time"] - time))) for time in reference["time"]]
    assert np.abs(early["time"][place] - reference["time"]).max() < 1e-12
    off = np.abs(early["time"][place] - reference["time"]) > 0
    assert off.sum() < 50
    same(early[place], reference)
    assert set(reference["impact_time"][1:]) - {0.0} <= set(early["time"])
