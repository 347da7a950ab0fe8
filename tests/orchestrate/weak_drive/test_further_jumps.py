"""A ramp that jumps twice: both are told, each by the record, by held voltages, or as undecided."""

import numpy as np
import pytest

from orchestrate import couple
from orchestrate.weak_drive.further_jumps import calmest_scatter, find_falls, find_further_jumps
from orchestrate.weak_drive.held import LOST, UNDECIDED, HeldVoltageTest, Verdict
from orchestrate.weak_drive.jumps import DOUBTFUL, JUMP, Passing, SweepLeg, find_passing
from orchestrate.weak_drive.losses import (
    AT_END,
    SLOTS,
    THROUGH,
    further_jump_variables,
    gather_losses,
    is_crossed,
    pick_jump,
    verdicts_from_rows,
    verdicts_to_rows,
)
from orchestrate.weak_drive.schedule import Ramp
from orchestrate.weak_drive.voltage_hold import HoldSettings
from tests.campaigns.jump_verdicts import SLOPES, WAYS, run_couple
from tools.draws import RATES, draw_with_folds, ramp_ends, scale_to_slope

from .test_held import H, Rotor, fold_of

SLOW = pytest.mark.slow
B = 0.02


def ramp(rate, first=0.03, scatter=0.0, sign=1.0):
    """A rotor on a ramp: the torque falls by ``first`` at 1.3, by 0.15 at 1.45."""
    time = np.arange(0.0, 0.5 / rate, 5.0)
    eta0, speed, torque, speeds = 1.2 + rate * time, 1.14, 0.06, []
    noise = scatter * np.random.default_rng(1).normal(size=len(time))
    for voltage, kick in zip(eta0, noise, strict=True):
        branch = 0.06 + 0.6 * (voltage - 1.2) - first * (voltage > 1.3) - 0.15 * (voltage > 1.45)
        torque += 5.0 * B * (branch - torque)
        speed += 5.0 * B * (voltage - torque - speed) + kick
        speeds.append(speed)
    return SweepLeg(time, eta0, np.array(speeds))


def places(leg, threshold=1.3):
    main = find_passing(leg, B, up=True, threshold=threshold)
    return find_further_jumps(leg, B, True, threshold, (main.before, main.after))


@pytest.mark.parametrize("rate", [2e-4, 1e-4, 2e-5])
def test_a_first_jump_is_seen_at_every_rate(rate):
    """Also where the speed hardly changes faster than the voltage."""
    leg = ramp(rate)
    (found,) = places(leg)
    assert leg.eta0[found.before] - 5e-3 < 1.3 < leg.eta0[found.after]
    assert leg.eta0[found.row] == pytest.approx(1.3, abs=3.0 * rate / B + 1e-3)


@pytest.mark.parametrize("rate", [2e-4, 1e-4, 2e-5])
def test_one_jump_has_no_further_one(rate):
    assert places(ramp(rate, first=0.0)) == []
    assert places(ramp(rate, first=0.003)) == []  # less than two motions differ by


@pytest.mark.parametrize(("first", "look"), [(0.009, DOUBTFUL), (0.012, DOUBTFUL), (0.03, JUMP)])
def test_a_record_alone_tells_no_jump_of_nearly_the_smallest_size(first, look):
    """A fast ramp does not show it at all: held voltages are asked on a slow one."""
    assert [place.look for place in places(ramp(5e-6, first))] == [look]


