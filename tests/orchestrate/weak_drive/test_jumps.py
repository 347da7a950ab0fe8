"""Jumps are where a branch ends; a speed that follows the voltage does not jump."""

import numpy as np
import pytest

from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.jumps import (
    DOUBTFUL,
    JUMP,
    SMOOTH,
    Criterion,
    SweepLeg,
    find_passing,
    half_slip_row,
)

from .coupled import BEAM, QUICK
from .test_couple import run
from .validation import random_sets


def test_a_run_that_began_beyond_the_resonance():
    """The motor starts at the speed of the first voltage, on the upper branch, and stays there."""
    found = run(QUICK.as_bonded(), (1.45, 1.65), 4e-4, back=False, spin_up=0.0)
    assert np.isnan(found.jumps).all() and np.isnan(found.jump_speed_before).all()
    assert found.no_jump.values.tolist() == [
        "began beyond the resonance",
        "the voltage does not fall",
    ]


def test_a_run_up_begins_below_the_resonance():
    """So the same voltages show the jump; late, as the rate has it."""
    found = run(QUICK.as_bonded(), (1.45, 1.65), 1e-4, back=False)
    up = found.sel(jump="up")
    assert up.jumps == pytest.approx(1.606, abs=1e-3)
    assert up.jump_lag == pytest.approx(float(up.jumps) - 1.58306, abs=1e-5)
    assert up.jump_rate == pytest.approx(1e-4, rel=1e-3)
    assert up.jump_speed_before == pytest.approx(1.315, abs=5e-3)
    assert up.jump_speed_after == pytest.approx(1.602, abs=5e-3)
    assert up.jump_amplitude_before > 19.0 > 4.0 > up.jump_amplitude_after
    assert up.no_jump == ""


def test_the_beam_begins_below_too():
    """It was said to jump at once, at 1.403."""
    found = run(BEAM.as_bonded(), (1.4, 1.6), 5e-5, back=False)
    assert found.jumps[0] / BEAM.drive.volts(BEAM.structure) == pytest.approx(1.5493, abs=1e-3)


def test_a_motor_without_folds():
    """A steep torque line: the speed goes through the resonance there and back."""
    resistance = QUICK.drive.armature_resistance / 20.0
    strong = QUICK._replace(drive=QUICK.drive.replace(armature_resistance=resistance))
    found = run(strong.as_bonded(), (1.25, 1.45), 4e-4)
    assert np.isnan(found.jumps).all() and np.isnan(found.averaged_jumps).all()
    assert all("follows the voltage" in text for text in found.no_jump.values)


def wandering(size, seed):
    """A ramp whose speed follows the voltage and wanders by ``size`` for 250/omega each time."""
    rng, rate, b = np.random.default_rng(seed), 2e-5, 0.03
    time = np.arange(0.0, 2e4, 5.0)
    eta0 = 1.3 + rate * time
    speed, torque, speeds, level = 1.25, 0.05, [], 0.0
    for i, voltage in enumerate(eta0):
        if i % 50 == 0:
            level = size * rng.normal()
        torque += 5.0 * 0.02 * (0.05 + level - torque)
        speed += 5.0 * b * (voltage - torque - speed)
        speeds.append(speed)
    return SweepLeg(time, eta0, np.array(speeds)), b


@pytest.mark.parametrize("seed", range(40))
def test_a_speed_that_wanders_by_itself_makes_no_sure_jump(seed):
    leg, b = wandering(0.02, seed)
    found = find_passing(leg, b, up=True, threshold=1.45)
    assert found is None or found.look != JUMP


@pytest.mark.slow
def test_a_ramp_too_fast_to_tell():
    """The record shows no jump, the theory a fold: held voltages decide."""
    found = run(QUICK.as_bonded(), (1.5, 1.75), 2e-3, back=False, step=0.4)
    up = found.sel(jump="up")
    assert up.decided == "by held voltages" and up.no_jump == ""
    assert up.held_jumps == pytest.approx(1.58310, abs=1.5e-4)


def test_a_spin_up_that_ends_beyond_the_resonance():
    """Too fast a one, near the fold: no jump of the ramp that follows is made of it."""
    asked = {"settle": 150.0, "spin_up": 300.0, "back": False, "step": 0.4}
    found = run(BEAM.as_bonded(), (1.53, 1.55), 2e-5, **asked)
    assert found.speed.max() > 1.4 * BEAM.structure.omega
    assert np.isnan(found.jumps).all()
    assert "began beyond" in str(found.no_jump.values[0])


