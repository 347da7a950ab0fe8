"""Record the passage through the resonance at every communication step, with spectra.

Of a long run only what lies around the jumps may be kept. :func:`waterfall` makes spectra over the
motor's revolutions of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..constants import TURN
from ..errors import InputError
from ..fmu.exported import make_fmu_finder
from ..lazy import Unpack, xr
from ..model.arguments import checked_integer
from ..model.drive import Drive
from ..model.ranges import checked_range
from ..model.structure import Structure
from ..response.labels import variable
from ..response.spectra import amplitude_spectrum
from ..running.job import Table
from ..running.options import Running
from ..running.runner import compute_dataset
from . import couple
from .controllers import Controller
from .energy_balance import ACCOUNTS
from .revolutions import COLUMNS
from .run import MotorRun
from .schedule import Schedule

SAMPLES = {
    "time": ("s", "time"),
    "voltage": ("V", "voltage of the motor over the step before"),
    "speed": ("rad/s", "speed of the motor at this instant"),
    "angle": ("rad", "angle of the motor"),
    "x1": ("m", "displacement of mass 1 relative to the box"),
    "x2": ("m", "displacement of mass 2 relative to the box"),
    "v1": ("m/s", "velocity of mass 1 relative to the box"),
    "v2": ("m/s", "velocity of mass 2 relative to the box"),
    "box_position": ("m", "position of the box"),
    "box_velocity": ("m/s", "velocity of the box"),
    "box_acceleration": ("m/s2", "acceleration of the box"),
    **{name: COLUMNS[name] for name in ACCOUNTS},
}
KEPT = "sampled "  # before the names of samples in a table that has revolutions too


@dataclass(frozen=True)
class PassageJob(couple.CoupleJob):
    """Run the coupled FMUs and keep the state after every communication step."""

    asked: ClassVar[str] = "passage"
    around: float | None = None  # time before and after each jump that is kept, s; else all

    item_columns: ClassVar[tuple[str, ...]] = tuple(KEPT + name for name in SAMPLES)

    def run_and_keep(self, run: MotorRun, steps: range) -> Table:
        record = run.run_steps(steps)
        revolutions, energies = run.revolutions.add_record(record)
        own = energies._asdict()
        every = ((own[name] if name in own else record[name])[record.ends] for name in SAMPLES)
        return {**revolutions, **{KEPT + n: one for n, one in zip(SAMPLES, every, strict=True)}}

    def dataset(self, table: Table) -> xr.Dataset:
        revolutions = super().dataset(table)
        samples = {name: table[KEPT + name] for name in SAMPLES}
        centres, what = self.sample_centres_and_description(revolutions)
        away = np.abs(samples["time"][:, np.newaxis] - centres).min(axis=1, initial=math.inf)
        span = math.inf if self.around is None else (1.0 + 1e-9) * self.around
        kept = np.flatnonzero(away <= span)
        variables = {n: variable("time", samples[n][kept], *text) for n, text in SAMPLES.items()}
        time = {"time": variables.pop("time")}
        title = f"Passage through the resonance, {self.structure.kind} structure"
        attributes = {**revolutions.attrs, "title": title, "kept": what}
        return xr.Dataset(variables, time, attributes).merge(revolutions.drop_dims("revolution"))

    def sample_centres_and_description(self, revolutions: xr.Dataset) -> tuple[np.ndarray, str]:
        """Return the times around which samples are kept, s, and a text on them."""
        jumps = revolutions.jump_time.values
        passed = float(revolutions.passage_time)
        if self.around is None:
            return np.zeros(0), "the whole run"
        if np.isfinite(jumps).any():
            return jumps[np.isfinite(jumps)], "around jumps"
        if math.isfinite(passed):
            return np.array([passed]), "around the passage, the run shows no jump"
        return np.array([self.schedule.duration - self.around]), "the end, the run shows no jump"


def passage(
    structure: Structure,
    drive: Drive,
    *,
    voltage: float | tuple[float, float] | Schedule,
    around: float | None = None,
    duration: float | None = None,
    rate: float | None = None,
    back: bool = False,
    settle: float | None = None,
    spin_up: float | None = None,
    speed_start: float | None = None,
    control: Controller | None = None,
    hold: float | None = None,
    step: float | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Run through the resonance at full resolution: time histories, speed, energies.

    Parameters
    ----------
    structure : Structure
    drive : Drive
    voltage : float, (float, float) or Schedule
        As in :func:`orchestrate.couple`, V.
    around : float, optional
        Keep only what is up to this time before or after a jump, s, or where there is none, the
        passage of the resonance, or the end; ``kept`` in the attributes says which. By default all.
    duration, rate, back, settle, spin_up, speed_start, control, hold
        As in :func:`orchestrate.couple`, but the voltage does not come back unless wanted.
    step : float, optional
        Communication step, s, and so the distance of samples; 0.1/omega by default.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over ``time`` (s): ``voltage`` (V), ``speed`` (rad/s) at the instant, ``angle`` (rad),
        positions and velocities of the masses (relative to the box) and of the box, and energies
        since the start (J). Over ``jump`` what :func:`orchestrate.couple` says of the jumps.

    Raises
    ------
    InputError
        Where an argument is not what is expected.

    Examples
    --------
    >>> from orchestrate import Drive, Structure, passage
    >>> quick = Structure.from_file("quick"), Drive.from_file("quick")
    >>> found = passage(*quick, voltage=1.5, duration=100.0, progress=False)
    >>> found.x1.dims, found.sizes["time"], found.speed.attrs["units"]
    (('time',), 1000, 'rad/s')
    """
    if around is not None:
        checked_range("around", around, "s", low=0.0, open_low=True)
    if spin_up is None and speed_start is not None:
        spin_up = 0.0
    settings = (duration, rate, settle, 0.0, back, spin_up)
    schedule = couple.schedule_from_arguments(structure, drive, voltage, *settings)
    scheme = couple.scheme_from_arguments(structure, step, sampled=True)
    run = couple.make_couple_job(structure, drive, schedule, scheme, speed_start, control, hold)
    fields = {**vars(run), "name": run.name.replace("couple", "passage"), "around": around}
    return compute_dataset(PassageJob(**fields), running, make_fmu_finder(running))


