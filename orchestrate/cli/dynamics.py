"""Commands on nonlinear dynamics: exponents, sections, attractors, basins, orbits, branches."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import Any, Literal

import orchestrate

from .. import units
from ..constants import GRAVITY, TURN
from ..errors import InputError
from ..flags import flag_word
from ..lazy import xr
from ..model import PARAMETERS, Structure
from ..model.ranges import PUSHES
from . import grammar, printing
from .answer import FunctionCommand, Runs, has_several_values
from .command import Keywords, option
from .options import CONTINUED, OfBox, OfPushes, OfStored, OfStructure, Over, parse_continued
from .output import ResultFiles, Results, Stored, result_file_stem

MOST_ROWS = 10  # of the exponents of a range


class Lyapunov(OfStructure, OfBox, Over, FunctionCommand, Stored, Results):
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
    has_picture = staticmethod(has_several_values)

    def read_question(self) -> tuple[Structure, Keywords]:
        structure, question = self.read_question_along_parameter()
        if self.follow:
            others = self.function_keywords()
            swept: Keywords = {name: question[name] for name in question if name not in others}
            swept |= {"direction": self.follow, "samples": 1, "transient": question["transient"]}
            question["start"] = orchestrate.sweep(structure, **swept, **self.running_keywords())
        return structure, question

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        spectrum = ", exponents:.5g, kaplan_yorke_dimension" * ("exponents" in data)
        name = printing.varied_parameter_name(data)
        names = f"exponent, standard_error, verdict{spectrum}"
        rows = data.sortby("exponent", ascending=False)
        yield from printing.table_lines(rows, names, most=MOST_ROWS)
        if data.sizes[name] > MOST_ROWS:
            yield "the largest is biased by its error: repeat it, with another --transient"
        yield from printing.count_lines(data, data.verdict)
        neutral = data.isel({name: printing.flag_mask(data.verdict, "neutral").values})
        sizes = (abs(neutral.exponent) * neutral.period).values
        wander = math.log(float(data.attrs["wander"]))
        needed = max((wander / size for size in sizes if size > 0.0), default=0.0)
        if needed > float(data.attrs["periods"]):
            yield (
                "neutral: quasi-periodic, or too few periods: exponents of these sizes take about "
                f"--periods {float(f'{needed:.2g}'):.0f}"
            )


class Poincare(OfStructure, OfBox, FunctionCommand, Stored, Results):
    """A Poincaré section: states at a phase of the box, at impacts or at releases."""

    calls, shows = "poincare", "x_rel v_rel phase impact_velocity v1"
    examples = """
  {program} poincare --eta 2.9 --periods 5000
  {program} poincare --eta 0.8 --at impacts
  {program} poincare --structure beam --hz 12.5 --g 0.02 --at releases"""

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        yield f"{data.sizes['point']} points"
        yield from super().summary_lines(data)


def simulate_from_state(data: xr.Dataset, state: xr.DataArray, periods: int) -> xr.Dataset:
    """Simulate the motion that begins at a state of a result, under its excitation."""
    varied = {name: data[name].item() for name in PARAMETERS if name in data.coords}
    structure = Structure.from_attributes(data.attrs).replace(**varied)
    names = ("frequency", "amplitude", *PUSHES)
    box: Keywords = {name: float(units.parameter_of(data, name, 0.0)) for name in names}
    motion = orchestrate.simulate(structure, **box, start=state.values, periods=periods)
    return units.with_units(motion, units.display_units_of(data))


def attractor_table_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield a table of attractors: share, period, impacts, how decided, largest gap, a state."""
    state = f"state at phase 0{' (SI)' * (not units.shows_lengths_as_ratios(data))}"
    names = "share, multiplicity, impacts_per_period, decided_by, xi_rel_max"
    shown, names = data.rename(state=state), f"{names}, {state}:.6g"
    yield from printing.table_lines(shown, names, ".4g", needs="multiplicity")


