"""The same bits again: two instances, two processes, a saved and restored state, the compiled
kernel and its Python source.
"""

import json
from textwrap import dedent

import pytest

from .driver import FMUS, run

# In chaotic motion (1.13) a lost bit grows to a first digit within some 150 s; at 0.4 the masses
# stick for a while in each period.
CASES = r"""
cases = {"chaotic": dict(harmonic(1.13), m2=1.25), "sticking": dict(harmonic(0.4), e=0.3), "irregular": dict(harmonic(2.9), e=0.2)}


def moments(f):
    '''A point of time in flight and one in contact, as (name, time), from a first look at the motion.'''
    found = {}
    while f.time < 60.0 and len(found) < 2:
        f.step(f.time + 2.0**-5)
        if f.time > 20.0:
            found.setdefault("contact" if f.get("in_contact")[0] else "flight", f.time)
    return found
"""

MAPS = r"""
def maps():
    return {line.split(None, 5)[5].strip() for line in Path("/proc/self/maps").read_text().splitlines() if "/" in line}
"""


def test_two_instances_side_by_side(fmu, tmp_path):
    """Stepped in turns, with other parameters in between, they do not touch each other."""
    script = r"""
    lone = open_fmu(PATH).start(**harmonic(1.13))
    expected = []
    for k in range(1, 1025):
        lone.step(k * 0.25)
        expected.append(lone.outputs())
    lone.free()
    one, two, other = open_fmu(PATH), open_fmu(PATH, name="two"), open_fmu(PATH, name="other")
    one.start(**harmonic(1.13))
    other.start(m1=2.0, m2=3.0, e=0.2)
    two.start(**harmonic(1.13))
    same = 0
    for k, row in enumerate(expected, 1):
        one.step(k * 0.25)
        other.step(k * 0.25)
        two.step(k * 0.25)
        same += one.outputs() == row == two.outputs() != other.outputs()
    other.free()
    one.step(300.0), two.step(300.0)
    answer([same, one.outputs() == two.outputs(), expected[-1]["impact_count"]])
    """
    same, end, impacts = run(script, fmu, cwd=tmp_path)
    assert same == 1024
    assert end
    assert impacts > 50


def test_two_processes(fmu, tmp_path):
    script = """
    f = open_fmu(PATH).start(**harmonic(1.13)).step(2000.0)
    answer(f.outputs())
    """
    first = run(script, fmu, cwd=tmp_path)
    assert first["impact_count"] > 300
    assert run(script, fmu, cwd=tmp_path, env={"PYTHONHASHSEED": "7", "LC_ALL": "C"}) == first


def test_state_is_saved_and_restored_in_one_process(fmu, tmp_path):
    """Back and forth in flight and in contact, in the same and in another instance, at several
    depths.
    """
    script = (
        CASES
        + r"""
seen = []
for name, values in cases.items():
    for where, moment in moments(open_fmu(PATH).start(**values)).items():
        f = open_fmu(PATH).start(**values).step(moment)
        here = f.outputs()
        state, data = f.call("getFMUState"), f.save()
        f.step(moment + 0.3)
        f.set(box_amplitude=123.0, box_acceleration=1.0)
        f.step(400.0)
        elsewhere = f.outputs()
        ends = []
        for _ in range(2):  # a state can be set more than once
            f.call("setFMUState", state)
            f.time = moment
            assert f.outputs() == here, (name, where)
            ends.append(f.step(400.0).outputs())
        ends.append(f.restore(*data).step(400.0).outputs())
        g = open_fmu(PATH).restore(*data)  # not even initialised
        assert g.outputs() == here
        ends.append(g.step(moment + 7.0).step(399.75).step(400.0).outputs(list(ends[0])))
        ends.append(open_fmu(PATH).start(m1=7.0, bonded=True).step(3.0).restore(*data).step(400.0).outputs())
        lone = open_fmu(PATH).start(**values).step(400.0).outputs()
        step_only = ("box_impulse", "box_impulse_moment", "x_rel_max")
        ends[3].update({n: ends[0][n] for n in step_only})
        lone.update({n: ends[0][n] for n in step_only})
        f.call("freeFMUState", state)
        seen.append([name, where, all(end == lone for end in ends), here != elsewhere != lone, lone["impact_count"]])
answer(seen)
"""
    )
    seen = run(script, fmu, cwd=tmp_path)
    assert {where for _, where, *_ in seen} == {"flight", "contact"}
    assert len(seen) == 5  # chaotic motion has hardly any contact
    for name, where, same, moved, impacts in seen:
        assert same, (name, where)
        assert moved, (name, where)
        assert impacts > 50


