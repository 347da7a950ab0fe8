"""Commands on nonlinear dynamics: exponents, sections, attractors, basins, orbits, branches."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, Literal

from ..constants import TURN
from ..errors import InputError
from ..flags import flag_words
from ..lazy import xr
from ..units import is_in_ratios, number_of, range_text, units_of, with_units
from .answer import Asked, is_curve
from .command import Question, option
from .grammar import parse, plain_int
from .options import CONTINUED, OfBox, OfStored, OfStructure, Over, parse_varied
from .output import Files, Results, Stored, result_name
from .stored import read_structure_and_question
from .text import (
    MOST_ROWS,
    attractor_table,
    columns_of,
    end_lines,
    extents,
    flag_word,
    format_largest_gap,
    format_parameter,
    format_range,
    format_ranges,
    format_share,
    has_flag,
    length_text,
    parameter_column,
    table,
    time_text,
    varied_parameter,
    without_unit,
)

if TYPE_CHECKING:
    from ..model import Structure


def ask_along_parameter(arguments: Any, si: bool = False) -> tuple[Structure, Question]:
    structure = arguments.read_structure()
    excitation, _ = arguments.varied_arguments(structure, si=si)
    return structure, {**arguments.keywords(), **excitation}


class Lyapunov(OfStructure, OfBox, Over, Asked, Stored, Results):
    """Largest Lyapunov exponents of responses: periodic, neutral or chaotic."""

    calls = "lyapunov"
    follow: Literal["up", "down"] | None = option(
        "responses of a sweep in this direction (default: each from rest)"
    )
    examples = """
  {program} lyapunov --eta 2.5:3.8:0.02 --follow up        along a sweep
  {program} lyapunov --eta 1.2 --over e --values 0.1:0.9:0.02
  {program} lyapunov --structure beam --hz 12.5,16.7 --amplitude 1e-4
Chaotic, periodic: the exponent is three standard errors from zero. Neutral: quasi-periodic, or not
decided with so few --periods."""
    has_picture = staticmethod(is_curve)

    def ask(self) -> tuple[Structure, Question]:
        structure, question = ask_along_parameter(self)
        if self.follow:
            import orchestrate

            others = self.keywords()
            swept: Question = {name: question[name] for name in question if name not in others}
            swept |= {"direction": self.follow, "samples": 1, "transient": question["transient"]}
            question["start"] = orchestrate.sweep(structure, **swept, **self.running())
        return structure, question

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        name = varied_parameter(data)
        data = data.sortby(name)
        if data.sizes[name] <= MOST_ROWS:
            rows = parameter_column(data, name, data[name].values)
            rows |= columns_of(data, "exponent standard_error verdict")
            if "exponents" in data:
                each = data.exponents.transpose(name, "order").values
                rows["all exponents"] = [", ".join(f"{x:.5g}" for x in row) for row in each]
                rows |= columns_of(data, "kaplan_yorke_dimension")
            yield from table(rows)
        else:
            top = data.isel(data.exponent.argmax(...))
            yield (
                f"largest exponent {float(top.exponent):.5f} +- {float(top.standard_error):.5f} "
                f"per tau at {format_parameter(data, name, top[name])}; the largest of "
                f"{data.sizes[name]} is biased by its error: repeat only it, with more --periods "
                "and another --transient"
            )
            for word in flag_words(data.verdict.attrs).values():
                holds = has_flag(data.verdict, word).values
                where = f" at {format_ranges(data, name, holds)}" if holds.any() else ""
                yield f"{format_share(int(holds.sum()), holds.size, word)}{where}"
        neutral = data.isel({name: has_flag(data.verdict, "neutral").values})
        wander = math.log(float(data.attrs["wander"]))
        sizes = zip(abs(neutral.exponent.values), neutral.period.values, strict=True)
        needed = max(
            (wander / (size * period) for size, period in sizes if size > 0.0), default=0.0
        )
        if needed > float(data.attrs["periods"]):
            yield (
                "neutral: quasi-periodic, or too few periods: exponents of these sizes take about "
                f"--periods {float(f'{needed:.2g}'):.0f}"
            )


COORDINATES = {  # that are printed of each section
    "phase": "x_rel v_rel",
    "impacts": "impact_velocity phase",
    "releases": "v1 phase",
}


class Poincare(OfStructure, OfBox, Asked, Stored, Results):
    """A Poincaré section: states at a phase of the box, at impacts or at releases."""

    calls = "poincare"
    examples = """
  {program} poincare --eta 2.9 --periods 5000
  {program} poincare --eta 0.8 --at impacts
  {program} poincare --structure beam --hz 12.5 --g 0.02 --at releases"""

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        yield f"{data.sizes['point']} points"
        yield from extents(data, COORDINATES[str(data.attrs["at"])])


class Attractors(OfStructure, OfBox, Over, Asked, Stored, Results):
    """Coexisting motions: how many, and how many random starts lead to each."""

    calls, takes = "attractors", "* scale"
    examples = """
  {program} attractors --eta 1.32 --starts 200 --seed 1
  {program} attractors --eta 1.2:1.4:0.01
  {program} attractors --structure beam --hz 15.5,16 --g 0.02 --scale 1e-3
