"""Somebody else's drive, coupled: against both as one system, and connections that cannot be."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import orchestrate
from orchestrate.errors import InputError
from orchestrate.fmu.description import describe
from orchestrate.weak_drive import cosimulate
from orchestrate.weak_drive.connection import proposals
from orchestrate.weak_drive.polynomials import derivatives

from ...sparing import ordinary
from .drives import table

STRUCTURE = orchestrate.Structure(m1=0.5, m2=0.4, k1=300.0, k2=420.0, d1=0.4, d2=0.5, e=0.6)
CONNECT = {"box_acceleration": "table_acc", "box_force": "specimen_force"}
CONNECTIONS = {
    "acceleration": CONNECT,
    "velocity": {"box_velocity": "table_vel", "box_force": "specimen_force"},
    "position": {"box_position": "table_pos", "box_force": "specimen_force"},
    "both": {**CONNECT, "box_velocity": "table_vel"},
}
DURATION, EVERY = 2.0, 0.02
TIMES = np.linspace(0.0, DURATION, round(DURATION / EVERY) + 1)
FINE = np.linspace(0.0, DURATION, 20001)
RUN = {  # shaken close to the structure's own frequencies
    "inputs": {"volts": (FINE, 20.0 * np.sin(26.0 * FINE))},
    "duration": DURATION,
    "progress": False,
    "estimate": False,
}


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """The FMU of somebody else, by pythonfmu."""
    from pythonfmu import FmuBuilder

    folder = tmp_path_factory.mktemp("drive")
    return FmuBuilder.build_FMU(table.__file__, dest=folder)


def together(numbers=table.NUMBERS, structure=STRUCTURE):
    """Displacements of both masses, and the number of impacts, of structure and shaker as one."""
    s, n = structure, numbers

    def rates(time, state):
        x1, x2, v1, v2, y, w, i = state
        force = s.k1 * x1 + s.d1 * v1 + s.k2 * x2 + s.d2 * v2
        box = (n["bl"] * i - n["stiffness"] * y - n["damping"] * w + force) / n["mass"]
        a1 = -(s.k1 * x1 + s.d1 * v1) / s.m1 - box
        a2 = -(s.k2 * x2 + s.d2 * v2) / s.m2 - box
        current = (20.0 * math.sin(26.0 * time) - n["r"] * i - n["bl"] * w) / n["l"]
        return [v1, v2, a1, a2, w, box, current]

    def gap(time, state):
        return state[1] - state[0]

    gap.terminal, gap.direction = True, -1
    time, state, impacts, rows = 0.0, np.zeros(7), 0, {0.0: (0.0, 0.0)}
    # both masses are pressed together at first: they are let apart where they part, a step later
    state[1] = 1e-14
    while time < DURATION:
        ahead = TIMES[time + 1e-12 < TIMES]
        done = solve_ivp(
            rates,
            (time, DURATION),
            state,
            method="DOP853",
            rtol=1e-11,
            atol=1e-14,
            events=gap,
            t_eval=ahead,
            max_step=0.01,
        )
        rows |= dict(zip(np.round(done.t, 9), done.y[:2].T, strict=True))
        if not done.t_events[0].size:
            break
        time, state = done.t_events[0][0], done.y_events[0][0].copy()
        closing = state[2] - state[3]
        impulse = (1.0 + s.e) * s.m1 * s.m2 / (s.m1 + s.m2) * closing
        state[2] -= impulse / s.m1
        state[3] += impulse / s.m2
        state[1] = state[0] + 1e-15
        impacts += closing > 1e-9
    return np.array([rows[time] for time in np.round(TIMES, 9)]), impacts


@pytest.fixture(scope="module")
def truth():
    return together()


def error(run, truth):
    """Largest error of both displacements at the times of the truth, m."""
    every = (run.sizes["time"] - 1) // (len(TIMES) - 1)
    both = np.column_stack([run.x1.values, run.x2.values])[::every]
    return np.abs(both - truth).max()


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize("name", ordinary(CONNECTIONS, ["acceleration", "position"]))
def test_errors_fall_with_the_square_of_the_step(drive, truth, name):
    run = {**RUN, "connect": CONNECTIONS[name]}
    coarse, fine = (orchestrate.cosimulate(STRUCTURE, drive, step=h, **run) for h in (0.02, 0.01))
    size = np.abs(truth[0]).max()
    assert error(coarse, truth[0]) < 0.07 * size
    assert 3.0 < error(coarse, truth[0]) / error(fine, truth[0]) < 6.0
    assert coarse.sizes["impact"] == fine.sizes["impact"] == truth[1] > 10


@pytest.mark.usefixtures("exported")
def test_the_stated_error_is_that_of_the_run(drive, truth):
    run = {**RUN, "connect": CONNECT, "estimate": True, "record": ["table_pos", "amperes"]}
    found = orchestrate.cosimulate(STRUCTURE, drive, step=0.01, **run)
    true, stated = error(found, truth[0]), float(found.coupling_error.max())
    assert 0.5 * true < stated < 2.0 * true
    assert {"table_pos", "amperes", "box_force", "impact_energy"} <= set(found.data_vars)
    assert "box_work" not in found  # no velocity is connected
    assert found.impact_energy[-1] > 0.0


@pytest.mark.usefixtures("exported")
def test_a_sign_and_two_runs_with_the_same_bits(drive):
    run = {**RUN, "duration": 0.4, "step": 0.01}
    twice = [orchestrate.cosimulate(STRUCTURE, drive, connect=CONNECT, **run) for _ in range(2)]
    assert twice[0].x1.values.tobytes() == twice[1].x1.values.tobytes()
    other = orchestrate.cosimulate(
        STRUCTURE, drive, connect={**CONNECT, "box_force": "-specimen_force"}, **run
    )
    assert np.abs(other.x1 - twice[0].x1).max() > 1e-4


BEAM = tuple(kind.from_file("beam") for kind in (orchestrate.Structure, orchestrate.Drive))
MOTOR = {"inputs": {"voltage": 4.0}, "parameters": {"speed_start": 60.0}, "progress": False}


@pytest.mark.usefixtures("exported")
def test_our_own_drive_is_what_couple_has():
    """Of fourth order, compared with half the step; the error that is stated is that of couple."""
    runs = [
        orchestrate.cosimulate(*BEAM, step=h, duration=1.0, record=["speed"], **MOTOR)
        for h in (0.008, 0.004)
    ]
    coarse, fine = (float(run.coupling_error.max()) for run in runs)
    assert coarse / fine > 11.0
    other = orchestrate.couple(
        *BEAM, voltage=4.0, duration=1.0, speed_start=60.0, step=0.004, hold=0.0, progress=False
    )
    at = np.interp(other.time[5:], runs[1].time, runs[1].speed)
    assert other.speed[5:].values == pytest.approx(at, rel=0.02)


@pytest.mark.usefixtures("exported")
def test_a_run_resumes_from_the_states_of_both_fmus(monkeypatch):
    run = {"step": 0.004, "duration": 0.4, "record": ["speed"], **MOTOR}
    whole = orchestrate.cosimulate(*BEAM, **run)
    monkeypatch.setattr(cosimulate.CosimulateJob, "chunk_size", 30)
    parts = orchestrate.cosimulate(*BEAM, **run)
    assert whole.attrs["resumable"] == "yes"
    for name in ("x1", "speed", "coupling_error", "box_work", "box_acceleration"):
        assert parts[name].values.tobytes() == whole[name].values.tobytes(), name


@pytest.mark.usefixtures("exported")
def test_a_drive_without_states_is_said_to_begin_anew(drive, monkeypatch):
    monkeypatch.setattr(cosimulate.CosimulateJob, "chunk_size", 10)
    run = {**RUN, "duration": 0.4, "step": 0.01}
    found = orchestrate.cosimulate(STRUCTURE, drive, connect=CONNECT, **run)
    assert found.attrs["resumable"].startswith("no")
    job = cosimulate.CosimulateJob(
        **{"name": "run", "structure": STRUCTURE, "drive": str(drive), "drive_sha256": ""},
        **{"connect": (), "duration": 0.4, "step": 0.01},
    )
    assert [(chunk.start, chunk.stop) for chunk in job.chunks()] == [(0, 40), (40, 41)]
    assert "not resumable" in job.progress_note(0)


@pytest.mark.usefixtures("exported")
def test_an_electrodynamic_shaker_of_ours_is_coupled_with_its_limits(exported):
    shaker = orchestrate.Shaker.from_file("shaker_100N").replace(voltage_limit=2.0)
    run = {"duration": 0.5, "progress": False, "record": ["current", "voltage", "limited"]}
    command = {"command": (FINE, 4.0 * np.sin(60.0 * FINE))}
    errors = [
        orchestrate.cosimulate(STRUCTURE, shaker, inputs=command, step=h, **run)
        for h in (0.004, 0.002)
    ]
    assert float(abs(errors[0].voltage).max()) == pytest.approx(2.0)
    assert errors[0].limited.values.any() and not errors[0].limited.values.all()
    coarse, fine = (float(run.coupling_error.max()) for run in errors)
    assert fine < 0.4 * coarse


@pytest.mark.usefixtures("exported")
def test_a_level_is_held_on_a_drive_of_somebody_else(drive):
    """It takes the command without its derivatives: its mean over each step."""
    sine = orchestrate.SteppedSine(frequencies=(8.0,), acceleration=2.0, settle_cycles=60)
    control = orchestrate.LevelControl(sine=sine, start=1.0)
    run = {**RUN, "inputs": {"volts": control}, "duration": 8.0, "record": ["volts"]}
    found = orchestrate.cosimulate(STRUCTURE.as_bonded(), drive, connect=CONNECT, step=5e-3, **run)
    last = found.sel(time=slice(7.0, 8.0 - 1e-9))
    turns = np.exp(-1j * sine.phase(last.time.values))
    table, volts = (complex((last[n] * turns).mean()) for n in ("box_acceleration", "volts"))
    assert 2.0 * abs(table) == pytest.approx(2.0, rel=0.03)
    assert abs(volts) > 1.0 and np.isnan(found.control_aborted)


@pytest.mark.usefixtures("exported")
def test_the_work_on_the_drive_is_what_the_system_loses(exported):
    """Energy of the masses: what the box's motion puts in, less dampers and impacts."""
    structure = STRUCTURE.replace(d1=0.0, d2=0.0)
    motor = orchestrate.Drive.from_file("beam")
    run = orchestrate.cosimulate(
        structure,
        motor,
        inputs={"voltage": 4.0},
        parameters={"speed_start": 20.0},
        duration=1.0,
        step=0.002,
        record=["box_velocity"],
        progress=False,
        estimate=False,
    )
    s = structure
    springs = 0.5 * (s.k1 * run.x1**2 + s.k2 * run.x2**2)
    kinetic = 0.5 * (
        s.m1 * (run.v1 + run.box_velocity) ** 2 + s.m2 * (run.v2 + run.box_velocity) ** 2
    )
    balance = springs + kinetic + run.impact_energy + run.box_work
    assert run.sizes["impact"] > 3
    assert np.abs(balance).max() < 1e-4 * np.abs(run.box_work).max()