class Attractors(OfStructure, OfBox, Over, FunctionCommand, Stored, Results):
    """Coexisting motions: how many, and how many random starts lead to each."""

    calls, takes = "attractors", "* scale"
    examples = """
  {program} attractors --eta 1.32 --starts 200 --seed 1
  {program} attractors --eta 1.2:1.4:0.01
  {program} attractors --structure beam --hz 15.5,16 --g 0.02 --scale 1e-3
Half of the starts lie around zero, half around the response from rest. Every motion found at one
value is carried to its neighbours, so along a range it is found as far as it exists; random starts
alone may miss one whose basin is small."""

    def read_question(self) -> tuple[Structure, Keywords]:
        # states are printed in m and m/s
        return self.read_question_along_parameter(needs_metres=True)

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        name = printing.varied_parameter_name(data)
        yield f"{data.sizes['start']} random starts at each value; attractors found:"
        yield from printing.count_lines(data, data.number)
        if data.sizes[name] <= 5:  # values up to which every attractor is printed
            yield from attractor_table_lines(data)
            yield "few starts overlook small basins: basin, or a range of values, finds them"
            return
        shares = data.share.where(data.multiplicity.notnull())
        shown = data.assign(least_share=shares.min(name), largest_share=shares.max(name))
        ends = zip(data.first_found.values, data.last_found.values, strict=True)
        found = [printing.format_parameter(data, name, *pair) for pair in ends]
        shown = shown.assign({"found at": ("attractor", found)})
        yield from printing.table_lines(shown, "least_share:.1%, largest_share:.1%, found at")

    def draw(self, results: Runs, question: Keywords, *_: xr.Dataset) -> Any:
        from ..show.planes import draw_phase_curves

        data = results[""]
        name = printing.varied_parameter_name(data)
        if data.sizes[name] > 1:
            return orchestrate.plot(data)
        at = data.isel({name: 0})
        at = at.isel(attractor=at.multiplicity.notnull().values)
        periods = at.multiplicity.astype(int).where(at.multiplicity > 0, 60)  # irregular: 60
        pairs = zip(at.state, periods.values.tolist(), strict=True)
        return draw_phase_curves(at, [simulate_from_state(at, *pair) for pair in pairs])


class Basin(OfStructure, OfBox, FunctionCommand, Stored, Results):
    """Basins of attraction: which motion each start of a plane leads to."""

    calls = "basin"
    examples = """
  {program} basin --eta 1.315
  {program} basin --eta 1.315 --x x_rel,0,1.3,60 --y v_rel,-1.3,1.3,60
  {program} basin --eta 1.32 --x phase,0,6.28,40 --y v1,-2,2,40 --at attractors.nc
  {program} basin --structure beam --hz 15.8 --g 0.02 --x x_rel,0,1e-3,40 --y v_rel,-0.1,0.1,40
Coordinates: x1 x2 x_rel in m, v1 v2 v_rel in m/s, phase in rad. What is not varied is that of
--at, such as a state that the command attractors has found."""

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        labels = data.attractor_of.values
        started, overlapping = int((labels >= 0).sum()), int((labels < 0).sum())
        sides = []
        for axis in (data[name] for name in data.attractor_of.dims):
            ends = axis.min().item(), axis.max().item(), str(axis.attrs["units"])
            sides.append(f"{axis.name} {units.format_quantity_range(data, *ends)}")
        yield f"{data.sizes['attractor']} found, of {started} starts in {', '.join(sides)}"
        yield from attractor_table_lines(data)
        if overlapping:
            yield f"{overlapping} starts left out: there the masses would overlap"
        if data.sizes["attractor"] > 1 and min(labels.shape) >= 32:  # along a side, for entropies
            mixed = orchestrate.basin_entropy(data)
            inside, at_boundaries = float(mixed.basin_entropy), float(mixed.boundary_basin_entropy)
            text = f"basin entropy {inside:.3g}, at boundaries {at_boundaries:.3g}"
            yield f"{text} (above 0.69: fractal)"
            exponent = float(mixed.uncertainty_exponent)
            if math.isfinite(exponent):
                error = float(mixed.uncertainty_exponent_error)
                words = printing.format_with_error(exponent, error, ".3g")
                yield f"uncertainty exponent {words} (1: smooth boundaries)"


class Orbit(OfStructure, OfBox, FunctionCommand, Stored, Results):
    """A periodic motion by Newton's method, stable or unstable, with its multipliers."""

    calls = "orbit"
    examples = """
  {program} orbit --eta 3.0                     unstable: simulate would leave it
  {program} orbit --eta 1.32 --period 2
  {program} orbit --eta 3.1 --guess orbit.nc    from an orbit that was found at another frequency
  {program} orbit --structure beam --hz 16.7 --g 0.02
Floquet multipliers: of a stable orbit all lie inside the unit circle."""

    def draw(self, results: Runs, question: Keywords, *_: xr.Dataset) -> Any:
        from ..show.labels import title_from_attributes

        data = results[""]
        motion = simulate_from_state(data, data.state.isel(sample=0), int(data.attrs["period"]))
        title = f"{flag_word(data.stability)} orbit, {title_from_attributes(motion)}"
        return orchestrate.plot(motion, title=title)

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        parts = data.multipliers.transpose("multiplier", "part").values
        size, word = max(abs(complex(*pair)) for pair in parts), flag_word(data.stability)
        yield f"{word}: the largest multiplier has the absolute value {size:.6f}"
        yield from printing.hint_lines([f"stability: {word}"])
        yield "multipliers " + ", ".join(f"{real:.6f}{other:+.6f}i" for real, other in parts)
        for time, speed in zip(data.impact_time.values, data.impact_velocity.values, strict=True):
            if math.isfinite(time):
                closing = units.format_quantity(data, speed, "m/s")
                yield f"impact at {printing.format_time(data, time, '.8g')}, closing at {closing}"
        rows = data.rename(sample="period", state="state at phase 0")
        yield from printing.table_lines(rows, "period, state at phase 0", ".8g")
        yield from printing.describe(data, "xi_rel_max")