def test_state_is_saved_before_and_during_initialisation(fmu, tmp_path):
    """Start values, start time and the phase of the calling sequence belong to the state."""
    script = r"""
    plain = open_fmu(PATH).start(5.0, x2_start=0.5, box_frequency=1.13).step(100.0).outputs()
    f = open_fmu(PATH)
    f.set(x2_start=0.5)
    early = f.save()
    f.enter(5.0)
    f.set(box_frequency=1.13)
    f.get("v1")
    late = f.save()
    f.leave()
    f.step(50.0)
    g = open_fmu(PATH).start(x2_start=3.0, m1=9.0).step(1.0)
    g.restore(late[0], 5.0)
    g.leave()
    first = g.step(100.0).outputs()
    g.restore(early[0], 0.0)
    g.enter(5.0)
    g.set(box_frequency=1.13)
    g.leave()
    answer([plain, first, g.step(100.0).outputs()])
    """
    plain, late, early = run(script, fmu, cwd=tmp_path)
    assert late == plain
    assert early == plain


def test_state_goes_into_another_process(fmu, tmp_path):
    """Serialised here, deserialised there: as if the run had never stopped."""
    save = (
        CASES
        + r"""
saved = {}
for name, values in cases.items():
    for where, moment in moments(open_fmu(PATH).start(**values)).items():
        f = open_fmu(PATH).start(**values).step(moment)
        data, time = f.save()
        f.step(399.5).step(400.0)
        saved[name + where] = [data.hex(), time, f.outputs()]
answer(saved)
"""
    )
    resume = r"""
    saved = json.loads(Path("saved.json").read_text())
    answer({key: open_fmu(PATH).restore(bytes.fromhex(data), time).step(399.5).step(400.0).outputs() for key, (data, time, _) in saved.items()})
    """
    saved = run(save, fmu, cwd=tmp_path)
    assert len(saved) == 5
    (tmp_path / "saved.json").write_text(json.dumps(saved))
    resumed = run(resume, fmu, cwd=tmp_path)
    for key, (_, _, outputs) in saved.items():
        assert resumed[key] == outputs, key


@pytest.mark.parametrize("eta", [1.13, 2.9])
def test_compiled_kernel_gives_the_bits_of_its_source(tmp_path, eta):
    """Over more than a thousand impacts, all outputs; the libraries mapped into the process show
    that none is compared with itself.
    """
    script = r"""
    eta = float(sys.argv[2])
    f = open_fmu(PATH).start(**harmonic(eta), e=0.7, d1=0.01, d2=0.01)
    rows = [f.step(end).outputs() for end in (1.0, 100.0, 1000.0, 6000.0 / min(eta, 1.5))]
    answer([rows, any(Path(p).name.startswith("kernel-") for p in maps())])
    """
    compiled, loaded = run(MAPS + dedent(script), FMUS["fmi2-python"], eta, cwd=tmp_path)
    source, loaded_too = run(
        MAPS + dedent(script), FMUS["fmi2-python"], eta, cwd=tmp_path, pure=True
    )
    assert loaded and not loaded_too
    assert compiled[-1]["impact_count"] > 1000
    assert compiled == source


def test_compiled_state_continues_in_the_source(tmp_path):
    """A serialised state is the same numbers for both forms."""
    save = "f = open_fmu(PATH).start(**harmonic(1.13)).step(77.0); data, time = f.save(); answer([data.hex(), f.step(300.0).outputs()])"
    resume = (
        "answer(open_fmu(PATH).restore(bytes.fromhex(sys.argv[2]), 77.0).step(300.0).outputs())"
    )
    data, outputs = run(save, FMUS["fmi2-python"], cwd=tmp_path)
    assert run(resume, FMUS["fmi2-python"], data, cwd=tmp_path, pure=True) == outputs
