"""Format labels, titles and legend texts of pictures: parameters, structures, responses."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping

import numpy as np
import xarray as xr

from ..constants import GRAVITY, TURN
from ..model.ranges import ADDED, STRUCTURE
from ..units import (
    display_scale_of,
    display_units_of,
    is_finite_number,
    is_in_si,
    omega_of,
    shows_lengths_as_ratios,
)

UNITS = {"m": "kg", "k": "N/m", "d": "N s/m", "x": "m", "f": "Hz"}  # of both masses' quantities
SYMBOLS = {
    **{"eta": r"$\eta$", "e": "$e$", "D": "$D$", "D1": "$D_1$", "D2": "$D_2$", "mu": r"$\mu$"},
    **{"kappa": r"$\kappa$", "gamma": r"$\gamma$", "omega": r"$\omega$ in rad/s"},
    **{"frequency": r"$\Omega$ in rad/s", "amplitude": "$a$ in m"},
    **{"level": r"$a\,\Omega^2$ in m/s$^2$", "phase": "phase of the box in rad"},
    **{f"{name}{i}": f"${name}_{i}$ in {unit}" for name, unit in UNITS.items() for i in (1, 2)},
    **{f"v{i}": rf"$\dot{{x}}_{i}$ in m/s" for i in (1, 2)},
    **{f"zeta{i}": rf"$\zeta_{i}$" for i in (1, 2)},
    "x_rel": "gap $x_2 - x_1$ in m",
    "v_rel": r"gap velocity $\dot{x}_2 - \dot{x}_1$ in m/s",
}
LOADS = {
    "box_acceleration": "{:.4g} m/s$^2$ more of the box",
    **{f"force{half}": f"$F_{half}$ = {{:.4g}} N" for half in "12"},
}
# what a title leaves out
USUAL_VALUES = {"mu": 1.0, "kappa": 1.2, "gamma": STRUCTURE["gamma"].default, "omega": 1.0}
TITLE_RATIOS = ("D", "D1", "D2", "mu", "kappa", "omega")
HALF_PARAMETERS = {"m1", "m2", "k1", "k2", "d1", "d2", "mu", "kappa", "omega", "D", "D1", "D2"}
HALF_PARAMETERS |= {"f1", "f2", "zeta1", "zeta2"}
PART_OF_LABEL = re.compile(r"bonded|(?P<name>[A-Za-z]+?)(?P<values>-?\d[\d.e+-]*)")
UNIT_SIGNS = {"m/s2": "m/s$^2$", "m2/s4/Hz": "(m/s$^2$)$^2$/Hz"}
UNIT_SIGNS |= {"g2/Hz": "g$^2$/Hz", "kg.m2": "kg m$^2$"}
ACCELERATION = re.compile(r"(\d[\d.e+-]*) m/s2")
PREFIXES = ((1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))


def symbol_with_unit(name: str) -> str:
    """Return a parameter's symbol, such as ``$a$ in m``, for an axis; without one, its name."""
    unit = STRUCTURE[name].unit if name in STRUCTURE else "1"
    ending = f" in {unit}" if unit != "1" else ""
    return SYMBOLS.get(name, name.replace("_", " ") + ending)


def format_parameters(values: Mapping[str, float]) -> str:
    """Format a dict of parameters as a title text, ``e = 0.7, D = 0.005``."""
    return join_by_commas(format_parameter(name, f"{value:g}") for name, value in values.items())


def format_parameter(name: str, number: str) -> str:
    """Format one parameter with its symbol and unit; damping ratios in per cent."""
    letter, _, unit = symbol_with_unit(name).partition(" in ")
    if name.startswith("zeta"):
        number, unit = f"{100.0 * float(number):.4g}", "%"
    return f"{letter} = {number} {unit}".rstrip()


def join_by_commas(parts: Iterable[str]) -> str:
    """Join the parts of a title that are not empty by commas."""
    return ", ".join(filter(None, parts))


def title_from_attributes(data: xr.Dataset, shown_elsewhere: Iterable[str] = ()) -> str:
    """Return a title with a dataset's structure and excitation: e, D and unusual parameters."""
    known = {name: float(value) for name, value in data.attrs.items() if is_finite_number(value)}
    shown = {*map(str, data.dims), *shown_elsewhere}
    by_halves = paper_ratios(known).get("omega", 1.0) != 1.0 and not shown & HALF_PARAMETERS
    values = {} if by_halves else paper_ratios(known)
    values = {name: known[name] for name in ("e", "gamma") if name in known} | values
    left_out = {name for name, value in USUAL_VALUES.items() if values.get(name) == value} | shown
    left_out |= {"D", "D1", "D2"} if "D" in shown else set()
    named = (name for name in ("e", *TITLE_RATIOS, "gamma") if name in values)
    texts = [format_halves(known) if by_halves else ""]
    texts.append(format_parameters({name: values[name] for name in named if name not in left_out}))
    bonded = bool(known.get("bonded"))
    added = [] if bonded else [name for name in ADDED if known.get(name) and name not in shown]
    texts += [format_added_parameter(name, known[name], data) for name in added]
    texts.append("bonded" if bonded else "against a wall" if known.get("wall") else "")
    excitation = excitation_texts(data, known).items()
    return join_by_commas([*texts, *(words for name, words in excitation if name not in shown)])


