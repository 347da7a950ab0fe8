"""A response followed to its largest gap."""

from __future__ import annotations

import pytest

from orchestrate.access import OSCILLATOR, Instance, find
from orchestrate.response.relative_resonance import follow_to_peak
from orchestrate.response.sweep import sweep
from orchestrate.structures import Structure


@pytest.mark.usefixtures("exported")
def test_a_response_is_followed_to_its_peak():
    structure = Structure.nondimensional(D=0.05)
    start = sweep(structure, eta=1.9, transient=300, samples=1).end_state.values[0]
    with Instance(find(OSCILLATOR).path) as instance:
        peak = follow_to_peak(instance, structure, 1.9, start, 1)
        none = follow_to_peak(instance, structure, 1.9, start, 2, reach=0.005)
    assert peak.eta == pytest.approx(2.054, abs=0.0015)
    here, above = sweep(structure, eta=[peak.eta, peak.eta + 0.02], start=peak.state).xi_rel_max
    assert here > above
    assert none.eta == 1.9
