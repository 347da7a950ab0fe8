"""Options that several commands share: structure, the box's motion, a varied parameter."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import orchestrate

from ..constants import GRAVITY
from ..errors import InputError
from ..lazy import xr
from ..model import SETS, Structure, read, resolve_path
from ..model.conversions import warn_of_ratios_in_per_cent
from ..model.ranges import ADDED, PUSHES, STRUCTURE
from ..model.sections import TO_RAD_S
from ..model.toml_files import read_tables
from . import grammar
from .command import Keywords, Options, option, option_names
from .notes import SETTINGS, heavy_mass_note

UNITS = {"hz": "hz", "rpm": "rpm", "frequency": "rad_s"}  # of a frequency's options
FREQUENCIES = ("eta", *UNITS)
ASSUMED = {  # what a beam needs besides what is set, with the names that set it as well
    **{"m1": ("mu",), "m2": ("mu",), "f1": ("k1", "omega"), "f2": ("k2", "kappa")},
    **{"zeta1": ("d1", "D", "D1"), "zeta2": ("d2", "D", "D2"), "e": ()},
}
UNIT_OF_LETTER = {"m": " kg", "f": " Hz", "z": " %", "e": ""}  # the first of those
CONTINUED = (  # what a continuation varies, for help texts
    "eta, hz, rpm, frequency, amplitude, box_acceleration or a parameter of the structure"
)
MOST_NAMED = 3  # parameters that a line on two structures names


def parameter_help(name: str) -> str:
    """Return lines of help text on a structure's parameter, from the FMU's variable table."""
    quantity = STRUCTURE[name]
    unit = "" if quantity.unit == "1" else f", {quantity.unit}"
    text = f"{quantity.description[0].lower()}{quantity.description[1:]}{unit}"
    return textwrap.fill(text, 94, initial_indent=f"  {name:22}", subsequent_indent=" " * 24)


QUANTITIES = f"""quantities:
  m1 m2, k1 k2, d1 d2   masses kg, stiffnesses N/m, dampers N s/m
  e                     coefficient of restitution: speed after an impact over that before
{parameter_help("gamma")}
{"".join(parameter_help(name) + chr(10) for name in ADDED)}\
  omega = sqrt(k1/m1)   unit of frequency, rad/s
  mu = m2/m1, kappa = k2/k1
  D1 = d1/(2 omega m1), D2 = d2/(2 omega m2); D sets both
  f1 f2, zeta1 zeta2    of each half alone: natural frequency Hz, damping ratio at it (0.007 is
                        0.7 %)
  wall=true             one mass before a stop: f1, zeta1, e, clearance (from rest to the stop, at
                        x1 = clearance), stroke (from there to another stop opposite)
  Omega = 2 pi Hz = 2 pi rpm/60 rad/s; the box moves by a sin(Omega t), T = 2 pi/Omega
  eta = Omega/omega     frequency ratio
  g                     a Omega^2 over 9.80665 m/s2: the box's peak acceleration
  xi = x/(a eta^2)      displacement without a unit; xi_Rel = xi_2 - xi_1 is the gap; with the box
                        at rest over the largest static displacement by forces and acceleration
  tau = omega t         time without a unit

