"""The hysteresis loop on made-up motors: a loss of stability, a steep branch, or undecided."""

from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate.weak_drive import hysteresis
from orchestrate.weak_drive.hysteresis import LOST, NONE, UNDECIDED, HeldPoint, HysteresisLoop, Jump
from orchestrate.weak_drive.schedule import Ramp

from .coupled import QUICK

H = 5.0
STIFF = 20.0


class Rotor:
    """A speed that follows eta0 = 1.5 + slope x + stiff x^3, x = speed - 1.3."""

    def __init__(self, schedule, slope, start, stiff=STIFF):
        self.schedule, self.slope, self.speed, self.stiff = schedule, slope, start, stiff

    def run_steps_for_speeds(self, steps):
        speeds = []
        for i in steps:
            x = self.speed - 1.3
            needed = 1.5 + self.slope * x + self.stiff * x**3
            self.speed += 0.02 * H * (self.schedule.voltage((i + 0.5) * H) - needed)
            speeds.append(self.speed)
        return np.array(speeds)

    def close(self):
        pass

    def get_state(self):
        return self.speed

    def set_state(self, speed):
        self.speed = speed


def decided(slope, up=True, start=1.1, longest=2e4):
    """The jumps of a course that begins at three tenths of a ramp."""
    first, last = (1.4, 1.6) if up else (1.6, 1.4)
    ramp = Ramp(first, last, 1e-4, back=False)
    loop = HysteresisLoop(lambda it: Rotor(it, slope, start), ramp, H, 1.0, 1.0, longest)
    return loop.find_jumps(loop.hold_ramp_voltage(round(0.3 * ramp.duration / H)), last)


def fold_of(slope, up=True):
    """Where the derivative is 0: 1.5 plus or minus 2/3 |slope| x there."""
    x = (-slope / 3.0 / STIFF) ** 0.5
    return 1.5 - (1 if up else -1) * 2.0 / 3.0 * slope * x


class Scripted(HysteresisLoop):
    """A motion half as steep as the voltage, and others: by how much their speed is higher, from
    which voltage on the last of them is come to, and down to which it lasts; or a function.
    """

    own_error = 0.0

    def __init__(self, higher):
        super().__init__(lambda _: None, Ramp(1.4, 1.6, 1e-3), H, 1.0, 1.0, 10.0)
        self.higher = higher
        if isinstance(higher, list):
            self.higher = lambda motion, _, voltage: next(
                (own for own, up, down in higher if voltage > (down if own == motion else up)), 0.0
            )

    def move_and_hold(self, state, first, voltage, min_time=0.0):
        motion = self.higher(state["motion"], first, voltage)
        stays = motion == state["motion"]
        return self.at(voltage, motion)._replace(time=max(min_time * stays, 1.0))

    def at(self, voltage, motion=0.0):
        speed = 1.3 + 0.5 * (voltage - 1.5) + motion
        return HeldPoint(voltage, speed, self.own_error, {"motion": motion}, time=1.0)

    def course(self):
        return self.find_jumps(self.at(1.5), 1.56)

    def outcomes(self):
        return [jump.outcome for jump in self.course()]


@pytest.mark.parametrize(("length", "bracket"), [(1.02e-4, 0.51e-4), (0.98e-4, 0.98e-4)])
def test_a_jump_is_bracketed_within_the_width(length, bracket):
    loop = Scripted([(0.1, 1.506, 1.5)])
    (jump,) = loop.find_jumps(loop.at(1.5), 1.5 + 128 * length)
    assert jump.outcome == LOST and jump.low < 1.506 <= jump.high
    assert jump.high - jump.low == pytest.approx(bracket)


@pytest.mark.parametrize(("spent", "outcome", "end"), [(599, LOST, 1.55), (601, UNDECIDED, 1.56)])
def test_what_is_left_after_sixty_holds_is_undecided(monkeypatch, spent, outcome, end):
    """They take 10 s; the motion is lost at 1.55."""
    loop = Scripted([(0.1, 1.55, 0.0)])
    insert = loop.insert_point_between

    def late(points, i):
        loop.spent = spent
        return insert(points, i)

    monkeypatch.setattr(loop, "insert_point_between", late)
    (jump,) = loop.course()
    assert (jump.outcome, jump.high) == (outcome, pytest.approx(end, abs=1e-4))


