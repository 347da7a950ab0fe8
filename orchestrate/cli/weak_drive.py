"""Commands on the weak drive: couple and cosimulate, capture, passage, jumps, branches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import orchestrate

from ..errors import InputError
from ..lazy import np, xr
from ..model import Drive, Structure
from ..units import display_units_of, format_quantity, with_units
from . import grammar, printing
from .answer import Files, FunctionCommand, Only, Runs, States
from .command import Keywords, Options, option
from .drive import DriveCommand, OfController, OfRamp, OfSchedule, Stepped
from .options import OfStructure, Over
from .output import OfBoth, ResultFiles, Results, Stored, fmus_by_model, question_digest

if TYPE_CHECKING:
    from ..weak_drive.couple import CoupleJob

LISTED = ("parameter", "structuralParameter", "input", "output")
PAIR = "NAME=VALUE"
ERROR_LIMIT = 1e-6  # of the motor's work: larger errors give a warning


class Couple(Only, OfSchedule, OfController, Stepped, DriveCommand, OfBoth):
    """The weak drive: structure and motor coupled, the voltage up and down (Figure 2)."""

    calls, takes = "couple", "tolerance"
    branches: bool = option(
        "compute the branches of stationary motions too, and draw them under the ramps"
    )
    ssp: Path | None = option("write the coupled system for other tools instead")
    ssp_version: Literal["1.0", "2.0"] = option("of SSP", "1.0")
    examples = """
  {program} couple                               quick: bonded, delaminated, up and down
  {program} couple --drive beam                  a delaminated beam on a small motor
  {program} couple --eta0 1.4:1.62 --rate 1e-5   a slower ramp over less
  {program} couple --drive beam --voltage 5.6:7.2 --volt-rate 0.01
  {program} couple --drive beam --voltage 6.5 --duration 10 --speed-control 110
  {program} couple --course voltage.csv          any course of the voltage
  {program} couple --ssp weak_drive.ssp          the coupled system as a package for other tools
A ramp shows its jumps late: voltages are those of rate 0, at which the motion is lost."""

    def __call__(self) -> None:
        if self.ssp:
            structure, motor, question = self.read_question()
            print(self.write_ssp_package(structure, motor, question))
        else:
            super().__call__()

    def make_job(self, structure: Structure, motor: Drive, question: Keywords) -> CoupleJob:
        from ..weak_drive.couple import make_couple_job, scheme_from_arguments

        control, accuracy = question["control"], (question["step"], question["tolerance"])
        scheme = scheme_from_arguments(structure, *accuracy, control is not None)
        more = {"control": control, "hold": question["hold"]}
        return make_couple_job(structure, motor, question["voltage"], scheme, **more)

    def compute(self, states: States, others: Any, question: Keywords, files: Files) -> Runs:
        from ..fmu import make_fmu_finder
        from ..running.options import RunOptions
        from ..running.runner import compute_into_folder
        from ..running.store import load_result

        jobs = [
            replace(self.make_job(one, others[0], question), name=files[state].result.stem)
            for state, one in states.items()
        ]
        running = self.running_keywords()
        options = RunOptions.from_keywords(running)
        compute_into_folder(jobs, self.output, options, make_fmu_finder(running))
        self.job, self.stationary = jobs[0], None
        if self.branches:
            delaminated = next(iter(states.values())).as_delaminated()
            own = question_digest(delaminated, *others)
            name = f"branches_{'_'.join(self.source_file_stems())}_{own}.nc"
            running = self.running_keywords(self.output / name)
            self.stationary = orchestrate.drive_branch(delaminated, *others, **running)
        return {state: load_result(files[state].result) for state in states}

    def all_summary_lines(self, results: Runs) -> Iterator[str]:
        if self.stationary is not None:
            yield from drive_branch_lines(with_units(self.stationary, self.display_units({})))
        yield from super().all_summary_lines(results)

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        yield from printing.describe(data, "speed passage_time")
        keys = ("missing_over_motor_work", "defects_over_motor_work")
        missing, defects = (float(data.attrs[key]) for key in keys)
        if max(abs(missing), defects) > ERROR_LIMIT:
            errors = f"relative energy error {missing:.1e}, coupling error {defects:.1e}"
            limit = f"more than {ERROR_LIMIT:g}, take a shorter --step"
            yield f"{errors} of the motor's work: {limit}"
        volts = self.job.drive.volts(self.job.structure)
        half = 0.5 * abs(data.jump_high - data.jump_low)
        shown = data.assign(half=half, eta0=(data.jumps / volts).assign_attrs(units="1"))
        names = "jumps+half:.5f, eta0:.5f, ramp_voltage:.4f, decided, no_jump"
        yield from printing.table_lines(shown, names)

    def draw(self, results: Runs, question: Keywords, *_: xr.Dataset) -> Any:
        from ..show.passage import draw_passage_histories
        from ..show.weak_drive import draw_ramps
        from ..weak_drive import averaged, own_resonance
        from ..weak_drive.schedule import Ramp

        title, system = self.picture_title(results), (self.job.structure, self.job.drive)
        if self.job.control or not isinstance(self.job.schedule, Ramp):
            resonance = own_resonance.dividing_speed(*system) * self.job.structure.omega
            return draw_passage_histories(results, resonance, title)
        units = display_units_of(next(iter(results.values())))
        theory = with_units(averaged.stationary_curve(*system), units)
        branches = None if self.stationary is None else with_units(self.stationary, units)
        return draw_ramps(results, theory, branches, title)

    def write_further_files(self, files: ResultFiles, shown: Runs, results: Runs) -> None:
        if any(data.jumps.notnull().any() for data in results.values()):
            title = self.picture_title(shown)
            draw = partial(orchestrate.plot, *shown.values(), part="jumps", title=title)
            files.write_pictures(draw, "jumps")

    def write_ssp_package(self, structure: Structure, motor: Drive, question: Keywords) -> Path:
        from ..fmu import find_or_export

        *_, chosen = self.structures_by_state(structure).values()
        job, own = self.make_job(chosen, motor, question), fmus_by_model(self.fmu)
        fmus = [find_or_export(n, "fmi2", self.build_folder, own.get(n)).path for n in job.models]
        start = {"voltage": job.schedule.voltage(0.0), "speed_start": job.speed_start}
        more: Any = {"fmus": fmus, "version": self.ssp_version, **start}
        return orchestrate.write_ssp(str(self.ssp), chosen, motor, **more)


class Capture(Only, OfRamp, Over, Stepped, OfController, DriveCommand, OfBoth):
    """Voltages switched on from rest: which pass the resonance, which are captured."""

    calls = "capture"
    examples = """
  {program} capture                                       quick, bonded and delaminated
  {program} capture --drive beam --voltage 6.1:6.9
  {program} capture --over rotor_inertia --values 600:1600:200
  {program} capture --drive beam --set armature_resistance=120 --voltage 7:10 --speed-gradient
