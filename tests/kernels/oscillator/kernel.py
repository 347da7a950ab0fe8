"""A kernel's flat memory from keyword arguments, and the states that a step passes through."""

import math
from unittest.mock import patch

import mpmath as mp
from hypothesis import settings
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator import motion, stepper
from fmu_src.kernels.oscillator.excitation import have_inputs_changed

DEFAULTS = {
    **{"m1": 1.0, "m2": 1.0, "k1": 1.0, "k2": 1.2, "d1": 0.01, "d2": 0.01, "e": 0.7},
    **{"gamma": 3.6515e-4, "box_amplitude": 1.0, "box_frequency": 0.4, "x_rel_max_on": 1.0},
    "evaluation_limit": 1e7,
}
FORCES = (
    *("force1_amplitude", "force2_amplitude", "force1", "force1_1", "force1_2", "force1_3"),
    *("force2", "force2_1", "force2_2", "force2_3"),
)
least_work = patch.multiple(stepper, WORK_BASE=5000.0, WORK_RATE=0.0)  # steps that give up early


def unstarted(**values):
    m = [0.0] * at.SIZE
    for name, value in {**DEFAULTS, **values}.items():
        m[getattr(at, name.upper())] = float(value)
    return m


def started(time=0.0, **values):
    """A memory after a successful ``initialize``."""
    m = unstarted(**values)
    assert stepper.initialize(m, time) == at.OK
    return m


def advanced(m, *times):
    for time in times:
        assert stepper.advance(m, time) == at.OK
    return m


def set_inputs(m, **values):
    for name, value in values.items():
        m[getattr(at, name.upper())] = value


def pieces(m, time):
    """Advance to ``time``; states passed through as (memory, age at entry, age at exit)."""
    passed = []
    entry = [0.0 if have_inputs_changed(m) else stepper.local_time(m, m[at.TIME])]
    end_state = motion.end_state

    def note(now):
        passed.append((list(now), entry[0], now[at.END]))
        entry[0] = 0.0
        end_state(now)

    with patch.object(stepper, "end_state", note):
        advanced(m, time)
    passed.append((list(m), entry[0], stepper.local_time(m, time)))
    return passed


def flight(x1, v1, x2, v2, **values):
    """A motion from initial conditions at the start time, in a structure with omega = 1."""
    return started(x1_start=x1, v1_start=v1, x2_start=x2, v2_start=v2, **values)


def examples(count):
    """Settings of a property: all of ``count`` examples in the slow run, else a tenth."""
    return settings(max_examples=max(8, count * settings.default.max_examples // 100))


def sizes(low, high):
    return st.floats(math.log(low), math.log(high)).map(math.exp)


def rounded(low, high):
    """Floats of three decimals: zero among them, but nothing that is almost zero."""
    return st.floats(low, high).map(lambda x: round(x, 3))


def rest_together(values):
    """Where both springs balance while the masses are together, from unloaded springs."""
    known = {**DEFAULTS, **values}
    clearance, total = mp.mpf(known.get("clearance", 0.0)), mp.mpf(known["k1"]) + known["k2"]
    return clearance * known["k2"] / total, -clearance * known["k1"] / total


def unloaded(values, state):
    """A start state (x1, v1, x2, v2), which counts from rest, from unloaded springs."""
    if values.get("clearance", 0.0) >= 0.0:
        return state
    (x1, v1, x2, v2), (rest_1, rest_2) = state, rest_together(values)
    return x1 + rest_1, v1, x2 + rest_2, v2


@st.composite
def structures(draw, damping=2.0, clearance=False):
    """Structures with omega = 1, their excitation and phase: light and heavy masses, undamped to
    overdamped, with cubics and forces, and with a gap or a preload where it is asked for.

    Not near critical damping, where the sums of exponentials that the kernel is compared with
    cancel in double precision.
    """
    values = {name: draw(sizes(0.2, 5.0)) for name in ("m2", "k2")}
    values["box_frequency"] = draw(sizes(0.15, 4.0))
    for name, critical in (("d1", 2.0), ("d2", 2.0 * math.sqrt(values["k2"] * values["m2"]))):
        value = draw(st.just(0.0) | sizes(1e-3, damping))
        values[name] = 0.9 * value if abs(value - critical) < 0.05 * critical else value
    values["phase_start"] = draw(rounded(0.0, 6.28))
    for name in ("acceleration", "jerk", "snap", "crackle"):
        values[f"box_{name}"] = draw(st.just(0.0) | rounded(-0.1, 0.1))
    for name in draw(st.just(()) | st.lists(st.sampled_from(FORCES), max_size=4, unique=True)):
        values[name] = draw(rounded(-0.3, 0.3))
    if clearance:
        values["clearance"] = draw(st.just(0.0) | rounded(-1.0, 1.0) | sizes(1e-9, 1e3))
    m = unstarted(**values)
    stepper.initialize(m, 0.0)
    if m[at.SECULAR] != 0.0:  # see `resonances`
        values["d1"] = values["d2"] = 0.01
    return values


@st.composite
def resonances(draw):
    """The same, driven on a natural frequency or beside it, with no damping or next to none."""
    values = draw(structures())
    kind = draw(st.sampled_from(("1", "2", "3", "equal", "nearly equal")))
    if "equal" in kind:
        near = draw(sizes(1e-12, 3e-5)) if kind == "nearly equal" else 0.0
        values["k2"] = values["m2"] * (1.0 + near)
    total = (1.0 + values["k2"]) / (1.0 + values["m2"])
    square = {"2": values["k2"] / values["m2"], "3": total}.get(kind, 1.0)
    detuning = draw(st.just(0.0) | sizes(1e-14, 9e-5))
    values["box_frequency"] = math.sqrt(square) * (1.0 + detuning * draw(st.sampled_from((-1, 1))))
    values["d1"] = draw(st.just(0.0) | sizes(1e-14, 1e-5))
    own = values["d1"] if "equal" in kind else draw(st.just(0.0) | sizes(1e-14, 1e-5))
    values["d2"] = values["m2"] * own
    return values