@pytest.mark.parametrize(("last", "count"), [(1.56, 3), (1.5601, 4), (1.44, 3), (1.5, 1)])
def test_first_steps_are_those_of_the_grid(last, count):
    loop = Scripted(lambda *now: 0.0)
    held = [point.voltage for point in loop.hold_grid(loop.at(1.5), last)]
    assert held == pytest.approx(np.linspace(1.5, last, count + 1))


def test_what_comes_after_a_speed_against_the_voltage():
    """The motion ends at 1.52 for one 0.02 below; unless it had converged, by chance."""
    loop = Scripted([(0.1, 1.54, 1.5), (-0.02, 1.52, 1.51)])
    assert loop.outcomes() == [LOST, LOST]
    loop.own_error = 1e-5
    lost, rest = loop.course()
    assert lost.outcome == LOST and lost.low - 1e-9 <= 1.52 < lost.low + 1e-4
    assert rest == (UNDECIDED, lost.high, 1.56, *rest[3:])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_a_motion_has_become_is_compared_from_the_step_before_on(sign):
    """The fourth of five does not last: the jump to it is decided again, those before stay."""
    loop, asked, lasts = Scripted(None), [], iter((0.0, 9.0))
    points = [loop.at(1.5 + sign * 0.01 * n)._replace(lasts=9.0 * (n != 3)) for n in range(5)]

    def jump_over(points, i, jumps):
        asked.append(i)
        return Jump((LOST, UNDECIDED)[i % 2], points[i].voltage, points[i + 1].voltage)

    loop.update_step_and_find_jump = jump_over
    loop.hold_until_lasting = lambda point, *_: point._replace(lasts=next(lasts))
    loop.hold_grid, loop.insert_point_between = lambda *ends: points, lambda *step: False
    loop.excess_change = loop.required_lifetime = lambda *step: 1.0
    found = loop.find_jumps(points[0], points[-1].voltage)
    assert asked == [0, 1, 2, 2, 3]
    assert [jump.low for jump in found] == [point.voltage for point in points[:4]]


def test_a_voltage_that_is_left_out_is_not_tried_again(monkeypatch):
    """The speed settles at 1.53 and, held on there, does not."""
    loop = Scripted(lambda *now: 0.1 * (now[2] > 1.52))
    gone = {"speed": np.nan, "lasts": 0.0}
    monkeypatch.setattr(loop, "hold_until_lasting", lambda point, *_: point._replace(**gone))
    points = [loop.at(1.53), loop.at(1.53005, 0.1)]
    monkeypatch.setattr(loop, "hold_grid", lambda *ends: points)
    loop.find_jumps(loop.at(1.5), 1.56)
    assert loop.left_out == {1.53}
    points = [loop.at(1.51), loop.at(1.55, 0.1)]  # 1.53 is half way
    assert loop.insert_point_between(points, 0) and points[1].voltage == pytest.approx(1.54)
    assert loop.left_out == {1.53, 1.52}  # there the motion is the one before


@pytest.mark.parametrize(("error", "widths"), [(0.0, 33), (0.0, 31), (1e-5, 33)])
def test_each_threshold_of_what_a_lost_motion_comes_to(error, widths):
    """Another one from ``widths`` past the step on, in both directions; or one that is near."""
    far = 1e-4 * widths
    for sign in (1.0, -1.0):
        lost = lambda *now, k=sign: now[0] or -1e-4 < k * (now[2] - 1.521) < far  # noqa: E731
        loop = Scripted(lambda *now, lost=lost: -0.02 if lost(*now) else 0.1)
        low, high = loop.at(1.521 - sign * 1e-3)._replace(error=error), loop.at(1.521, -0.02)
        assert loop.lands_on_one_motion(low, high) == (widths > 32 and not error)
    for away, is_one in ((4.9e-3, True), (5.1e-3, False)):
        loop = Scripted(lambda *now, away=away: -0.02 if now[0] else away - 0.02)
        assert loop.lands_on_one_motion(low, high) == (is_one and not error)


