"""Commands on responses to harmonic excitation: simulate, resonance, spectra, sweep, map."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any, Literal

from ..errors import InputError
from ..flags import flag_word, flag_words
from ..lazy import xr
from ..model import Drive, Structure
from ..units import as_shown, is_in_ratios, text_of
from . import printing
from .answer import Asked, Overlay, is_curve
from .command import Keywords, option, option_names
from .drive import Driven
from .grammar import parse_changes, parse_listed
from .options import Beside, OfBox, OfStructure, Over
from .output import OfBoth, Results, Stored


class Simulate(OfStructure, OfBox, Beside, Asked, Stored, Results):
    """A motion in time: both masses, gap, contact force, impacts, phase plane and spectrum."""

    calls = "simulate"
    examples = """
  {program} simulate --eta 0.4 --transient 500 --periods 2      the paper's Figure 5
  {program} simulate --eta 1.047 --beside                       with the undamaged structure
  {program} simulate --structure beam --hz 12.5 --g 0.02
  {program} simulate --eta 1.2 --start 0,0.5,0,0                from a gap of 0.5 m"""

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        yield from printing.extents(data, "x1 x2 x_rel a1_abs a2_abs")
        yield from printing.impact_lines(data)


def level_columns(data: xr.Dataset) -> printing.Columns:
    rows = printing.columns_of(data, "level", form=".4g")
    for structure in ("bonded", "delaminated"):
        part = data.x1_max.sel(structure=structure)
        tops = [at.isel(at.argmax(...)) for _, at in part.groupby("level")]
        rows[f"{structure} x1"] = [
            f"{text_of(data, top, 'm', '.4g')} at "
            f"{printing.format_parameter(data, 'frequency', top.frequency, '.4g')}"
            for top in tops
        ]
    gaps = data.x_rel_max.sel(structure="delaminated").transpose("level", ...)
    rows["largest gap"] = [text_of(data, gap.max(), "m", ".4g") for gap in gaps]
    if data.attrs["clearance"] < 0.0:
        opens = (gaps > 0.0).any(set(gaps.dims) - {"level", "frequency"})
        rows["opens at"] = [
            printing.format_ranges(data, "frequency", row.values, 2) for row in opens
        ]
    return rows


class Resonance(OfStructure, OfBox, Overlay, Asked, Stored, Results):
    """Resonance curves: amplitude and peak acceleration, bonded against delaminated; at several
    levels (--g FIRST:LAST:STEP), with the level at which a preloaded structure first opens.
    """

    calls = "resonance"
    examples = """
  {program} resonance --structure beam --hz 8:20:0.05 --g 0.02
  {program} resonance --structure beam --set clearance=-2e-5 --hz 8:20:0.05 --g 0.02,0.1,0.5
  {program} resonance --eta 0.3:4:0.005 --set e=0.3             the paper's structure"""
    has_picture = staticmethod(is_curve)

    def ask(self) -> tuple[Structure, Keywords]:
        structure, question = self.read_structure(), self.keywords()
        if self.has_levels():
            self.calls = "resonance_levels"
            if pushes := self.pushes():
                raise InputError(f"{option_names(pushes)}: expected one level, --g, with it")
            return structure, {**question, **self.read_excitation(structure, by_level=True)}
        return structure, {**question, **self.read_excitation(structure, si=True)}

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        if "level" in data.dims:
            yield from printing.table(level_columns(data), data.sizes["level"])
        else:
            name = printing.varied_parameter(data)
            if data.sizes[name] == 1:
                yield from table_of_one(data, name)
                return
            yield from peak_lines(data, name)
        if "lowest_threshold" in data:
            at = data.lowest_threshold
            level = printing.format_parameter(data, "level", at, ".3g")
            where = data.lowest_threshold_frequency
            where = printing.format_parameter(data, "frequency", where, ".4g")
            yield f"in this range it first {at.attrs['event']} at {where}: {level}"
        if data.attrs.get("clearance", 0.0) < 0.0:
            at_rest = Structure.from_attributes(data.attrs).as_delaminated().at_rest
            ends = " and ".join(text_of(data, abs(x), "m", ".4g") for x in at_rest)
            middle = "x1 and x2 count from the box's middle"
            yield f"{middle}: the preload by itself holds them {ends} from it"


