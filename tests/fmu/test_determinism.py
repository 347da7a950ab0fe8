"""The same bits again, in two processes, and from a saved and restored state."""

import pytest

from .driver import run
from .programs.driver import harmonic, open_fmu

# In chaotic motion (1.13) a lost bit grows to a first digit within some 150 s; at 0.4 the masses
# stick for a while in each period.
CASES = {
    "chaotic": dict(harmonic(1.13), m2=1.25),
    "sticking": dict(harmonic(0.4), e=0.3),
    "irregular": dict(harmonic(2.9), e=0.2),
}


def moments(f):
    """A point of time in flight and one in contact, by name, from a first look at the motion."""
    found = {}
    while f.time < 60.0 and len(found) < 2:
        f.step(f.time + 2.0**-5)
        if f.time > 20.0:
            found.setdefault("contact" if f.one("in_contact") else "flight", f.time)
    return found


def test_two_processes(fmu, tmp_path):
    """And a state that was saved in this one goes on in another."""
    f = open_fmu(fmu).start(**harmonic(1.13)).step(77.0)
    data, expected = f.save()[0].hex(), f.step(2000.0).outputs()
    assert expected["impact_count"] > 300
    other = {"PYTHONHASHSEED": "7", "LC_ALL": "C"}
    found = run("runs.run_and_resume", fmu, data, cwd=tmp_path, env=other)
    assert found[0][0]["impact_count"] < found[1]["impact_count"] == expected["impact_count"]
    assert found[1] == expected and found[0][1] == expected["x1"]


@pytest.mark.parametrize("name", CASES)
def test_state_is_saved_and_restored_in_one_process(fmu, name):
    """Back and forth in flight and in contact, in this and in another instance, more than once."""
    values, end = CASES[name], 400.0
    lone = open_fmu(fmu).start(**values).step(end).motion()
    assert lone["impact_count"] > 50
    found = moments(open_fmu(fmu).start(**values))
    assert ("contact" in found) == (name != "chaotic")  # which has hardly any
    for moment in found.values():
        f = open_fmu(fmu).start(**values).step(moment)
        here, state, data = f.outputs(), f.call("getFMUState"), f.save()
        f.set(box_amplitude=123.0, box_acceleration=1.0).step(end)
        assert f.motion() != lone
        for _ in range(2):
            f.call("setFMUState", state)
            f.time = moment
            assert f.outputs() == here
            assert f.step(end).motion() == lone
        f.call("freeFMUState", state)
        assert f.restore(*data).step(end).motion() == lone
        g = open_fmu(fmu).restore(*data)  # not even initialised
        assert g.outputs() == here
        assert g.save() == data  # every hidden number
        assert g.at(moment + 7.0, end - 0.25, end).motion() == lone
        g = open_fmu(fmu).start(m1=7.0, bonded=True).step(3.0)
        assert g.restore(*data).step(end).motion() == lone


def test_state_is_saved_before_and_during_initialisation(fmu):
    """Start values, start time and the phase of the calling sequence belong to the state."""
    plain = open_fmu(fmu).start(5.0, x2_start=0.5, box_frequency=1.13).step(100.0).outputs()
    f = open_fmu(fmu).set(x2_start=0.5)
    early = f.save()
    f.enter(5.0)
    f.set(box_frequency=1.13).get("v1")
    late = f.save()
    f.leave()
    f.step(50.0)
    g = open_fmu(fmu).start(x2_start=3.0, m1=9.0).step(1.0).restore(late[0], 5.0)
    g.leave()
    assert g.step(100.0).outputs() == plain
    g.restore(early[0], 0.0)
    g.enter(5.0)
    g.set(box_frequency=1.13)
    g.leave()
    assert g.step(100.0).outputs() == plain