def branch_title(data: xr.Dataset, over: Iterable[str]) -> str:
    varied = set(over)
    name = "frequency" if has_frequency_unit(data) else "eta"
    points = {key: data[key] for key in (name, "amplitude") if key in data.coords}
    if {"frequency", "amplitude"} <= set(points):
        points["level"] = points["amplitude"] * points["frequency"] ** 2
    constant = {
        key: float(values[0])
        for key, values in points.items()
        if values.ndim == 1 and np.allclose(values, values[0], rtol=1e-9, atol=0.0)
    }
    if "amplitude" in constant:
        constant.pop("level", None)
    texts = excitation_texts(data, constant).items()
    structure = title_from_attributes(data, {*varied, "eta", "frequency", "amplitude"})
    return join_by_commas([structure, *(text for name, text in texts if name not in varied)])


def has_frequency_unit(data: xr.Dataset) -> bool:
    if display_units_of(data).frequency:
        return display_units_of(data).frequency != "eta"
    return is_in_si(data) or "frequency" in data.dims


def gap_name(data: xr.Dataset) -> str:
    """Return the gap's name for an axis label; with a clearance it is not just ``x2 - x1``."""
    return "gap" if data.attrs.get("clearance") else "gap $x_2 - x_1$"


def format_added_parameter(name: str, value: float, data: xr.Dataset) -> str:
    """Format a parameter that is not in the paper; a clearance as a gap or, below 0, a preload."""
    if name != "clearance":
        return format_parameters({name: value})
    words = "clearance" if value > 0.0 else "pressed together by"
    return f"{words} {format_length(data, abs(value))}"


def typeset_unit(unit: str) -> str:
    """Return a unit as Matplotlib text: ``µm/s``, ``m/s$^2$``, ``g$^2$/Hz``."""
    return UNIT_SIGNS.get(unit, unit.replace("um", "µm") if unit.startswith("um") else unit)


def length_unit(data: xr.Dataset, largest: float, unit: str = "m") -> tuple[float, str]:
    """Return the divisor from m, or m/s, to the display unit, by default with an SI prefix."""
    if not display_units_of(data).length:
        factor, prefix = si_prefix(largest)
        return factor, prefix + unit
    factor, word = display_scale_of(data, unit)
    return factor, typeset_unit(word)


def format_length(data: xr.Dataset, length: float) -> str:
    factor, word = length_unit(data, length)
    return f"{length / factor:.4g} {word}"


def frequency_scale(data: xr.Dataset) -> tuple[float, str]:
    """Return the divisor from rad/s to the display unit of frequencies, by default Hz."""
    asked = display_units_of(data).frequency
    return display_scale_of(data, "rad/s") if asked else (TURN, "Hz")


def format_frequency(data: xr.Dataset, frequency: float) -> str:
    """Format a frequency given in rad/s in a dataset's display unit."""
    factor, word = frequency_scale(data)
    if word == "eta":
        return format_parameters({"eta": float(f"{frequency / factor:.5g}")})
    letter = r"$\Omega$" if word == "rad/s" else r"$\Omega/2\pi$"
    return f"{letter} = {frequency / factor:.5g} {word}"


def excitation_texts(data: xr.Dataset, parameters: Mapping[str, float]) -> dict[str, str]:
    units, texts = display_units_of(data), {}
    if "eta" in parameters:
        eta, omega = parameters["eta"], omega_of(data)
        by_unit = units.frequency not in ("", "eta") and math.isfinite(omega)
        in_unit = format_frequency(data, eta * omega) if by_unit else ""
        texts["eta"] = in_unit or format_parameters({"eta": eta})
    if parameters.get("frequency"):  # 0 where nothing is harmonic
        texts["frequency"] = format_frequency(data, parameters["frequency"])
    if "amplitude" in parameters and units.acceleration and "frequency" in parameters:
        level = parameters["amplitude"] * parameters["frequency"] ** 2
        texts["amplitude"] = format_level(data, level)
    elif parameters.get("amplitude") and not is_paper_amplitude(data, parameters):
        texts["amplitude"] = f"$a$ = {format_length(data, parameters['amplitude'])}"
    elif "level" in parameters:
        texts["level"] = format_level(data, parameters["level"])
    elif "frequency" in data.dims and "amplitude" in data.coords:
        levels = (data.amplitude * data.frequency**2).values
        if math.isclose(levels.min(), levels.max(), rel_tol=1e-9):
            texts["amplitude"] = format_level(data, levels.max())
    loads = {name: parameters[name] for name in LOADS if parameters.get(name)}
    return texts | {name: LOADS[name].format(value) for name, value in loads.items()}


