"""Grids, scaling, impacts and their neighbourhoods."""

import itertools
import math
import random

from driver import harmonic, open_fmu

OF_THE_STEP = ("box_impulse", "box_impulse_moment", "x_rel_max", "evaluations")


def grids(path, eta, end, more):
    """Outputs at the end of different communication grids.

    All are dyadic: every time and every difference of two times is exact, so that all grids reach
    the very same point of time. The last step is common to all of them, so that what belongs to a
    step (impulse, its moment, largest gap) must agree too.
    """
    last = end - 0.25
    rng = random.Random(1)
    ticks = int(last * 2**20)
    grids = {
        "one step": [last],
        "a thousand steps": [last * k / 1024 for k in range(1, 1025)],
        "uneven": sorted({rng.randrange(1, ticks) * 2.0**-20 for _ in range(300)} | {last}),
        "clustered": sorted(
            {2.0**-20, 2.0**-19, last - 2.0**-20, last}
            | {int(ticks * rng.random() ** 4 + 1.0) * 2.0**-20 for _ in range(50)}
        ),
    }
    found = {}
    for name, times in grids.items():
        f = open_fmu(path).start(**harmonic(eta), **more)
        for time in [*times, end]:
            f.step(time)
        found[name] = f.outputs()
        f.free()
    return found


def communication_grid_does_not_matter_after_inputs_changed(path, clearance):
    changes = [
        (0.0, {"box_frequency": 1.13}),
        (20.0, {"box_amplitude": 0.5}),
        (41.5, {"box_frequency": 2.9, "box_acceleration": 0.05}),
        (60.25, {"box_acceleration": 0.0}),
        (96.0, {}),
    ]
    found = []
    for pieces in (1, 7, 256):
        f = open_fmu(path).start(clearance=clearance)
        for (begin, values), (end, _) in itertools.pairwise(changes):
            f.set(**values)
            ticks = int((end - begin) * 2**20)
            for k in range(1, pieces + 1):
                f.step(begin + ticks * k // pieces * 2.0**-20)
            f.step(end + 0.0)
        found.append(f.outputs([n for n in f.output_names if n not in OF_THE_STEP]))
    return found


def cubic_inputs_run_on_over_steps(path):
    """Outputs in the middle and at the end by several grids, a state restored on the way; at the
    middle the jerk is set to the value that it has, in one way of doing it before the state was
    saved, else after it was restored.
    """
    cubic = {
        "box_acceleration": 0.1,
        "box_jerk": -0.03,
        "box_snap": 0.02,
        "box_crackle": -0.003,
    }
    found = []
    for pieces in (1, 7, 256):
        f = open_fmu(path).start(**harmonic(1.13), **cubic)
        for k in range(1, pieces + 1):
            f.step(int(8 * 2**20) * k // pieces * 2.0**-20)
        names = [n for n in f.output_names if n not in OF_THE_STEP]
        rows = [f.outputs(names)]
        if pieces == 7:
            f.set(box_jerk=-0.03)
            f = open_fmu(path).restore(*f.save())
        else:
            f = open_fmu(path).restore(*f.save())
            f.set(box_jerk=-0.03)
        for k in range(1, pieces + 1):
            f.step(8.0 + int(4 * 2**20) * k // pieces * 2.0**-20)
        found.append([*rows, f.outputs(names), [f.get(name)[0] for name in cubic]])
    untouched = open_fmu(path).start(**harmonic(1.13), **cubic).step(12.0)
    return [found, list(cubic.values()), untouched.outputs(names)]


def steps_of_a_period_end_where_one_step_ends(path, values, periods, pieces):
    size = 2.0 * math.pi / values.get("box_frequency", 0.4) * (periods / pieces)
    whole = open_fmu(path).start(**values).step(pieces * size)
    parts = open_fmu(path).start(**values)
    for k in range(1, pieces + 1):
        parts.step(k * size)
    return [f.get("x1", "x2", "impact_count") for f in (whole, parts)]


def amplitudes_scale_to_the_last_bit(path, clearance, e_slope):
    lengths = {"x1_start": -0.375, "x2_start": 0.8125, "clearance": clearance}
    lengths |= {"v1_start": 0.1, "v2_start": -0.3, "box_amplitude": 0.7}
    found = {}
    for n in (0, -40, 7, 60):
        scale = 2.0**n
        scaled = {name: value * scale for name, value in lengths.items()}
        f = open_fmu(path).start(box_frequency=1.13, m2=1.5, e_slope=e_slope / scale, **scaled)
        f.step(250.0)
        f.step(256.0)
        found[n] = f.outputs()
    return found


def masses_never_pass_through_each_other(path, clearance):
    rng = random.Random(2)
    lowest, near, impacts = math.inf, [], 0
    for eta, more in ((0.4, {}), (1.13, {"m2": 3.0}), (2.9, {"e": 0.1}), (0.4, {"e": 0.0})):
        more = {**harmonic(eta), **more, "clearance": clearance}
        first, second = (open_fmu(path).start(**more) for _ in range(2))
        count = 0
        while first.time < 40.0:
            first.step(first.time + rng.uniform(0.0, 0.02))
            gap, instant, after = first.get("x_rel", "impact_time", "impact_count")
            lowest = min(lowest, gap)
            if after == count + 1:
                impacts += 1
                for time in (
                    math.nextafter(instant, 0.0),
                    instant,
                    math.nextafter(instant, math.inf),
                ):
                    if time > second.time:
                        near += second.step(time).get("x_rel")
            count = after
            second.step(first.time)
    return [lowest, min(near), max(near), impacts]


def impacts(path, more):
    first, second = (open_fmu(path).start(**more) for _ in range(2))
    found, count, contacts, instant = [], 0, 0, 0.0
    h = 1e-9  # seconds before and after an impact: what springs do in the meantime is of this order
    while first.time < 120.0 and len(found) < 40:
        first.step(first.time + 2.0**-6)
        after, contacts_after, instant_after, closing = first.get(
            "impact_count", "contact_count", "impact_time", "impact_velocity"
        )
        if (
            after == count + 1
            and instant_after - second.time > h
            and instant_after - instant > 1e-3
            and instant_after + h < first.time
        ):
            early = second.step(instant_after - h).get("v1", "v2")
            found.append(
                [
                    *early,
                    *second.step(instant_after + h).get("v1", "v2"),
                    closing,
                    contacts_after - contacts,
                ]
            )
            assert second.get("impact_count") == [after]
        second.step(first.time)
        count, contacts, instant = after, contacts_after, instant_after
    return found