def peak_lines(data: xr.Dataset, name: str) -> Iterator[str]:
    """Yield tables of the peaks of resonance curves, and of jumps of the largest gap."""
    peaks = data.isel(peak=data.peak_irregular.values == 0)
    sizes = "x1_max x2_max a1_max a2_max x_rel_max"
    for of, part, names in (("peak", peaks, sizes), ("jump", data, "before after")):
        if not part.sizes[of]:
            yield f"no {of} in this range"
            continue
        yield "peaks" if of == "peak" else "jumps of the largest gap"
        rows = printing.columns_of(part, f"structure direction {name}", f"{of}_")
        yield from printing.table(rows | printing.columns_of(part, names, f"{of}_", ".4g"))
    if irregular := data.sizes["peak"] - peaks.sizes["peak"]:
        yield f"peaks of irregular responses, left out: {irregular}"


CAPTURED = {"quick": 1.53, "beam": 1.45}  # eta0 at which the motor is captured by the resonance


class Spectra(OfBox, Driven, Stored, OfBoth):
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

    def ask(self) -> tuple[Any, ...]:
        of_motor = self.one_of("eta0", "voltage")
        if not (self.is_shaken() or self.pushes()):
            self.calls = "drive_spectra"
            return self.ask_motor()
        if of_motor is not None:
            frequency = self.frequency_option() or "amplitude or --g"
            raise InputError(f"--{frequency}: expected without --{of_motor}, which is the motor's")
        self.drive, self.structure = "", self.structure or "paper"
        structure = Structure.from_file(self.structure).replace(**parse_changes(self.set))
        excitation = self.read_excitation(structure, si=True)
        return structure, {**self.keywords(), **excitation}

    def ask_motor(self) -> tuple[Structure, Drive, Keywords]:
        structure, motor = self.read_structure_and_drive()
        eta0 = CAPTURED.get(self.drive) if self.eta0 is None else self.eta0
        voltage = self.voltage
        if voltage is None and eta0 is not None:
            voltage = eta0 * motor.volts(structure)
        return structure, motor, {"voltage": voltage}

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        first = data.acceleration.sel(mass=1)
        others = [str(dim) for dim in first.dims if dim not in ("order", "kind")]
        for values in itertools.product(*(data[name].values for name in (*others, "kind"))):
            part = first.sel(dict(zip((*others, "kind"), values, strict=True)))
            largest, above = part.max(), part.where(part.order > 1.5, 0.0).max()
            line, share = text_of(data, largest, "m/s2", ".4g"), float(above / largest)
            where = [printing.format_parameter(data, name, part[name]) for name in others]
            where = where or [text_of(data, data.speed.sel(kind=values[-1]), "rad/s", ".5g")]
            yield (
                f"{values[-1]} at {where[0]}: largest line {line}, {share:.2g} of it above the "
                "excitation"
            )


PAPER_RANGE = "0.1:8.0:0.001"  # frequency ratios of Figure 6
DIFFERENT = 0.01  # of the largest gap: where up and down differ by more, they are different motions
UNDECIDED = "; undecided: slow to converge or nearly periodic, --transient 5000 decides most"
WORDS = {"repeated": "repeat", "irregular": "irregular", "undecided": "undecided"}


def largest_gap_line(data: xr.Dataset) -> str:
    top = data.isel(data.xi_rel_max.argmax(...))
    names = [str(dim) for dim in data.xi_rel_max.dims if dim != "direction"]
    where = ", ".join(printing.format_parameter(data, name, top[name]) for name in names)
    return f"largest gap: {printing.format_largest_gap(top)} at {where}"


def count_line(data: xr.Dataset) -> str:
    """Format how many responses repeat, are irregular, or are undecided, and permanent contact."""
    decided, size = data.multiplicity_decided, data.multiplicity_decided.size
    counts = {word: int(printing.has_flag(decided, flag).sum()) for flag, word in WORDS.items()}
    contact = int(data.permanent_contact.sum()) if "permanent_contact" in data else 0
    counts |= {"with permanent contact": contact} if contact else {}
    shares = [printing.format_share(count, size, word) for word, count in counts.items()]
    return f"{size:,} responses: {', '.join(shares)}"


def table_of_one(data: xr.Dataset, name: str) -> Iterator[str]:
    where = printing.format_parameter(data, name, data[name][0])
    yield f"one value, {where}: a table and no picture"
    shown, order = as_shown(data.isel({name: 0})), {"structure", "direction"} & {*data.dims}
    arrays = {key: one for key, one in shown.data_vars.items() if {*one.dims} <= order}
    columns = {"": [str(key) for key in arrays]}
    for case in itertools.product(*(data[dim].values.tolist() for dim in sorted(order)[::-1])):
        at = dict(zip(sorted(order)[::-1], case, strict=True))
        cells = [one.sel({dim: at[str(dim)] for dim in one.dims}) for one in arrays.values()]
        columns[" ".join(case) or "value"] = [flag_word(one) or f"{one:.6g}" for one in cells]
    columns["unit"] = [printing.unit_or_nothing(one) for one in arrays.values()]
    yield from printing.table(columns, len(arrays))