Half of the starts lie around zero, half around the response from rest. Every motion found at one
value is carried to its neighbours, so along a range it is found as far as it exists; random starts
alone may miss one whose basin is small."""

    def ask(self) -> tuple[Structure, Question]:
        return ask_along_parameter(self, si=True)  # states are printed in m and m/s

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        name = varied_parameter(data)
        if data.sizes[name] <= 5:  # values up to which every attractor is printed
            for i in range(data.sizes[name]):
                at = data.isel({name: i})
                count, where = int(at.number), format_parameter(data, name, at[name])
                word = "attractor" if count == 1 else "attractors"
                yield f"{count} {word} at {where} ({data.sizes['start']} random starts)"
                yield from attractor_table(at)
            yield "few starts overlook small basins: basin, or a range of values, finds them"
            return
        data = data.sortby(name)
        for number in sorted(set(data.number.values.tolist())):
            holds = data.number.values == number
            share = format_share(int(holds.sum()), holds.size, f"values with {number}")
            yield f"{share}: {format_ranges(data, name, holds)}"
        shares = data.share.where(data.multiplicity.notnull())
        ends = zip(data.first_found.values, data.last_found.values, strict=True)
        columns = {
            "range": [format_range(data, name, *map(float, pair)) for pair in ends],
            "smallest share": [f"{share:.1%}" for share in shares.min(name).values],
            "largest share": [f"{share:.1%}" for share in shares.max(name).values],
        }
        yield from table(columns)

    def draw(self, data: xr.Dataset, *_: xr.Dataset) -> Any:
        import orchestrate

        from ..model import Structure
        from ..model.ranges import PUSHES
        from ..show.planes import draw_motions

        name = varied_parameter(data)
        if data.sizes[name] > 1:
            return orchestrate.plot(data)
        at = data.isel({name: 0})
        at = at.isel(attractor=at.multiplicity.notnull().values)
        about = {str(key): value for key, value in data.attrs.items()}
        structure = Structure.from_attributes(about)
        if name not in ("eta", "frequency"):
            structure = structure.replace(**{name: float(at[name])})
        names = ("frequency", "amplitude", *PUSHES)
        box: Question = {name: float(number_of(at, name, 0.0)) for name in names}
        periods = at.multiplicity.astype(int).where(at.multiplicity > 0, 60)  # irregular: 60
        starts = zip(at.state.values, periods.values, strict=True)
        motions = [orchestrate.simulate(structure, **box, start=x, periods=n) for x, n in starts]
        return draw_motions(at, [with_units(motion, units_of(data)) for motion in motions])


class Basin(OfStructure, OfBox, Asked, Stored, Results):
    """Basins of attraction: which motion each start of a plane leads to."""

    calls = "basin"
    examples = """
  {program} basin --eta 1.315
  {program} basin --eta 1.315 --x x_rel,0,1.3,60 --y v_rel,-1.3,1.3,60
  {program} basin --eta 1.32 --x phase,0,6.28,40 --y v1,-2,2,40 --at attractors.nc
  {program} basin --structure beam --hz 15.8 --g 0.02 --x x_rel,0,1e-3,40 --y v_rel,-0.1,0.1,40