"""


def format_shipped_sets() -> str:
    lines = []
    for name, path in sorted(SETS.items()):
        above = path.read_text(encoding="utf-8").partition("\n\n")[0]
        words = " ".join(above.replace("#", "").split())
        lines.append(f"  {name:8}{words.partition('. ')[0].rstrip('.')}")
    return "\n".join(lines)


# -- structures -----------------------------------------------------------------------------------


class OfStructure(Options):
    """Options of the structure."""

    heading, rank = "structure", 0
    structure: Any = option(
        "TOML file with a [structure], or the name of a set", "paper", "SET|FILE"
    )
    set: list[str] = option(
        f"one of its parameters, SI ({' '.join(STRUCTURE)}), of each half (f1 f2 in Hz, zeta1 "
        "zeta2) or the paper's (mu kappa D D1 D2 omega); wall=true: one mass before a stop; may be "
        "repeated",
        (),
        "NAME=VALUE",
    )

    def read_and_report_structure(self) -> Structure:
        structure = Structure._read(self.structure, tables=self.toml_tables)
        changes = grammar.parse_changes(self.set, structure.wall)
        structure = structure.replace(**changes)
        print_assumptions(structure, self.structure, changes)
        stated = {"e"} if self.structure in SETS else self.toml_tables.get("structure", {})
        if not structure.bonded and "e" not in {*stated, *changes}:
            print(f"assumed: e = {structure.e:g} ({self.structure} has none; --set e=VALUE)")
        return structure

    @cached_property
    def toml_tables(self) -> dict[str, Any]:
        return read_tables(resolve_path(self.structure)) if self.structure else {}


class OfStored(OfStructure):
    """The same, of a command that may begin with a stored result."""

    structure: Any = option(
        "TOML file with a [structure], or the name of a set (default: that of the stored result, "
        "else paper)",
        value="SET|FILE",
    )

    def read_structure_and_question(self) -> tuple[Structure, Keywords]:
        if self.start is None:
            self.structure = self.structure or "paper"
            return self.read_and_report_structure(), self.function_keywords()
        data = grammar.load_earlier_result("--start", self.start)
        structure = self.stated_or_stored_structure("--start", self.start, data)
        return structure, {**self.function_keywords(), "start": data}

    def stated_or_stored_structure(self, flag: str, path: Any, data: xr.Dataset) -> Structure:
        """Return the structure asked for, else that of a stored result; print how they differ."""
        stored = stored_structure(flag, path, data)
        if self.structure:
            asked = self.read_and_report_structure()
        else:
            changes = grammar.parse_changes(self.set)
            asked = stored.replace(**changes)
            print_assumptions(asked, "", changes)
        print_structure_difference(flag, path, stored, asked)
        return asked


def stored_structure(flag: str, path: Any, data: xr.Dataset) -> Structure:
    from ..running.provenance import describe_dataset

    try:
        return Structure.from_attributes(dict(data.attrs))
    except (KeyError, TypeError, ValueError):
        text = f"{describe_dataset(data)}, without a structure; expected an orbit or a branch"
        raise InputError(f"{flag} {path}: {text}") from None


def print_structure_difference(flag: str, path: Any, stored: Structure, asked: Structure) -> None:
    names = (*STRUCTURE, "bonded", "wall")
    pairs = {name: (float(getattr(stored, name)), float(getattr(asked, name))) for name in names}
    texts = [
        f"{name} = {there:.6g} there, {here:.6g} here"
        for name, (there, here) in pairs.items()
        if not math.isclose(there, here, rel_tol=1e-9)
    ]
    left = len(texts) - MOST_NAMED
    texts = texts[:MOST_NAMED] + [f"and {left} more parameters"] * (left > 0)
    if texts:
        print(f"{flag} {path} was computed for another structure: {'; '.join(texts)}")


def print_assumptions(structure: Structure, source: str, changes: Mapping[str, Any]) -> None:
    """Print which parameters of the user's beam are taken from a shipped set; warn of per cent."""
    warn_of_ratios_in_per_cent({n: x for n, x in changes.items() if n in ("zeta1", "zeta2")})
    if note := heavy_mass_note(structure):
        print(note)
    if source not in SETS or not changes.keys() & {"f1", "f2"}:
        return
    left = [name for name, others in ASSUMED.items() if not changes.keys() & {name, *others}]
    left = [name for name in left if not (structure.wall and name.endswith("2"))]
    for name in {"f1", "f2"} & {*left}:
        (own,) = {"f1", "f2"} - {name}
        if not 1.0 / SETTINGS.unlike < structure.get(name) / structure.get(own) < SETTINGS.unlike:
            usual = f"{name} would be {structure.get(name):.4g} Hz, as in the set {source}"
            text = f"expected --set {name}=HZ too, or --set wall=true for one mass before a stop"
            raise InputError(f"--set {own}={changes[own]:g}: {usual}; {text}")
    percent = dict.fromkeys(("zeta1", "zeta2"), 100.0)
    shown = {name: structure.get(name) * percent.get(name, 1.0) for name in left}
    texts = [f"{name} = {shown[name]:.4g}{UNIT_OF_LETTER[name[0]]}" for name in left]
    if texts:
        masses = "; only the ratio of the masses acts" if "m2" in left else ""
        print(f"assumed, as in the set {source}: {', '.join(texts)} (--set){masses}")


