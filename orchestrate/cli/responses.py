"""Commands on responses to harmonic excitation: simulate, resonance, spectra, sweep, map."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from ..errors import InputError
from ..flags import flag_words
from ..lazy import xr
from ..units import is_in_ratios, text_of, with_units
from .answer import Asked, Overlay, is_curve
from .command import Question, option
from .drive import OfMotor, OfVoltage
from .grammar import is_single_number, parse_changes, parse_listed
from .options import Beside, OfBox, OfStructure, Over
from .output import Files, OfBoth, Results, Stored, digest
from .text import (
    MOST_ROWS,
    Columns,
    columns_of,
    extents,
    format_largest_gap,
    format_parameter,
    format_range,
    format_ranges,
    format_share,
    has_flag,
    impact_lines,
    parameter_column,
    table,
    table_of_one,
    varied_parameter,
)

if TYPE_CHECKING:
    from ..model import Structure


class Simulate(OfStructure, OfBox, Beside, Asked, Stored, Results):
    """A motion in time: both masses, gap, contact force, impacts, phase plane and spectrum."""

    calls = "simulate"
    examples = """
  {program} simulate --eta 0.4 --transient 500 --periods 2      the paper's Figure 5
  {program} simulate --eta 1.047 --beside                       with the undamaged structure
  {program} simulate --structure beam --hz 12.5 --g 0.02
  {program} simulate --eta 1.2 --start 0,0.5,0,0                from a gap of 0.5 m"""

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        yield from extents(data, "x1 x2 x_rel a1_abs a2_abs")
        yield from impact_lines(data)


def level_columns(data: xr.Dataset) -> Columns:
    """Return the largest response at each level, bonded and delaminated, and where it opens."""
    rows = parameter_column(data, "level", data.level.values, ".4g")
    for structure in ("bonded", "delaminated"):
        part = data.sel(structure=structure)
        tops = [at.isel(at.x1_max.argmax(...)) for _, at in part.groupby("level")]
        sizes = [text_of(data, top.x1_max, "m", ".4g") for top in tops]
        at = [format_parameter(data, "frequency", top.frequency, ".4g") for top in tops]
        rows[f"{structure} x1"] = [" at ".join(pair) for pair in zip(sizes, at, strict=True)]
    gaps = data.x_rel_max.sel(structure="delaminated").transpose("level", ...)
    rows["largest gap"] = [text_of(data, gap.max(), "m", ".4g") for gap in gaps]
    if data.attrs["clearance"] < 0.0:
        opens = (gaps > 0.0).any(set(gaps.dims) - {"level", "frequency"})
        rows["opens at"] = [
            format_ranges(data, "frequency", row.values, 2) if row.any() else "nowhere"
            for row in opens
        ]
    return rows


class Resonance(OfStructure, OfBox, Overlay, Asked, Stored, Results):
    """Resonance curves: amplitude and peak acceleration, bonded against delaminated; at several
    levels (--g FIRST:LAST:STEP), with the level at which a preloaded structure first opens.
    """

    calls = "resonance"
    examples = """
  {program} resonance --structure beam --hz 8:20:0.05 --g 0.02
  {program} resonance --structure beam --rpm 500:1200:5 --amplitude 3e-5 --format nc,csv
  {program} resonance --structure beam --set clearance=-2e-5 --hz 8:20:0.05 --g 0.02,0.1,0.5
  {program} resonance --eta 0.3:4:0.005 --set e=0.3             the paper's structure"""
    has_picture = staticmethod(is_curve)

    def __call__(self) -> None:
        structure = self.read_structure()
        several = self.g is not None and not is_single_number(self.g)
        if several:
            excitation = self.excitation_by_level(structure)
        else:
            excitation = self.read_excitation(structure, si=True)
        question = {**self.keywords(), **excitation}
        function = "resonance_levels" if several else "resonance"
        self.answer(structure, question, function=function)

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        from .. import model

        sizes = "x1_max x2_max a1_max a2_max x_rel_max"
        if "level" in data.dims:
            yield from table(level_columns(data), data.sizes["level"])
        else:
            name = varied_parameter(data)
            if data.sizes[name] == 1:
                yield from table_of_one(data, name)
                return
            peaks = data.isel(peak=data.peak_irregular.values == 0)
            irregular = data.sizes["peak"] - peaks.sizes["peak"]
            for of, part, columns in (("peak", peaks, sizes), ("jump", data, "before after")):
                if not part.sizes[of]:
                    yield f"no {of} in this range"
                    continue
                rows = columns_of(part, "structure direction", f"{of}_")
                rows |= parameter_column(data, name, part[f"{of}_{name}"].values)
                yield "peaks" if of == "peak" else "jumps of the largest gap"
                yield from table(rows | columns_of(part, columns, f"{of}_", ".4g"))
            if irregular:
                yield f"peaks of irregular responses, left out: {irregular}"
        if "lowest_threshold" in data:
            event = data.lowest_threshold.attrs["event"]
            level = format_parameter(data, "level", float(data.lowest_threshold), ".3g")
            where = format_parameter(data, "frequency", data.lowest_threshold_frequency, ".4g")
            yield f"in this range it first {event} at {where}: {level}"
        if data.attrs.get("clearance", 0.0) < 0.0:
            at_rest = model.Structure.from_attributes(data.attrs).as_delaminated().at_rest
            ends = " and ".join(text_of(data, abs(x), "m", ".4g") for x in at_rest)
            middle = "x1 and x2 count from the box's middle"
            yield f"{middle}: the preload by itself holds them {ends} from it"


