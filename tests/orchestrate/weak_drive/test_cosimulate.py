"""Somebody else's drive, coupled: against both as one system, and connections that cannot be."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import orchestrate
from orchestrate.errors import FmuError, InputError
from orchestrate.fmu.description import describe
from orchestrate.weak_drive import cosimulate
from orchestrate.weak_drive.connection import proposals

from ...sparing import ordinary
from .drives import table
from .drives.linear import draw, sine, table_drive, together

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
FINEST = {"estimate": False, "connect": {**CONNECT, "box_velocity": "table_vel"}}
MEANT = {"force_sign": "given"}


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """The FMU of somebody else, by pythonfmu."""
    from pythonfmu import FmuBuilder

    folder = tmp_path_factory.mktemp("drive")
    return FmuBuilder.build_FMU(table.__file__, dest=folder)


@pytest.fixture(scope="module")
def truth():
    return together(table_drive(table.NUMBERS), STRUCTURE, sine(), TIMES)


def error(run, truth):
    """Largest error of both displacements at the times of the truth, m."""
    every = (run.sizes["time"] - 1) // (len(TIMES) - 1)
    both = np.column_stack([run.x1.values, run.x2.values])[::every]
    return np.abs(both - truth).max()


@pytest.mark.usefixtures("exported")
def test_halves_that_strike_at_both_ends_of_a_play(drive):
    structure = STRUCTURE.replace(clearance=0.004, stroke=0.015)
    positions, impacts = together(table_drive(table.NUMBERS), structure, sine(), TIMES)
    run = {**RUN, "connect": CONNECTIONS["both"]}
    coarse, fine = (orchestrate.cosimulate(structure, drive, step=h, **run) for h in (0.01, 0.005))
    assert error(fine, positions) < 1e-4 * np.abs(positions).max()
    assert error(coarse, positions) / error(fine, positions) > 8.0
    assert coarse.sizes["impact"] == fine.sizes["impact"] == impacts > 40
    assert fine.x_rel.max() > 0.99 * structure.stroke
    with pytest.raises(InputError, match="wall = True: cosimulate does not know it yet"):
        orchestrate.cosimulate(structure.replace(wall=True), drive, step=0.01, **run)


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize(
    ("name", "most", "ratio"),
    [
        ("acceleration", 0.07, 3.5),  # it does not tell what the coil does within a step
        ("velocity", 0.005, 10.0),
        ("position", 0.04, 6.0),
        ("both", 0.003, 10.0),
    ],
)
def test_errors_under_a_sine_of_the_voltage_fall_with_the_step(drive, truth, name, most, ratio):
    """The voltage is held over each step, by its mean and what makes up for its first moment."""
    run = {**RUN, "connect": CONNECTIONS[name]}
    coarse, fine = (orchestrate.cosimulate(STRUCTURE, drive, step=h, **run) for h in (0.02, 0.01))
    assert error(coarse, truth[0]) < most * np.abs(truth[0]).max()
    assert error(coarse, truth[0]) / error(fine, truth[0]) > ratio
    assert coarse.sizes["impact"] == fine.sizes["impact"] == truth[1] > 10


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize("seed", ordinary(range(20), 3))
def test_random_drives_against_one_system(tmp_path, seed):
    """Native ones of FMI 3.0, of any names and signs; every second without feedthrough."""
    drive = draw(seed)
    path = drive.write(tmp_path)
    run = {**RUN, "inputs": {drive.names[1]: RUN["inputs"]["volts"]}, "connect": drive.connect}
    run |= {"parameters": drive.parameters}
    expected, impacts = together(drive, STRUCTURE, sine(), TIMES)
    coarse, fine = (orchestrate.cosimulate(STRUCTURE, path, step=h, **run) for h in (5e-3, 2.5e-3))
    one, other = error(coarse, expected), error(fine, expected)
    assert other < 0.01 * np.abs(expected).max() and one / other > 3.0
    assert coarse.attrs["resumable"].startswith("yes" if drive.has_states else "no")
    assert coarse.sizes["impact"] == fine.sizes["impact"] == impacts


@pytest.mark.usefixtures("exported")
def test_a_jump_of_the_command_that_is_felt_at_once_is_none_of_the_motion(tmp_path):
    """A drive whose acceleration has the command in it, which jumps: errors fall as without."""
    plain = draw(0)
    felt = np.array([plain.d[0], 0.2])
    b = plain.b.copy()
    b[1] = felt
    drive = replace(plain, b=b, d=felt)
    steps = np.arange(0.0, DURATION, 0.1)
    levels = 20.0 * np.sin(26.0 * steps)
    course = np.repeat(steps, 2)[1:], np.repeat(levels, 2)[:-1]
    command = lambda t: levels[min(int(t / 0.1 + 1e-9), len(levels) - 1)]  # noqa: E731
    expected, impacts = together(drive, STRUCTURE, command, TIMES)
    run = {**RUN, "inputs": {drive.names[1]: course}, "parameters": drive.parameters}
    run, path = run | {"connect": drive.connect}, drive.write(tmp_path)
    coarse, fine = (orchestrate.cosimulate(STRUCTURE, path, step=h, **run) for h in (5e-3, 2.5e-3))
    one, other = error(coarse, expected), error(fine, expected)
    assert other < 0.01 * np.abs(expected).max() and one / other > 3.0
    assert coarse.sizes["impact"] == fine.sizes["impact"] == impacts > 10


@pytest.mark.usefixtures("exported")
def test_the_stated_error_is_that_of_the_run(drive, truth):
    run = {**RUN, "connect": CONNECT, "estimate": True, "record": ["table_pos", "amperes"]}
    found = orchestrate.cosimulate(STRUCTURE, drive, step=0.01, **run)
    true, stated = error(found, truth[0]), float(found.coupling_error.max())
    assert 0.5 * true < stated < 2.0 * true
    assert {"table_pos", "amperes", "box_force", "impact_energy"} <= set(found.data_vars)
    exact = orchestrate.cosimulate(STRUCTURE, drive, step=0.001, **{**run, **FINEST})
    for name in ("table_pos", "amperes"):
        true = np.abs(found[name].values - exact[name].values[::10]).max()
        assert 0.5 * true < float(found[f"{name}_error"].max()) < 2.0 * true
    assert "box_work" not in found  # no velocity is connected
    assert found.impact_energy[-1] > 0.0


@pytest.mark.usefixtures("exported")
def test_a_sign_and_two_runs_with_the_same_bits(drive):
    run = {**RUN, "duration": 0.4, "step": 0.01}
    twice = [orchestrate.cosimulate(STRUCTURE, drive, connect=CONNECT, **run) for _ in range(2)]
    assert twice[0].x1.values.tobytes() == twice[1].x1.values.tobytes()
    other = orchestrate.cosimulate(
        STRUCTURE, drive, connect={**CONNECT, "box_force": "-specimen_force"}, **run, **MEANT
    )
    assert np.abs(other.x1 - twice[0].x1).max() > 1e-4


BEAM = tuple(kind.from_file("beam") for kind in (orchestrate.Structure, orchestrate.Drive))
MOTOR = {"inputs": {"voltage": 4.0}, "parameters": {"speed_start": 60.0}, "progress": False}


@pytest.mark.usefixtures("exported")
def test_points_between_communication_points_are_on_the_same_motion():
    """The same bits where both have them, and the equation of motion between."""
    run = {"step": 0.004, "duration": 0.2, "record": ["speed"], **MOTOR}
    coarse, fine = (orchestrate.cosimulate(*BEAM, points=n, **run) for n in (1, 8))
    for name in ("x1", "box_force", "box_acceleration", "coupling_error"):
        assert fine[name][::8].values.tobytes() == coarse[name].values.tobytes(), name
    for name in ("speed", "box_work"):
        assert fine[name].dims == ("step_time",)
        assert fine[name].values.tobytes() == coarse[name].values.tobytes()
    s, h = BEAM[0], float(fine.time[1])
    force = s.k1 * fine.x1 + s.d1 * fine.v1 + s.k2 * fine.x2 + s.d2 * fine.v2
    assert force.values == pytest.approx(fine.box_force.values, abs=1e-9)
    momentum = s.m1 * fine.v1 + s.m2 * fine.v2  # through impacts: of both masses
    pushes = -fine.box_force - (s.m1 + s.m2) * fine.box_acceleration
    simpson = h / 3.0 * (pushes[:-2:2].values + 4.0 * pushes[1::2].values + pushes[2::2].values)
    change = np.diff(momentum[::2].values)
    assert change == pytest.approx(simpson, abs=1e-3 * np.abs(change).max())
    assert orchestrate.plot(fine)


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
@pytest.mark.parametrize("kinks", [False, True])
def test_a_course_is_a_cubic_for_a_shaker_that_takes_one(exported, kinks):
    """Of fourth order, also with kinks within the steps, as in the recorded current."""
    shaker, times = orchestrate.Shaker.from_file("shaker_100N"), FINE[:: 70 if kinks else 1]
    run = {"duration": 0.4, "progress": False, "estimate": False, "record": ["current"]}
    run |= {"inputs": {"command": (times, 4.0 * np.sin(60.0 * times))}}
    runs = [orchestrate.cosimulate(STRUCTURE, shaker, step=4e-3 / 2**i, **run) for i in range(4)]
    for name, least in (("x1", 40.0), ("current", 10.0)):
        values = [one[name].values[:: 2**i] for i, one in enumerate(runs)]
        first, _, last = (np.abs(a - b).max() for a, b in zip(values, values[1:], strict=False))
        assert first < 1e-3 * np.abs(values[0]).max() and first / last > least


@pytest.mark.parametrize("seed", range(3))
def test_means_and_moments_of_a_course_are_exact(seed):
    """With jumps, kinks within steps, and held after its end; a constant's are its bits."""
    rng = np.random.default_rng(seed)
    times = np.sort(np.append(0.0, rng.uniform(0.0, 1.0, 7)))
    times[4] = times[3]  # a jump
    course = orchestrate.Course(tuple(times), tuple(rng.normal(size=8)))
    edges = np.sort(np.append(0.0, rng.uniform(0.0, 1.3, 6)))
    first, last, means, moments = course.over_steps(edges)
    for i, (t0, t1) in enumerate(zip(edges, edges[1:], strict=False)):
        fine = np.linspace(t0, t1, 50_001)
        middles = 0.5 * (fine[1:] + fine[:-1])
        values = np.array([course.voltage(time) for time in middles])
        assert means[i] == pytest.approx(values.mean(), abs=1e-4)
        moment = ((middles - 0.5 * (t0 + t1)) * values).mean() * (t1 - t0)
        assert moments[i] == pytest.approx(moment, abs=1e-5)
        assert first[i] == pytest.approx(course.voltage(t0), abs=1e-12)
        assert last[i] == pytest.approx(course.voltage(t1 - 1e-12), abs=1e-9)
    constant = orchestrate.Course((0.0, 1.0), (0.1, 0.1)).over_steps(edges)
    assert all((part == 0.1).all() for part in constant[:3]) and not constant[3].any()


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
    assert job.progress_note(0) == "run (not resumable)"


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