@pytest.mark.parametrize("start", [1.27, 1.28])
@pytest.mark.parametrize("swing", [0.0, 0.05])
def test_a_jump_at_the_begin_of_a_fast_ramp_is_seen(start, swing):
    """Where the torque swings after it, that was put down to an irregular motion."""
    rate, torque, speed, speeds = 2e-4, 0.06 + 0.6 * (start - 1.2), 0.4 * start + 0.66, []
    time = np.arange(0.0, 0.25 / rate, 5.0)
    eta0 = start + rate * time
    for voltage, since in zip(eta0, (eta0 - 1.3) / rate, strict=True):
        branch = 0.06 + 0.6 * (voltage - 1.2) - 0.03 * (voltage > 1.3)
        branch -= swing * (voltage > 1.3) * np.exp(-abs(since) / 150.0) * np.sin(0.08 * since)
        torque += 5.0 * B * (branch - torque)
        speed += 5.0 * B * (voltage - torque - speed)
        speeds.append(speed)
    (found,) = find_further_jumps(SweepLeg(time, eta0, np.array(speeds)), B, True, 1.6)
    assert eta0[found.before] - 0.02 < 1.3 < eta0[found.after]


def test_an_irregular_motion_from_the_begin_of_a_ramp_has_no_place_there():
    """What scatters after a fall just as much as it falls is no motion that settles."""
    noise = np.random.default_rng(2).normal(size=101)
    assert calmest_scatter(noise, 5) > 0.5
    assert calmest_scatter(noise * np.exp(-0.05 * np.arange(101)), 5) < 0.1


def test_what_an_irregular_motion_does_by_itself_is_no_place():
    assert places(ramp(1e-4, first=0.0, scatter=5e-3)) == []


def test_falls_are_between_rises():
    values = np.array([0.0, 3.0, 1.0, 1.5, 0.0, 2.0, 1.9, 2.5, 1.0])
    assert find_falls(values, 1.0) == [(1, 4), (7, 8)]


class TwoFolds(Rotor):
    """Two folds up, at 1.45 to a motion in the middle, and that at 1.5."""

    def revolve(self, steps):
        speeds = []
        for i in steps:
            voltage = self.schedule.voltage((i + 0.5) * H)
            self.level = max(self.level, (voltage > 1.45) + (voltage > 1.5))
            self.level *= voltage > 1.42
            target = 0.5 * voltage + 0.5 + (0.0, 0.05, 0.15)[int(self.level)]
            self.speed += 0.02 * H * (target - self.speed)
            speeds.append(self.speed)
        return {"speed": np.array(speeds)}

    level = 0.0

    def get_state(self):
        return {"speed": np.array([self.speed, self.level])}

    def set_state(self, table):
        self.speed, self.level = table["speed"].tolist()


