"""Event mode: the clock ticks at every impact, at its time; the trajectory stays what it is."""

import math

import pytest

from ..fmu.programs.driver import STATE, harmonic, open_fmu

CHAOS = harmonic(1.13)
EARLY = {"event_mode": True, "early_return": True}
CONTACTS = {**harmonic(0.8), "e": 0.3, "m1": 0.3, "k1": 1.7, "d1": 0.0}


def collect(fmu, end, size=8.0):
    """Times of all ticks: what an importer does that takes part in event mode with early return."""
    times = []
    while fmu.time < end:
        before = fmu.time
        target = min((math.floor(before / size) + 1) * size, end)
        event, early = fmu.go(target)
        assert fmu.time >= before
        assert early == (fmu.time < target)
        assert event or not early
        if event:
            fmu.fmu.enterEventMode()
            assert fmu.clock()
            assert fmu.one("impact_time") == fmu.time
            times.append(fmu.time)
            assert fmu.one("impact_count") == len(times)
            fmu.update()
            assert not fmu.clock()
            fmu.fmu.enterStepMode()
    return times


@pytest.mark.parametrize(("values", "end"), [(CHAOS, 512.0), ({}, 256.0), (CONTACTS, 256.0)])
def test_times_by_the_clock_are_impact_times_of_small_steps(fmus, values, end):
    with open_fmu(fmus["fmi3"], **EARLY) as fmu:
        fmu.start(**values)
        times = collect(fmu, end)
    assert len(times) > 20
    fmu, seen = open_fmu(fmus["fmi2"]).start(**values), 0
    while fmu.time < end:
        count, time = fmu.step(fmu.time + 2.0**-5).get("impact_count", "impact_time")
        if count > seen:
            assert time == times[count - 1]
            seen = count
    assert seen == len(times)


def test_an_ignored_tick_is_gone_after_the_next_step(fmus):
    """The event need not be handled; leaving event mode without an update ends the tick too."""
    with open_fmu(fmus["fmi3"], event_mode=True) as fmu:
        fmu.start(**CHAOS)
        assert fmu.go(20.0) == (True, False)
        assert fmu.go(20.0) == (False, False)
        fmu.fmu.enterEventMode()
        assert not fmu.clock()
        fmu.fmu.enterStepMode()
        while not fmu.go(fmu.time + 1.0)[0]:
            pass
        fmu.fmu.enterEventMode()
        assert fmu.clock()
        fmu.fmu.enterStepMode()
        fmu.fmu.enterEventMode()
        assert not fmu.clock()


@pytest.mark.parametrize(("velocity", "active"), [(1.0, True), (0.0, False), (-1.0, False)])
def test_an_impact_at_the_start_ticks_after_initialisation(fmus, velocity, active):
    with open_fmu(fmus["fmi3"], **EARLY) as fmu:
        fmu.set(v1_start=velocity, v2_start=-velocity)
        fmu.fmu.enterInitializationMode()
        fmu.fmu.exitInitializationMode()
        assert fmu.clock() == active
        assert fmu.one("impact_count") == active
        fmu.update()
        assert not fmu.clock()


def collect_rest(f):
    """Times of the ticks of the next 50 s, and the state there."""
    times, end = [], f.time + 50.0
    while f.time < end:
        if f.go(end)[0]:
            times.append(f.time)
            f.handle()
    return times, f.get(*STATE)


def test_saving_in_event_mode_saves_the_tick(fmus):
    """In the same instance and, serialised, in a new one; the run goes on from there."""
    f, other = (open_fmu(fmus["fmi3"], **EARLY) for _ in range(2))
    f.start(**CHAOS)
    while not f.go(f.time + 8.0)[0]:
        pass
    f.fmu.enterEventMode()
    active = f.save()
    f.update()
    inactive = f.save()
    for state, expected in ((active, True), (inactive, False), (active, True)):
        assert f.restore(*state).clock() == expected
    assert other.restore(*active).clock()
    assert other.one("impact_time") == other.time == f.time
    for one in (f, other):
        one.update()
        one.fmu.enterStepMode()
    assert collect_rest(f) == collect_rest(other)


@pytest.mark.parametrize("scale", [1.0, 1.7], ids=["omega=1", "omega=1.7"])
def test_time_does_not_run_backwards_next_to_an_impact(fmus, scale):
    """Communication points a few units in the last place around each impact."""
    values = {**CHAOS, "k1": scale**2, "k2": 1.2 * scale**2, "box_frequency": 1.13 * scale}
    values |= {"d1": 0.01 * scale, "d2": 0.01 * scale}
    with open_fmu(fmus["fmi3"], **EARLY) as fmu:
        fmu.start(0.1, **values)
        times = []
        while fmu.time < 300.0:
            if fmu.go(fmu.time + 10.0)[0]:
                times.append(fmu.time)
    assert len(times) > 40
    for ulps in range(-3, 4):
        with open_fmu(fmus["fmi3"], **EARLY) as fmu:
            fmu.start(0.1, **values)
            seen = []
            for time in times:
                point = time + ulps * math.ulp(time)
                for target in (point, point + 1e-9):
                    while fmu.time < target:
                        before = fmu.time
                        event, early = fmu.go(target)
                        assert fmu.time > before or event or not early
                        assert fmu.time >= before
                        seen += [fmu.one("impact_time")] * event
            assert seen == times
