"""Draw random beams and benches, measure them, and state the truth and a guess of each."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from orchestrate import Structure
from orchestrate.constants import TURN
from orchestrate.lazy import xr

from .beam import DelaminatedBeam
from .bench import Bench
from .excitation import Excitation, Random, Stepped, Swept
from .integrator import UnboundedMotionError
from .lumped import Clamp, Faces, Halves, cubic_stiffness, in_rattling_clamp
from .sensors import Sensor
from .system import ModalSystem, Motion

OPENED = 1e-6  # m: a gap that counts; a penalty lets go of less where nothing opens
FIRST, LAST, DURATION = 20.0, 90.0, 40.0  # Hz, Hz, s
LEVEL = (2.0, 10.0)  # m/s2
PRELOAD = (0.1, 1.6)  # force on the faces, over the one that opens them at resonance
SPLIT = ("delaminated", "gap", "preloaded")
EXCITATIONS = ("up", "down", "log", "stepped", "random")
MOST_APART = 1.5  # frequencies of a guess; the second mode of a hardly delaminated beam is far away
TRIES = 20  # of a softening beam whose motion escapes


@dataclass(frozen=True)
class Setup:
    """Test conditions of a beam: level, noise, number of sensors, excitation."""

    level: float  # peak of the base, m/s2; of noise twice the root mean square
    noise: float  # of the accelerometers, over the root mean square of what they read
    sensors: int
    excitation: str


@dataclass(frozen=True, kw_only=True)
class Truth:
    """The true properties of a specimen and its measurement, to judge verdicts by."""

    kind: str  # of the recipe
    is_delaminated: bool
    opened: bool  # whether the faces parted by more than `OPENED` in the record
    touched: bool  # whether they touched
    halves: Halves  # of a sound beam the frequencies and damping of both are those of the whole
    seen_gap: float = 0.0  # m: of the faces at the sensors
    size: float = math.nan  # length of the delamination over that of the beam; NaN for two masses
    setup: Setup


@dataclass(frozen=True)
class Case:
    """A measured record, the guess of the beam before its test, and the truth."""

    record: xr.Dataset
    guess: Structure
    truth: Truth


@dataclass(frozen=True)
class Specimen:
    """A beam's modal system, and its true masses, frequencies and damping."""

    system: ModalSystem
    halves: Halves
    clearance: float = 0.0
    size: float = math.nan
    sound: bool = False


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """Ranges from which a test's conditions are drawn, uniformly in the logarithm."""

    noise: tuple[float, float] = (0.01, 0.05)
    # one of `EXCITATIONS`, or `"any"`: one up in ten is log, stepped, random
    excitation: str = "up"
    sensors: int = 0  # 1 or 2, or 0 for either
    # length of the delamination of a beam of finite elements, parts of the beam's; whether it may
    # end before the free end; place of the sensors, parts of the length (None: where mode 1 moves
    # as a mass on a spring)
    size: tuple[float, float] = (0.1, 0.9)
    anywhere: bool = False
    sensor: tuple[float, float] | None = None
    participation: tuple[float, float] = (1.0, 1.0)  # of each sensor on masses
    off: float = 0.1  # how far guesses may be off


def draw_log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number between two bounds, uniformly in its logarithm."""
    return float(np.exp(rng.uniform(math.log(low), math.log(high))))


def draw_halves(rng: np.random.Generator) -> Halves:
    """Draw two halves whose bonded resonance is well inside the sweep."""
    middle, apart = rng.uniform(33.0, 62.0), rng.uniform(1.06, 1.4)
    slow, fast = middle / math.sqrt(apart), middle * math.sqrt(apart)
    f1, f2 = (slow, fast) if rng.random() < 0.5 else (fast, slow)
    m1 = rng.uniform(0.5, 3.0)
    m2 = m1 * draw_log_uniform(rng, 0.6, 1.67)
    damping = draw_log_uniform(rng, 0.004, 0.02)
    second = damping * draw_log_uniform(rng, 0.7, 1.4)
    return Halves(m1=m1, m2=m2, f1=f1, f2=f2, zeta1=damping, zeta2=second)


def draw_contact_law(rng: np.random.Generator) -> Faces:
    """Draw a contact law; one in four slides with friction."""
    return Faces(
        law=str(rng.choice(["linear", "hunt-crossley", "hertz"])),
        frequency=draw_log_uniform(rng, 500.0, 1500.0),
        restitution=rng.uniform(0.35, 0.85),
        friction=rng.uniform(0.0, 0.3) if rng.random() < 0.25 else 0.0,
    )


def bonded_specimen(own: Halves, system: ModalSystem) -> Specimen:
    """Return a specimen of a bonded beam with its modal system."""
    one = own.bonded_beam()
    whole = replace(own, f1=one.f, f2=one.f, zeta1=one.zeta, zeta2=one.zeta)
    return Specimen(system, whole, sound=True)


def two_mass_specimen(rng: np.random.Generator, own: Halves, clearance: float = 0.0) -> Specimen:
    """Return a specimen of two masses that touch by a contact law, which is drawn."""
    faces = replace(draw_contact_law(rng), clearance=clearance)
    return Specimen(own.delaminated(faces), own, clearance)


def draw_delaminated(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw a specimen of two halves that touch at rest without force."""
    return two_mass_specimen(rng, draw_halves(rng))


