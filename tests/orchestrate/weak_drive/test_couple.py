"""The Sommerfeld effect: jumps, the energy balance of a whole run, resuming, many runs at once."""

import math

import numpy as np
import pytest

from orchestrate import couple, couple_all, jump_voltages
from orchestrate.constants import TURN
from orchestrate.fmu import find_or_export
from orchestrate.weak_drive.averaged import folds
from orchestrate.weak_drive.connection import MOTOR
from orchestrate.weak_drive.couple import (
    VERDICT,
    make_couple_job,
    schedule_from_arguments,
    scheme_from_arguments,
)
from orchestrate.weak_drive.hysteresis import LOST, UNDECIDED, HysteresisSettings
from orchestrate.weak_drive.jump_voltages import JumpVoltagesJob
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.revolutions import Revolutions
from orchestrate.weak_drive.schedule import Ramp
from orchestrate.weak_drive.step_record import LEADING, Record

from .coupled import BEAM, QUICK, system_of

CLOSE = system_of(  # its folds, by its branch, at 1.13468 and 1.13041
    *(1.819477, 1.111004, 0.01933431, 0.04249591, 0.8220531),
    **{"beta": 0.1295615, "epsilon": 0.001822262, "b": 0.02891932},
    **{"Omega_b": 0.268049, "D_b": 0.005833275},
).as_bonded()
TAIL = system_of(  # two motions last at 1.638, of which the first is lost at 1.6415
    *(2.55983, 2.06781, 0.01518, 0.01881, 0.86764, 1.44925),
    **{"beta": 0.20942, "epsilon": 0.00099, "b": 0.01417, "Omega_b": 0.28779, "D_b": 0.04029},
)


def run(system, voltage, rate=None, **more):
    """A run by non-dimensional numbers: voltages over K omega, times in 1/omega."""
    structure, drive = system
    omega, volts = structure.omega, drive.volts(structure)
    for name in {"duration", "settle", "spin_up"} & more.keys():
        more[name] /= omega
    if "speed_start" in more:
        more["speed_start"] *= omega
    if rate is not None:
        more["rate"] = rate * volts * omega
    step = more.pop("step", 0.2)
    ends = np.multiply(voltage, volts).tolist()
    return couple(*system, voltage=ends, step=step and step / omega, progress=False, **more)


def test_a_run_up_begins_below_the_resonance():
    """So the same voltages show the jump; late, as the rate has it."""
    found = run(QUICK.as_bonded(), (1.45, 1.65), 1e-4, back=False)
    up = found.sel(jump="up")
    assert up.jumps == pytest.approx(1.58310, abs=1.5e-4)
    assert up.averaged_jumps == pytest.approx(1.58306, abs=1e-5)
    assert up.ramp_voltage == pytest.approx(1.606, abs=1e-3)
    assert up.jump_lag == pytest.approx(float(up.ramp_voltage - up.jumps), abs=1e-9)
    assert up.jump_rate == pytest.approx(1e-4, rel=1e-2)
    assert up.jump_speed_before == pytest.approx(1.335, abs=1e-2)
    assert up.jump_speed_after == pytest.approx(1.58, abs=1e-2)
    assert up.jump_amplitude_before > 17.0 > 6.0 > up.jump_amplitude_after
    assert up.no_jump == ""


def test_energy_balance_of_a_whole_run():
    """Up and down through both jumps: nothing is missing, and nothing is counted twice."""
    more = {"settle": 200.0, "speed_start": 1.26, "step": 0.1, "hold": 0.0}
    found = run(QUICK, (1.34, 1.68), 2e-4, **more)
    beyond = np.flatnonzero(np.diff(found.Omega.values > 1.36))
    up, down = found.eta0.values[beyond[[0, -1]]]
    assert 1.58 < up < 1.65 and 1.36 < down < 1.43
    assert found.decided.values.tolist() == ["undecided"] * 2  # no voltage is held
    end = found.isel(revolution=-1)
    assert abs(end.missing) < 1e-6 * end.motor and end.defect_sizes < 1e-6 * end.motor
    assert found.attrs["missing_over_motor_work"] == end.missing / end.motor
    assert min(end.dampers, end.box_damper, end.impact_loss) > 0.0