Coordinates: x1 x2 x_rel in m, v1 v2 v_rel in m/s, phase in rad. What is not varied is that of
--at, such as a state that the command attractors has found."""

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        labels = data.attractor_of.values
        started, overlapping = int((labels >= 0).sum()), int((labels < 0).sum())
        axes = [data[name] for name in map(str, data.attractor_of.dims)]
        sides = []
        for axis in axes:
            unit = str(axis.attrs["units"])
            text = range_text(data, axis.min().item(), axis.max().item(), unit)
            sides.append(f"{axis.name} {without_unit(data, text, unit)}")
        plane = ", ".join(sides)
        yield f"{data.sizes['attractor']} found, of {started} starts in {plane}"
        yield from attractor_table(data)
        if overlapping:
            yield f"{overlapping} starts left out: there the masses would overlap"
        if data.sizes["attractor"] > 1 and min(labels.shape) >= 32:  # along a side, for entropies
            import orchestrate

            mixed = orchestrate.basin_entropy(data)
            yield (
                f"basin entropy {float(mixed.basin_entropy):.3g}, at boundaries "
                f"{float(mixed.boundary_basin_entropy):.3g} (above 0.69: fractal)"
            )
            exponent, error = mixed.uncertainty_exponent, mixed.uncertainty_exponent_error
            if math.isfinite(exponent):
                yield (
                    f"uncertainty exponent {float(exponent):.3g} +- {float(error):.2g} "
                    "(1: smooth boundaries)"
                )


def orbit_title(orbit: xr.Dataset, motion: xr.Dataset) -> str:
    """Return the title of an orbit's picture: whether it is stable, structure and excitation."""
    from ..show.labels import title_from_attributes

    return f"{flag_word(orbit.stability)} orbit, {title_from_attributes(motion)}"


class Orbit(OfStructure, OfBox, Asked, Stored, Results):
    """A periodic motion by Newton's method, stable or unstable, with its multipliers."""

    calls = "orbit"
    examples = """
  {program} orbit --eta 3.0                     unstable: simulate would leave it
  {program} orbit --eta 1.32 --period 2
  {program} orbit --structure beam --hz 16.7 --g 0.02
Floquet multipliers: of a stable orbit all lie inside the unit circle."""

    def draw(self, data: xr.Dataset, *_: xr.Dataset) -> Any:
        import orchestrate

        from ..model import Structure
        from ..model.ranges import PUSHES

        excitation: Question = dict(ast.literal_eval(str(data.attrs["excitation"])))
        excitation |= {name: data.attrs[name] for name in PUSHES}
        motion = orchestrate.simulate(
            Structure.from_attributes({str(name): value for name, value in data.attrs.items()}),
            **excitation,
            periods=int(data.attrs["period"]),
            start=data.state.isel(sample=0).values,
        )
        shown = with_units(motion, units_of(data))
        return orchestrate.plot(shown, title=orbit_title(data, shown))

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        parts = data.multipliers.transpose("multiplier", "part").values
        size = max(abs(complex(*pair)) for pair in parts)
        word = flag_word(data.stability)
        yield f"{word}: the largest multiplier has the absolute value {size:.6f}"
        if word == "undecided":
            yield "a run of the FMU from this orbit has other impacts: it may not be a motion"
        yield "multipliers " + ", ".join(
            f"{real:.6f}{imaginary:+.6f}i" for real, imaginary in parts
        )
        for time, speed in zip(data.impact_time.values, data.impact_velocity.values, strict=True):
            if math.isfinite(time):
                closing = length_text(data, speed, "m/s")
                yield f"impact at {time_text(data, time, '.8g')}, closing at {closing}"
        names = "x1, x2, v1, v2" if is_in_ratios(data) else "x1, x2 in m, v1, v2 in m/s"
        for i, state in enumerate(data.state.values):
            numbers = ", ".join(f"{value:.8g}" for value in state)
            yield f"state at phase 0 after {i} periods: {numbers} ({names})"
        yield f"largest gap: {format_largest_gap(data)}"


class Manifold(OfStored, OfBox, Asked, Stored, Results):
    """The unstable manifold of a saddle of the stroboscopic map, as a curve to each side."""

    calls = "manifold"
    examples = """
  {program} manifold --eta 3.0
  {program} manifold --start orbit.nc --length 20       of an orbit that orbit has written
  {program} manifold --structure beam --hz 14 --g 0.02
What starts next to a saddle with one multiplier outside the unit circle leaves along it."""

    def ask(self) -> tuple[Structure, Question]:
        structure, question = read_structure_and_question(self)
        if self.is_shaken() or question["start"] is None:
            question |= self.read_excitation(structure, si=True, one=True)
        return structure, question

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        yield f"saddle: multiplier {float(data.multiplier):.6f}"
        yield from extents(data, "x_rel")
        lengths = (data.arclength.max("point") / data.orbit_size).values
        sides = columns_of(data, "side end") | {
            "points": [f"{n}" for n in data.arclength.count("point").values],
            "length over the orbit's size": [f"{length:.4g}" for length in lengths],
            "breaks": [f"{int((data.break_side == i).sum())}" for i in range(data.sizes["side"])],
        }
        yield from table(sides)


