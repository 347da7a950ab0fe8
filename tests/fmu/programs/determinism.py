"""The same bits again: instances in turns, saved and restored states."""

from driver import compiled, harmonic, open_fmu

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
            found.setdefault("contact" if f.get("in_contact")[0] else "flight", f.time)
    return found


def two_instances_side_by_side(path):
    lone = open_fmu(path).start(**harmonic(1.13))
    expected = []
    for k in range(1, 1025):
        lone.step(k * 0.25)
        expected.append(lone.outputs())
    lone.free()
    one, two, other = open_fmu(path), open_fmu(path, name="two"), open_fmu(path, name="other")
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
    return [same, one.outputs() == two.outputs(), expected[-1]["impact_count"]]


def state_is_saved_and_restored_in_one_process(path):
    seen = []
    for name, values in CASES.items():
        for where, moment in moments(open_fmu(path).start(**values)).items():
            f = open_fmu(path).start(**values).step(moment)
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
            g = open_fmu(path).restore(*data)  # not even initialised
            assert g.outputs() == here
            ends.append(g.step(moment + 7.0).step(399.75).step(400.0).outputs(list(ends[0])))
            ends.append(
                open_fmu(path)
                .start(m1=7.0, bonded=True)
                .step(3.0)
                .restore(*data)
                .step(400.0)
                .outputs()
            )
            lone = open_fmu(path).start(**values).step(400.0).outputs()
            step_only = ("box_impulse", "box_impulse_moment", "x_rel_max", "evaluations")
            ends[3].update({n: ends[0][n] for n in step_only})
            lone.update({n: ends[0][n] for n in step_only})
            f.call("freeFMUState", state)
            seen.append(
                [
                    name,
                    where,
                    all(end == lone for end in ends),
                    here != elsewhere != lone,
                    lone["impact_count"],
                ]
            )
    return seen


def state_is_saved_before_and_during_initialisation(path):
    plain = open_fmu(path).start(5.0, x2_start=0.5, box_frequency=1.13).step(100.0).outputs()
    f = open_fmu(path)
    f.set(x2_start=0.5)
    early = f.save()
    f.enter(5.0)
    f.set(box_frequency=1.13)
    f.get("v1")
    late = f.save()
    f.leave()
    f.step(50.0)
    g = open_fmu(path).start(x2_start=3.0, m1=9.0).step(1.0)
    g.restore(late[0], 5.0)
    g.leave()
    first = g.step(100.0).outputs()
    g.restore(early[0], 0.0)
    g.enter(5.0)
    g.set(box_frequency=1.13)
    g.leave()
    return [plain, first, g.step(100.0).outputs()]


def state_goes_into_another_process_save(path):
    saved = {}
    for name, values in CASES.items():
        for where, moment in moments(open_fmu(path).start(**values)).items():
            f = open_fmu(path).start(**values).step(moment)
            data, time = f.save()
            f.step(399.5).step(400.0)
            saved[name + where] = [data.hex(), time, f.outputs()]
    return saved


def state_goes_into_another_process_resume(path, saved):
    return {
        key: open_fmu(path).restore(bytes.fromhex(data), time).step(399.5).step(400.0).outputs()
        for key, (data, time, _) in saved.items()
    }


def compiled_kernel_gives_the_bits_of_its_source(path, eta):
    f = open_fmu(path).start(**harmonic(eta), e=0.7, d1=0.01, d2=0.01)
    rows = [f.step(end).outputs() for end in (1.0, 100.0, 1000.0, 6000.0 / min(eta, 1.5))]
    return [rows, compiled()]


def compiled_state_continues_in_the_source_save(path):
    f = open_fmu(path).start(**harmonic(1.13)).step(77.0)
    data, _ = f.save()
    return [data.hex(), f.step(300.0).outputs()]


def compiled_state_continues_in_the_source_resume(path, data):
    return open_fmu(path).restore(bytes.fromhex(data), 77.0).step(300.0).outputs()
