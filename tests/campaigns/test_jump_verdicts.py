"""The campaign on verdicts: its drives, what it takes for wrong, and a short form of it."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
import xarray as xr

from orchestrate.errors import VibroimpactError
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.couple import schedule_from_arguments
from tools import draws
from tools.draws import RATES

from . import held_speeds
from . import jump_verdicts as verdicts
from .findings import expect_none
from .jump_verdicts import (
    FOLD,
    NONE,
    TORUS,
    UNKNOWN,
    Answer,
    Truth,
    error_in_answer,
)

LOST = Answer("lost", 1.5, 1.5001, True)
SEEN = Answer("lost", 1.52, 1.52, False)
NOTHING = Answer("none", np.nan, np.nan, True)
OPEN = Answer("undecided", np.nan, np.nan, True)


def test_drives_with_folds_and_near_their_edge():
    rng = np.random.default_rng(1)
    for _ in range(5):
        system = draws.draw_with_folds(rng)
        assert averaged.folds(*system) and averaged.smallest_slope(*system) < 0.0
        edge = draws.scale_to_slope(system, 0.05)
        assert not averaged.folds(*edge)
        assert averaged.smallest_slope(*edge) == pytest.approx(0.05, abs=1e-6)
        assert edge.drive.b(edge.structure) == pytest.approx(system.drive.b(system.structure))


@pytest.mark.parametrize(
    ("answer", "known", "wrong"),
    [
        (LOST, Truth(FOLD, 1.50005, 1.50005), False),
        (LOST, Truth(FOLD, 1.5008, 1.5008), True),
        (LOST, Truth(FOLD, 1.499, 1.499), True),
        (LOST, Truth(TORUS, 1.49, 1.52), False),
        (LOST, Truth(NONE), True),
        (LOST, Truth(UNKNOWN), False),
        (SEEN, Truth(FOLD, 1.5, 1.5), False),
        (SEEN, Truth(FOLD, 1.53, 1.53), True),
        (NOTHING, Truth(FOLD, 1.5, 1.5), True),
        (NOTHING, Truth(NONE), False),
        (OPEN, Truth(FOLD, 1.5, 1.5), False),
    ],
)
def test_what_is_wrong(answer, known, wrong):
    """On the way up: the jump of a ramp is late."""
    assert bool(error_in_answer(answer, known, "up")) is wrong


def test_of_two_jumps_each_has_to_be_told():
    """The one that is not told is a finding; one that no branch knows is held by itself."""
    first = Answer("lost", 1.2276, 1.2277, True)
    both = first._replace(further=(LOST,))
    two = Truth(FOLD, 1.50005, 1.50005, (1.22765,))
    assert not error_in_answer(both, two, "up") and not verdicts.answers_without_truth(
        both, two, "up"
    )
    assert "in truth at 1.22765" in error_in_answer(LOST, two, "up")
    assert "in truth at 1.50005" in error_in_answer(first, two, "up")
    open_one = first._replace(further=(Answer("undecided", 1.5, 1.5001, True),))
    assert not error_in_answer(open_one, two, "up")
    assert verdicts.answers_without_truth(both, Truth(FOLD, 1.22765, 1.22765), "up") == [LOST]
    assert error_in_answer(NOTHING._replace(further=(LOST,)), Truth(NONE), "up")


def test_the_jump_of_a_ramp_down_is_late_downward():
    assert not error_in_answer(SEEN, Truth(FOLD, 1.53, 1.53), "down")
    assert error_in_answer(SEEN, Truth(FOLD, 1.5, 1.5), "down")


def test_answers_that_change_with_the_rate_are_findings(monkeypatch):
    said = iter([(LOST, NOTHING), (OPEN, NOTHING), (NOTHING, NOTHING), (LOST, NOTHING)])
    monkeypatch.setattr(verdicts, "run_couple", lambda *_: next(said))
    monkeypatch.setattr(verdicts, "contradiction", lambda *_: "")
    system = draws.draw_with_folds(np.random.default_rng(1))
    found = list(
        verdicts.check_answers(system, "delaminated", dict.fromkeys(verdicts.WAYS, Truth(UNKNOWN)))
    )
    problems = [problem for _, problem in found if problem]
    assert problems == ["delaminated, up: lost at some rates, none at others"]
    assert [name for name, _ in found].count("undecided") == 1


def branch(stable, end):
    """A branch up to a fold at 1.2 V, at 1.3 rad/s; stable or not; another one folds beside it."""
    count = len(stable)
    legs = {
        "voltage": np.linspace(1.0, 1.2, count),
        "speed": np.linspace(1.0, 1.3, count),
        "stable": np.array(stable),
        "revolutions": np.ones(count),
    }
    return xr.Dataset(
        {name: (("leg", "point"), values[np.newaxis]) for name, values in legs.items()}
        | {
            "end": ("leg", [end]),
            "bifurcation_structure": ("bifurcation", ["bonded"] * 2),
            "bifurcation_kind": ("bifurcation", ["fold"] * 2),
            "bifurcation_voltage": ("bifurcation", [1.195, 1.2]),
            "bifurcation_speed": ("bifurcation", [1.295, 1.3]),
            "bifurcation_revolutions": ("bifurcation", [2.0, 1.0]),
        },
        {"leg": ["from below"]},
    )


def test_where_a_branch_loses_its_motion():
    found = verdicts.first_loss_on_leg(
        branch([True] * 20 + [False], "limit"), "bonded", "up", (1.0, 1.0)
    )
    assert found == Truth(FOLD, 1.2, 1.2)
    whole = branch([True] * 20, "limit")
    assert verdicts.first_loss_on_leg(whole, "bonded", "up", (1.0, 1.0)).kind == NONE
    assert (
        verdicts.first_loss_on_leg(branch([True] * 20, "stuck"), "bonded", "up", (1.0, 1.0)).kind
        == UNKNOWN
    )
    other = whole.assign(stable=~whole.stable)
    assert verdicts.first_loss_on_leg(other, "bonded", "up", (1.0, 1.0)).kind == UNKNOWN


SYSTEM = draws.draw_with_folds(np.random.default_rng(1)).of_kind("delaminated")
FIRST_FOLD, LAST_FOLD = 1.30, 1.28


class Motions:
    """Speeds at held voltages, with a memory: lost at one voltage up, at another one down.

    Speeds rise with the voltage; ``gap`` lies between those of both motions. One more fold, of a
    motion that goes on with nearly the same speed, is met on the way up at 1.25. ``thrown``: how
    much earlier a ramp at the usual rate loses the motion.
    """

    def __init__(self, monkeypatch, gap=0.05, up=FIRST_FOLD, down=LAST_FOLD, thrown=0.0):
        self.gap, self.up, self.down, self.courses = gap, up, down, []
        self.thrown = thrown
        monkeypatch.setattr(verdicts, "held_speeds", self.held)

    def held(self, _system, first, voltages, part=1.0, rate=held_speeds.RATE):
        self.courses.append(list(voltages))
        up = self.up - self.thrown * (rate >= held_speeds.RATE)
        beyond, speeds = first > self.up, []
        for voltage in voltages:
            beyond = voltage > up or (beyond and voltage > self.down)
            small = 0.003 if voltage > 1.25 else 0.0
            speeds.append(0.9 * voltage + small + self.gap * beyond)
        return np.array(speeds)


def branch_with_folds(folds, kind="delaminated"):
    """A delaminated branch whose voltage rises and falls: each fold is a voltage and a speed."""
    voltage, speed = np.array(folds).T
    volts, omega = SYSTEM.drive.volts(SYSTEM.structure), SYSTEM.structure.omega
    highest = np.arange(len(folds)) % 2 == 0
    beside = np.where(highest, -1e-3, 1e-3)
    points = np.stack([voltage + beside, voltage, voltage + 2.0 * beside], 1).ravel()
    speeds = np.stack([speed - 1e-4, speed, speed + 1e-4], 1).ravel()
    along = ("structure", "leg", "point")
    bifurcation = {
        "structure": [kind] * len(folds),
        "kind": ["fold"] * len(folds),
        "voltage": voltage * volts,
        "speed": speed * omega,
        "revolutions": np.ones(len(folds)),
    }
    return xr.Dataset(
        {
            "voltage": (along, points[None, None] * volts),
            "speed": (along, speeds[None, None] * omega),
        }
        | {f"bifurcation_{name}": ("bifurcation", each) for name, each in bifurcation.items()},
        {"structure": ["delaminated"], "leg": ["from below"]},
    )


FOLDS = [(1.25, 1.125), (1.26, 1.0), (FIRST_FOLD, 1.173), (LAST_FOLD, 1.205), (1.33, 0.9)]


def test_a_fold_counts_where_held_voltages_meet_it_and_the_speed_jumps(monkeypatch):
    """Not one where the motion goes on with nearly the same speed, nor one of another branch."""
    Motions(monkeypatch)
    data = branch_with_folds(FOLDS)
    assert verdicts.fold_that_is_met(SYSTEM, data, "up").low == pytest.approx(FIRST_FOLD)
    assert verdicts.fold_that_is_met(SYSTEM, data, "down").low == pytest.approx(LAST_FOLD)
    beside = branch_with_folds([(1.25, 1.125), (1.26, 1.0), (1.33, 0.9)])
    assert verdicts.fold_that_is_met(SYSTEM, beside, "up").kind == UNKNOWN
    for others in (
        [(FIRST_FOLD, 0.9)],
        [(1.1, 1.0), (FIRST_FOLD, 1.173)],
    ):  # speed; end of a way down
        data = branch_with_folds(others)
        assert verdicts.fold_that_is_met(SYSTEM, data, "up").kind == UNKNOWN
    bonded = branch_with_folds(FOLDS, "bonded")
    assert verdicts.fold_that_is_met(SYSTEM, bonded, "up").kind == UNKNOWN


def test_a_motion_that_a_ramp_throws_away_is_held_again_on_a_slow_one(monkeypatch):
    Motions(monkeypatch, down=1.2, thrown=0.02)
    right = verdicts.Answer("lost", FIRST_FOLD - 5e-5, FIRST_FOLD + 5e-5, True)
    assert verdicts.bracket_problem(SYSTEM, right, "up", held_speeds.RATE)
    assert not verdicts.bracket_contradiction(SYSTEM, right, "up")
    late = verdicts.Answer("lost", FIRST_FOLD + 3e-3, FIRST_FOLD + 3.1e-3, True)
    assert verdicts.bracket_contradiction(SYSTEM, late, "up")


@pytest.mark.parametrize(("way", "place"), [("up", FIRST_FOLD), ("down", LAST_FOLD)])
@pytest.mark.parametrize("off", [0.0, 3e-3, -3e-3])
def test_a_bracket_is_refuted_where_nothing_is_lost(monkeypatch, way, place, off):
    motions = Motions(monkeypatch)
    bracket = Answer("lost", place + off - 3e-5, place + off + 3e-5, True)
    assert ("past it, held" in verdicts.contradiction(SYSTEM, bracket, way)) is (off != 0.0)
    _, far, stays, past, back = motions.courses[0]
    assert stays == back and min(far, past) < stays < max(far, past)
    Motions(monkeypatch, up=place, down=place)
    assert "comes back" in verdicts.contradiction(SYSTEM, bracket, way) or off != 0.0


@pytest.mark.parametrize(("before", "is_refuted"), [(0.9, False), (1.1, True)])
def test_a_bracket_may_lie_before_the_end_by_the_tolerance(monkeypatch, before, is_refuted):
    """An irregular motion may be lost somewhat later when it is held by itself."""
    Motions(monkeypatch)
    high = FIRST_FOLD - before * verdicts.TOLERANCE
    bracket = Answer("lost", high - 6e-5, high, True)
    assert bool(verdicts.contradiction(SYSTEM, bracket, "up")) is is_refuted


def speeds_held(monkeypatch, *speeds):
    """Give the judge these speeds: 4e-3 and 2e-3 before a bracket, at it, past it, and back."""
    monkeypatch.setattr(verdicts, "held_speeds", lambda *_, **__: np.array(speeds))
    bracket = Answer("lost", 1.25, 1.25006, True)
    return verdicts.contradiction(SYSTEM, bracket, "up")


def test_a_bracket_on_a_steep_branch_is_refuted(monkeypatch):
    """The branch alone changed by more there than two motions of the same speed: it was passed."""
    assert "goes on" in speeds_held(monkeypatch, 1.0, 1.004, 1.0085, 1.0088, 1.0085)
    assert not speeds_held(monkeypatch, 1.0, 1.004, 1.0085, 1.03, 1.029)


def test_a_motion_that_ends_against_the_way_is_lost_whatever_speed_was_before(monkeypatch):
    """Past its end the speed is that of a third motion, by chance the one of far before."""
    assert not speeds_held(monkeypatch, 1.142, 1.1437, 1.1799, 1.1402, 1.1401)


@pytest.mark.parametrize(
    ("place", "held", "is_told"),
    [(1.25, True, True), (1.2502, True, True), (1.26, True, False), (1.26, False, True)]
    + [(1.24, False, False)],
)
def test_an_answer_on_a_fold_that_is_left_against_the_way(place, held, is_told):
    """A held course came to a motion less far along there; ramps fell to the one beyond."""
    known = Truth(FOLD, 1.3, 1.3, against=(1.25,))
    answer = Answer("lost", place, place, held)
    assert verdicts.is_left_against_the_way(answer, known, "up") is is_told
    assert not verdicts.is_left_against_the_way(answer, Truth(FOLD, 1.3, 1.3), "up")


@pytest.mark.parametrize("problem", ["", "the speed goes on"])
def test_an_answer_against_the_way_is_counted_apart_and_held_by_itself(monkeypatch, problem):
    """It is right if courses beside it do not speak against it, else a finding."""
    left = Answer("lost", 1.25, 1.25006, True)
    monkeypatch.setattr(verdicts, "run_couple", lambda *_: (left, NOTHING))
    monkeypatch.setattr(verdicts, "contradiction", lambda *_: problem)
    known = {"up": Truth(FOLD, 1.3, 1.3, against=(1.25,)), "down": Truth(NONE)}
    up, down = verdicts.check_answers(SYSTEM, "delaminated", known, rates=[2e-4])
    text = f"delaminated, up, rate 0.0002: {problem}" if problem else ""
    assert up == ("lost against the way", text)
    assert down == ("none by held voltages", "")


def test_a_fold_past_which_the_speed_falls_back_is_kept_apart(monkeypatch):
    def fallen(_system, _first, voltages, *_, **__):
        return np.array([1.1 + 0.01 * (v <= 1.25) + 0.2 * (v > 1.3) for v in voltages])

    monkeypatch.setattr(verdicts, "held_speeds", fallen)
    folds = branch_with_folds([(1.25, 1.11), (1.2, 1.0), (1.3, 1.1)])
    known = verdicts.fold_that_is_met(SYSTEM, folds, "up")
    assert known.low == pytest.approx(1.3) and known.against == (pytest.approx(1.25),)


@pytest.mark.parametrize(("first", "second"), [(0.9, 1.0), (1.6, 1.7), (1.7, 1.6)])
def test_a_held_course_begins_as_a_ramp_does(first, second):
    """From its no-load speed, a course to 1.57 came to another motion than ramps."""
    structure, drive = SYSTEM
    volts = drive.volts(structure)
    ramp = schedule_from_arguments(structure, drive, (first * volts, second * volts))
    times, voltages = held_speeds.begin_course(SYSTEM, first, second)
    assert (ramp.spin_up > 0.0) is (second > first > 1.5)
    for time in np.linspace(0.0, times[-1], 7):
        expected = ramp.voltage(time / structure.omega) / volts
        assert np.interp(time, times, voltages) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("way", verdicts.WAYS)
def test_none_is_refuted_by_two_motions_and_a_jump_of_the_record_by_their_lack(monkeypatch, way):
    low, high = draws.ramp_ends(SYSTEM)
    middle = 0.5 * (low + high)
    Motions(monkeypatch, up=middle + 0.01, down=middle - 0.01)
    assert "two motions last" in verdicts.contradiction(SYSTEM, NOTHING, way)
    assert not verdicts.contradiction(SYSTEM, SEEN, way) and not verdicts.contradiction(
        SYSTEM, OPEN, way
    )
    Motions(monkeypatch, gap=0.0)
    assert not verdicts.contradiction(SYSTEM, NOTHING, way)
    assert "come back" in verdicts.contradiction(SYSTEM, SEEN, way)


@pytest.mark.parametrize("way", verdicts.WAYS)
def test_motions_that_exchange_against_the_voltage_are_no_jump_through_the_resonance(
    monkeypatch, way
):
    """On the way there the speed is ahead of the one on the way back: nothing is captured."""
    low, high = draws.ramp_ends(SYSTEM)
    middle = 0.5 * (low + high)
    Motions(monkeypatch, gap=-0.05, up=middle + 0.01, down=middle - 0.01)
    assert not verdicts.contradiction(SYSTEM, NOTHING, way)
    assert "come back" in verdicts.contradiction(SYSTEM, SEEN, way)


def test_a_voltage_is_held_after_another_and_the_speed_read_at_the_end(monkeypatch):
    """It follows the voltage; the second hold is too short for how slowly it does so."""

    def record(structure, drive, voltage, **_):
        time = np.linspace(0.0, voltage.duration, 20_000)[1:]
        eta0 = np.array([voltage.voltage(each) for each in time]) / drive.volts(structure)
        slow = np.where(eta0 < 1.15, 0.0, 0.1 * np.exp(-(time - time[0]) / 2e4))
        return xr.Dataset({"time": time, "Omega": ("time", eta0 - slow)})

    monkeypatch.setattr(held_speeds, "couple", record)
    first, second, third = held_speeds.held_speeds(SYSTEM, 1.0, [1.1, 1.2, 1.1])
    assert first == pytest.approx(1.1) and third == pytest.approx(1.1) and np.isnan(second)


@pytest.mark.slow
@pytest.mark.budget(1)  # drives; of more than one each takes a minute or more
def test_jump_verdicts_of_random_drives(exported, seed, budget):
    """With folds at four rates, and with so little unbalance that folds are close or just vanish.

    A short run, of one drive, judges its bonded structure with folds at one rate.
    """
    counts, findings = Counter[str](), []
    rates, kinds = (RATES, verdicts.KINDS) if budget > 1 else (RATES[:1], ("bonded",))
    for number in range(budget):
        rng = np.random.default_rng([seed, number])
        folded = draws.draw_with_folds(rng)
        edge = draws.scale_to_slope(folded, float(rng.uniform(*verdicts.SLOPES)))
        systems = (("folds", folded, rates), ("near the edge", edge, rates[::3]))
        for name, system, some in systems[: len(kinds)]:
            try:
                for said, problem in verdicts.judge(system, some, kinds):
                    counts[said] += 1
                    findings += [f"drive {number}, {name}, {problem}"] if problem else []
            except VibroimpactError as error:
                findings.append(f"drive {number}, {name}: {error}")
    expect_none(findings, counts)
