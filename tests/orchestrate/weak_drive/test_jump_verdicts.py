"""Jump, none or undecided: the same at every rate, and agreed with the averaged theory."""

import math

import numpy as np
import pytest

from orchestrate import Drive, passage
from orchestrate.access import OSCILLATOR, SHAKER, find
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.couple import couple_job
from orchestrate.weak_drive.held import FOLLOWS, LEFT_BEFORE, LOST, NOT_ASKED, UNDECIDED, Verdict
from orchestrate.weak_drive.jump_verdicts import (
    AveragedPrediction,
    averaged_predictions,
    check_against_theory,
    explain_no_jump,
    is_doubtful,
)
from orchestrate.weak_drive.jumps import (
    DOUBTFUL,
    JUMP,
    SMOOTH,
    UNFINISHED,
    Criterion,
    Passing,
    SweepLeg,
    find_passing,
)
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.schedule import Ramp
from tools.draws import draw_system, scale_to_slope

from .coupled import BEAM, QUICK, System
from .test_couple import run

RNG = np.random.default_rng(5)
DRAWN = [System(*draw_system(RNG)) for _ in range(3)]
CLOSE = DRAWN[2].as_bonded()  # its folds, by its branch, at 1.13468 and 1.13041
DOWN = {"back": False, "settle": 100.0, "step": None}


def down(system, rate, **more):
    """A ramp down through the jump, without one up."""
    return run(system, (1.2, 1.08), rate, **DOWN, **more).sel(jump="down")


def held_jump(found, system=CLOSE):
    """Where held voltages lose the motion, and the error, over K omega."""
    volts = system.drive.volts(system.structure)
    return float(found.held_jumps) / volts, float(found.held_error) / volts


def test_folds_that_are_close_are_seen():
    """It was said that there is no loss of stability."""
    found = down(CLOSE, 2e-4)
    place, error = held_jump(found)
    assert found.no_jump == "" and found.decided == "by held voltages"
    assert found.held_verdict == LOST and error < 1e-4
    assert place == pytest.approx(1.13041, abs=error + 5e-5)


@pytest.mark.slow
@pytest.mark.parametrize("rate", [2e-4, 1e-4, 5e-5, 3e-5, 1e-5])
def test_folds_that_are_close_both_ways(rate):
    found = run(CLOSE, (1.07, 1.25), rate, step=None)
    for way, fold in (("up", 1.13468), ("down", 1.13041)):
        at = found.sel(jump=way)
        assert np.isfinite(at.jumps)
        if at.decided == "by held voltages":
            place, error = held_jump(at)
            assert place == pytest.approx(fold, abs=error + 5e-5)


def test_no_record_makes_a_jump_of_a_vertical_branch():
    """Its least slope is 0.02, there is no fold: a jump down at 1.5042 was told by the record."""
    edge = System(*scale_to_slope(DRAWN[1], 0.02)).as_bonded()
    assert not averaged.folds(*edge)
    found = run(edge, (1.58, 1.45), 1e-4, **DOWN).sel(jump="down")
    assert np.isnan(found.jumps) and found.held_verdict == FOLLOWS
    assert "without a gap" in str(found.no_jump.item())
    falls = np.flatnonzero(found.eta0.diff("revolution").values < -1e-9)
    time = found.time.values[falls] * edge.structure.omega
    way = SweepLeg(time, found.eta0.values[falls], found.Omega.values[falls])
    b, threshold = edge.drive.b(edge.structure), averaged.dividing_speed(*edge)
    assert find_passing(way, b, up=False, threshold=threshold).look == DOUBTFUL
    weaker = Criterion(strength=0.0)
    assert find_passing(way, b, up=False, threshold=threshold, criterion=weaker).look == JUMP


def test_what_has_not_settled_is_undecided():
    """And the answer says what helps; a longer hold does."""
    omega = CLOSE.structure.omega
    found = down(CLOSE, 2e-4, hold=700.0 / omega)
    assert found.held_verdict == UNDECIDED and found.decided == "undecided"
    assert found.held_verdict.attrs["flag_meanings"].split() == [
        "not_asked",
        "lost",
        "follows",
        "left_before",
        "undecided",
    ]
    assert np.isnan(found.jumps)
    assert "undecided" in str(found.no_jump) and "longer hold" in str(found.no_jump.item())


@pytest.mark.parametrize("last", [1.606, 1.59])
def test_a_ramp_that_ends_during_the_jump_or_before_it_shows(last):
    """Past the fold at 1.5831: it was said that there is none, and where the speed ends."""
    quick = QUICK.as_bonded()
    found = run(quick, (1.5, last), 1e-4, back=False, step=None).sel(jump="up")
    told = found.held_jumps if np.isfinite(found.held_jumps) else found.further_held[0]
    assert float(told) / quick.drive.volts(quick.structure) == pytest.approx(1.5831, abs=1e-4)
    assert "by held voltages" in (found.decided, found.further_decided[0])