@pytest.mark.parametrize(("life", "place"), [(5.9, 1.51), (6.1, 1.52)])
def test_a_transient_is_held_for_five_times_its_first_hold_more(life, place):
    """It lives for that many holds between 1.51 and 1.52."""

    class Transient(Scripted):
        def move_and_hold(self, state, first, voltage, min_time=0.0):
            age = state.get("age", 0.0) * (voltage == first)
            lives = 0.1 if voltage > 1.52 else life if voltage > 1.51 else np.inf
            is_lost = state["motion"] and voltage > 1.505 or age + max(min_time, 1.0) > lives
            time = lives - age if is_lost and not state["motion"] else max(min_time, 1.0)
            state = {"motion": 0.02 * bool(is_lost), "age": age + time}
            return self.at(voltage, state["motion"])._replace(state=state, time=time)

    loop = Transient(None)
    (jump,) = loop.course()
    assert jump.outcome == LOST and jump.low - 1e-9 <= place <= jump.high + 1e-9
    brief, *lives = (loop.at(1.52)._replace(time=time) for time in (0.0, 19.9, 20.1))
    for lived, least in zip(lives, (99.5, 100.0), strict=True):  # ten holds at most
        for pair in ((brief, lived), (lived, brief)):
            assert loop.required_lifetime(*pair) == pytest.approx(least)


@pytest.mark.parametrize("change", [0.02, -0.02])
def test_a_step_without_hysteresis_is_no_jump(change):
    """As where halves begin to touch, at 1.52: with the voltage or against it; 1.54 is a jump."""
    step = (change, 1.52, 1.52)
    (jump,) = Scripted([(0.1, 1.54, 1.53), step]).course()
    assert jump.outcome == LOST and jump.low - 1e-9 <= 1.54 <= jump.high + 1e-9
    assert Scripted([step]).course() == []


@pytest.mark.parametrize(("change", "outcomes"), [(1.9e-3, []), (2.1e-3, [UNDECIDED])])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_comes_after_a_small_loss_is_undecided_by_chance(sign, change, outcomes):
    """Lost at 1.52 for one that is near, but 1e-3 past it for one that is not."""

    def higher(motion, before, voltage):
        if motion == 0.1 or motion == 0.0 and voltage > 1.521:
            return 0.1
        return sign * change if voltage > 1.52 or (motion and voltage > 1.51) else 0.0

    jumps = Scripted(higher).course()
    assert [jump.outcome for jump in jumps] == outcomes
    assert not jumps or (jumps[0].high, jumps[0].low < 1.52 + 1e-9) == (1.56, True)


def test_another_motion_on_the_way_back_is_undecided():
    """No step of the way there is large."""
    assert Scripted(lambda _, before, now: 0.02 * (now < before)).outcomes() == [UNDECIDED]


@pytest.mark.parametrize(
    ("change", "outcomes"),
    [(4.4e-3, []), (4.6e-3, [UNDECIDED]), (4.9e-3, [UNDECIDED]), (5.1e-3, [LOST])],
)
def test_motions_of_nearly_one_speed_are_undecided(change, outcomes):
    """Between `small`, of what is none, and `clear`, of what is a jump."""
    assert Scripted([(change, 1.52, 1.51)]).outcomes() == outcomes


@pytest.mark.parametrize(
    ("rate", "max_hold", "disturbance", "is_known", "lasts"),
    [
        (1.0, 100.0, 1e-15, True, False),  # grows by e^30 = 1e13 in `growths` growth times
        (1.0, 100.0, 1e-16, True, True),
        (3.1e-4, 1e4, 0.0, True, True),  # they take ten holds at most
        (2.9e-4, 1e4, 0.0, False, False),
    ],
)
def test_growth_is_seen_from_rounding_errors_on(rate, max_hold, disturbance, is_known, lasts):
    class Growing(Scripted):
        def move_and_hold(self, state, first, voltage, min_time=0.0):
            motion = disturbance * np.exp(rate * min_time)
            return self.at(voltage, motion)._replace(time=min_time)

        def growth_rate(self, point):
            return rate

    loop = Growing(None)
    loop.max_hold = max_hold
    held = loop.hold_until_lasting(loop.at(1.52), loop.at(1.53), 0.0)
    assert (np.isfinite(held.speed), bool(held.lasts)) == (is_known, lasts)


def line(*points):
    return [HeldPoint(voltage, speed, error, {}) for voltage, speed, error in points]


STEP = (1.50, 1.30, 0.0), (1.52, 1.33, 0.0)  # a slope of 1.5 before 1.52
PAST = (1.56, 1.38, 0.0), (1.60, 1.41, 0.0)  # one of 0.75 after 1.56


