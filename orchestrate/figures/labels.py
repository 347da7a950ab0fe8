"""Format labels, titles and legend texts of pictures: parameters, structures, responses."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping

import xarray as xr

from ..constants import GRAVITY, TURN
from ..structures.ranges import ADDED, STRUCTURE
from ..units import is_finite_number, omega_of, scale_of, units_of

SYMBOLS = {
    "eta": r"$\eta$",
    "e": "$e$",
    "D": "$D$",
    "D1": "$D_1$",
    "D2": "$D_2$",
    "mu": r"$\mu$",
    "kappa": r"$\kappa$",
    "gamma": r"$\gamma$",
    "omega": r"$\omega$ in rad/s",
    "frequency": r"$\Omega$ in rad/s",
    "amplitude": "$a$ in m",
    "level": r"$a\,\Omega^2$ in m/s$^2$",
    "m1": "$m_1$ in kg",
    "m2": "$m_2$ in kg",
    "k1": "$k_1$ in N/m",
    "k2": "$k_2$ in N/m",
    "d1": "$d_1$ in N s/m",
    "d2": "$d_2$ in N s/m",
    "x1": "$x_1$ in m",
    "x2": "$x_2$ in m",
    "v1": r"$\dot{x}_1$ in m/s",
    "v2": r"$\dot{x}_2$ in m/s",
    "x_rel": "gap $x_2 - x_1$ in m",
    "v_rel": r"gap velocity $\dot{x}_2 - \dot{x}_1$ in m/s",
    "phase": "phase of the box in rad",
    "f1": "$f_1$ in Hz",
    "f2": "$f_2$ in Hz",
    "zeta1": r"$\zeta_1$",
    "zeta2": r"$\zeta_2$",
}
USUAL_VALUES = {"mu": 1.0, "kappa": 1.2, "gamma": 1e-4, "omega": 1.0}  # what a title leaves out
EXCITATION = ("eta", "frequency", "amplitude")
HALF_PARAMETERS = {"m1", "m2", "k1", "k2", "d1", "d2", "mu", "kappa", "omega", "D", "D1", "D2"}
HALF_PARAMETERS |= {"f1", "f2", "zeta1", "zeta2"}
PART_OF_LABEL = re.compile(r"bonded|(?P<name>[A-Za-z]+?)(?P<values>-?\d[\d.e+-]*)")
UNIT_SIGNS = {
    "m/s2": "m/s$^2$",
    "m2/s4/Hz": "(m/s$^2$)$^2$/Hz",
    "g2/Hz": "g$^2$/Hz",
    "kg.m2": "kg m$^2$",
}
PREFIXES = ((1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))


def symbol(name: str) -> str:
    """Return a parameter's mathematical symbol for an axis; without one, its name with unit."""
    unit = STRUCTURE[name].unit if name in STRUCTURE else "1"
    ending = f" in {unit}" if unit != "1" else ""
    return SYMBOLS.get(name, name.replace("_", " ") + ending)


def format_parameters(values: Mapping[str, float]) -> str:
    """Format a dict of parameters as a title text, ``e = 0.7, D = 0.005``."""
    parts = []
    for name, value in values.items():
        letter, _, unit = symbol(name).partition(" in ")
        parts.append(f"{letter} = {value:g} {unit}".rstrip())
    return ", ".join(parts)


