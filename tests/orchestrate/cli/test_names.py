"""Files' names: readable, and never shared by two questions."""

from __future__ import annotations

import pytest
import xarray as xr
from orchestrate.cli.question import format_ranges

from orchestrate.cli.output import result_name
from orchestrate.structures import Structure

ASKED = {"eta": (0.1, 0.5, 8.0), "direction": "up", "transient": 500, "start": None}


@pytest.mark.parametrize(
    "change",
    [
        {"eta": (0.1, 0.6, 8.0)},
        {"eta": (0.1, 0.5, 8.0000001)},
        {"eta": 0.1},
        {"direction": "down"},
        {"transient": 501},
        {"start": (0.0, 0.0, 0.0, 1e-12)},
    ],
)
def test_another_question_has_another_name(change):
    assert result_name("sweep", Structure(), ASKED) != result_name(
        "sweep", Structure(), ASKED | change
    )


def test_another_structure_has_another_name():
    names = {result_name("sweep", one, ASKED) for one in (Structure(), Structure(e=0.7 + 1e-15))}
    assert len(names) == 2


def test_a_name_can_be_read():
    asked = {"frequency": (50.26548245743669, 125.66370614359172), "amplitude": 1e-3}
    name = result_name("resonance", Structure(), {**asked, "direction": "both"})
    assert name.startswith("resonance_e0.7_D0.005_8-20Hz_both_")


def test_ranges_are_told_in_the_unit_of_people():
    values = [6.283185307179586 * number for number in range(10)]
    flags = [number in (1, 2, 3, 7) for number in range(10)]
    assert format_ranges(xr.Dataset(), "frequency", values, flags) == "1 to 3, 7 Hz"
    assert (
        format_ranges(xr.Dataset(), "frequency", values, flags, max_ranges=1)
        == "1 to 3 Hz and 1 shorter ranges"
    )