def window_lines(data: xr.Dataset, name: str) -> Iterator[str]:
    """Yield the widest windows of one kind of response: range, multiplicity, impacts a period."""
    windows: list[tuple[xr.Dataset, list[int], tuple[str, float]]] = []
    several = "direction" in data.dims
    for part in [data.isel(direction=i) for i in range(2)] if several else [data]:
        marks = window_marks(part)
        runs = itertools.groupby(range(len(marks)), key=marks.__getitem__)
        windows += [(part, list(run), mark) for mark, run in runs]
    widest = sorted(windows, key=lambda window: -len(window[1]))[: printing.MOST_ROWS - 1]
    rows = []
    for part, run, mark in sorted(widest, key=lambda window: window[1]):
        where = printing.format_range(data, name, part[name][run[0]], part[name][run[-1]])
        impacts = part.impacts_per_period[run]
        counts = dict.fromkeys(f"{float(end):.4g}" for end in (impacts.min(), impacts.max()))
        direction = f", {part.direction.item()}" if several else ""
        rows.append((f"{where}{direction}", mark[0], " to ".join(counts)))
    titles = ("widest windows", "repeats", "impacts per period")
    yield from printing.table(dict(zip(titles, zip(*rows, strict=True), strict=True)))


def window_marks(data: xr.Dataset) -> list[tuple[str, float]]:
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
    has_picture = staticmethod(is_curve)

    def ask(self) -> tuple[Structure, Keywords]:
        if self.over is None and not self.is_shaken():
            self.eta = PAPER_RANGE
        texts = (self.values, self.eta, self.hz, self.rpm, self.frequency, self.g)
        usual = "up" if any(":" in text for text in texts if text) else "given"
        structure, question = self.ask_along_parameter()
        return structure, {**question, "direction": self.direction or usual}

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        name = printing.varied_parameter(data)
        if data.sizes[name] == 1:
            yield from table_of_one(data, name)
            return
        yield largest_gap_line(data)
        for mass in (1, 2) if not is_in_ratios(data) else ():
            displacement = text_of(data, data[f"x{mass}_max"].max(), "m", ".4g")
            acceleration = text_of(data, data[f"a{mass}_max"].max(), "m/s2", ".4g")
            yield f"mass {mass}: largest displacement {displacement}, acceleration {acceleration}"
        undecided = printing.has_flag(data.multiplicity_decided, "undecided").any()
        yield f"{count_line(data)}{UNDECIDED if undecided else ''}"
        yield from window_lines(data.sortby(name), name)
        if "direction" in data.dims:
            up, down = (data.xi_rel_max.sel(direction=word) for word in ("up", "down"))
            differ = abs(up - down) > DIFFERENT * data.xi_rel_max.max("direction")
            where = printing.format_ranges(data, name, differ.values)
            text = f"up and down differ by more than {DIFFERENT:.0%} of the largest gap"
            yield f"{text} {'at ' * bool(differ.any())}{where}"


class Map(OfStructure, OfBox, Over, Overlay, Asked, Stored, Results):
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

    def ask(self) -> tuple[Structure, Keywords]:
        structure = self.read_structure()
        if len(self.over) != len(self.values):
            raise InputError("--over and --values: give exactly one --values for each --over")
        for name in self.over:
            self.check_over(name)
        twice, by_level = len(self.over) == 2, self.g is not None
        excitation = self.read_excitation(structure, one=twice, by_level=by_level)
        for name, text in zip(self.over, self.values, strict=True):
            if name in excitation or (name == "level" and "amplitude" in excitation):
                raise InputError(f"--over {name}: twice; expected two parameters")
            excitation[name] = parse_listed(name, text)
        if sum(isinstance(value, tuple) for value in excitation.values()) != 2:
            raise InputError(
                "map: expected two parameters that vary: a range of frequencies and one of levels "
                "(--g) or --over with --values, or --over with --values twice at one frequency"
            )
        return structure, {**self.keywords(), **excitation}

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        yield count_line(data)
        repeat = printing.has_flag(data.multiplicity_decided, "repeated").values
        kinds = data.multiplicity.values[repeat].astype(int).tolist()
        counts = [(kinds.count(n), f"after {n} T") for n in sorted({*kinds})[:4]]
        if shares := [printing.format_share(n, len(kinds), words) for n, words in counts]:
            yield f"they repeat: {', '.join(shares)}"
        yield largest_gap_line(data)
        if "exponent" in data:
            chaotic = int(printing.has_flag(data.verdict, "chaotic").sum())
            yield printing.format_share(chaotic, data.exponent.size, "chaotic")