def title_from_attributes(data: xr.Dataset, shown_elsewhere: Iterable[str] = ()) -> str:
    r"""Return a title from a dataset's structure and excitation: e, D and unusual parameters.

    A structure that is not in the paper's units is described by its halves: frequencies in Hz,
    damping ratios at them in per cent.

    Examples
    --------
    >>> attributes = dict(m1=1.0, m2=2.0, k1=1.0, k2=1.2, d1=0.01, d2=0.02, e=0.7)
    >>> title_from_attributes(xr.Dataset(attrs=attributes))
    '$e$ = 0.7, $D$ = 0.005, $\\mu$ = 2'
    """
    known = {name: float(value) for name, value in data.attrs.items() if is_finite_number(value)}
    shown = {*map(str, data.dims), *shown_elsewhere}
    values = {"e": known["e"]} if "e" in known else {}
    by_halves = is_in_si(known) and not shown & HALF_PARAMETERS
    values |= {} if by_halves else paper_ratios(known)
    values |= {"gamma": known["gamma"]} if "gamma" in known else {}
    left_at_usual = {name for name, value in USUAL_VALUES.items() if values.get(name) == value}
    moved = {"D", "D1", "D2"} if "D" in shown else set()
    left_out = shown | left_at_usual | moved
    text = format_parameters(
        {name: value for name, value in values.items() if name not in left_out}
    )
    if by_halves:
        text = ", ".join(filter(None, [format_halves(known), text]))
    if not known.get("bonded"):
        added = {name: known[name] for name in ADDED if known.get(name) and name not in shown}
        text = ", ".join(
            filter(None, [text, *(format_added_parameter(*item, data) for item in added.items())])
        )
    shaken = [words for name, words in format_excitation(data, known).items() if name not in shown]
    return ", ".join(filter(None, [text, "bonded" if known.get("bonded") else "", *shaken]))


def gap_name(data: xr.Dataset) -> str:
    """Return the gap's name for an axis label; with a clearance it is not ``x2 - x1`` alone."""
    return "gap" if data.attrs.get("clearance") else "gap $x_2 - x_1$"


def format_added_parameter(name: str, value: float, data: xr.Dataset) -> str:
    """Format a parameter that is not in the paper, such as the clearance, for a title."""
    return (
        format_clearance(value, data) if name == "clearance" else format_parameters({name: value})
    )


def format_clearance(clearance: float, data: xr.Dataset) -> str:
    """Format a clearance as a gap or, if negative, as a preload.

    Examples
    --------
    >>> format_clearance(1.5e-3, xr.Dataset()), format_clearance(-2e-5, xr.Dataset())
    ('clearance 1.5 mm', 'pressed together by 20 µm')
    """
    words = "clearance" if clearance > 0.0 else "pressed together by"
    return f"{words} {format_length(data, abs(clearance))}"


def typeset_unit(unit: str) -> str:
    """Return a unit as Matplotlib text: ``µm/s``, ``m/s$^2$``, ``g$^2$/Hz``."""
    return UNIT_SIGNS.get(unit, unit.replace("um", "µm") if unit.startswith("um") else unit)


def format_length(data: xr.Dataset, length: float) -> str:
    """Format a length in a dataset's display unit, or with an SI prefix."""
    if units_of(data).length:
        factor, word = scale_of(data, "m")
        return f"{length / factor:.4g} {typeset_unit(word)}"
    factor, letter = si_prefix(length)
    return f"{length / factor:.4g} {letter}m"


def format_frequency(data: xr.Dataset, frequency: float) -> str:
    """Format a frequency given in rad/s in a dataset's display unit, by default Hz."""
    factor, word = scale_of(data, "rad/s") if units_of(data).frequency else (TURN, "Hz")
    if word == "eta":
        return format_parameters({"eta": float(f"{frequency / factor:.5g}")})
    letter = r"$\Omega$" if word == "rad/s" else r"$\Omega/2\pi$"
    return f"{letter} = {frequency / factor:.5g} {word}"


