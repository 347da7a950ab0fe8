"""What depends on which start value."""

from driver import Refused, describe, open_fmu

TOUCHING = {"x1_start": 0.25, "x2_start": 0.25, "phase_start": 0.5}
STARTS = (  # at rest, in flight, at impacts, on the boundary, where what is driven first decides
    {},
    {"x2_start": 0.5, "v1_start": 0.25},
    {**TOUCHING, "v1_start": 1.0, "e": 0.05, "gamma": 0.9},
    {**TOUCHING, "v1_start": 1.0, "e": 0.05, "e_slope": 2.0, "gamma": 0.9, "d2": 0.02},
    {**TOUCHING, "v1_start": 0.5, "v2_start": 0.5, "d2": 0.03},
    {"v1_start": 1.0, "clearance": -0.5, "d2": 0.03},
    {"clearance": 0.5},
    {"clearance": -0.5},
    {"d2": 0.03, "phase_start": -0.5},
    {"d2": 0.03, "box_amplitude": 0.0},
)


def initial_dependencies(path):
    """The outputs that each start value moves at the start, by more than rounding."""
    settable = [v for v in describe(path).modelVariables if v.causality in ("parameter", "input")]
    moved = {v.name: set() for v in settable}

    def at_start(values):
        f = open_fmu(path)
        try:
            f.set(**values)
            f.enter(3.0)
            return f.outputs()
        except Refused:
            return {}
        finally:
            f.free()

    def differs(one, other):
        return abs(one - other) > 1e-12 * (abs(one) + abs(other))

    for start in STARTS:
        outputs = at_start(start)
        for v in settable:
            if v.type == "Boolean":
                values = [v.start != "true"]
            elif v.type in ("Real", "Float64"):
                value = start.get(v.name, float(v.start))
                values = [0.0, value - 0.3, value + 0.3, value - 2.0, value + 2.0]
            else:
                values = [int(v.start) // 2, 3]
            for value in values:
                other = at_start({**start, v.name: value})
                moved[v.name] |= {key for key in other if differs(outputs[key], other[key])}
    return {name: sorted(keys) for name, keys in moved.items()}


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