@pytest.mark.usefixtures("exported")
def test_a_drive_runs_without_a_structure(drive):
    """Against its own exponential under a constant voltage; with a picture, and no structure."""
    run = {**RUN, "inputs": {"volts": 3.0}, "duration": 0.5, "step": 0.01, "record": ["table_pos"]}
    motion = {"box_acceleration": "table_acc"}
    found = orchestrate.cosimulate(None, drive, connect=motion, **run)
    own = table_drive(table.NUMBERS)
    inverse = np.linalg.inv(own.a[:3, :3])
    settled = -inverse @ own.b[:3, 1] * 3.0
    expected = [(settled - expm(own.a[:3, :3] * t) @ settled)[0] for t in found.time.values]
    assert found.table_pos.values == pytest.approx(expected, abs=1e-12)
    assert set(found.data_vars) == {"box_acceleration", "table_pos"} and orchestrate.plot(found)
    motor = orchestrate.Drive.from_file("beam")
    alone = orchestrate.cosimulate(None, motor, duration=0.1, step=0.01, record=["speed"], **MOTOR)
    assert 60.0 < alone.speed[-1] < 66.0
    with pytest.raises(InputError, match="box_force has no structure that exerts it; leave it out"):
        orchestrate.cosimulate(None, drive, connect=CONNECT, **run)