class Branch(OfStored, OfBox, Asked, Stored, Results):
    """Follow periodic motions along a parameter, stable and unstable, to their bifurcations."""

    calls = "branch"
    over: str = option(f"what varies: {CONTINUED}", "eta", value="NAME")
    limits: str | None = option("between which it is followed, in its own unit", value="FIRST:LAST")
    examples = """
  {program} branch --eta 2.5 --limits 2.4:2.8
  {program} branch --over e --eta 2.5 --limits 0.5:0.9
  {program} branch --structure beam --over hz --limits 20:30 --amplitude 1e-4
  {program} branch --start branch.nc --switch 1 --limits 2.4:2.9   the branch that leaves there
The excitation says where a first orbit is looked for; without it that is the lower limit."""

    def ask(self) -> tuple[Structure, Question]:
        if self.limits is None:
            raise InputError("--limits is missing; expected FIRST:LAST")
        over, limits = parse_varied(self.over, self.limits)
        structure, keywords = read_structure_and_question(self)
        if over == "frequency" and self.g is not None:
            self.hold_amplitude(structure, limits[0])
        excitation = self.branch_excitation(structure, over, keywords["start"] is not None)
        return structure, {**keywords, **excitation, "over": over, "limits": limits}

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        name = str(data.attrs["over"])
        stable, undecided = int(data.stable.sum()), int(has_flag(data.stability, "undecided").sum())
        unsure = (
            f", {undecided} undecided (runs of the FMU have other impacts)" if undecided else ""
        )
        where = format_range(data, name, float(data[name].min()), float(data[name].max()))
        yield f"{data.sizes['point']} orbits at {where}, {stable} of them stable{unsure}"
        if data.sizes.get("bifurcation", 0):
            rows = {"number": [str(i) for i in range(data.sizes["bifurcation"])]}
            rows |= columns_of(data, "kind", "bifurcation_")
            rows |= parameter_column(data, name, data.bifurcation_value.values, ".8f")
            yield from table(rows, len(rows["number"]))
        else:
            yield "no bifurcation in this range"
        ends = data.attrs["first_end"], data.attrs["last_end"]
        yield "first end: {}; last end: {}".format(*ends)
        yield from end_lines(ends)

    def hold_amplitude(self, structure: Structure, first: float) -> None:
        """Replace ``--g`` by the amplitude that it is at the start of a branch over frequency."""
        usual = self.frequency_option() is None
        if usual:
            self.frequency = repr(first)
        box = self.read_excitation(structure, one=True)
        frequency, amplitude = box["frequency"], float(f"{box['amplitude']:.6g}")
        text = f"--g {self.g}: is --amplitude {amplitude:g} at {frequency / TURN:.5g} Hz"
        if structure.has_scale:
            raise InputError(f"{text}; a branch over the frequency has one amplitude: expected it")
        print(f"{text}, constant along the branch; its bifurcations are those of any amplitude")
        self.g, self.amplitude = None, amplitude
        if usual:
            self.frequency = None

    def branch_excitation(self, structure: Structure, over: str, begun: bool) -> Question:
        """Return the excitation at which the first orbit is searched, as keywords."""
        name, amplitude = self.frequency_option(), self.read_amplitude()
        if over == "frequency" and amplitude is None and not begun:
            raise InputError(f"--over {self.over}: expected --amplitude in m with it")
        if name is None and (begun or over in ("eta", "frequency")):
            given = {} if amplitude is None else {"amplitude": amplitude}
            return given | self.pushes()
        excitation = self.read_excitation(structure, one=True)
        needed = "frequency" if over in ("frequency", "amplitude") else over
        if over in ("eta", "frequency", "amplitude") and needed not in excitation:
            expected = (
                "--eta without an amplitude" if over == "eta" else "a frequency and --amplitude"
            )
            raise InputError(f"--over {over}: expected {expected} with it")
        return excitation


