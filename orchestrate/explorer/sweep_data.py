"""Read a sweep for the page: frequencies, settings and each response's start state."""

from __future__ import annotations

import logging
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..constants import GRAVITY
from ..errors import InputError
from ..fmu import OSCILLATOR
from ..fmu.webassembly import kernel_digest
from ..lazy import xr
from ..model import Excitation, Structure
from ..model.ranges import PUSHES
from ..running.job import refuse_unsupported
from ..running.provenance import describe_dataset
from ..running.store import load_result
from ..units import Units

EXPECTED = "expected a result of orchestrate.sweep along eta or frequency"
SWEPT = ("eta", "frequency")
SETTINGS = ("transient", "samples", "tolerance")
READING = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)  # of a file
OWN = Units("Hz", "mm", "g")  # of a beam of one's own, where nothing else is asked for


@dataclass(frozen=True)
class SweepData:
    """A sweep as the page needs it: settings, range, and start states in one array."""

    structure: Structure
    directions: tuple[str, ...]  # `up`, `down` or both
    settings: dict[str, float]  # transient, samples and tolerance
    # frequency ratio, frequency and amplitude of each response, then for each direction the four
    # numbers of each start, m and m/s
    numbers: NDArray[np.float64]
    count: int  # number of responses in a direction
    # ends of the frequency ratios
    low: float
    high: float
    # how strongly the box is shaken: `"paper"`, 1/eta^2 m, or held at all frequencies, `"g"` as
    # acceleration, `"mm"` as amplitude
    level: tuple[str, float]
    source: str  # what computed it
    # loads other than the box's harmonic motion
    pushes: dict[str, float] = field(default_factory=dict)


def empty_sweep(structure: Structure, units: Units) -> SweepData:
    """Return data without a sweep: the page then computes its first diagram itself."""
    settings = {"transient": 500, "samples": 200, "tolerance": 1e-2}
    level = ("paper", 1.0) if opens_in_ratios(structure, units) else ("g", 1.0)
    return SweepData(structure, ("up",), settings, np.empty(0), 0, 0.1, 8.0, level, "")


def read_sweep(data: xr.Dataset) -> SweepData:
    try:
        return read_checked_sweep(data, checked_sweep_direction(data))
    except InputError:
        raise
    except READING as error:
        raise InputError(
            f"sweep: a part is missing or of another kind ({str(error)[:200]}); {EXPECTED}"
        ) from None


def read_checked_sweep(data: xr.Dataset, direction: str) -> SweepData:
    structure = Structure.from_attributes({str(name): value for name, value in data.attrs.items()})
    pushes = {name: data.attrs.get(name, 0.0) for name in PUSHES}
    varied = {name: text for name, text in pushes.items() if isinstance(text, str)}
    still = {} if data.amplitude.min() > 0.0 else {"amplitude": "0 m, a box at rest,"}
    refuse_unsupported("the explorer", varied | still)
    directions = ("up", "down") if direction == "both" else (direction,)
    (parameter,) = map(str, set(data.impacts_per_period.dims) - {"direction"})
    data = data.sortby(parameter)
    pairs = zip(data.frequency.values, data.amplitude.values, strict=True)
    lengths = np.array([Excitation(frequency=f, amplitude=a).length(structure) for f, a in pairs])
    scale = lengths[:, None] * np.array([1.0, 1.0, structure.omega, structure.omega])
    start = parse_state(data.attrs["start"])
    rows = [np.stack([data[name].values for name in ("eta", "frequency", "amplitude")])]
    for one_way in directions:
        part = data.sel(direction=one_way) if "direction" in data.dims else data
        ends = part.end_state.transpose(parameter, "coordinate").values * scale
        # each response begins at the end of the one before it
        rows.append(np.stack([start, *ends[:-1]] if one_way == "up" else [*ends[1:], start]))
    if any(row.dtype.kind != "f" for row in rows):
        raise TypeError("texts among the numbers")
    numbers = np.concatenate([row.ravel() for row in rows])
    if not np.isfinite(numbers).all() or not float(data.eta.min()) > 0.0:
        raise ValueError("numbers that are not finite, or a frequency ratio that is not above 0")
    return SweepData(
        structure=structure,
        directions=directions,
        settings=sweep_settings(data),
        numbers=numbers,
        count=data.sizes[parameter],
        low=float(data.eta.min()),
        high=float(data.eta.max()),
        level=excitation_level(data, structure),
        pushes={name: float(value) for name, value in pushes.items()},
        source=f"{data.attrs['source']}, {data.attrs['fmu_model']} {data.attrs['fmu_guid']}",
    )