def format_excitation(data: xr.Dataset, known: Mapping[str, float]) -> dict[str, str]:
    """Return texts of the excitation's frequency and amplitude, where each is one number."""
    units, texts = units_of(data), {}
    if "eta" in known:
        omega = omega_of(data)
        by_unit = units.frequency not in ("", "eta") and math.isfinite(omega)
        eta = known["eta"]
        texts["eta"] = (
            format_frequency(data, eta * omega) if by_unit else format_parameters({"eta": eta})
        )
    if "frequency" in known:
        texts["frequency"] = format_frequency(data, known["frequency"])
    if "amplitude" in known and units.acceleration and "frequency" in known:
        texts["amplitude"] = format_level(data, known["amplitude"] * known["frequency"] ** 2)
    elif "amplitude" in known:
        texts["amplitude"] = f"$a$ = {format_length(data, known['amplitude'])}"
    elif "level" in known:
        texts["level"] = format_level(data, known["level"])
    elif "frequency" in data.dims and "amplitude" in data.coords:
        level = (data.amplitude * data.frequency**2).values
        if math.isclose(level.min(), level.max(), rel_tol=1e-9):
            texts["amplitude"] = format_level(data, level.max())
    return texts


def format_level(data: xr.Dataset, level: float) -> str:
    """Format the box's peak acceleration, in m/s2, in the unit that an answer is shown in."""
    peak, in_g = f"{level:.4g} m/s$^2$", f"{level / GRAVITY:.3g} g"
    both = {"": f"{peak} ({in_g})", "m/s2": peak, "g": in_g}
    return rf"$a\,\Omega^2$ = {both[units_of(data).acceleration]}"


def format_voltage(voltage: float, error: float) -> str:
    """Format a voltage and its error, of which two digits are shown.

    Examples
    --------
    >>> format_voltage(6.325, 0.0251), format_voltage(1.5, math.nan)
    ('6.325 ± 0.025 V', '1.5000 V')
    """
    if not (math.isfinite(error) and error > 0.0):
        return f"{voltage:.4f} V"
    places = max(0, 1 - math.floor(math.log10(error)))
    return f"{voltage:.{places}f} ± {error:.{places}f} V"


def si_prefix(largest: float) -> tuple[float, str]:
    """Return the factor and the letter of the largest SI prefix that leaves a length at least 1.

    Examples
    --------
    >>> si_prefix(0.004)
    (0.001, 'm')
    """
    return next(((f, name) for f, name in PREFIXES if largest >= f), PREFIXES[0])


def paper_ratios(known: Mapping[str, float]) -> dict[str, float]:
    """Return the paper's ratios (6) to (8) of a structure in SI, as far as attributes tell."""
    if not {"m1", "m2", "k1", "k2", "d1", "d2"} <= set(known):
        return {}
    m1, m2, k1, k2 = (known[name] for name in ("m1", "m2", "k1", "k2"))
    omega = omega_of(known)
    D1, D2 = (round(known[d] / (2.0 * omega * m), 12) for d, m in (("d1", m1), ("d2", m2)))
    damping = {"D": D1} if D1 == D2 else {"D1": D1, "D2": D2}
    return {**damping, "mu": m2 / m1, "kappa": k2 / k1, "omega": omega}


def is_in_si(known: Mapping[str, float]) -> bool:
    """Return whether a structure's omega, from its parameters, differs from the paper's 1 rad/s."""
    return paper_ratios(known).get("omega", 1.0) != 1.0


def format_halves(known: Mapping[str, float]) -> str:
    r"""Format each half's natural frequency and damping ratio, and the mass ratio.

    Examples
    --------
    >>> format_halves(dict(m1=1.5, m2=1.5, k1=8437.5, k2=8437.5, d1=1.125, d2=2.25))
    '$f_1$ = 11.94 Hz, $f_2$ = 11.94 Hz, $\\zeta_1$ = 0.5 %, $\\zeta_2$ = 1 %'
    """
    frequencies, damping = [], []
    for half in "12":
        m, k, d = (known[letter + half] for letter in "mkd")
        frequencies.append(f"$f_{half}$ = {math.sqrt(k / m) / (2.0 * math.pi):.4g} Hz")
        damping.append(rf"$\zeta_{half}$ = {50.0 * d / math.sqrt(k * m):.4g} %")
    mu = known["m2"] / known["m1"]
    masses = [] if mu == USUAL_VALUES["mu"] else [format_parameters({"mu": mu})]
    return ", ".join([*frequencies, *damping, *masses])


