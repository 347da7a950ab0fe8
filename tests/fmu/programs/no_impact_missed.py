"""Impacts counted with large and small steps."""

import math

from driver import harmonic, open_fmu


def giant_steps_count_what_small_steps_count(path):
    found = []
    for eta in (0.3, 0.4, 0.7, 1.05, 1.13, 1.5, 2.5, 2.9, 4.0):
        counts = []
        for step in (256.0, 2.0**-4):
            f = open_fmu(path).start(**harmonic(eta), x_rel_max_on=False)
            while f.time < 256.0:
                f.step(f.time + step)
            counts.append(f.get("impact_count", "contact_count", "impact_time", "impact_energy"))
            f.free()
        found.append([eta, *counts])
    return found


def small_steps_show_every_impact_one_by_one(path):
    f = open_fmu(path).start(**harmonic(1.13))
    rows = []
    while f.time < 60.0:
        before, count = f.time, f.get("impact_count")[0]
        f.step(f.time + 2.0**-9)
        after, instant, closing = f.get("impact_count", "impact_time", "impact_velocity")
        if after != count:
            rows.append([after - count, before, instant, f.time, closing])
    return rows


def graze_of_one_part_in_a_billion(path, values):
    f = open_fmu(path).start(box_amplitude=0.0, box_acceleration=1.0, d2=0.0, e=1.0, **values)
    f.step(1000.0)
    return f.get("impact_count", "x_rel_max")


def no_impact_is_made_out_of_rounding(path, eta):
    return (
        open_fmu(path)
        .start(box_frequency=eta, phase_start=math.pi)
        .step(1.0)
        .get("impact_count", "x_rel")
    )


def impacts_against_an_independent_solution(path, values):
    f, rows = open_fmu(path).start(**values), []
    while f.time < 80.0:
        f.step(f.time + 2.0**-6)
        row = f.get("impact_count", "impact_time", "impact_velocity")
        if row[0] and (not rows or row != rows[-1]):
            rows.append(row)
    f = open_fmu(path).start(**values).step(80.0)
    return [rows, f.get("impact_count", "contact_count")]