@pytest.mark.parametrize(
    ("points", "i", "larger"),
    [
        *(
            ([(1.50, 1.3, 0.0), (1.52, 1.32 + gain, 0.0)], 0, abs(gain) > 1e-3)  # than the voltage
            for gain in (0.9e-3, -0.9e-3, 1.1e-3, -1.1e-3)
        ),
        ([(1.50, 1.3, 1e-3), (1.52, 1.32 + 1.9e-3, 0.0)], 0, False),  # by the error more
        ([(1.50, 1.3, 1e-3), (1.52, 1.32 + 2.1e-3, 0.0)], 0, True),
        ([(1.50, 1.3, 1.0), (1.52, 1.32 + 3.1e-3, 0.0)], 0, True),  # of which 2e-3 count at most
        *(
            ([*STEP, (1.54, 1.36 + gain, 0.0)], 1, abs(gain) > 1e-3)  # than by the slope before
            for gain in (0.9e-3, -0.9e-3, 1.1e-3, -1.1e-3)
        ),
        ([(1.48, 1.2, 0.0), *STEP, (1.53, 1.345, 0.0)], 2, False),  # over the nearest length
        ([(1.48, 1.2, 0.0), *STEP, (1.56, 1.46, 0.0)], 2, False),
        ([(1.48, 1.2, 0.0), *STEP, (1.56, 1.46 - 1.1e-3, 0.0)], 2, True),
        ([STEP[1], PAST[0], PAST[1]], 0, True),  # than by the slope after, if it is the first
        ([(1.52, 1.35, 0.0), *PAST], 0, False),
    ],
)
def test_each_threshold_of_a_step_that_is_looked_into(points, i, larger):
    assert (Scripted(None).excess_change(line(*points), i, []) > 0.0) == larger


def test_the_slope_before_a_jump_is_none_of_the_motion_after_it():
    """Of slopes 1.5, then 0.75; the jump between them has been decided."""
    points = line(*STEP, (1.5201, 1.38, 0.0), (1.5601, 1.41, 0.0), (1.6001, 1.44, 0.0))
    jumps = [Jump(LOST, 1.50, 1.52), Jump(LOST, 1.52, 1.5201)]
    loop = Scripted(None)
    assert loop.excess_change(points, 2, jumps) < 0.0 < loop.excess_change(points, 2, jumps[:1])


@pytest.mark.parametrize(
    ("away", "error", "same"),
    [(1.95e-3, 0.0, True), (2.05e-3, 0.0, False), (4.9e-3, 3e-3, True), (4.9e-3, 2.8e-3, False)]
    + [(5.1e-3, 1.0, False)],  # errors make no motions `clear` apart one
)
def test_each_threshold_of_one_motion(away, error, same):
    first, other = line((1.5, 1.3, 0.6 * error), (1.5, 1.3 + away, 0.8 * error))
    loop = Scripted(None)
    assert loop.may_be_same_motion(first, other) == loop.may_be_same_motion(other, first) == same


@pytest.mark.parametrize(("life", "outcome"), [(1.04, NONE), (1.06, LOST)])
def test_the_motion_on_the_way_back_has_to_last(life, outcome):
    """For five times what it takes to settle; it comes to the other one after ``life`` of that."""

    class Leaving(Scripted):
        def move_and_hold(self, state, first, voltage, min_time=0.0):
            return self.at(voltage, 0.1 * (min_time < 5.0 * life))._replace(time=1.05)

    loop = Leaving(None)
    assert loop.outcome_of_way_back(loop.at(1.5), loop.at(1.5001, 0.1)) == outcome
    for time, expected in ((2.0, 2.05), (2.1, 2.1)):  # since when the other one was lost
        high = loop.at(1.5)._replace(time=time)
        assert loop.hold_until_lasting(loop.at(1.5, 0.1), high, 9.0).time == pytest.approx(expected)
    loop, held = Scripted(lambda *now: 0.0), loop.at(1.5)._replace(lasts=3.0)
    assert loop.hold_until_lasting(held, held, 5.0).lasts == 5.0  # for the rest alone


