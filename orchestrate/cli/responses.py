"""Commands on responses to harmonic excitation: simulate, resonance, spectra, sweep, map."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal

from ..errors import InputError
from ..lazy import xr
from ..model import Drive, Structure
from ..units import format_quantity
from . import printing
from .answer import FunctionCommand, Overlay, has_several_values
from .command import Keywords, option, option_names
from .drive import DriveCommand
from .grammar import parse_changes, parse_over_values
from .options import Beside, OfBox, OfStructure, Over
from .output import OfBoth, Results, Stored


class Simulate(OfStructure, OfBox, Beside, FunctionCommand, Stored, Results):
    """A motion in time: both masses, gap, contact force, impacts, phase plane and spectrum."""

    calls, shows = "simulate", "x1 x2 x_rel a1_abs a2_abs"
    examples = """
  {program} simulate --eta 0.4 --transient 500 --periods 2      the paper's Figure 5
  {program} simulate --eta 1.047 --beside                       with the undamaged structure
  {program} simulate --structure beam --hz 12.5 --g 0.02
  {program} simulate --eta 1.2 --start 0,0.5,0,0                from a gap of 0.5 m"""


def largest_response_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield the largest response at each level, bonded and delaminated, and where it opens."""
    data = data.transpose("level", "structure", ...)
    others = [dim for dim in data.x1_max.dims if dim not in ("level", "structure")]
    gap = data.x_rel_max.max(others, keep_attrs=True)
    top, names = data.isel(data.x1_max.argmax(others)).assign(gap=gap), "x1_max, frequency, gap"
    if data.attrs["clearance"] < 0.0:
        opens = (data.x_rel_max > 0.0).any({*others} - {"frequency"})
        texts = [[printing.format_ranges(data, "frequency", x, 2) for x in y] for y in opens.values]
        top, names = top.assign({"opens at": (opens.dims[:2], texts)}), f"{names}, opens at"
    yield from printing.table_lines(top, names, ".4g")


class Resonance(OfStructure, OfBox, Overlay, FunctionCommand, Stored, Results):
    """Resonance curves: amplitude and peak acceleration, bonded against delaminated; at several
    levels (--g FIRST:LAST:STEP), with the level at which a preloaded structure first opens.
    """

    calls = "resonance"
    examples = """
  {program} resonance --structure beam --hz 8:20:0.05 --g 0.02
  {program} resonance --structure beam --set clearance=-2e-5 --hz 8:20:0.05 --g 0.02,0.1,0.5
  {program} resonance --eta 0.3:4:0.005 --set e=0.3             the paper's structure"""
    has_picture = staticmethod(has_several_values)

    def read_question(self) -> tuple[Structure, Keywords]:
        structure, question = self.read_and_report_structure(), self.function_keywords()
        if self.has_several_levels():
            self.calls = "resonance_levels"
            if pushes := self.given_pushes():
                raise InputError(f"{option_names(pushes)}: expected one level, --g, with it")
            return structure, {**question, **self.read_excitation(structure, by_level=True)}
        return structure, {**question, **self.read_excitation(structure, needs_metres=True)}

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        if "level" in data.dims:
            yield from largest_response_lines(data)
        else:
            if not data.sizes["peak"]:
                for part in (data.sel(structure=one) for one in data.structure):
                    yield f"{part.structure.item()}:"
                    yield from printing.describe(part, "x1_max x2_max a1_max a2_max x_rel_max")
            of = f"structure, direction, {printing.varied_parameter_name(data)}"
            largest = "x1_max:.4g, x2_max:.4g, a1_max:.4g, a2_max:.4g, x_rel_max:.4g, irregular"
            yield from printing.listing_lines(data, "peak", f"{of}, {largest}")
            yield from printing.listing_lines(data, "jump", f"{of}, before:.4g, after:.4g")
            if data.sizes["jump"]:
                yield "before, after: the largest gap on both sides of the jump"
        if "lowest_threshold" in data:
            level, at = data.lowest_threshold, data.lowest_threshold_frequency
            where = printing.format_parameter(data, "frequency", at, form=".4g")
            text = printing.format_parameter(data, "level", level, form=".3g")
            yield f"in this range it first {level.attrs['event']} at {where}: {text}"
        if data.attrs.get("clearance", 0.0) < 0.0:
            at_rest = Structure.from_attributes(data.attrs).as_delaminated().at_rest
            ends = " and ".join(format_quantity(data, abs(x), "m", ".4g") for x in at_rest)
            middle = "x1 and x2 count from the box's middle"
            yield f"{middle}: the preload by itself holds them {ends} from it"


