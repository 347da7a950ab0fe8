"""Small questions of every public function, drawn from a generator: what the referee asks."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import orchestrate as o

from .. import draws

SLOW = ("border", "detect", "detect_all", "fit", "couple_all", "jump_voltages")  # 1 s or more
# they draw and write: nothing is computed
NOT_COMPARED = ("channels", "plot", "report", "to_dataframe", "write_ssp")
QUIET: dict[str, Any] = {"progress": False, "jobs": 1}
BRIEF: dict[str, Any] = {"transient": 50, **QUIET}
SHORT: dict[str, Any] = {"samples": 60, **BRIEF}  # of fewer no repetition is decided
QUICK: dict[str, Any] = {"back": False, "step": 0.2, **QUIET}
FAST: dict[str, Any] = {"rate": 4e-4, "settle": 50.0, **QUICK}
PAPER = {"6": (0.7, 0.005), "10": (0.7, 0.05), "11": (0.3, 0.005)}  # e and D of its sweeps
Ask = Callable[["Draw"], xr.Dataset]


class Draw:
    """What a question is about: a structure with or without gap or preload, a drive, a record."""

    def __init__(self, rng: np.random.Generator) -> None:
        """Draw the structure and its frequency ratio; the rest when it is used."""
        self.structure, self.eta = draws.draw_structure(rng)
        self.rng = rng
        self.near = self.eta * np.array([0.97, 1.0, 1.03])
        self.frequency = self.near * self.structure.omega
        self.system = draws.System(o.Structure.from_file("quick"), o.Drive.from_file("quick"))
        self.ends = (lambda low: (low, low + 0.03))(float(rng.uniform(1.2, 1.6)))

    def volts(self) -> float:
        return self.ends[0] * float(self.system.drive.volts(self.system.structure))

    def halves(self) -> o.Structure:
        f1, m1, e = (float(self.rng.uniform(*ends)) for ends in ((27, 33), (1, 2), (0.3, 0.8)))
        return o.Structure.from_halves(m1=m1, m2=1.2, f1=f1, f2=38.0, zeta1=0.02, zeta2=0.02, e=e)

    def excitation(self) -> Any:
        return (
            o.SweptSine(first=26.0, last=42.0, duration=2.0, acceleration=5.0),
            o.SteppedSine(frequencies=(30.0, 34.0), acceleration=5.0, settle_cycles=5),
            o.Random(psd=((5.0, 0.1), (100.0, 0.1)), duration=1.0, seed=1),
            o.Shock(peak=50.0, length=0.01),
            o.Sampled(acceleration=tuple(self.rng.standard_normal(200)), sample_rate=200.0),
        )[int(self.rng.integers(5))]

    def felt(self, duration: float = 4.0) -> xr.Dataset:
        """Return what sensors read of halves in a swept sine."""
        sweep = o.SweptSine(first=26.0, last=42.0, duration=duration, acceleration=5.0)
        history = o.shake(self.halves(), sweep, sample_rate=600.0, progress=False)
        return o.measure(history, o.Sensor(bandwidth=250.0, sample_rate=600.0), excitation=sweep)

    def record(self, duration: float = 4.0) -> xr.Dataset:
        felt, channels = self.felt(duration), {}
        for name in ("box_acceleration", "acceleration1", "acceleration2"):
            values = felt[name].values
            noise = 0.02 * values.std() * self.rng.standard_normal(len(values))
            channels[name] = values + noise
        return o.record(time=felt.time.values, **channels)

    def written(self) -> xr.Dataset:
        with tempfile.TemporaryDirectory() as folder:
            return o.read_record(o.write_record(self.record(), Path(folder) / "record.unv"))

    def curve(self, by_file: bool) -> xr.Dataset:
        """Return a resonance curve from arrays, or from a table in a file."""
        hertz = np.linspace(20.0, 40.0, 21)
        height = 1.0 / np.hypot(1.0 - (hertz / self.rng.uniform(25, 35)) ** 2, 0.04)
        if not by_file:
            return o.resonance_curve(frequency=hertz, level=1.0, amplitude1=height)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "curve.csv"
            words = {"header": "f / Hz,a / m/s2", "comments": ""}
            np.savetxt(path, np.c_[hertz, height], "%.17g", ",", **words)
            columns = {"frequency": "f / Hz", "amplitude1": "a / m/s2"}
            return o.read_curve(path, columns=columns, unit="m/s2", level=1.0)

    def window(self) -> tuple[o.Structure, xr.Dataset]:
        """Return a structure near the paper's and its branch from eta 2.6 to the first ends."""
        e = float(self.rng.uniform(0.65, 0.75))
        structure = o.Structure.nondimensional(e=e)
        return structure, o.branch(structure, eta=2.6, limits=(2.4, 3.2), progress=False)