# -- the box's motion -----------------------------------------------------------------------------


class OfPushes(Options):
    """Options of what acts besides the box's harmonic motion."""

    heading, rank = "what acts besides", 1
    box_acceleration: float | None = option(
        "constant acceleration of the box, m/s2 or with g: -1g is gravity towards positive x, as "
        "to a stop"
    )
    force1: float | None = option("amplitude of a force F sin(Omega t) on half 1, N")
    force2: float | None = option("the same on half 2")

    def given_pushes(self) -> dict[str, float]:
        return self.given_options(OfPushes)


class OfBox(OfPushes):
    """Options of the box's harmonic motion."""

    heading, rank = "the box's motion", 1
    remark = (
        "one frequency and one amplitude of these, or the [excitation] of the file of --structure; "
        "where several values are taken: FIRST:LAST:STEP with both ends, or a list A,B,..."
    )
    hz: str | None = option("frequency in Hz", value="VALUES")
    rpm: str | None = option("the same in turns per minute", value="VALUES")
    frequency: str | None = option("the same as Omega in rad/s", value="VALUES")
    eta: Any = option("the same as frequency ratio Omega/omega", value="VALUES")
    amplitude: float | None = option("amplitude a in m (default with --eta: 1/eta^2 m)", value="A")
    g: Any = option("the same as peak acceleration in g, held at all frequencies", value="VALUES")

    def read_excitation(
        self,
        structure: Structure,
        needs_metres: bool = False,
        one_frequency: bool = False,
        by_level: bool = False,
    ) -> Keywords:
        """Return frequency and amplitude of the box's motion as keywords of the public API.

        With ``by_level`` the level in place of the amplitude, which may have several values; with
        ``needs_metres`` the paper's amplitude, 1/eta^2 m, is refused of other structures.
        """
        self.given_option("amplitude", "g")
        levels = grammar.parse_one_or_more("--g", self.g) if by_level else ()
        name = self.given_frequency_option()
        amplitude = None if by_level else self.amplitude_or_level()
        if name is None:
            own = amplitude is None and not by_level and self.take_excitation_from_file()
            if own:
                return own
            text = f"expected one of {option_names(FREQUENCIES)}"
            raise InputError(f"frequency: nothing given; {text}")
        text = getattr(self, name)
        values = grammar.parse_one_or_more(f"--{name}", text, one_frequency)
        to_rad_s = TO_RAD_S[UNITS[name]] if name in UNITS else lambda eta: eta * structure.omega
        box: Keywords = {"frequency": apply_to_each(to_rad_s, values)}
        if by_level:
            box["level"] = apply_to_each(lambda peak: peak * GRAVITY, levels)
        elif amplitude is None:
            if name != "eta":
                raise InputError(f"--{name} {text}: expected --amplitude in m or --g with it")
            if needs_metres and not math.isclose(structure.omega, 1.0):
                paper = "(1/eta^2 m is the paper's, for omega = 1 rad/s)"
                omega = f"--eta {text}: omega is {structure.omega:g} rad/s"
                raise InputError(f"{omega}; expected --amplitude in m or --g with it {paper}")
            box = {"eta": values}
        elif self.g is None:
            box["amplitude"] = amplitude
        else:
            peak = amplitude * GRAVITY
            box["amplitude"] = apply_to_each(lambda x: peak / (x * x), box["frequency"])
        return {**box, **self.given_pushes()}

    def take_excitation_from_file(self) -> Keywords | None:
        """Return keywords of the excitation in the structure's file, or None; set ``--phase``."""
        excitation: Any = read(self.structure).get("excitation")
        if excitation is None:
            return None
        if getattr(self, "phase", None) == 0.0:
            self.phase = excitation.phase
        pushes = {name: getattr(excitation, name) for name in PUSHES if getattr(excitation, name)}
        box = {"frequency": excitation.frequency, "amplitude": excitation.amplitude}
        return {**box, **pushes, **self.given_pushes()}

    def given_frequency_option(self) -> str | None:
        return self.given_option(*FREQUENCIES)

    def amplitude_or_level(self) -> float | None:
        """Return the number of ``--amplitude`` (m) or ``--g`` (g); None if neither is there."""
        given = self.given_option("amplitude", "g") == "g"
        return grammar.parse_positive_number("--g", self.g) if given else self.amplitude

    def is_shaken(self) -> bool:
        return self.given_frequency_option() is not None or self.amplitude_or_level() is not None

    def has_several_levels(self) -> bool:
        return self.g is not None and not grammar.is_single_number(self.g)