def test_a_held_course_keeps_every_loss_that_it_crosses():
    """It told the largest change alone."""
    schedule = Ramp(1.4, 1.6, 1e-4, back=False)
    count = round(schedule.duration / H)
    begin = lambda other: TwoFolds(other, 0.0, 1.2)  # noqa: E731
    test = HeldVoltageTest(begin, schedule, H, 1.0, 1.0, 2e4, HoldSettings())
    passing = Passing(count // 2, count // 10, 3 * count // 4, DOUBTFUL, count / 2)
    course = test.classify(passing, (0, count - 1), 1.3, True)
    found = [course.verdict, *course.further]
    assert [verdict.outcome for verdict in found] == [LOST, LOST]
    for verdict, place in zip(found, (1.5, 1.45), strict=True):
        assert verdict.low - 1e-9 <= place <= verdict.high + 1e-9
        assert verdict.high - verdict.low <= 1.01e-4


TABLE = {"voltage": np.linspace(1.2, 1.6, 401), "time": np.linspace(0.0, 4000.0, 401)}
ROWS = np.arange(401)
MAIN = Passing(300, 290, 320, DOUBTFUL, 300.0)
EARLY = Passing(110, 100, 130, DOUBTFUL, 110.0)
LATE_LOSS, EARLY_LOSS = Verdict(LOST, 1.48, 1.4801), Verdict(LOST, 1.29, 1.2901)

COURSE = EARLY_LOSS, LATE_LOSS


def told(primary, look=DOUBTFUL, further=()):
    """The jump and the further ones of a ramp with the place ``EARLY`` before its passing."""
    place = EARLY._replace(look=look)
    stored = verdicts_from_rows(verdicts_to_rows(list(further)))
    losses = gather_losses(TABLE, ROWS, MAIN, primary, [place], stored)
    return pick_jump(*losses, 1.0)


@pytest.mark.parametrize(
    ("look", "further"),
    [
        (DOUBTFUL, [(0, EARLY_LOSS)]),
        (DOUBTFUL, [(THROUGH, EARLY_LOSS), (0, Verdict(0))]),
        (JUMP, []),
    ],
)
def test_the_first_sure_jump_is_the_jump(look, further):
    first, others = told(LATE_LOSS, look, further)
    assert first.passing.row == EARLY.row and first.is_sure
    assert [loss.passing for loss in others] == [MAIN]
    columns = further_jump_variables(TABLE, [others, []])
    assert columns["further_jumps"][1][0, 0] == pytest.approx(1.5)
    assert columns["further_held"][1][0, 0] == pytest.approx(1.48005)
    assert columns["further_decided"][1][0, 0] == "by held voltages"
    assert columns["further_count"][1] == [1, 0]
    assert np.isnan(columns["further_jumps"][1]).sum() == 2 * SLOTS - 1


def test_a_loss_that_the_record_does_not_show_is_where_the_ramp_reaches_it():
    losses = gather_losses(TABLE, ROWS, MAIN, LATE_LOSS, [], [(THROUGH, EARLY_LOSS)])
    first, others = pick_jump(*losses, 1.0)
    assert TABLE["voltage"][first.passing.row] == pytest.approx(1.29, abs=2e-3)
    assert [loss.passing for loss in others] == [MAIN]


@pytest.mark.parametrize(
    ("ends", "crosses"), [((1.28, 1.30), True), ((1.27, 1.28), False), ((1.5, 1.52), False)]
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_place_beyond_all_losses_of_the_course_is_none_of_them(ends, crosses, sign):
    """A place far beyond the passing was taken for the first loss: the jump was told there."""
    losses = [loss._replace(low=sign * loss.low, high=sign * loss.high) for loss in COURSE]
    assert is_crossed(losses, sign * np.array(ends), sign) is crosses
    assert not is_crossed(losses[:1], sign * np.array(ends), sign)


@pytest.mark.parametrize("further", [[], [(0, Verdict(UNDECIDED))]])
def test_what_is_not_known_is_undecided_and_takes_nothing_from_the_sure_one(further):
    """At a place where nothing was held too: never silently nothing."""
    first, others = told(LATE_LOSS, DOUBTFUL, further)
    assert first.passing == MAIN
    columns = further_jump_variables(TABLE, [others, []])
    assert columns["further_decided"][1][0, 0] == "undecided"
    assert np.isnan(columns["further_jumps"][1][0, 0])
    middle, half = (columns[name][1][0, 0] for name in ("further_held", "further_error"))
    assert (middle - half, middle + half) == pytest.approx((1.3, 1.33))


@pytest.mark.parametrize(("slope", "first", "lost"), [(-0.05, 1.1, True), (0.1, 1.1, False)])
def test_a_ramp_that_ends_before_it_shows_its_loss(slope, first, lost):
    """It passes the fold by 0.004 and is still on its motion; held voltages find the loss."""
    fold = fold_of(-0.05)
    schedule = Ramp(1.4, fold + 0.004, 1e-3, back=False)
    count = round(schedule.duration / H)
    test = HeldVoltageTest(
        lambda other: Rotor(other, slope, first), schedule, H, 1.0, 1.0, 2e4, HoldSettings()
    )
    ramp = Rotor(schedule, slope, first)
    ramp.revolve(range(count))
    assert ramp.speed < 1.28
    verdicts = test.losses_before_the_end((count // 2, count - 1), True)
    assert len(verdicts) == lost
    for verdict in verdicts:
        assert verdict.outcome == LOST and verdict.low - 5e-6 <= fold <= verdict.high + 5e-6


def test_a_loss_before_the_end_of_a_ramp_without_another_is_its_jump():
    losses = gather_losses(TABLE, ROWS, None, Verdict(0), [], [(AT_END, LATE_LOSS)])
    jump, further = pick_jump(*losses, 1.0)
    assert jump.verdict == LATE_LOSS and jump.is_sure and further == []


@pytest.mark.parametrize("rate", [RATES[0], *(pytest.param(one, marks=SLOW) for one in RATES[1:3])])
def test_a_drive_that_jumps_near_the_end_of_its_ramp(rate):
    """A ramp of 2e-5 shows it; faster ones were said to lose nothing."""
    system = draw_with_folds(np.random.default_rng(14599022132451)).of_kind("delaminated")
    down = run_couple(system, rate)[WAYS.index("down")]
    assert down.said == "lost" and down.low - 2e-4 < 1.61834 < down.high + 2e-4


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize(
    ("seed", "jumps"), [(249286942736891, (1.22767, 1.3697)), (251, (1.3641, 1.4590))]
)
def test_drives_of_the_campaign_that_jump_twice(seed, jumps, rate):
    """Of each the second one alone was told.

    The first jump of one is by 0.0080 omega: outside the held course it is undecided.
    """
    structure, drive = draw_with_folds(np.random.default_rng(seed)).of_kind("delaminated")
    volts = drive.volts(structure)
    ends = tuple(end * volts for end in ramp_ends(draw_with_folds(np.random.default_rng(seed))))
    speed = rate * volts * structure.omega
    up = couple(structure, drive, voltage=ends, rate=speed, back=False, progress=False).sel(
        jump="up"
    )
    assert up.held_verdict in ((LOST, UNDECIDED) if seed == 249286942736891 else (LOST,))
    told = np.array([up.held_jumps, *up.further_held]) / volts
    assert np.nanmin(told) == pytest.approx(jumps[0], abs=2e-4)
    assert int(up.further_count) >= 1
    assert np.nanmax([*told, *(up.further_jumps / volts)]) > jumps[1] - 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES)
def test_a_drive_that_jumps_soon_after_the_begin_of_its_ramp(rate):
    """At 2e-4 its second jump alone was told, at 1.426."""
    system = draw_with_folds(np.random.default_rng(196661501742492))
    structure, drive = system.of_kind("delaminated")
    volts = drive.volts(structure)
    ends = tuple(end * volts for end in ramp_ends(system))
    speed = rate * volts * structure.omega
    run = couple(structure, drive, voltage=ends, rate=speed, back=False, progress=False)
    up = run.sel(jump="up")
    if up.held_verdict == LOST:
        assert float(up.held_jumps) / volts == pytest.approx(1.25427, abs=2e-4)
    assert 1.2541 < float(up.jumps) / volts < 1.2541 + 6.0 * rate / drive.b(structure)
    assert int(up.further_count) >= 1


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES[:2])
def test_a_drive_whose_first_motion_ends_against_the_way(rate):
    """Ramps fall at 1.612; a motion on which one may land beside it was said to be theirs."""
    structure, drive = draw_with_folds(np.random.default_rng(90232375555884)).of_kind("delaminated")
    volts = drive.volts(structure)
    speed = rate * volts * structure.omega
    ends = 1.75 * volts, 1.5 * volts
    down = couple(structure, drive, voltage=ends, rate=speed, back=False, progress=False)
    down = down.sel(jump="down")
    assert down.held_verdict == UNDECIDED or 1.6115 < down.held_jumps / volts < 1.6123
    told = np.array([down.held_jumps, *down.further_held]) / volts
    assert ((told > 1.6115) & (told < 1.6123)).any()


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES[2:])
def test_an_irregular_drive_jumps_nowhere_by_its_record(rate):
    """Its mean speed goes from 1.47 to 1.53 by and by, up and down: 2e-5 told two jumps."""
    system = draw_with_folds(np.random.default_rng(92120022409811))
    structure, drive = system.of_kind("delaminated")
    volts, omega = drive.volts(structure), structure.omega
    ends = tuple(end * volts for end in ramp_ends(system))
    speed = rate * volts * omega
    run = couple(structure, drive, voltage=ends, rate=speed, hold=1.0 / omega, progress=False)
    assert "by the record" not in {*run.decided.values, *run.further_decided.values.ravel()}


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES[::3])
def test_a_drive_whose_speed_falls_by_less_than_the_smallest_jump(rate):
    """By 0.0063 omega at 1.512, at the end of its ramp: the record of 2e-5 told a jump."""
    drawn = draw_with_folds(np.random.default_rng(237673316322565))
    down = run_couple(drawn.of_kind("delaminated"), rate)[1]
    assert "lost" not in {each.said for each in (down, *down.further)}


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES)
def test_a_small_jump_that_fast_ramps_do_not_show_is_undecided(rate):
    """By 0.0085 omega at 1.6015: slow ramps told a jump, fast ones that there is none."""
    rng = np.random.default_rng(164113769637592)
    edge = scale_to_slope(draw_with_folds(rng), float(rng.uniform(*SLOPES)))
    down = run_couple(edge.of_kind("delaminated"), rate)[1]
    assert down.said == "none" and all(other.said == "undecided" for other in down.further)