CAPTURED = {"quick": 1.53, "beam": 1.45}  # eta0 at which the motor is captured by the resonance


class Spectra(OfBox, DriveCommand, Stored, OfBoth):
    """Acceleration spectra, bonded and delaminated (Figure 3)."""

    calls = "spectra"
    eta0: float | None = option(
        "the motor's voltage as no-load speed over omega (default: 1.53 for quick, 1.45 for beam, "
        "else between the jumps of the averaged theory)"
    )
    voltage: float | None = option("the same in V")
    examples = """
  {program} spectra                      Figure 3: quick, the motor is captured by the resonance
  {program} spectra --drive beam --voltage 6.5
  {program} spectra --eta 0.4,1.047      shaken harmonically instead, at these frequency ratios
  {program} spectra --structure beam --hz 12.5 --g 0.02 --format nc,csv"""

    def read_question(self) -> tuple[Any, ...]:
        of_motor = self.given_option("eta0", "voltage")
        if not (self.is_shaken() or self.given_pushes()):
            self.calls = "drive_spectra"
            return self.read_motor_question()
        if of_motor is not None:
            frequency = self.given_frequency_option() or "amplitude or --g"
            raise InputError(f"--{frequency}: expected without --{of_motor}, which is the motor's")
        self.drive, self.structure = "", self.structure or "paper"
        structure = Structure.from_file(self.structure).replace(**parse_changes(self.set))
        excitation = self.read_excitation(structure, needs_metres=True)
        return structure, {**self.function_keywords(), **excitation}

    def read_motor_question(self) -> tuple[Structure, Drive, Keywords]:
        structure, motor = self.read_structure_and_drive()
        eta0 = CAPTURED.get(self.drive) if self.eta0 is None else self.eta0
        voltage = self.voltage
        if voltage is None and eta0 is not None:
            voltage = eta0 * motor.volts(structure)
        return structure, motor, {"voltage": voltage}

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        lines = data.acceleration.sel(mass=1)
        largest, above = lines.max("order"), lines.where(lines.order > 1.5).max("order")
        part = (above / largest).assign_attrs(units="1")
        shown = data.assign(largest=largest.assign_attrs(lines.attrs), part=part)
        yield "the largest line, and what part of it the largest above the excitation's is"
        speed = "speed:.5g, " * ("speed" in data)
        yield from printing.table_lines(shown, f"{speed}largest:.4g, part:.2g")


PAPER_RANGE = "0.1:8.0:0.001"  # frequency ratios of Figure 6
FEW = 4  # responses that have a row each, such as at one value up and down
DIFFERENT = 0.01  # of the largest gap: where up and down differ by more, they are different motions