def test_each_of_many_runs_is_that_of_couple():
    """Two sets, two rates; the shorter runs end in NaN."""
    sets, few = {"one": tuple(QUICK), "other": tuple(BEAM)}, {"back": False, "progress": False}
    many = {"eta0": (1.1, 1.11), "rates": [4e-4, 8e-4], "kinds": ["delaminated"], "jobs": 2}
    whole = couple_all(sets, **many, **few)
    assert whole.sizes["run"] == 4 and sorted(set(whole.system.values)) == ["one", "other"]
    (row,) = np.flatnonzero(((whole.system == "other") & (whole.rate == 8e-4)).values)
    volts, omega = BEAM.drive.volts(BEAM.structure), BEAM.structure.omega
    ends, rate = (1.1 * volts, 1.11 * volts), 8e-4 * volts * omega
    single = couple(*BEAM, voltage=ends, rate=rate, **few)
    count = single.sizes["revolution"]
    for name in ("speed", "amplitude", "missing", "eta0"):
        assert np.array_equal(whole[name][row, :count], single[name]), name
    assert np.isnan(whole.speed[row, count:]).all()
    assert whole.speed.units == "rad/s" and whole.rate.units == "1"


def completed(time, angle, speed, impacts):
    """Where whole turns are new, one or more further from the last, to its side."""
    last, begin, before, found = 0, 0.0, 0.0, []
    for i, turns in enumerate((angle / TURN).tolist()):
        if abs(turns - last) >= 1.0:
            turn = math.floor(turns) if turns > last else math.ceil(turns)
            end = time[i] - (angle[i] - turn * TURN) / speed[i]
            found.append((i, end, (turn - last) * TURN / (end - begin), impacts[i] - before))
            last, begin, before = turn, end, impacts[i]
    return found