def is_paper_amplitude(data: xr.Dataset, parameters: Mapping[str, float]) -> bool:
    """Return whether the amplitude is 1/eta^2 m, so that displacements are the paper's ratios."""
    eta = parameters.get("eta", parameters.get("frequency", math.nan) / omega_of(data))
    of_paper = math.isclose(parameters["amplitude"] * eta**2, 1.0, rel_tol=1e-9)
    return of_paper and shows_lengths_as_ratios(data)


def format_level(data: xr.Dataset, level: float) -> str:
    """Format the box's peak acceleration, in m/s2, in the unit that an answer is shown in."""
    peak, in_g = f"{level:.4g} m/s$^2$", f"{level / GRAVITY:.3g} g"
    both = {"": f"{peak} ({in_g})", "m/s2": peak, "g": in_g}
    return rf"$a\,\Omega^2$ = {both[display_units_of(data).acceleration]}"


def format_voltage(voltage: float, error: float) -> str:
    if not (math.isfinite(error) and error > 0.0):
        return f"{voltage:.4f} V"
    places = max(0, 1 - math.floor(math.log10(error)))
    return f"{voltage:.{places}f} ± {error:.{places}f} V"


def si_prefix(largest: float) -> tuple[float, str]:
    """Return the factor and the letter of the largest SI prefix that leaves a length at least 1."""
    return next(((f, name) for f, name in PREFIXES if largest >= f), PREFIXES[0])


def paper_ratios(parameters: Mapping[str, float]) -> dict[str, float]:
    """Return the paper's ratios (6) to (8) of a structure in SI, as far as attributes tell."""
    if not {"m1", "m2", "k1", "k2", "d1", "d2"} <= set(parameters):
        return {}
    m1, m2, k1, k2 = (parameters[name] for name in ("m1", "m2", "k1", "k2"))
    omega = omega_of(parameters)
    D1, D2 = (round(parameters[d] / (2.0 * omega * m), 12) for d, m in (("d1", m1), ("d2", m2)))
    damping = {"D": D1} if D1 == D2 else {"D1": D1, "D2": D2}
    if parameters.get("wall"):
        return {"D": D1, "omega": omega}
    return {**damping, "mu": m2 / m1, "kappa": k2 / k1, "omega": omega}


def format_halves(parameters: Mapping[str, float]) -> str:
    """Format each half's natural frequency and damping ratio, and the mass ratio."""
    frequencies, damping = [], []
    for half in "1" if parameters.get("wall") else "12":
        m, k, d = (parameters[letter + half] for letter in "mkd")
        frequencies.append(f"$f_{half}$ = {math.sqrt(k / m) / (2.0 * math.pi):.4g} Hz")
        damping.append(rf"$\zeta_{half}$ = {50.0 * d / math.sqrt(k * m):.4g} %")
    mu = parameters["m2"] / parameters["m1"]  # 1 of one mass
    masses = "" if mu == USUAL_VALUES["mu"] else format_parameters({"mu": mu})
    return join_by_commas([*frequencies, *damping, masses])


def format_period(multiplicity: int) -> str:
    """Return a response's period in the paper's words: ``T``, ``2T`` or "not periodic"."""
    return f"${multiplicity if multiplicity > 1 else ''}T$" if multiplicity else "not periodic"


def orbit_label(multiplicity: float, impacts_per_period: float) -> str:
    """Format an orbit for a legend: "2T, 3 impacts"; empty if it is not periodic."""
    n = round(multiplicity)
    impacts = round(n * impacts_per_period)
    return f"{n if n > 1 else ''}T, {impacts} impact{'s' * (impacts != 1)}" if n else ""


def convert_accelerations_in(text: str, data: xr.Dataset) -> str:
    """Return a text with its accelerations, ``5 m/s2``, in the display unit of a dataset."""
    factor, word = display_scale_of(data, "m/s2")
    unit = typeset_unit(word)
    return ACCELERATION.sub(lambda match: f"{float(match[1]) / factor:.4g} {unit}", text)


def expand_title(title: str, with_structure: bool = True) -> str:
    """Return a title with the structure's file-name label in words, or without it."""
    words, _, rest = title.rpartition(": ")
    label, comma, ending = rest.partition(", ")
    parts = [PART_OF_LABEL.fullmatch(part) for part in label.split("_")]
    if not words or not all(parts):
        return title
    texts = [words]
    for part in filter(None, parts) if with_structure else ():
        values = re.split(r"(?<=\d)-", part["values"] or "")  # f42-55: of f1 and f2
        numbers = [""] if len(values) == 1 else range(1, 1 + len(values))
        if not part["values"]:
            texts.append(part[0])
        elif part["name"] == "clearance":
            texts.append(format_added_parameter("clearance", float(values[0]), xr.Dataset()))
        else:
            names = (f"{part['name']}{number}" for number in numbers)
            texts += map(format_parameter, names, values)
    return join_by_commas(texts) + comma + ending