The motor is switched on at once and followed until its speed has settled."""

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        half = 0.5 * (data.border_high - data.border_low)
        yield from printing.table_lines(data.assign(half=half), "border+half:.5f, above_fold")
        yield from printing.hint_lines(["above_fold: yes"] * bool(data.above_fold.any()))
        yield from printing.describe(data, "passes decision")


class Passage(Only, OfSchedule, OfController, Stepped, DriveCommand, OfBoth):
    """A run through the resonance at full resolution: speed, motion, power, waterfall."""

    calls, takes = "passage", "around"
    revolutions: int = option("revolutions of each spectrum of the waterfall", 8)
    mass: Literal[1, 2] = option("whose acceleration the spectra are of", 1)
    examples = """
  {program} passage --eta0 1.4:1.65 --one-way               quick through its resonance
  {program} passage --drive rig --one-way --around 3
  {program} passage --drive beam --voltage 6.5 --duration 10 --speed-control 110"""

    def read_question(self) -> tuple[Any, ...]:
        from ..weak_drive.schedule import Constant

        if self.revolutions < 1:
            raise InputError(f"--revolutions {self.revolutions}: expected a whole number >= 1")
        structure, motor, question = super().read_question()
        if self.around is None and not isinstance(question["voltage"], Constant):
            question["around"] = 300.0 / structure.omega
        return structure, motor, question

    def draw(self, results: Runs, question: Keywords, *_: xr.Dataset) -> Any:
        from ..show.passage import draw_passage_with_spectra

        shown, falls = {}, {}
        for state, data in results.items():
            gaps = np.diff(data.time.values)  # a run may be stored around several jumps
            breaks = [*np.flatnonzero(gaps > 1.5 * np.median(gaps)), len(gaps)]
            shown[state] = data.isel(time=slice(0, int(breaks[0]) + 1))
            how = {"revolutions": self.revolutions, "mass": self.mass}
            falls[state] = orchestrate.waterfall(shown[state], **how)
        return draw_passage_with_spectra(shown, falls, self.picture_title(results))

    def all_summary_lines(self, results: Runs) -> Iterator[str]:
        from ..show.passage import format_jumps_or_passage

        for state, data in results.items():
            ends = f"{float(data.time[0]):.4g} s to {float(data.time[-1]):.4g} s"
            samples = f"{data.sizes['time']} samples, {ends} ({data.attrs['kept']})"
            yield f"{state}: {format_jumps_or_passage(data)}; {samples}"


class JumpVoltages(OfRamp, Over, Stepped, DriveCommand, Stored, OfBoth):
    """Voltages at which the speed jumps, at rate 0 and on ramps of several rates."""

    calls, takes = "jump_voltages", ""
    rate: str = option("change of eta0 in a time 1/omega, a list", "1e-4,5e-5,2.5e-5", "A,B,...")
    settle: float = option("time at the first voltage, in 1/omega", 300.0)
    one_way: bool = option("do not come back: jumps up only")
    examples = """
  {program} jump-voltages                                 quick, up and down
  {program} jump-voltages --rate 1e-4,3e-5,1e-5 --one-way
  {program} jump-voltages --over clearance --values 0,1e-5,3e-5 --drive beam --one-way"""

    def read_question(self) -> tuple[Any, ...]:
        structure, motor, question = super().read_question()
        unit = motor.volts(structure) * structure.omega
        rates = [rate * unit for rate in grammar.parse_rates("--rate", self.rate)]
        question |= {"rates": rates, "back": not self.one_way}
        return structure, motor, question | self.options_in_seconds(structure, "settle")

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        # a direction in which no ramp went has not been decided
        went = [jump for jump in data.jump.values if data.decided.sel(jump=jump).any()]
        yield from printing.table_lines(data.sel(jump=went), "jumps+standard_error:.5f, decided")
        if (data.decided == "undecided").any():
            yield "undecided by constant voltages; drive-branch shows which motions are stable"


def format_unlocated_changes(leg: xr.Dataset, located: Any) -> str:
    """Return the speeds at which a branch's stability changes without a located bifurcation."""
    at = leg.dropna("point", subset=["voltage"])
    stable, speeds = at.stable.values.astype(int), []
    for i in (stable[1:] != stable[:-1]).nonzero()[0]:
        low, high = sorted(at.speed.values[i : i + 2])
        if not ((located > 2.0 * low - high) & (located < 2.0 * high - low)).any():
            speeds.append(format_quantity(at, low, "rad/s", ".5g"))
    return ", ".join(speeds)