WRONG = {  # by Python alone: what a command line can have is tested there
    "no names": (["table_acc"], {}, "connect = "),
    "no number": (CONNECT, {"parameters": {"mass": math.nan}}, "mass = nan"),
    "no course": (CONNECT, {"inputs": {"volts": "loud"}}, "volts"),
    "no step": (CONNECT, {"step": "0.1"}, "step = 0.1 s"),
    "our own name": (CONNECT, {"record": ["x1"]}, "x1"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_connected_is_said_in_a_line(drive, name):
    connect, more, words = WRONG[name]
    with pytest.raises(InputError) as raised:
        orchestrate.cosimulate(STRUCTURE, drive, connect=connect, **{**RUN, "step": 0.01, **more})
    assert words in str(raised.value) and "\n" not in str(raised.value)


def test_what_is_proposed_has_the_causality_and_a_name_like_ours(drive):
    assert proposals(describe(drive)) == {
        **{"box_acceleration": "table_acc", "box_velocity": "table_vel"},
        **{"box_position": "table_pos", "box_force": "specimen_force"},
    }


@pytest.mark.usefixtures("exported")
def test_an_error_that_may_hide_impacts_gives_a_warning(drive):
    run = {**RUN, "duration": 0.5, "estimate": True, "step": 0.01}
    with pytest.warns(UserWarning, match="connect box_velocity, box_position"):
        orchestrate.cosimulate(STRUCTURE, drive, connect=CONNECT, **run)


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize("letters", ["a", "v", "p"])
def test_a_wrong_sign_of_the_force_is_an_error_unless_it_is_given(tmp_path, letters):
    drive = draw(4)
    path, connect = drive.write(tmp_path), drive.connected(letters)
    force = connect["box_force"]
    turned = force[1:] if force.startswith("-") else f"-{force}"
    run = {"duration": 0.02, "step": 0.01, "estimate": False, "progress": False}
    run |= {"parameters": drive.parameters, "connect": {**connect, "box_force": turned}}
    with pytest.raises(InputError, match=f"against the force; connect box_force={force}, or say"):
        orchestrate.cosimulate(STRUCTURE, path, **run)
    assert orchestrate.cosimulate(STRUCTURE, path, force_sign="given", **run).sizes["time"] == 3


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize("duration", [0.4, 8.0])  # to a force that is none, and to a refused step
def test_a_coupling_that_diverges_says_what_to_look_at(drive, tmp_path, duration):
    """By an acceleration in mm/s2 without a unit in compiled steps, by a sign in Python's."""
    one = draw(2)
    far = replace(one, c=1e3 * one.c, d=1e3 * one.d)
    turned = {**CONNECT, "box_force": "-specimen_force"}
    for path, connect, parameters, command, (unit, force) in (
        (far.write(tmp_path), one.connect, far.parameters, one.names[1], (one.names[2], "njnp4")),
        (drive, turned, {"mass": 0.005}, "volts", ("table_acc", "specimen_force")),
    ):
        run = {**RUN, "connect": connect, "inputs": {command: 3.0}, "duration": duration, **MEANT}
        with pytest.raises(FmuError) as raised:
            orchestrate.cosimulate(STRUCTURE, path, parameters=parameters, step=0.01, **run)
        words = rf"at t = [\d.]+ s \(box_force = .* N\): look at the unit of {unit} .*={force}; or"
        assert re.fullmatch(f"the coupling diverges {words} reduce the step", str(raised.value))
