"""Somebody else's drive, coupled: against both as one system, and connections that cannot be."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import orchestrate
from orchestrate.errors import FmuError, InputError
from orchestrate.fmu.description import describe
from orchestrate.weak_drive import connection, cosimulate

from ...sparing import ordinary
from .drives import table
from .drives.linear import displacement_error as error
from .drives.linear import draw, sine, table_drive, together

STRUCTURE = orchestrate.Structure(m1=0.5, m2=0.4, k1=300.0, k2=420.0, d1=0.4, d2=0.5, e=0.6)
PLAY = STRUCTURE.replace(clearance=0.004, stroke=0.015)
CONNECT = {"box_acceleration": "table_acc", "box_force": "specimen_force"}
BOTH = {**CONNECT, "box_velocity": "table_vel"}
DURATION, EVERY = 2.0, 0.02
TIMES = np.linspace(0.0, DURATION, round(DURATION / EVERY) + 1)
FINE = np.linspace(0.0, DURATION, 20001)
QUIET = {"progress": False, "estimate": False}
SINE = (FINE, 20.0 * np.sin(26.0 * FINE))  # close to the structure's own frequencies
RUN = {"inputs": {"volts": SINE}, "duration": DURATION, **QUIET}
BEAM = tuple(kind.from_file("beam") for kind in (orchestrate.Structure, orchestrate.Drive))
MOTOR = {"inputs": {"voltage": 4.0}, "parameters": {"speed_start": 60.0}, "progress": False}
pytestmark = pytest.mark.usefixtures("exported")


NAMES = ("specimen_force", "volts", "table_acc", "table_pos", "table_vel")
TABLE = replace(table_drive(table.NUMBERS), names=NAMES)


@pytest.fixture
def native(tmp_path, here):
    """The FMU of somebody else, in this process; it has no states."""
    return TABLE.write(tmp_path)


def test_errors_under_a_sine_of_the_voltage_fall_with_the_step(native):
    """It is held over each step, by its mean and what makes up for its first moment; halves strike
    at both ends of a play.
    """
    truth, impacts = together(TABLE, PLAY, sine(), TIMES)
    run = {**RUN, "connect": BOTH, "parameters": TABLE.parameters}
    coarse, fine = (orchestrate.cosimulate(PLAY, native, step=h, **run) for h in (0.01, 0.005))
    assert 8.0 * error(fine, truth) < error(coarse, truth) < 1e-3 * np.abs(truth).max()
    assert coarse.sizes["impact"] == fine.sizes["impact"] == impacts > 40
    assert fine.x_rel.max() > 0.99 * PLAY.stroke
    with pytest.raises(InputError, match="wall = True: cosimulate"):
        orchestrate.cosimulate(PLAY.replace(wall=True), native, step=0.01, **run)


def jumping(plain):
    """A drive whose acceleration has the command in it, which jumps, and such a command."""
    b, felt = plain.b.copy(), np.array([plain.d[0], 0.2])
    b[1] = felt
    steps = np.arange(0.0, DURATION, 0.1)
    levels = 20.0 * np.sin(26.0 * steps)
    command = lambda t: levels[min(int(t / 0.1 + 1e-9), len(levels) - 1)]  # noqa: E731
    course = np.repeat(steps, 2)[1:], np.repeat(levels, 2)[:-1]
    return replace(plain, b=b, d=felt), course, command


LETTERS = ("a", "av", "avp", "v", "p", "ap", "pv")


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("seed", ordinary([*range(20), "jumps"], [3, 4, "jumps"]))
def test_random_drives_against_one_system(tmp_path, seed):
    """Native ones of FMI 2.0 and 3.0, of any names and signs, connected by any motions; every
    second without feedthrough. What is stated is the error.
    """
    drive, course, command, letters = *jumping(draw(0)), "a"
    if seed != "jumps":
        drive, letters = replace(draw(seed), fmi=2 + seed // 2 % 2), LETTERS[seed % len(LETTERS)]
        course, command = RUN["inputs"]["volts"], sine()
    run = {**RUN, "inputs": {drive.names[1]: course}, "connect": drive.connected(letters)}
    run |= {"parameters": drive.parameters, "estimate": True}
    expected, impacts = together(drive, STRUCTURE, command, TIMES)
    path, errors = drive.write(tmp_path), []
    for step in (5e-3, 2.5e-3):
        found = orchestrate.cosimulate(STRUCTURE, path, step=step, **run)
        errors.append(error(found, expected))
        assert found.sizes["impact"] == impacts
    assert errors[1] < 0.01 * np.abs(expected).max() and errors[0] / errors[1] > 3.0
    assert 0.4 < errors[1] / float(found.coupling_error.max()) < 2.5
    assert found.attrs["resumable"].startswith("yes" if drive.has_states else "no")


def test_the_stated_error_is_that_of_the_run(native):
    """Of displacements and of what is recorded; where it may hide impacts it is a warning."""
    truth, _ = together(TABLE, STRUCTURE, sine(), TIMES)
    run = {**RUN, "estimate": True, "record": ["table_pos", "table_vel"]}
    run |= {"parameters": TABLE.parameters}
    with pytest.warns(UserWarning, match="connect box_velocity, box_position"):
        found = orchestrate.cosimulate(STRUCTURE, native, connect=CONNECT, step=0.01, **run)
    assert 0.5 < error(found, truth) / float(found.coupling_error.max()) < 2.0
    run |= {"estimate": False, "connect": BOTH}
    exact = orchestrate.cosimulate(STRUCTURE, native, step=0.001, **run)
    for name in ("table_pos", "table_vel"):
        true = np.abs(found[name].values - exact[name].values[::10]).max()
        assert 0.5 * true < float(found[f"{name}_error"].max()) < 2.0 * true
    assert "box_work" in exact and "box_work" not in found  # without a velocity
    assert found.impact_energy[-1] > 0.0


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


def test_our_own_drive_is_what_couple_has(monkeypatch):
    """Of fourth order, by half the step; resumed from the states of both FMUs; energy kept."""
    run = {"duration": 0.6, "record": ["speed", "box_velocity"], **MOTOR}
    coarse, fine = (orchestrate.cosimulate(*BEAM, step=h, **run) for h in (0.008, 0.004))
    assert float(coarse.coupling_error.max() / fine.coupling_error.max()) > 11.0
    alone = {"speed_start": 60.0, "hold": 0.0, "progress": False}
    other = orchestrate.couple(*BEAM, voltage=4.0, duration=0.6, step=0.004, **alone)
    at = np.interp(other.time[3:], fine.time, fine.speed)
    assert other.speed[3:].values == pytest.approx(at, rel=0.02)
    monkeypatch.setattr(cosimulate.CosimulateJob, "chunk_size", 30)
    parts = orchestrate.cosimulate(*BEAM, step=0.004, **run)
    assert fine.attrs["resumable"] == "yes"
    for name in ("x1", "speed", "coupling_error", "box_work", "box_acceleration"):
        assert parts[name].values.tobytes() == fine[name].values.tobytes(), name
    undamped = BEAM[0].replace(d1=0.0, d2=0.0)
    run = {**run, "duration": 1.0, "parameters": {"speed_start": 70.0}, "estimate": False}
    found, s = orchestrate.cosimulate(undamped, BEAM[1], step=0.002, **run), undamped
    kinetic = s.m1 * (found.v1 + found.box_velocity) ** 2
    kinetic = 0.5 * (kinetic + s.m2 * (found.v2 + found.box_velocity) ** 2)
    springs = 0.5 * (s.k1 * found.x1**2 + s.k2 * found.x2**2)
    balance = springs + kinetic + found.impact_energy + found.box_work
    assert found.sizes["impact"] > 3
    assert np.abs(balance).max() < 1e-4 * np.abs(found.box_work).max()


@pytest.mark.parametrize("kinks", [False, True])
def test_a_course_is_a_cubic_for_a_shaker_that_takes_one(kinks):
    """Of fourth order, also with kinks within the steps, as in the recorded current."""
    shaker, times = orchestrate.Shaker.from_file("shaker_100N"), FINE[:: 70 if kinks else 1]
    run = {"duration": 0.4, "record": ["current"], **QUIET}
    run |= {"inputs": {"command": (times, 4.0 * np.sin(60.0 * times))}}
    runs = [orchestrate.cosimulate(STRUCTURE, shaker, step=4e-3 / 2**i, **run) for i in range(4)]
    for name, least in (("x1", 40.0), ("current", 10.0)):
        values = [one[name].values[:: 2**i] for i, one in enumerate(runs)]
        first, _, last = (np.abs(a - b).max() for a, b in zip(values, values[1:], strict=False))
        assert first < 1e-3 * np.abs(values[0]).max() and first / last > least


def test_a_drive_without_states_is_said_to_begin_anew(native):
    job = cosimulate.CosimulateJob(
        **{"name": "run", "structure": STRUCTURE, "drive": str(native), "drive_sha256": ""},
        **{"connect": (), "duration": 0.4, "step": 0.01},
    )
    assert [(chunk.start, chunk.stop) for chunk in job.chunks()] == [(0, 40), (40, 41)]
    assert job.progress_note(0) == "run (not resumable)"


def test_a_level_is_held_on_a_drive_of_somebody_else(native):
    """It takes the command without its derivatives: its mean over each step."""
    sine = orchestrate.SteppedSine(frequencies=(8.0,), acceleration=2.0, settle_cycles=60)
    control = orchestrate.LevelControl(sine=sine, start=1.0)
    run = {**RUN, "inputs": {"volts": control}, "duration": 8.0, "record": ["volts"]}
    run |= {"parameters": TABLE.parameters}
    found = orchestrate.cosimulate(STRUCTURE.as_bonded(), native, connect=CONNECT, step=5e-3, **run)
    last = found.sel(time=slice(7.0, 8.0 - 1e-9))
    turns = np.exp(-1j * sine.phase(last.time.values))
    table, volts = (complex((last[n] * turns).mean()) for n in ("box_acceleration", "volts"))
    assert 2.0 * abs(table) == pytest.approx(2.0, rel=0.03)
    assert abs(volts) > 1.0 and np.isnan(found.control_aborted)


def test_a_drive_runs_without_a_structure(native):
    """Against its own exponential under a constant voltage; with a picture, and no structure."""
    run = {**RUN, "inputs": {"volts": 3.0}, "duration": 0.5, "step": 0.01, "record": ["table_pos"]}
    run, a = {**run, "parameters": TABLE.parameters}, TABLE.a[:3, :3]
    found = orchestrate.cosimulate(None, native, connect={"box_acceleration": "table_acc"}, **run)
    settled = -np.linalg.inv(a) @ TABLE.b[:3, 1] * 3.0
    expected = [(settled - expm(a * t) @ settled)[0] for t in found.time.values]
    assert found.table_pos.values == pytest.approx(expected, abs=1e-12)
    assert set(found.data_vars) == {"box_acceleration", "table_pos"} and orchestrate.plot(found)
    with pytest.raises(InputError, match="box_force has no structure"):
        orchestrate.cosimulate(None, native, connect=CONNECT, **run)


def test_what_is_proposed_has_the_causality_and_a_name_like_ours(native):
    names = {"box_acceleration": "table_acc", "box_velocity": "table_vel"}
    names |= {"box_position": "table_pos", "box_force": "specimen_force"}
    assert connection.propose_connections(describe(native)) == names
    assert [connection.EXPONENTS[name]["s"] for name in connection.FORCE] == [-2, -3, -4, -5]
    links = {name: connection.Link("push", 1.0) for name in ("force2", "box_force")}
    assert connection.Connection(links).connected_pushes == ("force2",)


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("letters", ["a", "v", "p"])
def test_a_wrong_sign_of_the_force_is_an_error_unless_it_is_given(tmp_path, letters):
    drive = draw(4)
    path, connect = drive.write(tmp_path), drive.connected(letters)
    force = connect["box_force"]
    turned = force[1:] if force.startswith("-") else f"-{force}"
    run = {"duration": 0.02, "step": 0.01, **QUIET}
    run |= {"parameters": drive.parameters, "connect": {**connect, "box_force": turned}}
    with pytest.raises(InputError, match=f"against the force; connect box_force={force}, or say"):
        orchestrate.cosimulate(STRUCTURE, path, **run)
    assert orchestrate.cosimulate(STRUCTURE, path, force_sign="given", **run).sizes["time"] == 3


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("duration", [0.4, 8.0])  # to a force that is none, and to a refused step
def test_a_coupling_that_diverges_says_what_to_look_at(tmp_path, duration):
    """By an acceleration in mm/s2 without a unit."""
    one = draw(2)
    far = replace(one, c=1e3 * one.c, d=1e3 * one.d)
    run = {"connect": one.connect, "parameters": far.parameters, "force_sign": "given", **QUIET}
    run |= {"inputs": {one.names[1]: 3.0}, "duration": duration}
    words = rf"at t = [\d.]+ s \(box_force = .* N\): look at the unit of {one.names[2]} .*"
    with pytest.raises(FmuError, match=f"^the coupling diverges {words}"):
        orchestrate.cosimulate(STRUCTURE, far.write(tmp_path), step=0.01, **run)