def test_revolutions_are_the_turns_that_are_new():
    """To and fro, across zero, several at once, exact ones, and over records that follow."""
    rng, names = np.random.default_rng(8), (*LEADING, *MOTOR.outputs)
    turns = np.concatenate([np.cumsum(rng.normal(0.0, 0.8, 400)), [-3.0, 2.0, -2.5, 0.0, 0.5]])
    count = len(turns)
    columns = {"time": np.arange(1.0, count + 1), "angle": TURN * turns}
    columns |= {"speed": rng.uniform(20.0, 30.0, count), "impacts": np.arange(count) // 3.0}
    table = np.zeros((len(names), count))
    table[[names.index(name) for name in columns]] = np.array(list(columns.values()))
    revolutions, found = Revolutions(QUICK.structure), []
    for ends in np.split(np.arange(count), [7, 100, 101]):
        found += revolutions.complete_revolutions(
            Record(names, table, ends, np.empty((0, 0)))
        ).tolist()
    expected = completed(*columns.values())
    assert len(found) > 100 and len({row[2] > 0.0 for row in found}) == 2
    assert [tuple(row) for row in found] == expected


def test_the_first_sure_jump_of_a_direction_comes_first():
    """Of made-up ones over a short run; further ones are numbered."""
    job = make_couple_job(*QUICK, Ramp(1.5, 1.6, 1e-2, back=False), Scheme(0.2), hold=0.0)
    table = job.run_all_chunks({model: find_or_export(model).path for model in job.models})
    ends = {1.50: UNDECIDED, 1.52: LOST, 1.55: LOST}
    jumps = [(True, (how, low, low + 1e-2, np.nan, np.nan)) for low, how in ends.items()]
    found = job.dataset({**table, "verdicts": np.array(jumps, VERDICT)})
    assert found.jump.values.tolist() == ["up", "down", "up 2", "up 3"]
    assert found.jump_low.values == pytest.approx([1.52, np.nan, 1.55, 1.50], nan_ok=True)
    assert found.decided.values[[0, 3]].tolist() == ["by held voltages", "undecided"]


@pytest.mark.slow
def test_quick():
    """Bonded at the averaged theory's folds, delaminated up and down at lower voltages."""
    rates = [2e-4, 1e-4, 5e-5]
    ends = {"voltage": (1.38, 1.64), "step": 0.2, "settle": 200.0, "progress": False}
    found = jump_voltages(*QUICK, rates=rates, **ends)
    up, down = folds(*QUICK.as_bonded())
    bonded, loose = (found.sel(structure=name) for name in ("bonded", "delaminated"))
    assert bonded.jumps.values == pytest.approx([up.eta0, down.eta0], abs=2e-4)
    assert loose.jumps.values == pytest.approx([1.56970, 1.43626], abs=1e-4)
    assert ((found.standard_error > 0.0) & (found.standard_error < 1.1e-4)).all()
    assert found.rate.values.tolist() == sorted(rates)
    assert (np.diff(bonded.voltage.sel(jump="up")) > 0.0).all()  # the faster the later


def test_over_a_parameter_the_bonded_structure_is_computed_once():
    ramps = tuple(
        schedule_from_arguments(*QUICK, (1.3, 1.6), None, r, None, 0.0, False) for r in (1, 2)
    )
    scheme = scheme_from_arguments(QUICK[0], 0.2)
    job = JumpVoltagesJob("x", *QUICK, ramps, scheme, "clearance", (0.0, 0.01))
    assert [one.bonded for one in job.items()] == [True, False, False]
    assert [one.clearance for one in job.items()[1:]] == [0.0, 0.01]
    jumps = np.arange(3.0)[:, None, None] + np.zeros((3, 3, 2))
    how, shown = np.full((3, 2), "by held voltages"), np.arange(24.0).reshape(3, 2, 2, 2)
    data = job.dataset({"jumps": jumps, "decided": how, "shown": shown})
    assert data.jumps.dims == ("structure", "clearance", "jump")
    assert data.jumps.sel(jump="up").values.tolist() == [[0.0, 0.0], [1.0, 2.0]]
    at = {"rate": 1, "jump": 0}
    assert data.voltage.isel(at).values.tolist() == [[4.0, 4.0], [12.0, 20.0]]


def bracket(found, system):
    """The bracket of each jump, over K omega, ascending."""
    volts = system.drive.volts(system.structure)
    return np.sort([found.jump_low.values / volts, found.jump_high.values / volts], axis=0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("system", "ends", "rate", "place", "width", "off"),
    [
        # a record does not tell it from a steep branch
        (CLOSE, (1.2, 1.08), 2e-4, 1.13041, 2.1e-4, 5e-5),
        # the Neimark-Sacker points: growth is seen in time from 1e-3 past them on
        (BEAM.as_bonded(), (1.40, 1.33), 1e-4, 1.37313, 4e-3, 0.0),
        (BEAM, (1.40, 1.33), 1e-4, 1.37007, 4e-3, 0.0),
    ],
)
def test_a_jump_down_where_the_branch_loses_stability(system, ends, rate, place, width, off):
    found = run(system, ends, rate, back=False, step=None).sel(jump="down")
    low, high = bracket(found, system)
    assert found.no_jump == "" and found.decided == "by held voltages"
    assert low - off < place < high + off and high - low < width


def test_what_has_not_settled_is_undecided():
    """And the answer says what helps."""
    more = {"settle": 100.0, "hold": 300.0 / CLOSE.structure.omega, "back": False, "step": None}
    found = run(CLOSE, (1.2, 1.08), 2e-4, **more).sel(jump="down")
    assert found.decided == "undecided" and np.isnan(found.jumps)
    assert "longer hold" in str(found.no_jump.item())


def test_a_ramp_that_ends_before_the_jump_shows():
    """Past the fold at 1.5831; the bracket is as wide as the settings say."""
    quick, settings = QUICK.as_bonded(), HysteresisSettings(width=2e-3)
    found = run(quick, (1.5, 1.59), 1e-4, back=False, step=None, hysteresis=settings)
    low, high = bracket(found.sel(jump="up"), quick)
    assert found.decided[0] == "by held voltages" and np.isnan(found.ramp_voltage[0])
    assert low < 1.5831 < high and 1e-3 < high - low < 4.1e-3


@pytest.mark.slow
def test_a_second_jump_in_the_tail_of_a_larger_one():
    """The record of the ramp shows one fall of the slip."""
    found = run(TAIL, (1.535, 1.665), 2.5e-5, back=False, step=None).sel(jump=["up", "up 2"])
    volts = TAIL.drive.volts(TAIL.structure)
    assert found.jumps.values / volts == pytest.approx([1.5436, 1.6415], abs=2e-4)


@pytest.mark.slow
def test_a_motor_that_turns_backward_has_the_mirrored_jump():
    quick = QUICK.as_bonded()
    found = run(quick, (-1.5, -1.65), 2e-4, back=False, step=None)
    volts = quick.drive.volts(quick.structure)
    assert float(found.jumps[0]) / volts == pytest.approx(-1.5831, abs=2e-4)
    assert float(found.averaged_jumps[0]) / volts == pytest.approx(-1.58306, abs=1e-5)
    assert float(found.ramp_voltage[0]) < float(found.jumps[0])
    assert found.jump_speed_before[0] < -1.3 and found.motor[-1] > 0.0
    assert found.sizes["revolution"] > 100
