"""Short forms of the campaigns on bits, faults, malicious input, leaks and mutants; slow ones."""

from __future__ import annotations

import itertools
import random
import shutil
import sys

import pytest

from orchestrate.access import OSCILLATOR, find
from tools.trust import bits, forged_results, mutants, parameter_sets
from tools.trust.bits import BitCampaign
from tools.trust.clusters import ClusterCampaign
from tools.trust.faults import FaultCampaign
from tools.trust.fuzzing import FuzzCampaign
from tools.trust.hostile import HostileCampaign
from tools.trust.leaks import LeakCampaign
from tools.trust.mutants import MutantCampaign

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")


@pytest.fixture(scope="module")
def fmu(exported):
    return find(OSCILLATOR).path


def without_chromium():
    return not (shutil.which("chromium") and shutil.which("chromedriver"))


@pytest.fixture(scope="module")
def seen():
    if without_chromium():
        pytest.skip("no chromium with chromedriver here")
    with forged_results.open_browser() as window:
        yield window


def clean(found, count):
    assert found.done >= count and found.findings == 0, found.notes


def test_a_point_that_no_step_size_hits_is_left_out():
    """From its middle the nearest step size ends one number beside the target."""
    drawn = parameter_sets.draw_parameter_set(19, 69)
    _, (middle, end), *_ = drawn.grids()
    assert middle + (end - middle) != end
    grids = [bits.reachable_points(drawn.start_time, grid) for grid in drawn.grids()]
    assert [grid[-1] for grid in grids] == [end] * len(grids)
    for grid in grids:
        steps = itertools.pairwise([drawn.start_time, *grid])
        assert all(time + (target - time) == target for time, target in steps)
    assert len(grids[-1]) > 12


def test_bits_of_a_few_sets(fmu):
    clean(BitCampaign().run(fmu, 5, 12), 12)


def test_another_bit_would_be_seen(fmu, monkeypatch):
    drawn = parameter_sets.draw_parameter_set(1, 4)
    grid = list(drawn.grids())[0]
    other = parameter_sets.ParameterSet(
        drawn.kind, {**drawn.values, "x2_start": drawn.values["x2_start"] + 1e-15}, 0.0, 1.0
    )
    assert bits.simulate_by_fmu(fmu, drawn, grid) != bits.simulate_by_fmu(fmu, other, grid)
    monkeypatch.setattr(
        bits, "simulate_by_web", lambda *_: ("0x0p+0",) * len((*bits.STATE, *bits.STEP))
    )
    assert any(line.startswith("wasm") for line in bits.bit_differences(drawn, False))


@pytest.mark.skipif(without_chromium(), reason="no chromium with chromedriver here")
def test_a_few_malicious_inputs(fmu):
    clean(HostileCampaign().run(fmu, 1, 4), 4)


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("<script>window.explorer = {}</script>", ""),
        ("<script>window.explorer = {}; window.canary = 1</script>", "a script of the file ran"),
        ("<script>window.explorer = {}; alert(1)</script>", "the browser: unexpected alert"),
        ("<script>window.explorer = {}</script><img src=ADDRESS>", "the page asked /canary"),
    ],
)
def test_a_script_that_ran_would_be_seen(seen, tmp_path, body, expected):
    page = tmp_path / "page.html"
    page.write_text(f"<!doctype html>{body}".replace("ADDRESS", seen.address))
    verdict = seen.check_page(page)
    assert verdict.startswith(expected) and bool(verdict) == bool(expected)


def test_memory_stays_flat(fmu, monkeypatch):
    monkeypatch.setattr("tools.trust.leaks.peak_memory", lambda _, number: 400 * number)
    found = LeakCampaign().run(fmu, 1, 100_000)
    clean(found, 100_000)
    assert found.worst == 400.0


def test_a_short_run_finds_no_leak_where_there_is_none(fmu):
    """What a process takes once was shared out among ten frequencies."""
    clean(LeakCampaign().run(fmu, 1, 10_000), 10_000)


def test_a_few_faults(fmu, monkeypatch):
    monkeypatch.setattr(FaultCampaign, "commands", ("sweep",))
    clean(FaultCampaign().run(fmu, 1, 3), 3)


def test_a_mutant_is_another_program():
    source = "def f(x):\n    return x + 1.5 if x < 2 else -x\n"
    found = {mutants.make_mutant(source, random.Random(seed))[0] for seed in range(60)}
    assert source not in found and len(found) == 5
    assert "def f(x):\n    return x - 1.5 if x < 2 else -x" in found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("campaign", "count"),
    [
        (BitCampaign(), 150),
        (HostileCampaign(), 60),
        (FaultCampaign(), 48),
        (ClusterCampaign(), 6),
        (FuzzCampaign(), 200_000),
    ]
    + [(LeakCampaign(), 2_000_000), (MutantCampaign(), 2)],
    ids=lambda value: getattr(value, "name", ""),
)
def test_middle_forms(fmu, campaign, count):
    found = campaign.run(fmu, 2, count)
    assert found.done >= count
    if campaign.name != "mutants":  # some survive, and are explained in the ledger
        assert found.findings == 0, found.notes
