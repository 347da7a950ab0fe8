"""FMI 3.0 event mode: the clock ticks at every impact, at its exact time, and nowhere else; the
trajectory stays what it is.
"""

import math

import pytest

from ..fmu.programs.driver import IMPACT, STATE, harmonic, open_fmu

CHAOS = harmonic(1.13)
REGIMES = pytest.mark.parametrize(
    ("values", "end"),
    [
        (CHAOS, 512.0),
        ({}, 256.0),
        ({**harmonic(0.8), "e": 0.3, "m1": 0.3, "k1": 1.7, "d1": 0.0}, 256.0),
    ],
    ids=["chaos", "defaults", "contacts"],
)


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


@REGIMES
def test_times_by_the_clock_are_impact_times_of_small_steps(fmus, values, end):
    with open_fmu(fmus["fmi3"], event_mode=True, early_return=True) as fmu:
        fmu.start(**values)
        times = collect(fmu, end)
    assert len(times) > 20
    for form in ("fmi2", "fmi3"):
        with open_fmu(fmus[form]) as fmu:
            fmu.start(**values)
            seen = 0
            while fmu.time < end:
                fmu.step(fmu.time + 2.0**-6)
                count, time = fmu.get("impact_count", "impact_time")
                if count > seen:
                    assert time == times[count - 1]
                    seen = count
            assert seen == len(times)
            assert fmu.one("impact_time") == times[-1]


@REGIMES
def test_trajectory_does_not_depend_on_event_mode(fmus, values, end):
    """Plain importer, event mode without and with early return, and FMI 2.0: the same bits."""
    found = {}
    for name, form, options in (
        ("fmi2", "fmi2", {}),
        ("plain", "fmi3", {}),
        ("ticks at the end", "fmi3", {"event_mode": True}),
        ("early return", "fmi3", {"event_mode": True, "early_return": True}),
    ):
        with open_fmu(fmus[form], **options) as fmu:
            fmu.start(**values)
            if "early_return" in options:
                collect(fmu, end)
            else:
                for k in range(1, 33):
                    fmu.step(end * k / 32)
            assert fmu.time == end
            found[name] = fmu.get(*STATE)
    reference = found.pop("fmi2")
    for name, state in found.items():
        assert state == reference, name


@REGIMES
def test_without_early_return_the_clock_ticks_at_the_end_of_steps_with_impacts(fmus, values, end):
    with open_fmu(fmus["fmi3"], event_mode=True) as fmu:
        fmu.start(**values)
        count, ticks, quiet = 0, 0, 0
        for k in range(1, int(4 * end) + 1):
            event, early = fmu.go(0.25 * k)
            assert not early
            assert fmu.time == 0.25 * k
            before, count = count, fmu.one("impact_count")
            assert event == (count > before)
            fmu.fmu.enterEventMode()
            assert fmu.clock() == event
            ticks, quiet = ticks + event, quiet + (not event)
            fmu.update()
            assert not fmu.clock()
            fmu.fmu.enterStepMode()
        assert ticks > 10
        assert quiet > 100


def test_an_ignored_tick_is_gone_after_the_next_step(fmus):
    """An importer need not handle the event; and leaving event mode without an update ends the tick
    too.
    """
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
    with open_fmu(fmus["fmi3"], event_mode=True, early_return=True) as fmu:
        fmu.set(v1_start=velocity, v2_start=-velocity)
        fmu.fmu.enterInitializationMode()
        fmu.fmu.exitInitializationMode()
        assert fmu.clock() == active
        assert fmu.one("impact_count") == active
        fmu.update()
        assert not fmu.clock()


def test_saving_in_event_mode_saves_the_tick(fmus):
    """In the same instance and, serialised, in a new one; the run goes on from there."""
    with (
        open_fmu(fmus["fmi3"], event_mode=True, early_return=True) as fmu,
        open_fmu(fmus["fmi3"], event_mode=True, early_return=True) as other,
    ):
        fmu.start(**CHAOS)
        while not fmu.go(fmu.time + 8.0)[0]:
            pass
        time = fmu.time
        fmu.fmu.enterEventMode()
        active = fmu.fmu.getFMUState()
        saved = fmu.fmu.serializeFMUState(active)
        fmu.update()
        inactive = fmu.fmu.getFMUState()
        for state, expected in ((active, True), (inactive, False), (active, True)):
            fmu.fmu.setFMUState(state)
            assert fmu.clock() == expected
        for state in (active, inactive):
            fmu.fmu.freeFMUState(state)
        state = other.fmu.deserializeFMUState(saved)
        other.fmu.setFMUState(state)
        other.fmu.freeFMUState(state)
        other.time = time
        assert other.clock()
        assert other.one("impact_time") == time
        for one in (fmu, other):
            one.update()
            one.fmu.enterStepMode()
        assert collect_rest(fmu) == collect_rest(other)


def collect_rest(fmu):
    """Times of the ticks of the next 50 s, and the state there."""
    times, end = [], fmu.time + 50.0
    while fmu.time < end:
        if fmu.go(end)[0]:
            fmu.fmu.enterEventMode()
            times.append(fmu.time)
            fmu.update()
            fmu.fmu.enterStepMode()
    return times, fmu.get(*STATE)


@pytest.mark.parametrize("scale", [1.0, 1.7], ids=["omega=1", "omega=1.7"])
def test_time_does_not_run_backwards_next_to_an_impact(fmus, scale):
    """Communication points a few units in the last place around each impact: every step ends at or
    after its beginning.
    """
    values = {
        **CHAOS,
        "k1": scale**2,
        "k2": 1.2 * scale**2,
        "box_frequency": 1.13 * scale,
        "d1": 0.01 * scale,
        "d2": 0.01 * scale,
    }
    with open_fmu(fmus["fmi3"], event_mode=True, early_return=True) as fmu:
        fmu.start(0.1, **values)
        times = []
        while fmu.time < 300.0:
            if fmu.go(fmu.time + 10.0)[0]:
                times.append(fmu.time)
    assert len(times) > 40
    for ulps in range(-3, 4):
        with open_fmu(fmus["fmi3"], event_mode=True, early_return=True) as fmu:
            fmu.start(0.1, **values)
            seen = []
            for time in times:
                point = time + ulps * math.ulp(time)
                for target in (point, point + 1e-9):
                    while fmu.time < target:
                        before = fmu.time
                        event, early = fmu.go(target)
                        assert fmu.time >= before
                        seen += [fmu.one("impact_time")] * event
                        if early and fmu.time == before and not event:
                            raise AssertionError("a step that went nowhere without an event")
            assert seen == times


@pytest.mark.parametrize("size", [0.0, 1e-10])
def test_time_does_not_run_backwards_within_the_tolerance_of_the_communication_point(fmus, size):
    with open_fmu(fmus["fmi3"]) as fmu:
        fmu.start(**CHAOS).step(20.0)
        assert fmu.fmu.doStep(20.0 - 1e-9, size)[3] >= 20.0


def test_a_refused_step_in_event_mode_leaves_the_tick(fmus):
    with open_fmu(fmus["fmi3"], event_mode=True) as fmu:
        fmu.start(**CHAOS)
        assert fmu.go(20.0)[0]
        fmu.fmu.enterEventMode()
        fmu.refused("doStep", 20.0, 1.0)
        assert fmu.clock()


def test_the_clock_of_the_model_description(fmus):
    with open_fmu(fmus["fmi3"]) as fmu:
        clock = fmu.variables["impact"]
        assert (clock.type, clock.valueReference, clock.causality, clock.intervalVariability) == (
            "Clock",
            IMPACT,
            "output",
            "triggered",
        )