def opens_in_ratios(structure: Structure, units: Units) -> bool:
    """Return whether a page opens with the paper's ratios: no other unit is asked for."""
    if units.length or units.acceleration:
        return False
    return units.frequency == "eta" if units.frequency else is_nondimensional(structure)


def check_units(units: Units, level: tuple[str, float]) -> None:
    """Check that a sweep can be shown in some units: one of the paper's motion is in ratios."""
    in_units = units.length or units.acceleration or units.frequency not in ("", "eta")
    if level[0] == "paper" and in_units:
        raise InputError(
            f"units {units}: the page replays the sweep as it was shaken, by the paper's ratios; "
            "expected eta, or a structure instead of the sweep"
        )


def shown_units(units: Units, level: tuple[str, float]) -> dict[str, str]:
    if level[0] == "paper":  # ratios have no unit, but of time
        units = Units(time=units.time)
    return asdict(units.with_defaults(OWN))


def is_nondimensional(structure: Structure) -> bool:
    """Return whether a structure is the paper's, whose omega is 1 rad/s."""
    return math.isclose(structure.omega, 1.0)


def excitation_level(data: xr.Dataset, structure: Structure) -> tuple[str, float]:
    """Return the unit of the box's motion ("paper", "mm" or "g"), and its size in it."""
    eta, frequency, amplitude = (data[name].values for name in ("eta", "frequency", "amplitude"))
    if is_nondimensional(structure) and np.allclose(amplitude * eta**2, 1.0, rtol=1e-9):
        return "paper", 1.0
    if np.ptp(amplitude) == 0.0:
        return "mm", float(f"{1e3 * amplitude[0]:.12g}")
    return "g", float(f"{amplitude[0] * frequency[0] ** 2 / GRAVITY:.9g}")


def sweep_settings(data: xr.Dataset) -> dict[str, float]:
    """Return transient, samples and tolerance of a sweep; raise if they are out of range."""
    settings = {name: float(data.attrs[name]) for name in SETTINGS}
    transient, samples, tolerance = settings.values()
    if not (transient.is_integer() and samples.is_integer() and transient >= 0 and samples >= 1):
        raise ValueError(f"transient = {transient}, samples = {samples}")
    # what a page computes within seconds
    if not (0.0 < tolerance < math.inf and transient + samples <= 1_000_000):
        raise ValueError(f"tolerance = {tolerance}, {transient + samples} periods")
    return settings


def checked_sweep_direction(data: xr.Dataset) -> str:
    """Return the direction of a sweep; raise if the page cannot show the sweep."""
    needed = {"eta", "frequency", "amplitude", "impacts_per_period", "end_state"}
    missing = needed - {str(name) for name in data.variables}
    direction = str(data.attrs.get("direction"))
    if missing or not {*SETTINGS, "start", "m1"} <= set(data.attrs):
        raise InputError(f"result: {describe_dataset(data)}; {EXPECTED}")
    if not set(SWEPT) & {str(name) for name in data.impacts_per_period.dims}:
        raise InputError(f"sweep over {data.impacts_per_period.dims[-1]}: {EXPECTED}")
    if direction not in ("up", "down", "both", "given"):
        raise InputError(f"sweep with direction {direction!r}: {EXPECTED}")
    if (direction == "both") != ("direction" in data.impacts_per_period.dims):
        raise InputError(f"sweep with direction {direction!r}, of other dimensions: {EXPECTED}")
    if direction == "given" or data.sizes[str(data.impacts_per_period.dims[-1])] < 2:
        raise InputError("sweep of single frequencies: expected a range, up, down or both")
    return direction


def parse_state(text: Any) -> NDArray[np.float64]:
    """Parse an attribute such as ``[0, 0, 0, 1]`` into four numbers."""
    state = np.array([float(part) for part in str(text).strip("[]").split(",")])
    if state.shape != (4,):
        raise ValueError(f"start = {text}")
    return state


FILE = Path(__file__).with_name("figure6.nc")  # written by tools/figure6_states.py
STAMP = "kernel"  # attribute: digest of the kernel that computed it

log = logging.getLogger(__name__)


def first_sweep(structure: Structure, units: Units | None = None) -> SweepData:
    """Return the page's first diagram: Figure 6 for the paper's structure, else an empty one."""
    units = units or Units()
    if structure != Structure() or not opens_in_ratios(structure, units):
        return empty_sweep(structure, units)
    data = load_result(FILE)
    if not is_from_current_kernel(data):
        log.warning("Figure 6 was computed by another kernel: the page computes its own")
        return empty_sweep(structure, units)
    return read_sweep(data)


def is_from_current_kernel(data: xr.Dataset) -> bool:
    """Return whether the present kernel computed a stored Figure 6."""
    return bool(data.attrs.get(STAMP) == kernel_digest(OSCILLATOR))