def test_a_motor_that_turns_backward_has_the_mirrored_verdicts():
    """It was said that it does not jump: up was where its voltage falls from 0."""
    quick = QUICK.as_bonded()
    volts = quick.drive.volts(quick.structure)
    forward, backward = (run(quick, (way * 1.4, way * 1.65), 2e-4, step=None) for way in (1, -1))
    assert np.isfinite(forward.jumps.values).all()
    for name in ("jumps", "jump_speed_before", "jump_rate", "averaged_jumps", "jump_lag"):
        mirrored = -backward[name].values
        assert mirrored == pytest.approx(forward[name].values, rel=1e-3, abs=1e-6), name
    ends = run(quick, (-1.5, -1.606), 1e-4, back=False, step=None).sel(jump="up")
    assert ends.decided == "by held voltages"
    assert float(ends.held_jumps) / volts == pytest.approx(-1.5831, abs=1e-4)


def test_a_verdict_is_the_same_from_other_checkpoints_and_at_full_resolution():
    """A run is cut into chunks of 4,000 steps, a passage into chunks of 10,000."""
    volts, omega = CLOSE.drive.volts(CLOSE.structure), CLOSE.structure.omega
    ramp = Ramp(1.2 * volts, 1.08 * volts, 4e-4 * volts * omega, 100.0 / omega, back=False)
    scheme = Scheme("rollback", 0.4 / omega)
    job = couple_job(*CLOSE, ramp, scheme)
    fmus = {model: find(model).path for model in (OSCILLATOR, SHAKER)}
    expected = job.run_here(fmus)["verdicts"]
    assert expected[0, 1, 0] == LOST
    found = passage(*CLOSE, voltage=ramp, step=0.4 / omega, progress=False)
    middle = expected[0, 1, 1:].mean()
    assert float(found.held_jumps.sel(jump="down")) == middle


PLACE = AveragedPrediction((1.13, 1.13), False, -0.5)
TORUS = AveragedPrediction((1.16, 1.13), False, -0.5)
NONE = AveragedPrediction((), False, 0.1)


@pytest.mark.parametrize(
    ("verdict", "theory", "what"),
    [
        (Verdict(LOST, 2.2599, 2.2601), PLACE, LOST),
        (Verdict(LOST, -2.2599, -2.2601), PLACE, LOST),
        (Verdict(LOST, 2.2640, 2.2642), PLACE, UNDECIDED),
        (Verdict(LOST, 2.29, 2.2902), TORUS, LOST),
        (Verdict(LOST, 2.24, 2.2402), TORUS, UNDECIDED),
        (Verdict(LOST, 2.2599, 2.2601), NONE, UNDECIDED),
        (Verdict(FOLLOWS), PLACE, UNDECIDED),
        (Verdict(FOLLOWS), PLACE._replace(narrow=True), FOLLOWS),
        (Verdict(FOLLOWS), NONE, FOLLOWS),
        (Verdict(LEFT_BEFORE), PLACE, LEFT_BEFORE),
        (Verdict(NOT_ASKED), NONE, NOT_ASKED),
    ],
)
def test_a_verdict_that_the_averaged_theory_contradicts_is_not_given(verdict, theory, what):
    """Volts are 2: the theory loses the motion at 2.26 V."""
    final = check_against_theory(verdict, theory, 2.0)
    assert final.outcome == what
    if what == UNDECIDED:
        text = explain_no_jump(verdict, final, theory, 5.0)
        assert text.startswith("undecided: held voltages") and "averaged theory" in text
        assert math.isnan(verdict.low) or f"{0.5 * (verdict.low + verdict.high):.5g} V" in text


@pytest.mark.parametrize(
    ("look", "bonded", "theory", "doubtful"),
    [
        (JUMP, True, PLACE, False),
        (JUMP, True, NONE, True),
        (JUMP, False, NONE, False),
        (DOUBTFUL, True, PLACE, True),
        (SMOOTH, True, PLACE, True),
        (SMOOTH, True, NONE, False),
        (SMOOTH, False, NONE, True),
        (SMOOTH, False, NONE._replace(slope=0.5), False),
        (UNFINISHED, True, PLACE, True),
        (UNFINISHED, False, NONE, True),
    ],
)
def test_when_voltages_are_held(look, bonded, theory, doubtful):
    assert is_doubtful(Passing(1, 0, 2, look, 1.0), bonded, theory) is doubtful


def test_what_the_averaged_theory_knows():
    up, down = averaged_predictions(*BEAM)
    assert len(up.losses) == len(down.losses) == 2 and not up.narrow
    assert up.losses[0] == up.losses[1] == pytest.approx(1.5418, abs=1e-4)
    assert down.losses == pytest.approx((1.3731, 1.3588), abs=1e-4)  # the first a Neimark-Sacker
    assert up.slope == down.slope < -1.0
    weak = QUICK.drive.replace(armature_resistance=QUICK.drive.armature_resistance / 20.0)
    none = averaged_predictions(QUICK.structure, weak)[0]
    assert none.losses == () and 0.0 < none.slope < 1.0


def test_the_least_slope_is_that_of_the_branch():
    assert averaged.smallest_slope(*scale_to_slope(DRAWN[1], 0.02)) == pytest.approx(0.02, abs=1e-9)
    speeds = np.linspace(1.2, 1.6, 4001)
    slopes = np.gradient(averaged.no_load_speed(*QUICK, speeds), speeds)
    assert averaged.smallest_slope(*QUICK) == pytest.approx(slopes.min(), rel=1e-3)
    assert isinstance(scale_to_slope(DRAWN[1], 0.02).drive, Drive)