WRONG = {
    "nothing connected": ({}, {}, "box_force"),
    "no force": ({"box_acceleration": "table_acc"}, {}, "box_force"),
    "no motion": ({"box_force": "specimen_force"}, {}, "box_acceleration"),
    "our name": ({**CONNECT, "box_speed": "table_vel"}, {}, "box_speed"),
    "their name": ({**CONNECT, "box_force": "specimen_forse"}, {}, "did you mean specimen_force"),
    "an input as motion": ({**CONNECT, "box_acceleration": "volts"}, {}, "causality input"),
    "an output as force": ({**CONNECT, "box_force": "table_acc"}, {}, "causality output"),
    "no parameter": (CONNECT, {"parameters": {"masse": 3.0}}, "did you mean mass"),
    "no number": (CONNECT, {"parameters": {"mass": math.nan}}, "mass = nan"),
    "no input": (CONNECT, {"inputs": {"amperes": 1.0}}, "causality output"),
    "no course": (CONNECT, {"inputs": {"volts": "loud"}}, "volts"),
    "nothing recorded": (CONNECT, {"record": ["speed"]}, "speed"),
    "no step": (CONNECT, {"step": 0.0}, "step = 0.0 s"),
    "no duration": (CONNECT, {"duration": -1.0}, "duration = -1.0 s"),
    "no start": (CONNECT, {"start": (0.0, 1.0)}, "start"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_connected_is_said_in_a_line(drive, name):
    connect, more, words = WRONG[name]
    with pytest.raises(InputError) as raised:
        orchestrate.cosimulate(STRUCTURE, drive, connect=connect, **{**RUN, "step": 0.01, **more})
    assert words in str(raised.value) and "\n" not in str(raised.value)


def test_what_is_proposed_has_the_causality_and_a_name_like_ours(drive):
    found = proposals(describe(drive))
    assert found["box_force"][0] == "specimen_force"
    assert found["box_acceleration"][0] == "table_acc"


def test_derivatives_of_a_polynomial_through_points():
    times = [-0.3, -0.1, 0.0, 0.4]
    values = [2.0 - t + 3.0 * t**2 + 5.0 * t**3 for t in times]
    assert derivatives(times, values, 1) == pytest.approx((-1.0, 6.0))
    assert derivatives(times, values, 2) == pytest.approx((6.0, 30.0))