def format_period(multiplicity: int) -> str:
    """Return a response's period in the paper's words: ``T``, ``2T`` or "not periodic"."""
    if multiplicity == 0:
        return "not periodic"
    return "$T$" if multiplicity == 1 else f"${multiplicity}T$"


def orbit_label(multiplicity: float, impacts_per_period: float) -> str:
    """Format an orbit for a legend: "2T, 3 impacts"; empty if it is not periodic."""
    n = round(multiplicity)
    if not n:
        return ""
    impacts = round(n * impacts_per_period)
    return f"{n if n > 1 else ''}T, {impacts} impact{'s' * (impacts != 1)}"


def in_shown_units(data: xr.Dataset, text: str) -> str:
    """Return a text with its accelerations in m/s2 in the unit that an answer is shown in."""

    def in_shown_unit(match: re.Match[str]) -> str:
        factor, word = scale_of(data, "m/s2")
        return f"{float(match[1]) / factor:.4g} {typeset_unit(word)}"

    return re.sub(r"(\d[\d.e+-]*) m/s2", in_shown_unit, text)


def plain_title(title: str) -> str:
    """Return a title with the structure's file-name label written out for a reader.

    Examples
    --------
    >>> plain_title("Orders: swept sine: e0.6_f42-55_clearance-2e-05")
    'Orders: swept sine, $e$ = 0.6, $f_1$ = 42 Hz, $f_2$ = 55 Hz, clearance = -2e-05 m'
    >>> plain_title("Orders: Shaken: e0.6, as sensors read it")
    'Orders: Shaken, $e$ = 0.6, as sensors read it'
    >>> plain_title("Orders: Record beam.csv")
    'Orders: Record beam.csv'
    """
    words, label, ending = split_title(title)
    written = [expand_label_part(part) for part in label.split("_") if part]
    return ", ".join([words, *written]) + ending


def title_without_structure(title: str) -> str:
    """Return a title without the structure's file-name label.

    Examples
    --------
    >>> title_without_structure("Map over frequency and e: e0.6_f42-55")
    'Map over frequency and e'
    """
    words, _, ending = split_title(title)
    return words + ending


def split_title(title: str) -> tuple[str, str, str]:
    """Return what is before a structure's file-name label, the label, and what is after it.

    Examples
    --------
    >>> split_title("Orders: Shaken: e0.6_f42, as sensors read it")
    ('Orders: Shaken', 'e0.6_f42', ', as sensors read it')
    """
    words, _, rest = title.rpartition(": ")
    label, comma, ending = rest.partition(", ")
    is_label = bool(words) and all(PART_OF_LABEL.fullmatch(part) for part in label.split("_"))
    return (words, label, comma + ending) if is_label else (title, "", "")


def expand_label_part(part: str) -> str:
    r"""Return one part of a structure's file-name label, such as ``f42-55``, as words.

    Examples
    --------
    >>> expand_label_part("zeta0.005-0.01")
    '$\\zeta_1$ = 0.5 %, $\\zeta_2$ = 1 %'
    """
    match = PART_OF_LABEL.fullmatch(part)
    if match is None or not match["values"]:
        return part
    name, values = match["name"], re.split(r"(?<=\d)-", match["values"])
    names = [name] if len(values) == 1 else [f"{name}{i + 1}" for i in range(len(values))]
    return ", ".join(map(format_label_value, names, values))


def format_label_value(name: str, text: str) -> str:
    """Return a parameter and its value with unit; damping ratios in per cent, as titles have them.

    Examples
    --------
    >>> format_label_value("zeta", "0.007"), format_label_value("clearance", "-2e-05")
    ('zeta = 0.7 %', 'clearance = -2e-05 m')
    """
    letter, _, unit = symbol(name).partition(" in ")
    if name.startswith("zeta"):
        text, unit = f"{100.0 * float(text):.4g}", "%"
    return f"{letter} = {text} {unit}".rstrip()
