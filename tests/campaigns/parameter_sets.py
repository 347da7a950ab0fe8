"""Draw adversarial parameter sets of the oscillator, each from a seed and a number.

What is drawn is legal by the variable table, and hostile to arithmetic: oscillators that differ in
the last digits, damping and drives next to nothing, starts of 1e-150 m and 1e60 m, a clock at 1e12
s, dampers far beyond critical, drives on a natural frequency. The same motion is then asked for
over several communication grids, to the last bit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from orchestrate.structures.ranges import ADDED, STRUCTURE

Values = dict[str, float]
Draw = Callable[[np.random.Generator, Values], None]


@dataclass(frozen=True)
class ParameterSet:
    """A structure, its start, its excitation and a duration."""

    kind: str  # name of the class it was drawn from
    values: Values  # variables of the FMU, by name; those left out have their start values
    # s
    start_time: float
    duration: float

    def grids(self) -> Iterator[list[float]]:
        """Yield communication grids with one end: one step, two, uneven ones, 24 equal ones."""
        start, end = self.start_time, self.start_time + self.duration
        cuts = (), (0.5,), (0.001, 0.7, 0.7000001, 0.95), tuple(i / 24 for i in range(1, 24))
        for parts in cuts:
            inside = (start + part * self.duration for part in parts)
            yield [time for time in inside if start < time < end] + [end]


def draw_power_of_ten(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number between two powers of ten, uniformly in its logarithm."""
    return float(10.0 ** rng.uniform(low, high))


def draw_one_of(rng: np.random.Generator, *choices: float) -> float:
    """Return one of several numbers, drawn at random."""
    return choices[int(rng.integers(len(choices)))]


def draw_sign(rng: np.random.Generator) -> float:
    """Return -1 or 1, drawn at random."""
    return draw_one_of(rng, -1.0, 1.0)


def natural_frequencies(values: Values) -> tuple[float, float]:
    """Return the natural frequencies of the two masses, rad/s."""
    return math.sqrt(values["k1"] / values["m1"]), math.sqrt(values["k2"] / values["m2"])


def draw_ordinary(rng: np.random.Generator) -> Values:
    """Draw a structure with chattering, impacts and contact, from which every class starts."""
    return {
        "m1": 1.0,
        "m2": draw_power_of_ten(rng, -1.5, 1.5),
        "k1": 1.0,
        "k2": draw_power_of_ten(rng, -1.5, 1.5),
        "d1": draw_one_of(rng, 0.0, 1.0) * draw_power_of_ten(rng, -4.0, 0.0),
        "d2": draw_one_of(rng, 0.0, 1.0) * draw_power_of_ten(rng, -4.0, 0.0),
        "e": float(rng.uniform()),
        "gamma": draw_power_of_ten(rng, -6.0, 0.0),
        "x1_start": float(rng.uniform(-1.0, 0.0)),
        "x2_start": float(rng.uniform(0.0, 1.0)),
        "v1_start": float(rng.uniform(-1.0, 1.0)),
        "v2_start": float(rng.uniform(-1.0, 1.0)),
        "phase_start": float(rng.uniform(0.0, 6.28)),
        "box_amplitude": draw_power_of_ten(rng, -1.0, 1.0),
        "box_frequency": draw_power_of_ten(rng, -1.0, 0.7),
    }


def make_nearly_equal(rng: np.random.Generator, values: Values) -> None:
    """Change values to nearly equal oscillators with almost lossless impacts."""
    differs = [
        draw_one_of(rng, 0.0, 1.0) * draw_sign(rng) * draw_power_of_ten(rng, -17.0, -2.0)
        for _ in range(2)
    ]
    values["k2"] = values["k1"] * values["m2"] / values["m1"] * (1.0 + differs[0])
    values["d2"] = values["d1"] * values["m2"] / values["m1"] * (1.0 + differs[1])
    values["e"] = 1.0 - draw_one_of(rng, 0.0, 1.0) * draw_power_of_ten(rng, -17.0, -1.0)
    values["gamma"] = draw_power_of_ten(rng, -6.0, 0.0)
    if rng.random() < 0.5:
        values["x2_start"] = values["x1_start"]


def make_subnormal(rng: np.random.Generator, values: Values) -> None:
    """Change some dampings, drive values or starts to subnormal numbers or nearly so."""
    for name in ("d1", "d2", "box_amplitude", "box_frequency", "x2_start", "v2_start"):
        if rng.random() < 0.4:
            values[name] = draw_one_of(rng, 5e-324, 1e-310, draw_power_of_ten(rng, -323.0, -20.0))
    values["x1_start"] = draw_one_of(rng, 0.0, values["x1_start"], -5e-324)