def draw_with_gap(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw a specimen of two halves with a gap of 0.1 to 2 mm at rest."""
    own, clearance = draw_halves(rng), draw_log_uniform(rng, 1e-4, 2e-3)
    return two_mass_specimen(rng, own, clearance)


def draw_preloaded(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw halves pressed together by a part of the force that opens them at resonance."""
    own = draw_halves(rng)
    k1, k2 = own.m1 * (TURN * own.f1) ** 2, own.m2 * (TURN * own.f2) ** 2
    one = own.bonded_beam()
    peak = level / (2.0 * one.zeta)  # acceleration over the base
    force = own.m1 * peak * abs((own.f1 / one.f) ** 2 - 1.0)
    clearance = -rng.uniform(*PRELOAD) * force * (1.0 / k1 + 1.0 / k2)
    return two_mass_specimen(rng, own, clearance)


def draw_sound(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw a bonded, linear beam."""
    own = draw_halves(rng)
    return bonded_specimen(own, own.bonded())


def draw_hardening(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw a bonded beam whose frequency at the peak is up to 30 % higher, or 15 % lower."""
    own = draw_halves(rng)
    one = own.bonded_beam()
    change = rng.uniform(0.03, 0.3) if rng.random() < 0.7 else -rng.uniform(0.02, 0.15)
    peak = level / (2.0 * one.zeta * (TURN * one.f) ** 2 * (1.0 + change))
    cubic = cubic_stiffness(change, one.f, peak)
    return bonded_specimen(own, own.bonded(cubic=cubic))


def draw_sagging(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw a bonded beam that hardens by up to 15 % and is stiffer to one side."""
    own = draw_halves(rng)
    one = own.bonded_beam()
    change = rng.uniform(0.02, 0.15)
    peak = level / (2.0 * one.zeta * (TURN * one.f) ** 2 * (1.0 + change))
    cubic, sag = cubic_stiffness(change, one.f, peak), peak * rng.uniform(0.1, 0.5)
    specimen = bonded_specimen(own, own.bonded(cubic=cubic, sag=sag))
    f = one.f * math.sqrt(1.0 + 3.0 * cubic * sag**2 / (TURN * one.f) ** 2)
    return replace(specimen, halves=replace(specimen.halves, f1=f, f2=f))


def draw_with_friction(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw a bonded beam with dry friction of 5 to 50 % of the driving force."""
    own = draw_halves(rng)
    return bonded_specimen(own, own.bonded(friction=level * rng.uniform(0.05, 0.5)))


def draw_clamp(rng: np.random.Generator) -> Clamp:
    """Draw a clamp with play, the root pressed against one side or loose."""
    play = draw_log_uniform(rng, 2e-5, 3e-4) * (-1.0 if rng.random() < 0.3 else 1.0)
    stops = Faces(frequency=draw_log_uniform(rng, 400.0, 1000.0), restitution=rng.uniform(0.3, 0.8))
    return Clamp(
        faces=stops,
        play=play,
        both_sides=play > 0.0 and bool(rng.random() < 0.7),
        mass=rng.uniform(0.1, 0.5),
        centring=draw_log_uniform(rng, 0.3, 3.0),
    )


def draw_in_clamp(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw a bonded beam in a rattling clamp."""
    own = draw_halves(rng)
    mass = own.bonded_beam().mass
    return bonded_specimen(own, in_rattling_clamp(own.bonded(), mass, draw_clamp(rng)))


def draw_with_torsion(
    rng: np.random.Generator, level: float, conditions: Conditions, clamped: bool = True
) -> Specimen:
    """Draw a bonded beam with torsion 3 to 13 % above or below bending, also in a loose clamp."""
    own = draw_halves(rng)
    ratio = rng.uniform(1.03, 1.13)
    system = own.bonded_with_torsion(
        ratio=ratio if rng.random() < 0.7 else 1.0 / ratio,
        participation=rng.uniform(0.3, 0.6),
        offset=rng.uniform(0.1, 0.3),
    )
    if not clamped:  # both modes together move less than this mass
        system = in_rattling_clamp(system, 1.5 * own.bonded_beam().mass, draw_clamp(rng))
    return bonded_specimen(own, system)


def draw_place(
    rng: np.random.Generator, beam: DelaminatedBeam, conditions: Conditions
) -> float | None:
    """Draw the position of the sensors on a beam, m; None where the conditions have no range."""
    return rng.uniform(*conditions.sensor) * beam.length if conditions.sensor else None


def shut_frequency(system: ModalSystem) -> float:
    """Return the lowest natural frequency of a system whose contacts are closed, Hz."""
    contacts = system.contacts
    closed = np.diag(system.frequency**2)
    closed += contacts.rows.T * contacts.stiffness @ contacts.rows
    return math.sqrt(float(np.linalg.eigvalsh(closed)[0])) / TURN


def draw_finite_elements(
    rng: np.random.Generator, level: float, conditions: Conditions
) -> Specimen:
    """Draw a finite-element cantilever, delaminated from its free end on, or anywhere."""
    size = rng.uniform(*conditions.size)
    last = rng.uniform(size, 1.0) if conditions.anywhere and rng.random() < 0.5 else 1.0
    share = 0.5 + float(rng.choice([-1.0, 1.0])) * rng.uniform(0.03, 0.2)
    thickness = DelaminatedBeam.thickness * rng.uniform(0.9, 1.5)
    beam = DelaminatedBeam(first=last - size, last=last, thickness=thickness, share=share)
    touching = replace(draw_contact_law(rng), law="hunt-crossley", friction=0.0)
    zeta = draw_log_uniform(rng, 0.005, 0.02)
    system = beam.system(touching, zeta, modes=12, sensor=draw_place(rng, beam, conditions))
    f1, shut = float(system.frequency[0]) / TURN, shut_frequency(system)
    f2 = math.sqrt((shut**2 - share * f1**2) / (1.0 - share))
    halves = Halves(m1=share, m2=1.0 - share, f1=f1, f2=f2, zeta1=zeta, zeta2=zeta)
    return Specimen(system, halves, size=size)


def draw_intact_finite_elements(
    rng: np.random.Generator, level: float, conditions: Conditions, clamped: bool = True
) -> Specimen:
    """Draw a finite-element cantilever without a delamination, in a firm or a rattling clamp."""
    thickness = DelaminatedBeam.thickness * rng.uniform(0.9, 1.5)
    beam = DelaminatedBeam(first=0.0, last=0.0, thickness=thickness)
    zeta, modes = draw_log_uniform(rng, 0.005, 0.02), 4 if clamped else 10
    system = beam.system(Faces(), zeta, modes=modes, sensor=draw_place(rng, beam, conditions))
    f = float(system.frequency[0]) / TURN
    if not clamped:
        system = in_rattling_clamp(system, beam.section(1.0).mass * beam.length, draw_clamp(rng))
    halves = Halves(m1=0.5, m2=0.5, f1=f, f2=f, zeta1=zeta, zeta2=zeta)
    return Specimen(system, halves, sound=True, size=0.0)


Maker = Callable[[np.random.Generator, float, Conditions], Specimen]
KINDS: Mapping[str, Maker] = {
    "sound": draw_sound,
    "hardening": draw_hardening,
    "sagging": draw_sagging,
    "friction": draw_with_friction,
    "clamp": draw_in_clamp,
    "torsion": draw_with_torsion,
    "delaminated": draw_delaminated,
    "gap": draw_with_gap,
    "preloaded": draw_preloaded,
    "elements": draw_finite_elements,
    "intact elements": draw_intact_finite_elements,
    "rattling torsion": partial(draw_with_torsion, clamped=False),
    "rattling elements": partial(draw_intact_finite_elements, clamped=False),
}


def draw_excitation(rng: np.random.Generator, name: str, level: float) -> tuple[str, Excitation]:
    """Draw a base excitation of a kind, or of any kind; return the kind's name and it."""
    if name == "any":
        name = str(rng.choice(EXCITATIONS, p=(0.6, 0.15, 0.1, 0.1, 0.05)))
    ends = (LAST, FIRST) if name == "down" else (FIRST, LAST)
    if name == "random":
        return name, Random(*ends, DURATION, 0.5 * level, int(rng.integers(1 << 31)))
    if name == "stepped":
        return name, Stepped(*ends, DURATION, level, steps=80)
    return name, Swept(*ends, DURATION, level, log=name == "log")


def draw_sensor(rng: np.random.Generator, noise: float, bandwidth: float) -> Sensor:
    """Draw a sensor with a gain error of up to 3 % and a delay of up to 50 us."""
    gain, delay = rng.uniform(0.97, 1.03), rng.uniform(0.0, 5e-5)
    return Sensor(bandwidth=bandwidth, gain=gain, delay=delay, noise=noise)


def draw_guess(rng: np.random.Generator, beam: Specimen, off: float) -> Structure:
    """Draw a guess: true masses and frequencies with relative errors, damping by up to 2."""

    def near(value: float) -> float:
        return value * float(rng.uniform(1.0 - off, 1.0 + off))

    own = beam.halves
    f1, f2 = own.f1, min(own.f2, MOST_APART * own.f1)
    if beam.sound:
        apart = math.sqrt(rng.uniform(1.06, 1.4))
        f1, f2 = f1 / apart, f2 * apart
    return Structure.from_halves(
        m1=near(own.m1),
        m2=near(own.m2),
        f1=near(f1),
        f2=near(f2),
        zeta1=own.zeta1 * draw_log_uniform(rng, 0.5, 2.0),
        zeta2=own.zeta2 * draw_log_uniform(rng, 0.5, 2.0),
        e=0.6,
    )


def draw_levels(
    rng: np.random.Generator,
    kind: str,
    conditions: Conditions = Conditions(),
    rate: float = 2000.0,
    kinds: Mapping[str, Maker] = KINDS,
    times: Sequence[float] = (1.0,),
) -> list[Case]:
    """Draw a beam and a bench, and measure it at multiples of the level it is drawn for."""
    level = draw_log_uniform(rng, *LEVEL)
    noise = draw_log_uniform(rng, *conditions.noise)
    name, shaker = draw_excitation(rng, conditions.excitation, level)
    count = conditions.sensors or int(rng.integers(1, 3))
    bandwidth = draw_log_uniform(rng, 1000.0, 4000.0)
    box, face1, face2 = (draw_sensor(rng, noise, bandwidth) for _ in range(3))
    bench = Bench(
        excitation=shaker,
        box=replace(box, noise=min(noise, 0.02)),
        face1=face1,
        face2=face2 if count == 2 else None,
        rate=rate,
        steps=30.0 if "elements" in kind else 60.0,
    )
    louder = [replace(bench, excitation=replace(shaker, level=n * shaker.level)) for n in times]
    for _ in range(TRIES):
        own = kinds[kind](rng, level, conditions)
        placed = own.system
        if conditions.participation != (1.0, 1.0):
            rows = rng.uniform(*conditions.participation, (2, 1)) * placed.output_rows
            placed = replace(placed, output_rows=rows)
        try:
            measured = [one.measure(placed, int(rng.integers(1 << 31))) for one in louder]
        except UnboundedMotionError:
            continue
        guess = draw_guess(rng, own, conditions.off)
        return [
            Case(record, guess, make_truth(kind, own, moved, Setup(n * level, noise, count, name)))
            for n, (record, moved) in zip(times, measured, strict=True)
        ]
    raise UnboundedMotionError(f"{kind}: {TRIES} beams, and none whose motion stays bounded")


def gap_at_sensors(system: ModalSystem, motion: Motion) -> float:
    """Return the largest gap, m, of the contact next to the sensors; 0 where no face parts."""
    apart, rows = system.output_rows[0] - system.output_rows[-1], system.contacts.rows
    if not (len(rows) and apart.any()):
        return 0.0
    away = [np.linalg.norm(rows + sign * apart, axis=1) for sign in (1.0, -1.0)]
    return float(motion.largest_gap[np.minimum(*away).argmin()])


def make_truth(kind: str, own: Specimen, motion: Motion, setup: Setup) -> Truth:
    """Return the truth of a specimen, from how it was drawn and how it moved."""
    opened, touched = (motion.largest_gap > OPENED).any(), (motion.largest_force > 0.0).any()
    return Truth(
        kind=kind,
        is_delaminated=not own.sound,
        opened=not own.sound and bool(opened),
        touched=not own.sound and bool(touched),
        halves=own.halves,
        seen_gap=gap_at_sensors(own.system, motion),
        size=own.size,
        setup=setup,
    )