@pytest.mark.parametrize(("least", "excess"), [(5.0, 1.0), (1.0, 0.0)])
def test_a_step_is_no_jump_before_its_motions_have_lasted(least, excess):
    loop = Scripted(lambda *now: 0.0)
    loop.required_lifetime, loop.excess_change = lambda *ends: least, lambda *step: excess
    ends = [loop.at(1.5)._replace(lasts=2.0), loop.at(1.51)]
    assert loop.update_step_and_find_jump(ends, 0, []) is None


@pytest.mark.parametrize(("asked", "base", "rotor"), [({}, 4000, 200), ({"base_hold": 1}, 1, 200)])
def test_the_usual_hold_is_longer_for_a_slower_rotor(asked, base, rotor):
    structure, drive = QUICK
    expected = (base + rotor / drive.b(structure)) / structure.omega
    settings = hysteresis.HysteresisSettings(**asked)
    assert settings.usual_hold(structure, drive) == pytest.approx(expected)


def test_a_hold_comes_at_the_rate():
    courses = []
    begin = lambda course: courses.append(course) or Rotor(course, 0.0, 1.3, 0.0)  # noqa: E731
    loop = HysteresisLoop(begin, Ramp(1.4, 1.6, 1e-4), H, 1.0, 1.0, 2e4)
    loop.hold_from(HeldPoint(1.5, 1.3, 0.0, 1.3), 1.5098)
    assert courses[-1].times == pytest.approx((0.0, 200.0, 20200.0))


@pytest.mark.parametrize(
    ("later", "error", "pieces"),
    [(1.3, 0.0, 30), (1.3049, 0.0, 30), (1.3051, 0.0, 7), (1.3051, 2e-4, 30), (1.3053, 2e-4, 7)],
)
def test_a_motion_is_held_for_a_time_unless_it_is_left(monkeypatch, later, error, pieces):
    """Its first block is at 1.3; left is what settles `clear` away, but for its error."""
    told, settled = [], hysteresis.settled_speed
    monkeypatch.setattr(hysteresis, "settled_speed", lambda *all: (settled(*all)[0], error))

    def speeds(rows):
        told.append(rows)
        return np.full(12 * bool(rows), 1.3 if len(told) < 4 else later)

    run = SimpleNamespace(run_steps_for_speeds=speeds, get_state=dict, close=list)
    loop = HysteresisLoop(lambda course: run, Ramp(1.4, 1.6, 1e-4), 1.0, 1.0, 1.0, 2e4)
    point = loop.move_and_hold(None, 1.5, 1.5, min_time=1500.0)  # of pieces of 50/omega
    assert point.speed == pytest.approx(later) and len([rows for rows in told if rows]) == pieces
    assert point.time == 50.0 * pieces
    loop.step = 200.0  # longer than a piece
    assert loop.move_and_hold(None, 1.5, 1.5).time in 200.0 * np.arange(1, 9)
    loop.step = 1.0
    time = loop.move_and_hold(None, 1.5, 1.501).time
    assert time % 50.0 == 0.0  # without the 20 that it comes in


@pytest.mark.parametrize(
    ("unsettled", "away", "comes"),
    [
        *(((1.52,), 0.0, True), ((1.52, 1.54), 0.0, True), ((1.52, 1.53), 0.0, False)),
        *(((1.5,), 0.0, False), ((), 4.9e-3, True), ((), 5.1e-3, False)),
    ],
)
def test_the_way_back_settles_but_for_single_voltages(unsettled, away, comes):
    loop = Scripted(lambda *now: np.nan if round(now[2], 3) in unsettled else away)
    points = [loop.at(voltage) for voltage in (1.5, 1.51, 1.52, 1.53, 1.54, 1.55)]
    assert loop.comes_back_over_all(points) == comes


@pytest.mark.parametrize(("away", "comes"), [(1.9e-3, False), (2.1e-3, True)])
def test_the_way_back_goes_on_with_the_motion_that_another_parts_from(away, comes):
    """First by little; on the other motion's own way it is 0.02 farther down."""

    def higher(motion, before, voltage):
        return motion and (away if voltage > 1.535 else 0.02)

    loop = Scripted(higher)
    points = [*(loop.at(voltage) for voltage in (1.5, 1.52, 1.54)), loop.at(1.55, 1e-4)]
    assert loop.comes_back_over_all(points) == comes