def make_any_start_size(rng: np.random.Generator, values: Values) -> None:
    """Change start values to sizes far below and far above the box's motion."""
    for name in ("x1_start", "x2_start", "v1_start", "v2_start"):
        values[name] *= draw_one_of(rng, 0.0, 1.0, 1.0) * draw_power_of_ten(rng, -150.0, 60.0)
    values["x1_start"], values["x2_start"] = sorted((values["x1_start"], values["x2_start"]))


def make_small_start(rng: np.random.Generator, values: Values) -> None:
    """Change start values to nearly rest with closed gap, under an ordinary drive."""
    values["x1_start"] = values["x2_start"] = draw_one_of(rng, 0.0, 1.0) * draw_power_of_ten(
        rng, -20.0, 0.0
    )
    values["v1_start"] = draw_one_of(rng, 0.0, 1.0) * draw_power_of_ten(rng, -20.0, 0.0)
    values["v2_start"] = values["v1_start"] + draw_one_of(rng, 0.0, 1.0) * draw_power_of_ten(
        rng, -20.0, 0.0
    )
    values["phase_start"] = draw_one_of(rng, 0.0, math.pi, draw_power_of_ten(rng, -15.0, 0.0))


def make_large_gamma(rng: np.random.Generator, values: Values) -> None:
    """Change values to a gamma of up to one and unequal masses: impacts that nearly stick."""
    values["gamma"] = draw_one_of(rng, 1.0, 0.99, 0.5)
    values["m2"] = draw_one_of(rng, 25.0, 0.04, 1000.0, 0.001)
    values["k2"] = values["m2"] * draw_power_of_ten(rng, -1.0, 1.0)
    values["e"] = draw_one_of(rng, 0.5, 0.0, 1.0, float(rng.uniform()))


def make_overdamped(rng: np.random.Generator, values: Values) -> None:
    """Change the dampers to about and far beyond critical."""
    for name, mass, stiffness in (("d1", "m1", "k1"), ("d2", "m2", "k2")):
        critical = 2.0 * math.sqrt(values[mass] * values[stiffness])
        factor = 1.0 + draw_sign(rng) * draw_power_of_ten(rng, -16.0, -3.0)
        values[name] = critical * draw_one_of(
            rng, factor, 1.0, draw_power_of_ten(rng, 0.0, 2.0), values[name]
        )
        if rng.random() < 0.1:
            values[name] = critical * draw_power_of_ten(rng, 2.0, 4.0)


def make_resonant(rng: np.random.Generator, values: Values) -> None:
    """Change the drive to or next to a natural frequency, with little or no damping."""
    together = math.sqrt((values["k1"] + values["k2"]) / (values["m1"] + values["m2"]))
    natural = draw_one_of(rng, *natural_frequencies(values), together)
    beside = draw_one_of(rng, 0.0, 1.0) * draw_sign(rng) * draw_power_of_ten(rng, -17.0, -3.0)
    values["box_frequency"] = natural * (1.0 + beside)
    for name in ("d1", "d2"):
        values[name] = draw_one_of(rng, 0.0, 0.0, draw_power_of_ten(rng, -20.0, -2.0))
    values["bonded"] = draw_one_of(rng, 0.0, 0.0, 0.0, 1.0)
    if values["bonded"]:
        values["x2_start"], values["v2_start"] = values["x1_start"], values["v1_start"]


def make_late_start(rng: np.random.Generator, values: Values) -> None:
    """Change the start time to a late one."""


def make_cubic_input(rng: np.random.Generator, values: Values) -> None:
    """Change the box accelerations to cubics of many scales."""
    for name in ("box_acceleration", "box_jerk", "box_snap", "box_crackle"):
        values[name] = (
            draw_one_of(rng, 0.0, 1.0) * draw_sign(rng) * draw_power_of_ten(rng, -12.0, 2.0)
        )
    if rng.random() < 0.5:
        values["box_jerk"] = values["box_snap"] = values["box_crackle"] = 0.0
    values["box_amplitude"] *= draw_one_of(rng, 0.0, 1.0)


def make_long_chattering(rng: np.random.Generator, values: Values) -> None:
    """Change values for long chattering: constant push, little loss in impacts, small gamma."""
    values["k2"] = values["m2"] * draw_power_of_ten(rng, -0.5, 0.5)
    values["box_acceleration"] = draw_sign(rng) * draw_power_of_ten(rng, -2.0, 2.0)
    values["e"] = 1.0 - draw_power_of_ten(rng, -3.0, 0.0)
    values["gamma"] = draw_power_of_ten(rng, -9.0, -1.0)


def make_far_drive(rng: np.random.Generator, values: Values) -> None:
    """Change the drive's frequency to far from the natural frequencies."""
    values["box_frequency"] = draw_one_of(
        rng, draw_power_of_ten(rng, 0.5, 3.0), draw_power_of_ten(rng, -12.0, -1.0)
    )
    values["box_amplitude"] = (
        draw_power_of_ten(rng, -3.0, 1.0) / (values["box_frequency"] + 0.01) ** 2
    )