CAPTURED = {"quick": 1.53, "beam": 1.45}  # eta0 at which the motor is captured by the resonance


def line_ratio(data: xr.Dataset, name: str, amplitude: xr.DataArray) -> str:
    """Format a spectrum's largest line, and its largest one above the excitation over that."""
    largest = float(amplitude.max())
    above = float(amplitude.where(amplitude.order > 1.5, 0.0).max())
    share = above / largest if largest else 0.0
    line = text_of(data, largest, "m/s2", ".4g")
    return f"{name}: largest line {line}, {share:.2g} of it above the excitation"


class Spectra(OfMotor, OfVoltage, OfBox, Asked, Stored, OfBoth):
    """Acceleration spectra, bonded and delaminated (Figure 3)."""

    calls = "spectra"
    examples = """
  {program} spectra                      Figure 3: quick, the motor is captured by the resonance
  {program} spectra --drive beam --voltage 6.5
  {program} spectra --eta 0.4,1.047      shaken harmonically instead, at these frequency ratios
  {program} spectra --structure beam --hz 12.5 --g 0.02 --format nc,csv"""

    def __call__(self) -> None:
        of_motor = self.one_of("eta0", "voltage")
        if not (self.is_shaken() or self.pushes()):
            self.answer_motor_spectra()
            return
        if of_motor is not None:
            frequency = self.frequency_option() or "amplitude or --g"
            raise InputError(f"--{frequency}: expected without --{of_motor}, which is the motor's")
        from ..model import Structure

        self.structure = self.structure or "paper"
        structure = Structure.from_file(self.structure).replace(**parse_changes(self.set))
        excitation = self.read_excitation(structure, si=True)
        self.answer(structure, {**self.keywords(), **excitation})

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        name = str(data.acceleration.dims[0])
        for value in data[name].values:
            for kind in map(str, data.kind.values):
                part = data.acceleration.sel({"kind": kind, "mass": 1, name: value})
                yield line_ratio(
                    data, f"{kind} at {format_parameter(data, name, float(value))}", part
                )

    def answer_motor_spectra(self) -> None:
        """Compute spectra of a motor-driven structure (Figure 3); print, store and draw them."""
        structure, drive = self.read_structure_and_drive()
        eta0 = CAPTURED.get(self.drive) if self.eta0 is None else self.eta0
        voltage = self.voltage
        if voltage is None and eta0 is not None:
            voltage = eta0 * drive.volts(structure)
        digits = digest(structure.parameters(), drive.parameters(), voltage)
        stem = Path(self.drive).stem
        files = Files.from_options(self, f"spectra_{stem}_{digits}")

        import orchestrate

        running = self.running(files.result)
        data = orchestrate.drive_spectra(structure, drive, voltage=voltage, **running)
        data = with_units(data, self.drive_units())
        for kind in map(str, data.kind.values):
            part = data.sel(kind=kind, mass=1)
            speed = text_of(data, part.speed, "rad/s", ".5g")
            print(line_ratio(data, f"{kind} at {speed}", part.acceleration))
        words = str(data.attrs["title"])
        title = f"{stem}: {words[0].lower()}{words[1:]}, absolute acceleration of mass 1"
        files.write(data, partial(orchestrate.plot, data, title=title))


