"""Ranges of ``modelDescription.xml`` hold in the FMU, and a refused call changes nothing."""

import math

import pytest

from .driver import FMUS, run, run_with_output

RANGES = r"""
tried, missed, kept = 0, [], []


def try_all(f, settable):
    global tried
    for v in f.variables.values():
        if v.type not in ("Real", "Float64") or not settable(v):
            continue
        low, high = float(v.min), float(v.max)
        before = f.get(v.name)
        for value in (math.nan, math.inf, -math.inf, math.nextafter(low, -math.inf), math.nextafter(high, math.inf)):
            tried += 1
            try:
                f.set(**{v.name: value})
                missed.append([v.name, value, "accepted"])
            except Refused as refused:
                text = "\n".join(refused.messages)
                told = re.search(rf"\b{v.name} = (\S+?):? ", text)
                if not told or float(told[1]).hex() != value.hex():
                    missed.append([v.name, value, text])
                missed.extend([v.name, value, part] for part in (repr(low), repr(high)) if part not in text)
        if f.get(v.name) != before:
            kept.append(v.name)
        for value in (low, high):
            f.set(**{v.name: value})  # the ends belong to the range
        f.set(**{v.name: before[0]})


f = open_fmu(PATH)
f.enter()
try_all(f, lambda v: v.causality in ("parameter", "input"))
f.leave()
f.step(1.0)
try_all(f, lambda v: v.causality == "input" or v.variability == "tunable")
f.step(50.0)
plain = open_fmu(PATH).start().step(1.0).step(50.0)
answer([tried, missed, kept, f.outputs() == plain.outputs()])
"""


def test_every_range_holds(fmu, tmp_path):
    """NaN, infinities and the numbers next to the ends are refused, the ends themselves are not;
    before and after initialisation.
    """
    tried, missed, kept, same = run(RANGES, fmu, cwd=tmp_path)
    assert tried >= 5 * (18 + 6)
    assert missed == []
    assert kept == []
    assert same


def test_a_refused_set_sets_nothing(fmu, tmp_path):
    """One bad value in a list: the good ones before and after it are not taken over either."""
    script = r"""
    f = open_fmu(PATH)
    f.enter()
    references = [f.variables[name].valueReference for name in ("m1", "k1", "m2")]
    try:
        f.call("set" + f.variables["m1"].type, references, [2.0, math.nan, 3.0])
    except Refused:
        answer(f.get("m1", "k1", "m2"))
    """
    assert run(script, fmu, cwd=tmp_path) == [1.0, 1.0, 1.0]


def test_a_refused_step_leaves_the_instance_where_it_was(fmu, tmp_path):
    """After a step that cannot be done the run goes on with the bits it would have had."""
    script = r"""
    def run(spoil):
        f = open_fmu(PATH).start(d1=0.0, x2_start=0.25, box_frequency=1.13).step(30.0)
        before, refusals = f.outputs(), 0
        if spoil:
            f.set(box_frequency=1.0)
            for target in (31.0, 30.5):
                try:
                    f.step(target)
                except Refused:
                    refusals += 1
            for point, size in ((30.0, -1.0), (30.0, math.nan), (12.0, 1.0)):
                try:
                    f.call("doStep", currentCommunicationPoint=point, communicationStepSize=size)
                except Refused:
                    refusals += 1
            f.set(box_frequency=1.13)
        return refusals, f.outputs() == before, f.step(90.0).outputs()

    answer([run(True), run(False)])
    """
    (refusals, unmoved, spoilt), (_, _, plain) = run(script, fmu, cwd=tmp_path)
    assert refusals == 5
    assert unmoved
    assert spoilt == plain


def test_stderr_has_the_message_where_logging_is_off(tmp_path):
    """An importer that has logging off is told nothing by pythonfmu, so the FMU itself tells."""
    script = r"""
    f = open_fmu(PATH, logging=False, name="quiet")
    logged = []
    for call in (lambda: f.set(m1=-2.0), lambda: f.start() and f.step(-1.0)):
        try:
            call()
        except Refused as refused:
            logged.append([refused.status, refused.messages])
    answer(logged)
    """
    logged, done = run_with_output(script, FMUS["fmi2-python"], cwd=tmp_path)
    assert [status > 1 for status, _ in logged] == [True, True]
    assert [messages for _, messages in logged] == [[], []]
    first, second = done.stderr.splitlines()
    assert "'quiet': m1 = -2.0 kg: expected 1e-30 <= m1 <= 1e+30" in first
    assert "'quiet': communicationStepSize = -1.0 s: expected" in second


def test_long_step_ends(fmu, tmp_path):
    """A step of some thousand periods is no hang, and zero length is no step back."""
    script = r"""
    f = open_fmu(PATH).start(**harmonic(0.4)).step(1e5)
    before = f.outputs()
    f.step(1e5)
    after = f.outputs()
    answer([before, after])
    """
    before, after = run(script, fmu, cwd=tmp_path, timeout=60)
    assert before["impact_count"] > 1e5
    assert after["x_rel_max"] == pytest.approx(before["x_rel"], abs=1e-14)
    assert after == {
        **before,
        "box_impulse": 0.0,
        "box_impulse_moment": 0.0,
        "x_rel_max": after["x_rel_max"],
    }
    assert all(math.isfinite(value) for value in before.values())


def test_overdamped_masses_are_supported(fmu, tmp_path):
    """Overdamping is in range, so it has to give right numbers: mass 2 creeps back alone, as its
    closed form says.
    """
    script = r"""
    f = open_fmu(PATH).start(box_amplitude=0.0, d2=5.0, x2_start=0.5)
    answer([f.step(time).get("x2", "v2", "impact_count") for time in (0.5, 2.0, 6.0)])
    """
    root = math.sqrt(2.5**2 - 1.2)
    for (x2, v2, count), time in zip(run(script, fmu, cwd=tmp_path), (0.5, 2.0, 6.0), strict=True):
        slow, fast = -2.5 + root, -2.5 - root
        a = -0.5 * fast / (slow - fast)
        b = 0.5 - a
        assert count == 0
        assert x2 == pytest.approx(a * math.exp(slow * time) + b * math.exp(fast * time), rel=1e-12)
        assert v2 == pytest.approx(
            slow * a * math.exp(slow * time) + fast * b * math.exp(fast * time), rel=1e-12
        )