def test_what_the_averaged_theory_loses_first():
    """The upper branch of `beam` by a Neimark-Sacker point, that of `quick` by its fold."""
    beam, quick = (averaged.stability_limits(*one.as_bonded()) for one in (BEAM, QUICK))
    assert [place.kind for place in (*beam, *quick)] == ["fold", "Neimark-Sacker", "fold", "fold"]
    assert beam[1].eta0 == pytest.approx(1.3731, abs=1e-4)
    assert quick[1].eta0 == pytest.approx(1.43568, abs=1e-5)


@pytest.mark.slow
def test_a_steep_motor_with_folds():
    """A quick rotor follows the vibration: its inertia takes little torque, though it jumps."""
    stronger = {"b": (0.02, 0.5), "epsilon": (1e-4, 2e-3)}
    steep = random_sets(15, 17, stronger)[1].as_bonded()
    volts = steep.drive.volts(steep.structure)
    ends = averaged.folds(*steep)
    asked = {"speed_start": 1.3, "settle": 200.0, "step": None}
    found = run(steep, (1.40, 1.60), 1e-4, **asked)
    assert found.decided.values.tolist() == ["by held voltages"] * 2
    expected = [ends[0].eta0, ends[-1].eta0]
    assert found.held_jumps.values / volts == pytest.approx(expected, abs=5e-4)
    assert np.isfinite(found.jumps).all()


def way(speed, rate):
    """A ramp from 1.2 to 1.6 and the speed over its voltage, a revolution each 5/omega."""
    time = np.arange(0.0, 0.4 / rate, 5.0)
    eta0 = 1.2 + rate * time
    return SweepLeg(time, eta0, speed(eta0, time))


@pytest.mark.parametrize("up", [True, False])
def test_where_folds_are_close_the_slip_is_large_on_both_sides(up):
    """What it crosses rises without a step, from half of its largest value to all of that."""
    beyond, rows = np.linspace(0.0, 0.99, 100), []
    for least in beyond:
        slip = np.interp(np.arange(60.0), [20.0, 40.0], [least, 1.0])
        row = half_slip_row(slip[::-1] if up else slip, 10, 50, up)
        rows.append(59.0 - row if up else row)
    crossed = beyond + (1.0 - beyond) * (np.array(rows) - 20.0) / 20.0
    assert crossed == pytest.approx(np.maximum(0.5, 0.3 + 0.7 * beyond))


@pytest.mark.parametrize("rate", [1e-4, 1e-5])
def test_a_fast_change_is_a_jump_at_every_rate(rate):
    """Slip grows to the fold at 1.5, where the rotor is set free."""

    def speed(eta0, time):
        free = np.maximum(time - 0.3 / rate, 0.0)
        return eta0 - 0.6 * (eta0 - 1.2) * np.exp(-0.02 * free)

    jump = find_passing(way(speed, rate), 0.02, up=True, threshold=1.4)
    assert jump.look == JUMP
    assert way(speed, rate).eta0[jump.row] == pytest.approx(1.5 + 35.0 * rate, abs=10 * rate)


def test_the_comings_and_goings_of_an_irregular_motion_make_no_jump():
    """The same change, among others nearly as large."""

    def speed(eta0, time):
        free = np.maximum(time - 3000.0, 0.0)
        regular = eta0 - 0.6 * (eta0 - 1.2) * np.exp(-0.02 * free)
        return regular + 0.05 * np.sin(2.0 * np.pi * time / 55.0) * (np.abs(free - 150.0) > 150.0)

    irregular = way(speed, 1e-4)
    assert find_passing(irregular, 0.02, up=True, threshold=1.4).look == DOUBTFUL
    unclear = Criterion(clearness=0.0)
    assert find_passing(irregular, 0.02, up=True, threshold=1.4, criterion=unclear).look == JUMP


@pytest.mark.parametrize("rate", [3e-5, 1e-5])
def test_a_steep_branch_is_no_jump(rate):
    """Five times as steep as the voltage, but in the ramp's own time."""

    def speed(eta0, time):
        return eta0 - 0.6 * np.clip(eta0 - 1.2, 0.0, 0.3) + np.clip(4.0 * (eta0 - 1.5), 0.0, 0.18)

    assert find_passing(way(speed, rate), 0.02, up=True, threshold=1.4).look == DOUBTFUL


def test_steps_of_the_voltage_are_no_jumps():
    """The speed follows each step in the rotor's own time, but no further than the step."""
    time = np.arange(0.0, 4000.0, 5.0)
    count, since = np.floor(time / 200.0), time % 200.0
    speed = 1.2 + 0.02 * (count - np.exp(-0.02 * since))
    steps = SweepLeg(time, 1.2 + 0.02 * count, speed)
    assert find_passing(steps, 0.02, up=True, threshold=1.4).look == SMOOTH