PAPER_RANGE = "0.1:8.0:0.001"  # frequency ratios of Figure 6
DIFFERENT = 0.01  # of the largest gap: where up and down differ by more, they are different motions
UNDECIDED = "; undecided: slow to converge or nearly periodic, --transient 5000 decides most"
WORDS = {"repeated": "repeat", "irregular": "irregular", "undecided": "undecided"}


def count_line(data: xr.Dataset) -> str:
    """Format how many responses repeat, are irregular, or are undecided, and permanent contact."""
    decided, size = data.multiplicity_decided, data.multiplicity_decided.size
    shares = [
        format_share(int(has_flag(decided, flag).sum()), size, word) for flag, word in WORDS.items()
    ]
    contact = int(data.permanent_contact.sum()) if "permanent_contact" in data else 0
    if contact:
        shares.append(format_share(contact, size, "with permanent contact"))
    return f"{size:,} responses: {', '.join(shares)}"


def window_lines(data: xr.Dataset, name: str) -> Iterator[str]:
    """Yield the widest windows of one kind of response: range, multiplicity, impacts a period."""
    windows: list[tuple[xr.Dataset, list[int]]] = []
    several = "direction" in data.dims
    for part in [data.isel(direction=i) for i in range(2)] if several else [data]:
        marks = window_marks(part)
        runs = itertools.groupby(range(len(marks)), key=marks.__getitem__)
        windows += [(part, list(run)) for _, run in runs]
    widest = sorted(windows, key=lambda window: -len(window[1]))[: MOST_ROWS - 1]
    columns: dict[str, list[str]] = {"widest windows": [], "repeats": [], "impacts per period": []}
    for part, run in sorted(widest, key=lambda window: window[1]):
        low, high = (float(part[name][i]) for i in (run[0], run[-1]))
        impacts = part.impacts_per_period[run]
        fewest, most = (f"{float(end):.4g}" for end in (impacts.min(), impacts.max()))
        direction = f", {part.direction.item()}" if several else ""
        cells = (
            format_range(data, name, low, high) + direction,
            window_marks(part.isel({name: run[:1]}))[0][0],
            fewest if fewest == most else f"{fewest} to {most}",
        )
        for column, cell in zip(columns.values(), cells, strict=True):
            column.append(cell)
    yield from table(columns)


def window_marks(data: xr.Dataset) -> list[tuple[str, float]]:
    """Return what each response does, and its impacts a period where it repeats."""
    words = flag_words(data.multiplicity_decided.attrs)
    names = ("multiplicity_decided", "multiplicity", "impacts_per_period")
    rows = zip(*(data[name].values.tolist() for name in names), strict=True)
    return [
        (f"after {n} T", round(impacts, 9)) if words[how] == "repeated" else (words[how], 0.0)
        for how, n, impacts in rows
    ]