def ask_border(q: Draw) -> xr.Dataset:
    structure, start = q.window()
    limits = ((2.3, 3.4), (0.6, 0.8))
    return o.border(structure, start=start, bifurcation=0, limits=limits, most=3, progress=False)


def ask_plan(q: Draw) -> xr.Dataset:
    sensor = o.Sensor(bandwidth=400.0, noise=0.004, range=60.0)
    return o.plan_test(q.halves(), sensor=sensor, levels=[0.4, 10.0], **QUIET)


def ask_halves(q: Draw) -> xr.Dataset:
    """The halves by a knock on each, with a gap between them."""
    apart = q.halves().replace(clearance=0.01)
    knocks = [o.Hammer(peak=5.0, width=0.004, half=half, duration=4.0) for half in (1, 2)]
    return o.halves(*(o.shake(apart, one, sample_rate=2000.0, **QUIET) for one in knocks))


GUESS = o.Structure.from_halves(m1=1.5, m2=1.2, f1=31.5, f2=36.5, zeta1=0.03, zeta2=0.015, e=0.6)
PLANE: dict[str, Any] = {"y": ("v_rel", -1.0, 1.0, 10), "transient": 50, "longest": 500, **QUIET}


def passage(q: Draw) -> xr.Dataset:
    return o.passage(*q.system, voltage=q.ends, **FAST)


def basin(q: Draw) -> xr.Dataset:
    return o.basin(q.structure, eta=q.eta, x=("x_rel", 0.0, 1.0, 10), **PLANE)