def answer_up(system, rate):
    """The answer of `couple` upward, on the delaminated structure, with its further jumps."""
    answer = run_couple(system.of_kind("delaminated"), rate)[0]
    return [(each.said, each.low, each.high) for each in (answer, *answer.further)]


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES)
def test_a_drive_with_a_motion_in_a_narrow_range(rate):
    """The jump to it, from 1.6799 on, was not told at 5e-5."""
    found = answer_up(draw_with_folds(np.random.default_rng(198196246354768)), rate)
    assert any(low <= 1.6799 <= high for said, low, high in found if said == "lost")
    assert any(low <= 1.7199 <= high for _, low, high in found)


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES)
def test_a_drive_with_two_motions_that_end_soon_after_each_other(rate):
    """Ramps at 1e-6 too lose the first at 1.2298: some rates told the end of another alone."""
    rng = np.random.default_rng(95547264317277)
    found = answer_up(scale_to_slope(draw_with_folds(rng), float(rng.uniform(*SLOPES))), rate)
    assert any(low <= 1.2299 and high >= 1.2297 for said, low, high in found if said == "lost")
    assert any(low <= 1.2336 <= high + 1e-4 for _, low, high in found)


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES[:3])
def test_a_motion_that_is_long_unstable_before_it_leaves(rate):
    """It leaves 1.4925 when held five times: its end was told at 1.4946 to 1.4955, by the rate."""
    system = draw_with_folds(np.random.default_rng(277742146813143)).of_kind("delaminated")
    up = run_couple(system, rate)[0]
    assert up.said == "undecided" or up.low < 1.4925


@pytest.mark.slow
@pytest.mark.parametrize("rate", RATES[:3])
@pytest.mark.parametrize(
    ("seed", "way", "jump"), [(251, "down", 1.35711), (15186479623816, "up", None)]
)
def test_a_motion_fallen_into_by_chance_ends_at_no_jump(seed, way, jump, rate):
    """At one of these rates each was said to lose, elsewhere, a motion of a narrow range."""
    system = draw_with_folds(np.random.default_rng(seed)).of_kind("delaminated")
    answer = run_couple(system, rate)[WAYS.index(way)]
    assert answer.said == ("lost" if jump else "none")
    assert jump is None or answer.low <= jump + 1e-4 and answer.high >= jump - 1e-4
    assert all(other.said == "undecided" for other in answer.further)