class Manifold(OfStored, OfBox, FunctionCommand, Stored, Results):
    """The unstable manifold of a saddle of the stroboscopic map, as a curve to each side."""

    calls = "manifold"
    examples = """
  {program} manifold --eta 3.0
  {program} manifold --start orbit.nc --length 20       of an orbit that orbit has written
  {program} manifold --structure beam --hz 14 --g 0.02
What starts next to a saddle with one multiplier outside the unit circle leaves along it."""

    def read_question(self) -> tuple[Structure, Keywords]:
        structure, question = self.read_structure_and_question()
        if self.is_shaken() or question["start"] is None:
            question |= self.read_excitation(structure, needs_metres=True, one_frequency=True)
        return structure, question

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        yield f"saddle: multiplier {float(data.multiplier):.6f}"
        yield from printing.describe(data, "x_rel")
        breaks = [int((data.break_side == i).sum()) for i in range(data.sizes["side"])]
        size, length = data.arclength.max("point") / data.orbit_size, "length over the orbit's size"
        sides = {"points": data.arclength.count("point"), length: size, "breaks": ("side", breaks)}
        yield from printing.table_lines(data.assign(sides), f"end, points, breaks, {length}:.4g")


def branch_end_lines(data: xr.Dataset) -> Iterator[str]:
    ends = data.attrs["first_end"], data.attrs["last_end"]
    yield "first end: {}; last end: {}".format(*ends)
    yield from printing.hint_lines(dict.fromkeys(ends))


class Branch(OfStored, OfBox, FunctionCommand, Stored, Results):
    """Follow periodic motions along a parameter, stable and unstable, to their bifurcations."""

    calls = "branch"
    over: str = option(f"what varies: {CONTINUED}", "eta", "NAME")
    limits: str | None = option("between which it is followed, in its own unit", value="FIRST:LAST")
    examples = """
  {program} branch --eta 2.5 --limits 2.4:2.8
  {program} branch --over e --eta 2.5 --limits 0.5:0.9
  {program} branch --structure beam --over hz --limits 20:30 --amplitude 1e-4
  {program} branch --start branch.nc --switch 1 --limits 2.4:2.9   the branch that leaves there
The excitation says where a first orbit is looked for; without it that is the lower limit."""

    def read_question(self) -> tuple[Structure, Keywords]:
        text = self.require("limits", "; expected FIRST:LAST")
        over, limits = parse_continued(self.over, text)
        structure, keywords = self.read_structure_and_question()
        if over == "frequency" and self.g is not None:
            self.replace_level_by_amplitude(structure, limits[0])
        excitation = self.branch_excitation(structure, over, keywords["start"] is not None)
        return structure, {**keywords, **excitation, "over": over, "limits": limits}

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        name, count = str(data.attrs["over"]), data.sizes.get("bifurcation", 0)
        yield f"{data.sizes['point']} orbits at {printing.format_full_range(data, name)}"
        yield from printing.count_lines(data, data.stability)
        rows = data.rename({"bifurcation_value": f"bifurcation_{name}"} if count else {})
        rows = rows.assign(bifurcation_number=("bifurcation", range(count)))
        yield from printing.listing_lines(rows, "bifurcation", f"number, kind, {name}:.8f")
        yield from branch_end_lines(data)

    def replace_level_by_amplitude(self, structure: Structure, first: float) -> None:
        """Replace ``--g`` by the amplitude that it is at the start of a branch over frequency."""
        if self.given_frequency_option() is not None:
            first = self.read_excitation(structure, one_frequency=True)["frequency"]
        level = grammar.parse_positive_number("--g", self.g) * GRAVITY
        amplitude = float(f"{level / first**2:.6g}")
        text = f"--g {self.g}: is --amplitude {amplitude:g} at {first / TURN:.5g} Hz"
        if structure.has_scale:
            raise InputError(f"{text}; a branch over the frequency has one amplitude: expected it")
        print(f"{text}, constant along the branch; its bifurcations are those of any amplitude")
        self.g, self.amplitude = None, amplitude

    def branch_excitation(self, structure: Structure, over: str, has_start: bool) -> Keywords:
        name, amplitude = self.given_frequency_option(), self.amplitude_or_level()
        if over == "frequency" and amplitude is None and not has_start:
            raise InputError(f"--over {self.over}: expected --amplitude in m with it")
        if name is None and (has_start or over in ("eta", "frequency")):
            given = {} if amplitude is None else {"amplitude": amplitude}
            return given | self.given_pushes()
        excitation = self.read_excitation(structure, one_frequency=True)
        both = "frequency", "a frequency and --amplitude"
        needs = {"eta": ("eta", "--eta without an amplitude"), "frequency": both, "amplitude": both}
        needed, expected = needs.get(over, ("", ""))
        if needed and needed not in excitation:
            raise InputError(f"--over {over}: expected {expected} with it")
        return excitation


