"""Adversarial states by the seed, the kernel's ends of them, and a dense search of its own.

Nothing in the search comes from the kernel: each mass is a sum
of complex exponentials by Newton's law, in SI units, omega = 1.
"""

from __future__ import annotations

import cmath
import math

import numpy as np

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator import roots, stepper

CLASSES = (
    *("near grazing", "nearly equal", "chattering", "long at high eta", "cubic inputs"),
    *("steep damping", "long contact"),
)
GRAZING, EQUAL, CHATTERING, FAST, CUBIC, STEEP, CONTACT = range(len(CLASSES))
NAMES = (
    *("m2", "k2", "d1", "d2", "box_amplitude", "box_frequency", "phase_start"),
    *("box_acceleration", "box_jerk", "box_snap", "box_crackle"),
    *("x1_start", "v1_start", "x2_start", "v2_start"),
)
HORIZON = 12.0
HORIZONS = (HORIZON, HORIZON, HORIZON, 6.0, HORIZON, 3.0, 60.0)  # of each class
OK, MISSED, NOT_A_ROOT, UNFINISHED, NOT_BEGUN = 0, 1, 2, 3, 4


def draw(seed: int, count: int) -> np.ndarray:
    """Parameters of states, the classes in turn: shape (count, number of NAMES)."""
    rng = np.random.default_rng(seed)
    kind = np.arange(count) % len(CLASSES)
    values = dict.fromkeys(NAMES, np.zeros(count))
    values["m2"], values["k2"] = (
        log_uniform(rng, 0.2, 5.0, count),
        log_uniform(rng, 0.2, 5.0, count),
    )
    for name in ("d1", "d2"):
        values[name] = np.where(rng.random(count) < 0.2, 0.0, log_uniform(rng, 1e-3, 1.0, count))
    values["box_amplitude"] = np.ones(count)
    values["box_frequency"] = log_uniform(rng, 0.15, 4.0, count)
    values["phase_start"] = rng.uniform(0.0, 2.0 * math.pi, count)
    values["x1_start"], values["v1_start"] = rng.uniform(-1, 0, count), rng.uniform(-1, 1, count)
    values["x2_start"], values["v2_start"] = rng.uniform(0.01, 1, count), rng.uniform(-1, 1, count)
    equal = kind == EQUAL
    near = 1.0 + log_uniform(rng, 1e-9, 1e-2, count) * rng.choice((-1.0, 1.0), count)
    values["k2"] = np.where(equal, values["m2"] * near, values["k2"])
    values["d2"] = np.where(equal, values["m2"] * values["d1"], values["d2"])
    touching = (kind == CHATTERING) | (equal & (rng.random(count) < 0.5))
    values["x2_start"] = np.where(touching, values["x1_start"], values["x2_start"])
    leave = values["v1_start"] + log_uniform(rng, 1e-9, 1.0, count)
    values["v2_start"] = np.where(touching, leave, values["v2_start"])
    fast = log_uniform(rng, 4.0, 40.0, count)
    values["box_frequency"] = np.where(kind == FAST, fast, values["box_frequency"])
    values["box_amplitude"] = np.where(kind == FAST, 0.3 / fast, values["box_amplitude"])
    for name in ("acceleration", "jerk", "snap", "crackle"):
        values[f"box_{name}"] = np.where(kind == CUBIC, rng.uniform(-0.2, 0.2, count), 0.0)
    for name in ("d1", "d2"):
        steep = np.where(rng.random(count) < 0.7, log_uniform(rng, 3.0, 40.0, count), values[name])
        values[name] = np.where(kind == STEEP, steep * values["m2"] ** (name == "d2"), values[name])
    press_together(rng, kind == CONTACT, values)
    return np.stack([values[name] for name in NAMES], axis=1)


def press_together(rng: np.random.Generator, chosen: np.ndarray, values: dict) -> None:
    """Let states begin as one, under a slow drive and a constant push of the box."""
    count = len(chosen)
    for one, other in (("x2_start", "x1_start"), ("v2_start", "v1_start")):
        values[one] = np.where(chosen, values[other], values[one])
    slow = log_uniform(rng, 0.02, 1.0, count)
    values["box_frequency"] = np.where(chosen, slow, values["box_frequency"])
    push = rng.uniform(-2.0, 2.0, count)
    values["box_acceleration"] = np.where(chosen, push, values["box_acceleration"])
    creep = rng.uniform(-0.02, 0.02, count) * (rng.random(count) < 0.3)
    values["box_jerk"] = np.where(chosen, creep, values["box_jerk"])


