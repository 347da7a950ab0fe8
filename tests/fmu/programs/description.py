"""What depends on which start value."""

from driver import Refused, open_fmu


def initial_dependencies_are_true(path):
    changes = {
        "m1": 1.5,
        "m2": 1.7,
        "k1": 1.3,
        "k2": 1.6,
        "d1": 0.3,
        "d2": 0.2,
        "e": 0.4,
        "gamma": 0.9,
        "x1_start": -0.125,
        "x2_start": 0.375,
        "v1_start": 0.3,
        "v2_start": -0.2,
        "phase_start": 2.0,
        "box_amplitude": 2.0,
        "box_frequency": 0.9,
        "box_acceleration": -3.0,
        "box_jerk": 2.0,
        "box_snap": 2.0,
        "box_crackle": 2.0,
        "bonded": True,
        "x_rel_max_on": False,
    }
    bases = [
        {},
        {"x2_start": 0.5, "v1_start": 0.25},
        {"x1_start": 0.25, "x2_start": 0.25, "v1_start": 1.0, "phase_start": 0.5},
        {"x1_start": 0.25, "x2_start": 0.25, "v1_start": 0.5, "v2_start": 0.5, "phase_start": 0.5},
    ]
    found = {}

    def at_start(values):
        f = open_fmu(path)
        f.set(**values)
        f.enter()
        try:
            return f.outputs()
        except Refused:
            return None
        finally:
            f.free()

    for base in bases:
        plain = at_start(base)
        for name, value in changes.items():
            other = at_start({**base, name: value})
            if other:
                found.setdefault(name, set()).update(
                    key for key in plain if plain[key] != other[key]
                )
    return {name: sorted(keys) for name, keys in found.items()}


def outputs_wait_for_the_next_step(path, values):
    f = open_fmu(path).start(**values).step(10.0)
    before = f.outputs()
    f.set(
        box_amplitude=3.0,
        box_frequency=2.0,
        box_acceleration=5.0,
        box_jerk=1.0,
        box_snap=1.0,
        box_crackle=1.0,
    )
    return [before, f.outputs(), f.step(11.0).outputs()]
