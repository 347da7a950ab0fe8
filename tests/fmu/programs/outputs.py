"""Rows of outputs to be checked against their definitions."""

from driver import open_fmu


def outputs_follow_their_definitions(path, values):
    f = open_fmu(path).start(phase_start=1.0, **values)
    return [{"time": f.step(k / 16).time, **f.outputs()} for k in range(1, 1000)]


def paper_displacements_are_zero_without_excitation(path):
    cases = {"box_amplitude": 0.0}, {"box_frequency": 0.0}
    return [
        open_fmu(path).start(x1_start=-1.0, **still).step(1.0).get("xi1", "xi2", "xi_rel")
        for still in cases
    ]


def what_belongs_to_a_step_is_exact(path, values):
    found = []
    for more in (
        {},
        {"box_acceleration": 0.1},
        {"box_frequency": 1.13, "box_acceleration": -0.2, "m2": 2.0},
    ):
        whole, parts = (open_fmu(path).start(**{**values, **more}) for _ in range(2))
        for size in (0.25, 3.0, 17.0, 40.0):
            begin = whole.time
            whole.step(begin + size)
            rows = []
            while parts.time < begin + size:
                here, force = parts.time, parts.get("box_force")[0]
                parts.step(here + 2.0**-6)
                rows.append(
                    [
                        here - begin,
                        force,
                        *parts.get(
                            "box_force", "box_impulse", "box_impulse_moment", "x_rel", "x_rel_max"
                        ),
                    ]
                )
            found.append(
                [whole.get("box_impulse", "box_impulse_moment", "x_rel_max", "x_rel"), rows]
            )
    return found


def largest_gap_between_samples_is_found(path):
    values = {"box_amplitude": 0.0, "d2": 0.0, "v2_start": 2.0}
    cases = (True, 2.5), (True, 0.5), (False, 2.5)
    return [
        open_fmu(path).start(**values, x_rel_max_on=on).step(end).get("x_rel_max", "x_rel")
        for on, end in cases
    ]
