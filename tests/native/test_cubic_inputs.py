"""Cubic inputs that the importer does not touch run on: over steps, early returns and event mode.

What is compared is bits: however the way is divided, the motion is that of one step.
"""

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from ..fmu.programs.driver import STATE, harmonic, open_fmu
from ..kernels.oscillator.kernel import examples

CUBIC = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
TICKS = 2.0**-12  # s: sums of dyadic steps are exact, all grids reach the same time
COEFFICIENTS = st.just(0.0) | st.floats(-0.1, 0.1)


@st.composite
def motions(draw):
    """Start values, the end, and five splits of the way there."""
    values = harmonic(draw(st.floats(0.3, 3.0)))
    values |= {name: draw(COEFFICIENTS) for name in CUBIC}
    values |= {"e": draw(st.sampled_from((0.0, 0.3, 0.7, 1.0))), "bonded": draw(st.just(False))}
    values["x2_start"] = draw(st.sampled_from((0.0, 0.4)))
    ticks = draw(st.integers(2**13, 2**16))
    splits = [
        sorted({*draw(st.lists(st.integers(1, ticks - 1), max_size=12)), ticks}) for _ in range(5)
    ]
    return values, [[tick * TICKS for tick in split] for split in splits]


def run(f, values, grid):
    """Outputs at the grid's end; in event mode with all that an importer does there."""
    f.reset().start(**values)
    for point in grid:
        if not f.third:
            f.step(point)
        while f.time < point:
            if f.go(point)[0] and f.event_mode:
                f.handle()
    return f.get(*STATE, *CUBIC)


@pytest.fixture
def ways(fmus):
    """A plain instance of FMI 3.0; others of FMI 2.0, with event mode, and with early return."""
    events = {"event_mode": True}
    second, plain = (open_fmu(fmus[version]) for version in ("fmi2", "fmi3"))
    others = events, {**events, "early_return": True}
    return plain, second, *(open_fmu(fmus["fmi3"], **options) for options in others)


@examples(150)
@given(motion=motions())
def test_five_splits_event_mode_and_early_return_are_one_step(ways, motion):
    values, splits = motion
    end = [splits[0][-1]]
    expected = run(ways[0], values, end)
    assume(ways[0].get("impact_count")[0] < 10_000)  # at e = 1 there may be 1e5, each an event
    for way in ways:
        for grid in (end, *splits):
            assert run(way, values, grid) == expected