def drive_branch_lines(data: xr.Dataset) -> Iterator[str]:
    rows = data.sortby(["bifurcation_structure", "bifurcation_voltage"])
    yield from printing.listing_lines(rows, "bifurcation", "structure, kind, voltage, speed")
    if rows.sizes["bifurcation"]:
        yield "at which of them a motor that follows its voltage jumps: jump-voltages, or couple"
    located, count = data.bifurcation_speed.values, data.voltage.count("point").drop_attrs()
    last = data.isel(point=count - 1).rename(end="ends by")
    last = last.assign(motions=count, stable=data.stable.sum("point").drop_attrs())
    names = "motions, stable, ends by, voltage:.5f, speed"
    unlocated = [
        [format_unlocated_changes(data.sel(structure=name, leg=leg), located) for leg in data.leg]
        for name in data.structure
    ]
    if any(map(any, unlocated)):
        title = "unlocated changes of stability near (--period)"
        last, names = last.assign({title: (count.dims, unlocated)}), f"{names}, {title}"
    yield from printing.table_lines(last, names, needs="voltage")
    yield from printing.hint_lines(dict.fromkeys(data.end.values[count.values > 0].tolist()))


class DriveBranch(DriveCommand, Stored, OfBoth):
    """Stationary motions of structure and motor, stable and unstable, and their bifurcations."""

    calls = "drive_branch"
    examples = """
  {program} drive-branch                              quick, bonded and delaminated
  {program} drive-branch --drive beam --speed 92:110
Branches go round their folds."""

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        return drive_branch_lines(data)


# -- any drive ------------------------------------------------------------------------------------


def split_at_commas(texts: Sequence[str] | None) -> tuple[str, ...]:
    return tuple(word for word in ",".join(texts or ()).split(",") if word)


def parse_variable_values(option: str, texts: Sequence[str]) -> dict[str, Any]:
    """Return values by name: numbers, true or false; of inputs also files with time and value."""
    found: dict[str, Any] = {}
    for name, text in grammar.parse_pairs(option, texts, PAIR).items():
        try:
            flag = {"true": True, "false": False}.get(text)
            found[name] = grammar.parse_plain_float(text) if flag is None else flag
        except ValueError:
            if option != "--input":
                text = f"{option} {name}={text}: expected a number, true or false"
                raise InputError(text) from None
            found[name] = orchestrate.Course.from_csv(text)
    return found