class Sweep(OfStructure, OfBox, Over, Overlay, Asked, Stored, Results):
    """Follow responses along the frequency or another parameter: an orbit diagram."""

    calls = "sweep"
    eta: Any = option(
        "the same as frequency ratio Omega/omega (default: 0.1:8.0:0.001 where no frequency is "
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
  {program} sweep --eta 2.4:2.8:0.002 --overlay branch.nc   with what branch has written
Repeat the command to resume an interrupted run. A finished result is left as it is."""
    has_picture = staticmethod(is_curve)

    def ask(self) -> tuple[Structure, Question]:
        structure = self.read_structure()
        excitation, is_range = self.varied_arguments(structure, usual=PAPER_RANGE)
        direction = self.direction or ("up" if is_range else "given")
        return structure, {**self.keywords(), **excitation, "direction": direction}

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        name = varied_parameter(data)
        if data.sizes[name] == 1:
            yield from table_of_one(data, name)
            return
        top = data.isel(data.xi_rel_max.argmax(...))
        yield f"largest gap: {format_largest_gap(top)} at {format_parameter(data, name, top[name])}"
        for mass in (1, 2) if not is_in_ratios(data) else ():
            displacement = text_of(data, data[f"x{mass}_max"].max(), "m", ".4g")
            acceleration = text_of(data, data[f"a{mass}_max"].max(), "m/s2", ".4g")
            yield f"mass {mass}: largest displacement {displacement}, acceleration {acceleration}"
        undecided = has_flag(data.multiplicity_decided, "undecided").any()
        yield f"{count_line(data)}{UNDECIDED if undecided else ''}"
        yield from window_lines(data.sortby(name), name)
        if "direction" in data.dims:
            up, down = (data.xi_rel_max.sel(direction=word) for word in ("up", "down"))
            differ = abs(up - down) > DIFFERENT * data.xi_rel_max.max("direction")
            where = f"at {format_ranges(data, name, differ.values)}" if differ.any() else "nowhere"
            yield f"up and down differ by more than {DIFFERENT:.0%} of the largest gap {where}"


class Map(OfStructure, OfBox, Over, Overlay, Asked, Stored, Results):
    """Responses over two parameters: impacts per period, multiplicity, largest gap, exponent."""

    calls = "map"
    over: list[str] = option(
        "a parameter of the structure that varies, as for --set; twice at one frequency",
        (),
        value="NAME",
    )
    values: list[str] = option(
        "its values, FIRST:LAST:STEP or a list A,B,...; one for each --over", (), value="VALUES"
    )
    examples = """
  {program} map --eta 0.4:2.2:0.05 --over e --values 0.1:0.9:0.05
  {program} map --eta 1.2 --over e --values 0.1:0.9:0.1 --over D --values 0.005,0.02,0.05
  {program} map --structure beam --hz 8:20:0.25 --amplitude 1e-4 --over e --values 0.3,0.5,0.7
  {program} map --structure beam --set clearance=2e-5 --hz 8:20:0.25 --g 0.002:0.05:0.002
  {program} map --eta 2.4:2.9:0.02 --over e --values 0.6:0.8:0.02 --overlay border.nc
Each point starts from rest. The picture has a panel for each quantity."""

    def ask(self) -> tuple[Structure, Question]:
        structure = self.read_structure()
        if len(self.over) != len(self.values):
            raise InputError("--over and --values: give exactly one --values for each --over")
        for name in self.over:
            self.check_over(name)
        chosen = self.excitation_by_level if self.g is not None else self.read_excitation
        excitation: Question = chosen(structure, one=len(self.over) == 2)
        for name, text in zip(self.over, self.values, strict=True):
            if name in excitation or (name == "level" and "amplitude" in excitation):
                raise InputError(f"--over {name}: twice; expected two parameters")
            excitation[name] = parse_listed(name, text)[0]
        if sum(isinstance(value, tuple) for value in excitation.values()) != 2:
            raise InputError(
                "map: expected two parameters that vary: a range of frequencies and one of levels "
                "(--g) or --over with --values, or --over with --values twice at one frequency"
            )
        return structure, {**self.keywords(), **excitation}

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        yield count_line(data)
        kinds = data.multiplicity.values[has_flag(data.multiplicity_decided, "repeated").values]
        counts = {n: int((kinds == n).sum()) for n in sorted(set(kinds.tolist()))}
        shares = [
            format_share(count, kinds.size, f"after {int(n)} T") for n, count in counts.items()
        ]
        if shares:
            yield f"they repeat: {', '.join(shares[:4])}"
        top = data.isel(data.xi_rel_max.argmax(...))
        names = map(str, data.xi_rel_max.dims)
        where = ", ".join(format_parameter(data, name, top[name]) for name in names)
        yield f"largest gap: {format_largest_gap(top)} at {where}"
        yield from extents(data, "impacts_per_period")
        if "exponent" in data:
            chaotic = int(has_flag(data.verdict, "chaotic").sum())
            yield format_share(chaotic, data.exponent.size, "chaotic")