def apply_to_each(change: Callable[[float], float], values: float | tuple[float, ...]) -> Any:
    return tuple(map(change, values)) if isinstance(values, tuple) else change(values)


# -- a parameter that varies ----------------------------------------------------------------------


class Over(Options):
    """Options of a parameter that varies."""

    over: Any = option(
        "a parameter of the structure that varies, as for --set, at one frequency", value="NAME"
    )
    values: Any = option("its values, FIRST:LAST:STEP or a list A,B,...", value="VALUES")

    def over_arguments(self) -> Keywords:
        if (self.over is None) != (self.values is None):
            raise InputError("--over and --values: expected both, or none of them")
        values = self.over and grammar.parse_over_values(self.over, self.values)
        return {"over": self.over, "values": values} if values else {}

    def read_question_along_parameter(
        self, needs_metres: bool = False
    ) -> tuple[Structure, Keywords]:
        structure, varied = self.read_and_report_structure(), self.over_arguments()
        if varied:
            self.check_varied_parameter(self.over)
        by_level = not varied and self.has_several_levels()
        box = self.read_excitation(structure, needs_metres, bool(varied) or by_level, by_level)
        if by_level:
            varied = {"over": "level", "values": box.pop("level")}
        return structure, {**self.function_keywords(), **box, **varied}

    def check_varied_parameter(self, over: str) -> None:
        if over in FREQUENCIES:
            raise InputError(f"--over {over}: expected --{over} VALUES instead")
        if over in ("amplitude", "g", "level"):
            raise InputError(f"--over {over}: expected --g VALUES at one frequency instead")
        scaled = self.amplitude_or_level() is not None and self.eta is not None
        if scaled and over in ("m1", "k1", "omega"):
            expected = option_names(UNITS, " or ")
            raise InputError(f"--over {over}: omega varies; expected {expected} instead of --eta")


def parse_continued(name: str, limits: str) -> tuple[str, tuple[float, ...]]:
    """Return a continued parameter's name in the public API, and its limits in that one's unit."""
    if name == "g":
        raise InputError("--over g: expected --over amplitude, in m, at one frequency")
    ends = grammar.parse_ends("--limits", limits)
    return ("frequency", tuple(map(TO_RAD_S[UNITS[name]], ends))) if name in UNITS else (name, ends)


# -- sensors --------------------------------------------------------------------------------------


class OfSensors(Options):
    """Options of accelerometers that read a simulated motion."""

    heading = "sensors of a simulated test"
    sensor: Any = option(
        "what accelerometers of this bandwidth read, with the spikes of impacts; RATE: samples a "
        "second (default: 2.56 times it)",
        value="HZ[:RATE]",
        read=grammar.parse_sensor,
    )
    noise: float | None = option("density of their noise, (m/s2)/sqrt(Hz), or 30ug of g/sqrt(Hz)")
    range: float | None = option(
        "of the sensors, g (default: none)", read=grammar.parse_positive_number
    )

    def read_sensor(
        self, usual: Callable[..., orchestrate.Sensor] | None = None
    ) -> orchestrate.Sensor | None:
        """Return the sensor; without ``--sensor`` the ``usual`` one, None without any option."""
        limits = {"noise": self.noise, "range": self.range and GRAVITY * self.range}
        given: Keywords = {n: value for n, value in limits.items() if value is not None}
        if self.sensor is not None:
            bandwidth, *rate = self.sensor
            return orchestrate.Sensor(bandwidth=bandwidth, sample_rate=[*rate, None][0], **given)
        if given and usual is None:
            raise InputError(f"{option_names(given)}: of sensors; expected --sensor HZ with it")
        return usual(**given) if given and usual else None


class Beside(Options):
    """The option of both structures."""

    beside: bool = option("also compute the bonded structure and plot both")