@pytest.mark.parametrize(("speed", "again"), [(1.304, True), (1.306, False)])
@pytest.mark.parametrize("lives", [True, False])
def test_a_motion_nearer_to_the_one_before_is_held_on(monkeypatch, speed, again, lives):
    loop = Scripted(None)
    low, here, high = line((1.5, 1.3, 0.0), (1.501, speed, 0.0), (1.501, 1.31, 0.0))
    here = here._replace(time=1.0)
    monkeypatch.setattr(loop, "hold_from", lambda *asked: here)
    monkeypatch.setattr(loop, "hold_until_lasting", lambda point, high, least: least)
    assert loop.hold_from_low_end(low, 1.501, high, lives) == (5.0 * lives if again else here)


def test_a_ramp_is_taken_up_in_the_middle_of_a_step_from_the_checkpoint_before(monkeypatch):
    asked = []
    run = SimpleNamespace(set_state=asked.append, run_steps_for_speeds=asked.append, close=list)
    run.get_state = lambda: "there"
    loop = HysteresisLoop(lambda course: run, Ramp(1.4, 1.6, 1e-3), 2.0, 1.0, 1.0, 1.0)
    memories = (f"{name}_memory" for name in ("master", "balance", "revolution", "control"))
    table = dict.fromkeys(("oscillator_state", "shaker_state", *memories), np.arange(3))
    loop.add_checkpoints(table, 10, 25)  # before steps 10, 20 and 25, the end
    assert loop.ramp_state_before(0) is None and list(loop.checkpoints) == [10, 20, 25]
    assert loop.checkpoints[20]["master_memory"].tolist() == [1]
    assert loop.ramp_state_before(23) == loop.ramp_state_before(23) == "there"
    assert asked == [loop.checkpoints[20], range(20, 23)]
    monkeypatch.setattr(loop, "move_and_hold", lambda *held: held)
    assert loop.hold_ramp_voltage(23) == ("there", *[pytest.approx(1.4 + 1e-3 * 23.5 * 2.0)] * 2)


@pytest.mark.parametrize(("steep", "width"), [(0.1, 2e-3), (0.01, 2e-2)])
def test_a_motion_whose_disturbances_grow_slowly_is_held_for_their_growth_time(steep, width):
    """Stable up to 1.52; nowhere past it is the end of the motion but by a hold long enough."""

    class Slow(Scripted):
        def move_and_hold(self, state, first, voltage, min_time=0.0):
            motion = 0.1 if state["motion"] or (min_time and voltage > 1.52) else 0.0
            return self.at(voltage, 0.1 if voltage > 1.55 else motion)

        def hold_from(self, point, voltage):
            motion = 0.1 if voltage > 1.55 or (point.state["motion"] and voltage > 1.4) else 0.0
            return self.at(voltage, motion)

        def growth_rate(self, point):
            return -1.0 if point.state["motion"] else steep * (point.voltage - 1.52)

    loop = Slow(None)
    loop.max_hold = 1e4  # of growths up to 3e-4 something is seen
    (jump,) = loop.course()
    assert jump.outcome == LOST and jump.low <= 1.52 < jump.high and jump.high - jump.low > 1e-3
    assert 30.0 / (steep * (jump.high - 1.52)) < 1e5 or jump.high > 1.55


@pytest.mark.parametrize(("slope", "up", "start"), [(-0.05, True, 1.1), (-0.02, False, 1.5)])
def test_a_fold(slope, up, start):
    """It is bracketed; -0.02: the other one is 5e-4 away."""
    (jump,) = decided(slope, up=up, start=start)
    low, high = sorted((jump.low, jump.high))
    assert jump.outcome == LOST and high - low < 2.1e-4
    assert low - 5e-6 <= fold_of(slope, up) <= high + 5e-6


def test_a_steep_branch():
    """100 times as steep as the voltage, but the speed comes back with it."""
    assert decided(0.01, longest=2e5) == []


@pytest.mark.parametrize("slope", [-0.02, 0.0])
@pytest.mark.parametrize("longest", [1500.0, 5000.0])
def test_a_short_hold_is_never_wrong(slope, longest):
    """Near the edge of a fold speeds settle slowly."""
    outcomes = {jump.outcome for jump in decided(slope, longest=longest)}
    lost = slope < 0.0 and fold_of(slope) - fold_of(slope, up=False) > 1e-4
    assert outcomes <= {LOST, UNDECIDED} if lost else outcomes <= {UNDECIDED}
    assert outcomes or not lost
