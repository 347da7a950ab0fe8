"""Inputs that change on the way."""

from driver import open_fmu


def phase_is_continuous_when_the_frequency_changes(path):
    f = open_fmu(path).start(phase_start=-1.0, box_frequency=0.4)
    frequencies, found, phase = (0.4, 3.0, 0.0, 1e3, 0.7, 0.7), [], -1.0
    for number, frequency in enumerate(frequencies):
        f.set(box_frequency=frequency)
        before = f.outputs(["phase", "x1", "x2", "v1", "v2", "impact_count"])
        f.step(f.time)  # no time passes: what the new input does at once
        after = f.outputs(list(before))
        phase += 1.7 * frequency
        f.step(1.7 * (number + 1))
        found.append([before, after, phase, f.get("phase")[0]])
    return found


def constant_acceleration_ends_in_static_displacement(path, masses):
    found = []
    for g in (0.5, -0.5):
        f = open_fmu(path).start(box_amplitude=0.0, box_acceleration=g, **masses).step(3000.0)
        found.append(f.outputs())
    return found


def piecewise_cubic_acceleration_against_integration(path, values, signals):
    found = []
    names = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
    for step, rows in signals:
        f = open_fmu(path).start(
            box_amplitude=0.0, **values, **dict(zip(names, rows[0], strict=True))
        )
        at = []
        for k, row in enumerate(rows):
            f.set(**dict(zip(names, row, strict=True)))
            f.step((k + 1) * step)
            if (k + 1) * step % 0.5 == 0.0:
                at.append(f.get("x1", "v1", "x2", "v2"))
        found.append([at, f.get("impact_count", "contact_count")])
    return found


def cubic_input_over_one_step_is_exact(path, cubic):
    names = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
    f = open_fmu(path).start(box_amplitude=0.0, bonded=True, **dict(zip(names, cubic, strict=True)))
    f.step(5.0)
    return f.get("x1", "v1", "x2", "v2", "box_impulse", "box_impulse_moment")


def resonance_without_damping(path, times):
    """Both as one, driven at 1 rad/s from rest."""
    undamped = {"d1": 0.0, "d2": 0.0, "k2": 0.5, "m2": 0.5}
    f = open_fmu(path).start(bonded=True, box_amplitude=1.0, box_frequency=1.0, **undamped)
    found = []
    for time in times:
        f.step(time)
        found.append(f.get("x1", "v1", "box_force"))
    return found


def each_derivative_moves_masses_from_rest(path, name, value):
    f = open_fmu(path).start(box_amplitude=0.0, **{name: value})
    f.step(2.0**-10)
    return f.step(1.0).outputs()
