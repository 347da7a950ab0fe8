"""Draw adversarial parameter sets of the oscillator, each from a seed and a number.

What is drawn is legal by the variable table, and hostile to arithmetic: oscillators that differ in
the last digits, damping and drives next to nothing, starts of 1e-150 m and 1e60 m, a clock at 1e12
s, dampers far beyond critical, drives on a natural frequency. The same motion is then asked for
over several communication grids, to the last bit.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from orchestrate.model.ranges import ADDED, STRUCTURE

Values = dict[str, float]


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


class Chance(np.random.Generator):
    """Random numbers of the kinds that are drawn here."""

    def power(self, low: float, high: float) -> float:
        """Draw a number between two powers of ten, uniformly in its logarithm."""
        return float(10.0 ** self.uniform(low, high))

    def one_of(self, *choices: float) -> float:
        return choices[int(self.integers(len(choices)))]

    def sign(self) -> float:
        return self.one_of(-1.0, 1.0)

    def perhaps(self) -> float:
        """Draw 0 or 1."""
        return self.one_of(0.0, 1.0)


def natural_frequencies(values: Values) -> tuple[float, float]:
    return math.sqrt(values["k1"] / values["m1"]), math.sqrt(values["k2"] / values["m2"])


def draw_ordinary(rng: Chance) -> Values:
    """Draw a structure with chattering, impacts and contact, from which every class starts."""
    return {
        "m1": 1.0,
        "m2": rng.power(-1.5, 1.5),
        "k1": 1.0,
        "k2": rng.power(-1.5, 1.5),
        "d1": rng.perhaps() * rng.power(-4.0, 0.0),
        "d2": rng.perhaps() * rng.power(-4.0, 0.0),
        "e": float(rng.uniform()),
        "gamma": rng.power(-6.0, 0.0),
        "x1_start": float(rng.uniform(-1.0, 0.0)),
        "x2_start": float(rng.uniform(0.0, 1.0)),
        "v1_start": float(rng.uniform(-1.0, 1.0)),
        "v2_start": float(rng.uniform(-1.0, 1.0)),
        "phase_start": float(rng.uniform(0.0, 6.28)),
        "box_amplitude": rng.power(-1.0, 1.0),
        "box_frequency": rng.power(-1.0, 0.7),
    }


def make_nearly_equal(rng: Chance, values: Values) -> None:
    """Change values to nearly equal oscillators with almost lossless impacts."""
    differs = [rng.perhaps() * rng.sign() * rng.power(-17.0, -2.0) for _ in range(2)]
    values["k2"] = values["k1"] * values["m2"] / values["m1"] * (1.0 + differs[0])
    values["d2"] = values["d1"] * values["m2"] / values["m1"] * (1.0 + differs[1])
    values["e"] = 1.0 - rng.perhaps() * rng.power(-17.0, -1.0)
    values["gamma"] = rng.power(-6.0, 0.0)
    if rng.random() < 0.5:
        values["x2_start"] = values["x1_start"]


def make_subnormal(rng: Chance, values: Values) -> None:
    """Change some dampings, drive values or starts to subnormal numbers or nearly so."""
    for name in ("d1", "d2", "box_amplitude", "box_frequency", "x2_start", "v2_start"):
        if rng.random() < 0.4:
            values[name] = rng.one_of(5e-324, 1e-310, rng.power(-323.0, -20.0))
    values["x1_start"] = rng.one_of(0.0, values["x1_start"], -5e-324)


def make_any_start_size(rng: Chance, values: Values) -> None:
    for name in ("x1_start", "x2_start", "v1_start", "v2_start"):
        values[name] *= rng.one_of(0.0, 1.0, 1.0) * rng.power(-150.0, 60.0)
    values["x1_start"], values["x2_start"] = sorted((values["x1_start"], values["x2_start"]))


def make_small_start(rng: Chance, values: Values) -> None:
    """Change start values to nearly rest with closed gap, under an ordinary drive."""
    values["x1_start"] = values["x2_start"] = rng.perhaps() * rng.power(-20.0, 0.0)
    values["v1_start"] = rng.perhaps() * rng.power(-20.0, 0.0)
    values["v2_start"] = values["v1_start"] + rng.perhaps() * rng.power(-20.0, 0.0)
    values["phase_start"] = rng.one_of(0.0, math.pi, rng.power(-15.0, 0.0))


def make_large_gamma(rng: Chance, values: Values) -> None:
    """Change values to a gamma of up to one and unequal masses: impacts that nearly stick."""
    values["gamma"] = rng.one_of(1.0, 0.99, 0.5)
    values["m2"] = rng.one_of(25.0, 0.04, 1000.0, 0.001)
    values["k2"] = values["m2"] * rng.power(-1.0, 1.0)
    values["e"] = rng.one_of(0.5, 0.0, 1.0, float(rng.uniform()))


def make_overdamped(rng: Chance, values: Values) -> None:
    """Change the dampers to about and far beyond critical."""
    for name, mass, stiffness in (("d1", "m1", "k1"), ("d2", "m2", "k2")):
        critical = 2.0 * math.sqrt(values[mass] * values[stiffness])
        factor = 1.0 + rng.sign() * rng.power(-16.0, -3.0)
        values[name] = critical * rng.one_of(factor, 1.0, rng.power(0.0, 2.0), values[name])
        if rng.random() < 0.1:
            values[name] = critical * rng.power(2.0, 4.0)


def make_resonant(rng: Chance, values: Values) -> None:
    """Change the drive to or next to a natural frequency, with little or no damping."""
    together = math.sqrt((values["k1"] + values["k2"]) / (values["m1"] + values["m2"]))
    natural = rng.one_of(*natural_frequencies(values), together)
    beside = rng.perhaps() * rng.sign() * rng.power(-17.0, -3.0)
    values["box_frequency"] = natural * (1.0 + beside)
    for name in ("d1", "d2"):
        values[name] = rng.one_of(0.0, 0.0, rng.power(-20.0, -2.0))
    values["bonded"] = rng.one_of(0.0, 0.0, 0.0, 1.0)
    if values["bonded"]:
        values["x2_start"], values["v2_start"] = values["x1_start"], values["v1_start"]


def make_cubic_input(rng: Chance, values: Values) -> None:
    for name in ("box_acceleration", "box_jerk", "box_snap", "box_crackle"):
        values[name] = rng.perhaps() * rng.sign() * rng.power(-12.0, 2.0)
    if rng.random() < 0.5:
        values["box_jerk"] = values["box_snap"] = values["box_crackle"] = 0.0
    values["box_amplitude"] *= rng.perhaps()


def make_long_chattering(rng: Chance, values: Values) -> None:
    """Change values for long chattering: constant push, little loss in impacts, small gamma."""
    values["k2"] = values["m2"] * rng.power(-0.5, 0.5)
    values["box_acceleration"] = rng.sign() * rng.power(-2.0, 2.0)
    values["e"] = 1.0 - rng.power(-3.0, 0.0)
    values["gamma"] = rng.power(-9.0, -1.0)


def make_far_drive(rng: Chance, values: Values) -> None:
    values["box_frequency"] = rng.one_of(rng.power(0.5, 3.0), rng.power(-12.0, -1.0))
    values["box_amplitude"] = rng.power(-3.0, 1.0) / (values["box_frequency"] + 0.01) ** 2


def make_any_scale(rng: Chance, values: Values) -> None:
    """Change masses and stiffnesses to scales over decades, from watches to ships."""
    mass, stiffness = rng.power(-9.0, 9.0), rng.power(-9.0, 9.0)
    rate = math.sqrt(stiffness / mass)
    for name in ("m1", "m2"):
        values[name] *= mass
    for name in ("k1", "k2"):
        values[name] *= stiffness
    for name in ("d1", "d2"):
        values[name] *= math.sqrt(stiffness * mass)
    for name in ("v1_start", "v2_start", "box_frequency"):
        values[name] *= rate


def set_clearance(rng: Chance, values: Values) -> None:
    """Set a random clearance or preload, and a start position that fits."""
    size = max(abs(values[name]) for name in ("x1_start", "x2_start", "box_amplitude"))
    spread = rng.one_of(rng.power(-3.0, 1.0), rng.power(-12.0, 12.0))
    values["clearance"] = rng.sign() * min(size * spread, 1e100)
    if values["clearance"] > 0.0 and not values.get("bonded"):
        values["x2_start"] -= rng.perhaps() * values["clearance"]
    elif spread > 10.0:  # pressed so hard that a hop is short: of hops there would be no end
        values["x2_start"], values["v2_start"] = values["x1_start"], values["v1_start"]


def set_added_parameters(rng: Chance, values: Values) -> None:
    """Set the parameters that are not in the paper to sizes that matter, or any."""
    for name in (one for one in ADDED if one != "stroke"):  # sets that once fell have none
        if name != "clearance" and rng.random() < 0.4:
            quantity = STRUCTURE[name]
            spread = rng.one_of(rng.power(-3.0, 2.0), rng.power(-30.0, 30.0))
            size = rng.sign() * unit_of_motion(values, quantity.dimension) * spread
            values[name] = min(max(size, quantity.minimum), quantity.maximum)


def unit_of_motion(values: Values, dimension: Mapping[str, int]) -> float:
    """Return the unit that mass 1, its frequency and the largest length give a dimension."""
    lengths = [abs(values[name]) for name in ("x1_start", "x2_start", "box_amplitude")]
    units = {"kg": values["m1"], "m": max(*lengths, 1e-60)}
    units["s"] = 1.0 / natural_frequencies(values)[0]
    return math.prod(units[base] ** exponent for base, exponent in dimension.items())


KINDS: dict[str, Callable[[Chance, Values], None]] = {
    "nearly equal": make_nearly_equal,
    "next to nothing": make_subnormal,
    "of all sizes": make_any_start_size,
    "one small start": make_small_start,
    "heavy": make_large_gamma,
    "steep": make_overdamped,
    "resonant": make_resonant,
    "late": lambda rng, values: None,
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
    rng = Chance(np.random.PCG64((seed, number)))
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
    set_added_parameters(Chance(np.random.PCG64((seed, number, 1))), values)
    rate = max(*natural_frequencies(values), values["box_frequency"])
    duration = rng.one_of(rng.power(-10.0, 0.0), *(rng.power(0.0, 5.0) for _ in "ab")) / rate
    clock = kind == "late" or rng.random() < 0.25
    start_time = rng.sign() * rng.power(0.0, 12.0) if clock else 0.0
    return ParameterSet(kind, values, start_time, duration)
