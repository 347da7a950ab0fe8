"""Adversarial parameter sets finish, with the same bits on every communication grid."""

from __future__ import annotations

import dataclasses
import sys

import pytest

from fmu_src.kernels.oscillator import memory as at
from tools.trust.parameter_sets import KINDS, draw_parameter_set

from . import grids

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="a library for Linux")


@pytest.fixture(scope="module")
def entries(python_fmu, tmp_path_factory):
    return grids.entry_points(python_fmu, tmp_path_factory.mktemp("kernel"))


def complaints(entries, seed, first, stop):
    """Of sets by number, by those that have one."""
    found = {}
    for number in range(first, stop):
        chosen = draw_parameter_set(seed, number)
        runs = [grids.run(entries, chosen, points) for points in chosen.grids()]
        if text := grids.complaint(runs):
            found[number, chosen.kind] = text
    return found


def test_sets_finish_with_the_same_bits_on_every_grid(entries):
    assert complaints(entries, 1, 0, 25 * len(KINDS)) == {}


# of seed 1: each did not finish on all or some of its grids, or was refused on some
@pytest.mark.parametrize(
    "number", [62, 675, 732, 804, 830, 877, 902, 1130, 2077, 4897, 5725, 7373, 8873]
)
def test_sets_that_once_did_not(entries, number):
    assert complaints(entries, 1, number, number + 1) == {}


def test_a_set_whose_contacts_last_a_trillionth_of_a_radian(entries):
    assert complaints(entries, 2, 2322, 2323) == {}


@pytest.mark.slow
def test_twenty_thousand_sets(entries):
    assert complaints(entries, 2, 0, 20_000) == {}


def test_what_is_wrong_is_said(entries):
    chosen = draw_parameter_set(1, 7)
    whole, *others = [grids.run(entries, chosen, points) for points in chosen.grids()]
    assert grids.complaint([whole, *others]) == ""
    changed = {
        "other bits": {"point": whole.point[::-1]},
        "few impacts": {"code": at.UNFINISHED, "impacts": 999.0},
        "on one grid": {"code": at.NOT_FINITE},
        "2 s": {"code": at.UNFINISHED, "impacts": 1e7, "seconds": 2.5},
    }
    for text, values in changed.items():
        assert text in grids.complaint([dataclasses.replace(whole, **values), *others])
    refused = dataclasses.replace(whole, code=at.NOT_FINITE, point=b"")
    assert "on the way" in grids.complaint([refused])
