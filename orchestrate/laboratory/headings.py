"""What files call quantities and units: headings of columns, split; usual names, units, texts."""

from __future__ import annotations

import re

from ..constants import TURN
from .conversion import ACCELERATIONS, LENGTHS, OF_FORCES, SPEEDS, VOLTAGES, normalize_unit

LONG_HEADING = 300  # letters of a heading that are read: patterns take the square of them in time
FREQUENCIES = {  # in Hz
    **{"hz": 1.0, "1/s": 1.0, "khz": 1e3, "rad/s": 1.0 / TURN},
    **dict.fromkeys(("rpm", "1/min"), 1.0 / 60.0),
}
ANGLES = {  # in rad
    **dict.fromkeys(("rad", "radian", "radians"), 1.0),
    **dict.fromkeys(("deg", "\u00b0", "degree", "degrees"), TURN / 360.0),
}
RATIO_UNITS = dict.fromkeys(("1", "-", "g/g", "m/m", "mm/mm", "m/s2/m/s2", "(m/s2)/(m/s2)"), 1.0)
TIMES = {  # in s
    **dict.fromkeys(("s", "sec", "second", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec"), 1e-3),
    **dict.fromkeys(("us", "usec", "\u00b5s", "\u03bcs"), 1e-6),
    **{"ns": 1e-9, "min": 60.0, "h": 3600.0},
}
# What files call a quantity, as patterns of names in small letters and digits
SENSOR = (
    "(?:a|acc|accel|acceleration|accelerometer|beschleunigung|sensor|aufnehmer|capteur|"
    "accélération|acelerometro|acelerómetro|accelerometro|geber|ch|channel|kanal)?"
)
BASE = (
    "(?:base|basis|box|table|tisch|schwingtisch|shaker|shakertable|shakerhead|armature|ref|control|"
    "input|steuersensor|erreger|aufnahme|fixture|clamp|"
    "einspannung|fuß|fuss|socle|embase|mesa|tavola|slip|sliptable|excitation|reference|referenz)"
)
FACE = "(?:face|mass|masse|fläche)"
BEAM = (
    "(?:beam|balken|face|tip|spitze|response|antwort|poutre|viga|trave|specimen|probe|prüfling|"
    "laser|vibrometer|ldv)"
)
FORCE = (
    "(?:impact|impulse?|modal)?(?:force|kraft|fuerza|forza|load|hammer)(?:cell|sensor|geber|input)?"
)
NUMBERED = f"(?:a|acc|accel|acceleration|beschleunigung|{SENSOR}{FACE})"
NAMES = {
    "time": "time|t|zeit|temps|tiempo|tempo|timestamp|xvalue|zeitachse",
    "box_acceleration": rf"{SENSOR}\d*{BASE}{SENSOR}[xyz]?",
    "acceleration1": f"{NUMBERED}1{SENSOR}[xyz]?|{SENSOR}{BEAM}{SENSOR}[xyz]?",
    "acceleration2": f"{NUMBERED}2{SENSOR}[xyz]?",
    "force1": f"{FORCE}1?",  # that has no number is on the first half
    "force2": f"{FORCE}2",
}
MOTION = "(?:amplitude|acceleration|acc|a|face|mass|velocity|v|displacement|x)"
RATIO = "(?:transmissibility|ratio|response|magnitude)"
SWEPT = "f|hz|freq|frequenz|frequency"
WORDS = r"[^\W\d_]{3,}.*|.*\w \w.*"  # in parentheses, hardly a unit: shaker head, SN 4711
HEADING = re.compile(r"(?P<name>.*?)[\s_/]*[\[(](?P<unit>[^\[\]()]*)[\])]")
SUFFIX = re.compile(  # as the last word: LDV mm/s, acc_base_g, time_ms
    r"(?P<name>.*?\w)[\s_]+(?P<unit>g|m?s|[u\u00b5]s|[mu\u00b5]m|m?m/s(\^?2|\u00b2)?|(?<=_)(m?V|k?N)|mV|kN)"
)
QUOTIENT = re.compile(r"(?P<name>.+?)(?:\s*[/,]\s*|\s+in\s+)(?P<unit>.*\D.*|-)")
TEXTS = {  # what a field is that is no number
    "a clock time": r"\d{1,2}:\d\d(:\d\d([.,]\d+)?)?",
    "a date": r"(\d{1,2}[./-]\d{1,2}[./-]\d{2,4}|\d{4}-\d\d-\d\d)([T ].*)?",
    "a number with thousands separators": r"[+-]?\d{1,3}([.,' \xa0\u202f]\d{3})+([.,]\d+)?",
}


def column_patterns_of_face(number: str, pattern: str) -> dict[str, str]:
    """Return regular expressions of a face's column names in a resonance curve, by quantity."""
    motion, alone = f"(?:{MOTION}|{RATIO}){pattern}", "|order|harmonic" if number == "1" else ""
    return {
        f"amplitude{number}": f"{motion}|(?:{MOTION}|{RATIO}){number}order1",
        f"phase{number}": f"phase{pattern}",
        f"amplitude{number}_order2": f"(?:{motion}order{alone})2",
        f"amplitude{number}_order3": f"(?:{motion}order{alone})3",
        f"floor{number}": f"(?:floor|noise){pattern}",
    }


CURVE_NAMES = {
    "frequency": SWEPT,
    "level": f"input|drive|excitation|level|{SENSOR}{BASE}(?:acceleration|amplitude|level)?",
    **column_patterns_of_face("1", "1?"),  # a face that has no number is the first
    **column_patterns_of_face("2", "2"),
}


def split_heading(heading: str) -> tuple[str, str]:
    """Split a column's heading; return its name and its unit, an empty string without one."""
    plain = heading.strip().strip('"').strip()[:LONG_HEADING]
    parts = HEADING.fullmatch(plain)
    if parts and re.fullmatch(WORDS, parts["unit"]) and not is_unit(parts["unit"]):
        return plain, ""  # a place or a sensor
    parts = parts or SUFFIX.fullmatch(plain)
    if parts is None and (quotient := QUOTIENT.fullmatch(plain)) and is_unit(quotient["unit"]):
        parts = quotient
    return (plain, "") if parts is None else (parts["name"].strip(), parts["unit"].strip())


def describe_text(text: str) -> str:
    """Return a text in quotes, and what it is where that is known: a clock time, for instance."""
    kinds = [kind for kind, pattern in TEXTS.items() if re.fullmatch(pattern, text)]
    return ", ".join([repr(text[:40]), *kinds[:1]])


def is_unit(text: str) -> bool:
    """Return whether a text is a unit that columns of records or resonance curves may have."""
    motions = (ACCELERATIONS, TIMES, SPEEDS, LENGTHS, VOLTAGES, FREQUENCIES, ANGLES)
    known = (*motions, RATIO_UNITS, OF_FORCES[0])
    return any(normalize_unit(text) in units for units in known)