@grammar.reader("a number, or all")
def parse_bifurcation(_: str, text: str) -> int | str:
    return text if text == "all" else grammar.parse_plain_int(text)


class Border(OfStored, OfPushes, FunctionCommand, Stored, Results):
    """Follow a bifurcation of a branch over two parameters: where a window begins or ends."""

    calls = "border"
    over: str = option(
        f"what varies, that of the branch first, each {CONTINUED}", "eta,e", "NAME,NAME"
    )
    limits: Any = option("between which each is followed, in its own unit", value="A:B,C:D")
    bifurcation: int | str = option(
        "its number, or all of them in one picture", 0, "N|all", read=parse_bifurcation
    )
    examples = """
  {program} border --start branch.nc --bifurcation 0 --over eta,e --limits 2.4:2.9,0.6:0.8
  {program} border --start beam.nc --over hz,e --limits 14:18,0.6:0.8
  {program} border --start branch.nc --bifurcation all --limits 2.4:2.9,0.6:0.8
--start is what the command branch has written, with the numbers of its bifurcations;
structure and excitation are those of that branch."""

    def read_question(self) -> tuple[Structure, Keywords]:
        self.require("start", "; expected a file of the command branch")
        ranges = self.require("limits", "; expected A:B,C:D").split(",")
        names = [part.strip() for part in self.over.split(",")]
        if len(names) != 2:
            raise InputError(f"--over {self.over}: expected two names, such as eta,e or hz,e")
        if len(ranges) != 2:
            text = f"expected A:B,C:D, a range for each of {self.over}"
            raise InputError(f"--limits {self.limits}: {text}")
        over, limits = zip(*map(parse_continued, names, map(str.strip, ranges)), strict=True)
        structure, question = self.read_structure_and_question()
        return structure, {**question, **self.given_pushes(), "over": over, "limits": limits}

    def __call__(self) -> None:
        structure, question = self.read_question()
        if question["bifurcation"] != "all":
            self.compute_print_and_write(structure, question)
            return
        from ..dynamics.borders import passes_bifurcation

        if self.store is not None:
            raise InputError("--store: of one bifurcation; expected it without --bifurcation all")
        curves: list[xr.Dataset] = []
        for number in range(question["start"].sizes.get("bifurcation", 0)):
            one = {**question, "bifurcation": number}
            if any(passes_bifurcation(curve, one) for curve in curves):
                print(f"number {number} is on a curve that was followed")
                continue
            try:
                curves += self.compute_print_and_write(structure, one, picture=False).values()
            except InputError as reason:
                print(f"number {number} is not followed: {reason}")
        if not curves:
            raise InputError(f"--start {self.start}: no bifurcation that can be followed")
        name = result_file_stem("border_all", self.source_file_stems(), structure, question)
        shown = [units.with_units(curve, self.display_units(question)) for curve in curves]
        files = ResultFiles.from_options(self, name, fresh=True)
        files.write_pictures(partial(orchestrate.plot, *shown))

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        names = [str(name) for name in data.attrs["over"]]
        yield f"{data.attrs['kind']}: {data.sizes['point']} points"
        for name in names:
            both = [printing.format_parameter(data, name, data[name][i]) for i in (0, -1)]
            yield f"from {' to '.join(both)}, within {printing.format_full_range(data, name)}"
        yield from printing.listing_lines(data, "codimension_two", ", ".join(["kind", *names]))
        yield from branch_end_lines(data)