def response_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield the sizes of responses, and their periods: of few in a table, of many in numbers."""
    sizes, decided = "x1_max x2_max a1_max a2_max", data.multiplicity_decided
    if data.multiplicity.size <= FEW:
        yield from printing.describe(data, f"{sizes} permanent_contact")
        names = "xi_rel_max, impacts_per_period:.4g, multiplicity, multiplicity_decided"
        yield from printing.table_lines(data, names)
        if printing.flag_mask(decided, "undecided").any():
            yield from printing.hint_lines(["multiplicity_decided: undecided"])
        return
    counted = "impacts_per_period multiplicity_decided permanent_contact"
    yield from printing.describe(data, f"xi_rel_max {sizes} {counted}")
    repeated = printing.flag_mask(decided, "repeated")
    yield from printing.count_lines(data, data.multiplicity.where(repeated))


class Sweep(OfStructure, OfBox, Over, Overlay, FunctionCommand, Stored, Results):
    """Follow responses along the frequency or another parameter: an orbit diagram."""

    calls = "sweep"
    eta: Any = option(
        f"the same as frequency ratio Omega/omega (default: {PAPER_RANGE} where no frequency is "
        "given)",
        value="VALUES",
    )
    direction: Literal["up", "down", "both"] | None = option(
        "order of the values, each started from the end of the last (default: up for a range, a "
        "list as it stands)"
    )
    examples = """
  {program} sweep                                           the paper's Figure 6
  {program} sweep --set e=0.3                               Figure 11
  {program} sweep --eta 1.0:1.5:0.0005 --direction both     up and down: non-unique responses
  {program} sweep --over e --values 0.05:0.95:0.003 --eta 1.2
  {program} sweep --structure beam --hz 8:20:0.05 --g 0.02 --format nc,csv
  {program} sweep --eta 2.4:2.8:0.002 --overlay branch.nc   with what branch has written"""
    has_picture = staticmethod(has_several_values)

    def read_question(self) -> tuple[Structure, Keywords]:
        if self.over is None and not self.is_shaken():
            self.eta = PAPER_RANGE
        texts = (self.values, self.eta, self.hz, self.rpm, self.frequency, self.g)
        usual = "up" if any(":" in text for text in texts if text) else "given"
        structure, question = self.read_question_along_parameter()
        return structure, {**question, "direction": self.direction or usual}

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        name = printing.varied_parameter_name(data)
        if data.sizes[name] == 1:
            yield "one value: no picture"
        yield from response_lines(data)
        if "direction" in data.dims:
            up, down = (data.xi_rel_max.sel(direction=word) for word in ("up", "down"))
            differ = abs(up - down) > DIFFERENT * data.xi_rel_max.max("direction")
            where = printing.format_ranges(data, name, differ.values)
            text = f"up and down differ by more than {DIFFERENT:.0%} of the largest gap"
            yield f"{text} {'at ' * bool(differ.any())}{where}"


class Map(OfStructure, OfBox, Over, Overlay, FunctionCommand, Stored, Results):
    """Responses over two parameters: impacts per period, multiplicity, largest gap, exponent."""

    calls = "map"
    over: list[str] = option(
        "a parameter of the structure that varies, as for --set; twice at one frequency",
        (),
        "NAME",
    )
    values: list[str] = option(
        "its values, FIRST:LAST:STEP or a list A,B,...; one for each --over", (), "VALUES"
    )
    examples = """
  {program} map --eta 0.4:2.2:0.05 --over e --values 0.1:0.9:0.05
  {program} map --eta 1.2 --over e --values 0.1:0.9:0.1 --over D --values 0.005,0.02,0.05
  {program} map --structure beam --set clearance=2e-5 --hz 8:20:0.25 --g 0.002:0.05:0.002
  {program} map --eta 2.4:2.9:0.02 --over e --values 0.6:0.8:0.02 --overlay border.nc
Each point starts from rest. The picture has a panel for each quantity."""

    def read_question(self) -> tuple[Structure, Keywords]:
        structure = self.read_and_report_structure()
        if len(self.over) != len(self.values):
            raise InputError("--over and --values: give exactly one --values for each --over")
        for name in self.over:
            self.check_varied_parameter(name)
        twice, by_level = len(self.over) == 2, self.g is not None
        excitation = self.read_excitation(structure, one_frequency=twice, by_level=by_level)
        for name, text in zip(self.over, self.values, strict=True):
            if name in excitation or (name == "level" and "amplitude" in excitation):
                raise InputError(f"--over {name}: twice; expected two parameters")
            excitation[name] = parse_over_values(name, text)
        if sum(isinstance(value, tuple) for value in excitation.values()) != 2:
            raise InputError(
                "map: expected two parameters that vary: a range of frequencies and one of levels "
                "(--g) or --over with --values, or --over with --values twice at one frequency"
            )
        return structure, {**self.function_keywords(), **excitation}

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        yield from response_lines(data)
        yield from printing.describe(data, "verdict")