def is_on_curve(curve: xr.Dataset, question: Question, near: float = 1e-3) -> bool:
    """Return whether a curve of a bifurcation's kind passes it, within a part of the range."""
    import numpy as np

    from ..flags import flag_words
    from ..model import Structure

    start, (across, along) = question["start"], question["over"]
    found = start.isel(bifurcation=question["bifurcation"])
    level = Structure.from_attributes(start.attrs).parameters().get(along, np.nan)
    x, y = curve[across].values - float(found.bifurcation_value), curve[along].values - level
    at = np.flatnonzero((y[:-1] * y[1:] <= 0.0) & (y[:-1] != y[1:]))
    passes = x[at] - y[at] * (x[at + 1] - x[at]) / (y[at + 1] - y[at])
    reach = near * np.ptp(question["limits"][0])
    kind = flag_words(start.bifurcation_kind.attrs)[int(found.bifurcation_kind)]
    return bool(curve.attrs["kind"] == kind and (np.abs(passes) < reach).any())


def parse_bifurcation(option: str, text: str) -> int | str:
    """Parse the number of a bifurcation, or the word ``all``."""
    return text if text == "all" else parse(option, text, "a number, or all", plain_int)


Bifurcation = Annotated[int | str, parse_bifurcation]


class Border(OfStored, Asked, Stored, Results):
    """Follow a bifurcation of a branch over two parameters: where a window begins or ends."""

    calls = "border"
    over: str = option(
        f"what varies, that of the branch first, each {CONTINUED}", "eta,e", value="NAME,NAME"
    )
    limits: Any = option("between which each is followed, in its own unit", value="A:B,C:D")
    bifurcation: Bifurcation = option("its number, or all of them in one picture", 0, value="N|all")
    examples = """
  {program} border --start branch.nc --bifurcation 0 --over eta,e --limits 2.4:2.9,0.6:0.8
  {program} border --start beam.nc --over hz,e --limits 14:18,0.6:0.8
  {program} border --start branch.nc --bifurcation all --limits 2.4:2.9,0.6:0.8
--start is what the command branch has written, with the numbers of its bifurcations;
structure and excitation are those of that branch."""

    def ask(self) -> tuple[Structure, Question]:
        for name, expected in (("start", "a file of the command branch"), ("limits", "A:B,C:D")):
            if getattr(self, name) is None:
                raise InputError(f"--{name} is missing; expected {expected}")
        over, limits = self.over, self.limits
        names, ranges = ([part.strip() for part in text.split(",")] for text in (over, limits))
        if len(names) != 2:
            raise InputError(f"--over {over}: expected two names, such as eta,e or hz,e")
        pairs = [parse_varied(*pair) for pair in zip(names, ranges, strict=False)]
        if len(ranges) != 2:
            raise InputError(f"--limits {limits}: expected A:B,C:D, a range for each of {over}")
        structure, question = read_structure_and_question(self)
        both = {
            "over": tuple(name for name, _ in pairs),
            "limits": tuple(ends for _, ends in pairs),
        }
        return structure, {**question, **both}

    def __call__(self) -> None:
        import orchestrate

        structure, question = self.ask()
        if question["bifurcation"] != "all":
            self.answer(structure, question)
            return
        if self.store is not None:
            raise InputError("--store: of one bifurcation; expected it without --bifurcation all")
        curves: list[xr.Dataset] = []
        for number in range(question["start"].sizes.get("bifurcation", 0)):
            one = {**question, "bifurcation": number}
            if any(is_on_curve(curve, one) for curve in curves):
                print(f"number {number} is on a curve that was followed")
                continue
            try:
                curves.append(self.answer(structure, one, picture=False))
            except InputError as reason:
                print(f"number {number} is not followed: {reason}")
        if not curves:
            raise InputError(f"--start {self.start}: no bifurcation that can be followed")
        name = result_name("border_all", str(self.start), structure, question)
        shown = [with_units(curve, self.display_units(question)) for curve in curves]
        files = Files.from_options(self, name, fresh=True)
        files.write_pictures(partial(orchestrate.plot, *shown))

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        names = [str(name) for name in data.attrs["over"]]
        yield f"{data.attrs['kind']}: {data.sizes['point']} points"
        for name in names:
            reach = format_range(data, name, float(data[name].min()), float(data[name].max()))
            both = (format_parameter(data, name, data[name][i]) for i in (0, -1))
            yield f"from {' to '.join(both)}, within {reach}"
        if data.sizes["codimension_two"]:
            rows = columns_of(data, "kind", "codimension_two_")
            for name in names:
                rows |= parameter_column(data, name, data[f"codimension_two_{name}"].values)
            yield from table(rows, data.sizes["codimension_two"])
        ends = data.attrs["first_end"], data.attrs["last_end"]
        yield "first end: {}; last end: {}".format(*ends)
        yield from end_lines(ends)