def log_uniform(rng: np.random.Generator, low: float, high: float, count: int) -> np.ndarray:
    """Numbers over decades."""
    return np.exp(rng.uniform(math.log(low), math.log(high), count))


def mass(m, d, k, x, v, a, w, phase, cubic, c, s, p, sign, at_slot):
    """Add one mass's motion to the amplitudes c, exponents s and polynomial p of the gap."""
    drive = 1j * a * w * w * cmath.exp(1j * phase)  # of the box's acceleration, -a w^2 sin
    forced = -drive / complex(k / m - w * w, w * d / m)
    q3 = -m * cubic[3] / k
    q2 = (-m * cubic[2] - d * q3) / k
    q1 = (-m * cubic[1] - d * q2 - m * q3) / k
    q0 = (-m * cubic[0] - d * q1 - m * q2) / k
    split = cmath.sqrt(complex(0.25 * d * d / (m * m) - k / m, 0.0))
    slow, fast = -0.5 * d / m + split, -0.5 * d / m - split
    left = x - forced.real - q0
    speed = v - (1j * w * forced).real - q1
    c[0] += sign * forced
    s[0] = complex(0.0, w)
    c[at_slot], s[at_slot] = sign * (speed - fast * left) / (slow - fast), slow
    c[at_slot + 1], s[at_slot + 1] = sign * (slow * left - speed) / (slow - fast), fast
    p[0] += sign * q0
    p[1] += sign * q1
    p[2] += sign * q2
    p[3] += sign * q3


def set_gap(row, c, s, p):
    """Amplitudes, exponents and polynomial of the gap of one flight."""
    c[:] = 0.0
    p[:] = 0.0
    box = row[7:11]
    mass(1.0, row[2], 1.0, row[11], row[12], row[4], row[5], row[6], box, c, s, p, -1.0, 1)
    mass(row[0], row[3], row[1], row[13], row[14], row[4], row[5], row[6], box, c, s, p, 1.0, 3)


def set_force(row, c, s, p):
    """The same of the force between both masses as one: ``(d2/m2 - d1) v + (k2/m2 - k1) x``."""
    c[:] = 0.0
    p[:] = 0.0
    m, d, k = 1.0 + row[0], row[2] + row[3], 1.0 + row[1]
    mass(m, d, k, row[11], row[12], row[4], row[5], row[6], row[7:11], c, s, p, 1.0, 1)
    s[3:] = 0.0
    by_speed, by_place = row[3] / row[0] - row[2], row[1] / row[0] - 1.0
    for i in range(3):
        c[i] *= by_speed * s[i] + by_place
    for i in range(4):
        p[i] = by_place * p[i] + (by_speed * p[i + 1] if i < 3 else 0.0)


def gap(c, s, p, t):
    """Value, slope and curvature."""
    value = p[0] + t * (p[1] + 0.5 * t * (p[2] + t * p[3] / 3.0))
    slope = p[1] + t * (p[2] + 0.5 * t * p[3])
    curvature = p[2] + t * p[3]
    for k in range(5):
        term = c[k] * cmath.exp(s[k] * t)
        value += term.real
        slope += (s[k] * term).real
        curvature += (s[k] * s[k] * term).real
    return value, slope, curvature


def sample(c, s, p, t):
    """Values and slopes at many points."""
    value = p[0] + t * (p[1] + 0.5 * t * (p[2] + t * p[3] / 3.0))
    slope = p[1] + t * (p[2] + 0.5 * t * p[3])
    for k in range(5):
        term = c[k] * np.exp(s[k] * t)
        value = value + term.real
        slope = slope + (s[k] * term).real
    return value, slope


def bottom(c, s, p, t):
    """A minimum near t, by Newton's method; as it is where the curvature is not positive."""
    for _ in range(4):
        _, slope, curvature = gap(c, s, p, t)
        if curvature > 0.0:
            t -= slope / curvature
    return t