def waterfall(
    found: xr.Dataset, *, mass: int = 1, revolutions: int = 16, highest: float = 6.0
) -> xr.Dataset:
    """Compute spectra of a mass's absolute acceleration, revolution after revolution.

    Parameters
    ----------
    found : xarray.Dataset
        Of :func:`passage`, with all samples kept or those around one jump.
    mass : int
        1 or 2.
    revolutions : int
        Of each spectrum; it begins a quarter of them after the one before. Lines are
        1/``revolutions`` of the speed apart.
    highest : float
        Highest line, as a multiple of the motor's speed.

    Returns
    -------
    xarray.Dataset
        ``acceleration`` (m/s2) over ``time`` (s, the middle of the revolutions) and ``order``, the
        multiple of the motor's speed; and mean ``speed`` (rad/s) and ``voltage`` (V) over time.

    Raises
    ------
    InputError

    Notes
    -----
    The displacement is interpolated to equal angles by its values and velocities, its spectrum is
    taken with a Hann window, and multiplied by the square of the frequency: an impact is a kink of
    the displacement, so what folds back is small.

    Examples
    --------
    >>> from orchestrate import Drive, Structure, passage, waterfall
    >>> quick = Structure.from_file("quick"), Drive.from_file("quick")
    >>> spectra = waterfall(passage(*quick, voltage=1.3, duration=300.0, progress=False))
    >>> strongest = spectra.acceleration.isel(time=-1).sel(order=slice(0.5, None)).idxmax()
    >>> float(strongest)
    1.0
    """
    check_waterfall_arguments(found, mass, revolutions, highest)
    points = max(16, math.ceil(4.0 * highest))
    from scipy.interpolate import CubicHermiteSpline

    angle, time = np.abs(found.angle.values - found.angle.values[0]), found.time.values
    forward = np.concatenate([[True], np.diff(np.maximum.accumulate(angle)) > 0.0])
    last = math.floor(angle[forward][-1] * points / TURN)
    times = np.interp(np.arange(last) * TURN / points, angle[forward], time[forward])
    position = (found[f"x{mass}"] + found.box_position).values
    velocity = (found[f"v{mass}"] + found.box_velocity).values
    moved = CubicHermiteSpline(time, position, velocity)(times)
    length, hop = revolutions * points, max(1, revolutions // 4) * points
    begins = np.arange(0, len(times) - length + 1, hop)
    if not begins.size:
        turns = len(times) // points
        raise InputError(f"revolutions = {revolutions}: expected at most the {turns} there are")
    _, lines = amplitude_spectrum(moved[begins[:, np.newaxis] + np.arange(length)], 1.0)
    order = np.arange(lines.shape[1]) / revolutions
    shown = order <= highest
    ends = begins + length - 1
    speed = TURN * (length - 1) / points / (times[ends] - times[begins])
    middle = times[begins + length // 2]
    volts = np.interp(middle, found.time, found.voltage)
    text = f"amplitude of the absolute acceleration of mass {mass}"
    amplitude = lines[:, shown] * np.outer(speed, order[shown]) ** 2
    variables = {
        "acceleration": variable(("time", "order"), amplitude, "m/s2", text),
        "speed": variable("time", speed, "rad/s", "mean speed of the motor"),
        "voltage": variable("time", volts, "V", "voltage of the motor"),
    }
    coordinates = {
        "time": variable("time", middle, "s", "middle of the revolutions"),
        "order": variable("order", order[shown], "1", "multiple of the motor's speed"),
    }
    return xr.Dataset(variables, coordinates, {"title": "Spectra over the motor's revolutions"})


def check_waterfall_arguments(data: Any, mass: int, revolutions: int, highest: float) -> None:
    checked_integer("mass", mass, 1, 2)
    checked_integer("revolutions", revolutions, 1)
    checked_range("highest", highest, "times the speed", low=0.0, open_low=True)
    for name in ("angle", "box_position", "box_velocity", "v1", "x1"):
        if name not in getattr(data, "variables", ()):
            raise InputError(f"no {name} in the dataset: expected one of passage()")
    gaps = np.diff(data.time.values)
    if not gaps.size or gaps.max() > 1.5 * gaps.min():
        raise InputError(
            "time: samples of several jumps, or too few; expected some without a gap, such as "
            "found.sel(time=slice(first, last))"
        )