def drive_variable_lines(drive: Path) -> Iterator[str]:
    from ..fmu.description import describe
    from ..weak_drive.connection import MOTION, explain_proposal, propose_connections

    description = describe(drive)
    yield f"{description.name}, FMI {description.fmi_version}"
    every = description.variables.items()
    listed = [pair for kind in LISTED for pair in every if pair[1].causality == kind]
    columns = {
        "causality": [one.causality for _, one in listed],
        "name": [name for name, _ in listed],
        "start": ["" if one.start is None else str(one.start) for _, one in listed],
        "unit": [one.unit or "no unit" for _, one in listed],
        "description": [one.description or "" for _, one in listed],
    }
    yield from printing.text_table_lines(columns)
    if likely := propose_connections(description):
        links = " ".join(f"{ours}={theirs}" for ours, theirs in likely.items())
        yield f"likely: --connect {links}   (a run checks the sign of the force)"
        for ours, theirs in likely.items():
            yield f"  {ours:17} {theirs}: {explain_proposal(description, ours, theirs)}"
    else:
        outputs = " ".join(f"{ours}=OUTPUT" for ours in MOTION)
        text = f"--connect {outputs} box_force=INPUT (one motion is enough, all are more exact)"
        yield f"units and names do not tell which are the box's: {text}"


class OfDrive(Options):
    """Options of the drive of a co-simulation."""

    heading, rank = "the drive", 1
    drive: Path = option("FMI 2.0 or 3.0", value="FMU", needed=True)
    listed: bool = option("show its variables, propose connections, and end", names=("--list",))
    connect: list[str] = option(
        "box_acceleration (or box_velocity, box_position) and box_force, by names of the drive, or "
        "force1, force2, its forces on the halves; a "
        "minus before a name turns its sign, a unit after it in brackets states it: pos[mm]",
        (),
        "OURS=THEIRS",
        many=True,
    )
    unit: list[str] = option(
        "units of connected variables that it does not state, or not rightly",
        (),
        "NAME=UNIT",
        many=True,
    )
    parameter: list[str] = option("its start values", (), PAIR, many=True)
    input: list[str] = option(
        "its other inputs: a number, or a CSV file with time in s and value", (), PAIR, many=True
    )
    record: list[str] = option("variables of the drive that are stored", (), "NAME", many=True)


class Cosimulate(OfStructure, OfDrive, FunctionCommand, Stored, Results):
    """Both FMUs together: the oscillator and a drive of anybody's."""

    calls = "cosimulate"
    shows = "x1 x2 box_acceleration box_velocity box_position coupling_error"
    renamed: ClassVar = {"units": "unit", "parameters": "parameter", "inputs": "input"}
    examples = """
  {program} cosimulate --drive shaker.fmu --list
  {program} cosimulate --structure beam --drive shaker.fmu --duration 2 --step 1e-3
      --connect box_acceleration=table_acc box_force=-force --input volts=3 --record amperes
  {program} cosimulate --structure none --drive shaker.fmu --connect box_acceleration=table_acc
      --input volts=3 --duration 2 --step 1e-3                the drive alone
  {program} cosimulate --structure beam --drive shaker.fmu --connect box_velocity=v box_force=f
      --input volts=volts.csv --duration 2 --step 1e-3"""

    def __call__(self) -> None:
        if self.listed:
            print(*drive_variable_lines(self.drive), sep="\n")
        else:
            super().__call__()

    def read_question(self) -> tuple[Structure | None, Keywords]:
        alone = self.structure == "none"
        if alone and self.set:
            raise InputError("--set: --structure none has no parameters; leave it out")
        structure = None if alone else self.read_and_report_structure()
        if self.structure == "paper" and not self.set:
            text = "expected one in SI units, as the drive has them, or none for the drive alone"
            raise InputError(f"--structure is missing; {text}")
        return structure, self.function_keywords() | {
            "drive": str(self.drive),
            "connect": grammar.parse_pairs("--connect", split_at_commas(self.connect), PAIR),
            "units": grammar.parse_pairs("--unit", split_at_commas(self.unit), "NAME=UNIT"),
            "parameters": parse_variable_values("--parameter", self.parameter),
            "inputs": parse_variable_values("--input", self.input),
            "record": split_at_commas(self.record),
        }

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        if self.structure == "none":
            yield f"no structure: the drive alone for {float(data.time[-1]):.6g} s"
        yield from super().summary_lines(data)
        if data.attrs["inputs_at_start"]:
            yield f"no input was given for {data.attrs['inputs_at_start']}, which stays so"