def graze(row, c, s, p, depth):
    """Move x2_start so that the gap's first minimum is ``depth``, where it has one."""
    t = np.arange(1.0, 241.0) * (HORIZON / 240.0)
    for _ in range(4):
        set_gap(row, c, s, p)
        _, slope = sample(c, s, p, t)
        minima = np.flatnonzero((slope[:-1] < 0.0) & (slope[1:] >= 0.0))
        if len(minima) == 0:
            return
        low = bottom(c, s, p, t[minima[0]])
        half = 0.5 * row[3] / row[0]
        nu = math.sqrt(abs(row[1] / row[0] - half * half))
        lift = math.exp(-half * low) * (math.cos(nu * low) + half * math.sin(nu * low) / nu)
        if abs(lift) < 0.1 or low <= 0.0:
            return
        moved = row[13] + (depth - gap(c, s, p, low)[0]) / lift
        if not row[11] < moved < 10.0:
            return
        row[13] = moved


def search(c, s, p, stop, is_root):
    """Whether no root lies before ``stop``, and one there if it is said to be one."""
    size, fastest = 0.0, 1.0
    for k in range(5):
        size += abs(c[k])
        fastest = max(fastest, abs(s[k]))
    for k in range(4):
        size += abs(p[k]) * stop**k
    allowed = 4e-15 * size * (1.0 + fastest * stop)
    count = int(math.ceil(stop * fastest / 0.03)) + 2
    t = np.arange(1.0, count) * (stop / count)
    value, slope = sample(c, s, p, t)
    if value.min() < -allowed:
        return MISSED
    for i in np.flatnonzero((slope[:-1] < 0.0) & (slope[1:] >= 0.0)):
        low = bottom(c, s, p, t[i + 1])
        if t[i] < low < t[i + 1] and gap(c, s, p, low)[0] < -allowed:
            return MISSED
    last, slope_last, _ = gap(c, s, p, stop)
    if is_root and abs(last) > 10.0 * allowed + 1e-15 * stop * abs(slope_last):
        return NOT_A_ROOT
    return OK


def fill(m, row):
    """A memory with the parameters of one flight."""
    for i in range(len(m)):
        m[i] = 0.0
    m[at.M1] = 1.0
    m[at.K1] = 1.0
    m[at.E] = 0.7
    m[at.GAMMA] = 1e-12
    m[at.M2], m[at.K2], m[at.D1], m[at.D2] = row[0], row[1], row[2], row[3]
    m[at.BOX_AMPLITUDE], m[at.BOX_FREQUENCY], m[at.PHASE_START] = row[4], row[5], row[6]
    for i in range(4):
        m[at.BOX_ACCELERATION + i] = row[7 + i]
    m[at.X1_START], m[at.V1_START] = row[11], row[12]
    m[at.X2_START], m[at.V2_START] = row[13], row[14]


def state_end(m, row, horizon, mode):
    """The kernel's end of a state, or the horizon; and whether it is a root; minus a verdict where
    no state of that kind begins, or it does not get there.
    """
    fill(m, row)
    if stepper.initialize(m, 0.0) != at.OK or m[at.MODE] != mode:
        return -float(NOT_BEGUN), False
    m[at.WORK], m[at.WORK_LIMIT] = 0.0, 1e4
    roots.walk(m, horizon)
    if m[at.WORK] >= m[at.WORK_LIMIT]:
        return -float(UNFINISHED), False
    if m[at.END_KIND] == at.END_RENEWAL:  # many nodes on: another state of the same motion
        horizon = min(horizon, m[at.END])
    found = m[at.END_KIND] == at.END_EVENT and m[at.END] <= horizon
    return (m[at.END] if found else horizon), found


def judge(m, rows, depths, verdicts, ends):
    """Verdict and end of each state."""
    c, s, p = np.zeros(5, np.complex128), np.zeros(5, np.complex128), np.zeros(4)
    for i in range(len(rows)):
        row, kind = rows[i], i % len(CLASSES)
        if kind == GRAZING:
            graze(row, c, s, p, depths[i])
        mode = at.CONTACT if kind == CONTACT else at.FLIGHT
        end, found = state_end(m, row, HORIZONS[kind], mode)
        ends[i] = end
        if end < 0.0:
            verdicts[i] = int(-end)
            continue
        if kind == CONTACT:
            set_force(row, c, s, p)
        else:
            set_gap(row, c, s, p)
        verdicts[i] = search(c, s, p, end, found)


def campaign(seed: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Parameters, verdicts and ends of many states."""
    rows = draw(seed, count)
    rng = np.random.default_rng(seed + 1)
    depths = log_uniform(rng, 1e-11, 1e-3, count) * rng.choice((-1.0, 1.0), count)
    verdicts, ends = np.zeros(count, np.int64), np.zeros(count)
    judge(np.zeros(at.SIZE), rows, depths, verdicts, ends)
    return rows, verdicts, ends