QUESTIONS: dict[str, Ask] = {
    "simulate": lambda q: o.simulate(q.structure, eta=q.eta, periods=9, points=20, **QUIET),
    "sweep": lambda q: o.sweep(q.structure, eta=q.near, **SHORT, direction="both"),
    "resonance": lambda q: o.resonance(q.structure, frequency=q.frequency, amplitude=0.5, **SHORT),
    "resonance_levels": lambda q: o.resonance_levels(
        q.structure, frequency=q.frequency, level=[0.1, 5.0], **SHORT
    ),
    "contact_threshold": lambda q: o.contact_threshold(
        q.structure.replace(clearance=-0.1), eta=q.near
    ),
    "map": lambda q: o.map(q.structure, eta=q.near, e=[0.3, 0.7], **SHORT),
    "lyapunov": lambda q: o.lyapunov(q.structure, eta=q.near, periods=200, **BRIEF),
    "attractors": lambda q: o.attractors(q.structure, eta=q.eta, starts=5, **BRIEF),
    "basin": basin,
    "basin_entropy": lambda q: o.basin_entropy(basin(q), box=2),
    "impact_statistics": lambda q: o.impact_statistics(
        q.structure, eta=q.near, periods=50, **BRIEF
    ),
    "spectra": lambda q: o.spectra(q.structure, eta=q.near, periods=4, points=128, **BRIEF),
    "poincare": lambda q: o.poincare(
        q.structure, eta=q.eta, periods=50, at=str(q.rng.choice(["phase", "impacts"])), **BRIEF
    ),
    "orbit": lambda q: o.orbit(q.structure, eta=q.eta, **QUIET),
    "manifold": lambda q: o.manifold(
        o.Structure.nondimensional(e=float(q.rng.uniform(0.6, 0.8))), eta=3.0, length=0.3, **QUIET
    ),
    "branch": lambda q: o.branch(
        q.structure, eta=q.eta, limits=(q.near[0], q.near[2]), most=50, **QUIET
    ),
    "border": ask_border,
    "shake": lambda q: o.shake(q.halves(), q.excitation(), sample_rate=600.0, **QUIET),
    "measure": lambda q: q.felt(),
    "record": lambda q: q.record(),
    "read_record": lambda q: q.written(),
    "write_record": lambda q: q.written(),
    "resonance_curve": lambda q: q.curve(False),
    "read_curve": lambda q: q.curve(True),
    "frf": lambda q: o.frf(q.record()),
    "psd": lambda q: o.psd(q.record()),
    "track_orders": lambda q: o.track_orders(q.record()),
    "harmonics": lambda q: o.harmonics(q.record()),
    "spectrogram": lambda q: o.spectrogram(q.record()),
    "shock_spectrum": lambda q: o.shock_spectrum(q.record()),
    "probability_density": lambda q: o.probability_density(q.record()),
    "signs": lambda q: o.signs(q.record(), structure=GUESS),
    "fit": lambda q: o.fit(q.record(), GUESS, **QUIET),
    "detect": lambda q: o.detect(q.record(), GUESS, **QUIET),
    "detect_all": lambda q: o.detect_all({"one": q.record()}, GUESS, **QUIET)["one"],
    "plan_test": ask_plan,
    "halves": ask_halves,
    "cosimulate": lambda q: o.cosimulate(
        *q.system, inputs={"voltage": q.volts()}, duration=10.0, step=0.1, **QUIET
    ),
    "couple": lambda q: o.couple(*q.system, voltage=q.ends, **FAST),
    "couple_all": lambda q: o.couple_all({"one": q.system}, eta0=q.ends, rates=[4e-4], **QUICK),
    "record_of_run": lambda q: o.record_of_run(passage(q)),
    "passage": passage,
    "waterfall": lambda q: o.waterfall(passage(q), revolutions=4),
    "capture": lambda q: o.capture(
        *q.system, voltage=q.ends, count=2, tolerance=0.01, time=200.0, step=0.2, **QUIET
    ),
    "jump_voltages": lambda q: o.jump_voltages(
        *q.system, voltage=q.ends, rates=[4e-4, 2e-4], settle=50.0, **QUICK
    ),
    "drive_branch": lambda q: o.drive_branch(
        *q.system, speed=q.ends, most=3, steps=16, settle=50.0, **QUIET
    ),
    "drive_spectra": lambda q: o.drive_spectra(
        *q.system, voltage=q.ends[0], revolutions=8, points=64, step=0.2, **QUIET
    ),
}


def figure(number: str, stride: int) -> xr.Dataset:
    """Answer a sweep of the paper: every ``stride``-th of its 7,901 frequency ratios."""
    e, D = PAPER[number]
    structure = o.Structure.nondimensional(e=e, D=D)
    return o.sweep(structure, eta=np.arange(100, 8001, stride) / 1000, **QUIET)


def beam(number: int) -> xr.Dataset:
    case = draws.draw_beam(4500, number)
    return o.detect(case.record, case.guess, **QUIET)


def attractors(number: int) -> xr.Dataset:
    """Search the attractors of a structure of the campaign."""
    structure, eta = draws.draw_structure(np.random.default_rng([4500, number]))
    return o.attractors(structure, eta=[eta, 1.003 * eta], starts=16, seed=number, **QUIET)


def drive(number: int) -> xr.Dataset:
    """Ramp a drive, at one of the four rates: eight questions a drive, bonded and delaminated."""
    number, part = divmod(number, 8)
    system = draws.draw_with_folds(np.random.default_rng([4500, number]))
    structure, motor = system.of_kind(("bonded", "delaminated")[part % 2])
    volts = motor.volts(structure)
    first, last = (end * volts for end in draws.ramp_ends(system))
    rate = draws.RATES[part // 2] * volts * structure.omega
    return o.couple(structure, motor, voltage=(first, last), rate=rate, **QUIET)