def make_any_scale(rng: np.random.Generator, values: Values) -> None:
    """Change masses and stiffnesses to scales over decades, from watches to ships."""
    mass, stiffness = draw_power_of_ten(rng, -9.0, 9.0), draw_power_of_ten(rng, -9.0, 9.0)
    rate = math.sqrt(stiffness / mass)
    for name in ("m1", "m2"):
        values[name] *= mass
    for name in ("k1", "k2"):
        values[name] *= stiffness
    for name in ("d1", "d2"):
        values[name] *= math.sqrt(stiffness * mass)
    for name in ("v1_start", "v2_start", "box_frequency"):
        values[name] *= rate


def set_clearance(rng: np.random.Generator, values: Values) -> None:
    """Set a random clearance or preload, and a start position that fits."""
    size = max(abs(values[name]) for name in ("x1_start", "x2_start", "box_amplitude"))
    spread = draw_one_of(
        rng, draw_power_of_ten(rng, -3.0, 1.0), draw_power_of_ten(rng, -12.0, 12.0)
    )
    values["clearance"] = draw_sign(rng) * min(size * spread, 1e100)
    if values["clearance"] > 0.0 and not values.get("bonded"):
        values["x2_start"] -= draw_one_of(rng, 0.0, 1.0) * values["clearance"]
    elif spread > 10.0:  # pressed so hard that a hop is short: of hops there would be no end
        values["x2_start"], values["v2_start"] = values["x1_start"], values["v1_start"]


def set_added_parameters(rng: np.random.Generator, values: Values) -> None:
    """Set the parameters that are not in the paper to sizes that matter, or any."""
    for name in ADDED:
        if name != "clearance" and rng.random() < 0.4:
            quantity = STRUCTURE[name]
            spread = draw_one_of(
                rng, draw_power_of_ten(rng, -3.0, 2.0), draw_power_of_ten(rng, -30.0, 30.0)
            )
            size = draw_sign(rng) * unit_of_motion(values, quantity.dimension) * spread
            values[name] = min(max(size, quantity.minimum), quantity.maximum)


def unit_of_motion(values: Values, dimension: Mapping[str, int]) -> float:
    """Return the unit that mass 1, its frequency and the largest length give a dimension."""
    lengths = [abs(values[name]) for name in ("x1_start", "x2_start", "box_amplitude")]
    units = {
        "kg": values["m1"],
        "m": max(*lengths, 1e-60),
        "s": 1.0 / natural_frequencies(values)[0],
    }
    return math.prod(units[base] ** exponent for base, exponent in dimension.items())


KINDS: dict[str, Draw] = {
    "nearly equal": make_nearly_equal,
    "next to nothing": make_subnormal,
    "of all sizes": make_any_start_size,
    "one small start": make_small_start,
    "heavy": make_large_gamma,
    "steep": make_overdamped,
    "resonant": make_resonant,
    "late": make_late_start,
    "cubic": make_cubic_input,
    "pressed": make_long_chattering,
    "fast or slow": make_far_drive,
    "of all scales": make_any_scale,
}


def draw_parameter_set(seed: int, number: int) -> ParameterSet:
    """Draw the parameter set of a number under a seed; the same on every machine.

    One in four belongs to a second class besides its own; one in four begins at a clock of up to
    1e12 s, all in the class ``late``; four in ten have a clearance, as many each of what was
    added later.

    Examples
    --------
    >>> draw_parameter_set(1, 4) == draw_parameter_set(1, 4), draw_parameter_set(1, 4).kind
    (True, 'heavy')
    """
    rng = np.random.default_rng((seed, number))
    names = list(KINDS)
    kind = names[number % len(names)]
    values = draw_ordinary(rng)
    if rng.random() < 0.25:
        KINDS[names[int(rng.integers(len(names)))]](rng, values)
    KINDS[kind](rng, values)
    values["x2_start"] = max(values["x1_start"], values["x2_start"])
    if values.get("bonded"):
        values["x2_start"], values["v2_start"] = values["x1_start"], values["v1_start"]
    if rng.random() < 0.4:
        set_clearance(rng, values)
    set_added_parameters(np.random.default_rng((seed, number, 1)), values)
    rate = max(*natural_frequencies(values), values["box_frequency"])
    duration = (
        draw_one_of(
            rng,
            draw_power_of_ten(rng, -10.0, 0.0),
            *(draw_power_of_ten(rng, 0.0, 5.0) for _ in "ab"),
        )
        / rate
    )
    clock = kind == "late" or rng.random() < 0.25
    start_time = draw_sign(rng) * draw_power_of_ten(rng, 0.0, 12.0) if clock else 0.0
    return ParameterSet(kind, values, start_time, duration)
