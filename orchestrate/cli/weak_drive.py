"""Commands on the weak drive: cosimulate, couple, capture, passage, jump-voltages, drive-branch."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from ..errors import InputError
from ..lazy import xr
from ..units import range_text, text_of, units_of, with_units
from .command import Command, Question, option
from .drive import (
    ETA0,
    RESUME,
    Driven,
    Held,
    OfController,
    OfMotor,
    OfRamp,
    OfSchedule,
    Only,
    Stepped,
    format_title,
    times_in_seconds,
)
from .grammar import parse_rates
from .options import Over
from .output import Files, OfBoth, Stored, digest, user_fmus
from .text import Columns, columns_of, end_lines, parameter_column, table

if TYPE_CHECKING:
    from ..model import Drive, Structure
    from ..weak_drive.couple import CoupleJob
    from .drive import Runs


ERROR_LIMIT = 1e-6  # of the motor's work: larger errors give a warning


def draw_couple(
    title: str,
    results: Runs,
    structure: Structure,
    drive: Drive,
    job: CoupleJob,
    branches: xr.Dataset | None,
) -> Any:
    """Draw the runs: ramps with averaged theory and branches, others over time."""
    import numpy as np

    from ..show.passage import draw_run
    from ..show.weak_drive import draw
    from ..weak_drive import averaged, own_resonance
    from ..weak_drive.schedule import Ramp

    if job.control or not isinstance(job.schedule, Ramp):
        resonance = own_resonance.dividing_speed(structure, drive) * structure.omega
        return draw_run(results, resonance, title)
    Omega = np.linspace(0.3, 3.0, 20001)
    volts = averaged.no_load_speed(structure, drive, Omega) * drive.volts(structure)
    amplitude = averaged.amplitude(structure, drive, Omega) * drive.length
    points, stable = averaged.branch_stability(structure, drive)
    part = np.searchsorted([point.Omega for point in points], Omega)
    theory = xr.Dataset(
        {
            "voltage": ("speed", volts),
            "amplitude": ("speed", amplitude, {"units": "m"}),
            "stable": ("speed", np.array(stable)[part]),
        },
        {"speed": ("speed", Omega * structure.omega, {"units": "rad/s"})},
        structure.parameters(),
    )
    units = units_of(next(iter(results.values())))
    under = None if branches is None else with_units(branches, units)
    return draw(results, with_units(theory, units), under, title)


def couple_lines(results: Runs, volts: float) -> Iterator[str]:
    """Yield revolutions and speeds of each run, a table of jumps, and the runs' accuracy."""
    names = ("structure", "jump", "voltage V", "eta0", "of the ramp V", "decided")
    columns: dict[str, list[str]] = {name: [] for name in names}
    for name, data in results.items():
        ends = float(data.speed.min()), float(data.speed.max())
        passed = float(data.passage_time)
        line = (
            f"{name}: {data.sizes['revolution']} revolutions at {range_text(data, *ends, 'rad/s')}"
        )
        if math.isfinite(passed) and not data.jumps.notnull().any():
            line += f", beyond the resonance from {passed:.4g} s on"
        yield line
        missing, defects = (
            float(data.attrs[f"{key}_over_motor_work"]) for key in ("missing", "defects")
        )
        doubt = f": more than {ERROR_LIMIT:g}, take a shorter --step"
        yield (
            f"  relative energy error {missing:.1e}, coupling error {defects:.1e} of the motor's "
            f"work{doubt if max(abs(missing), defects) > ERROR_LIMIT else ''}"
        )
        for jump in data.jump.values:
            cells = (name, *jump_cells(data.sel(jump=jump), volts))
            for column, cell in zip(columns.values(), cells, strict=True):
                column.append(cell)
    yield from table(columns)


def jump_cells(at: xr.Dataset, volts: float) -> tuple[str, ...]:
    """Return the cells of a jump: direction, voltage, eta0, the ramp's voltage, how decided."""
    voltage, direction = float(at.jumps), str(at.jump.item())
    if not math.isfinite(voltage):
        word = "undecided" if at.decided.item() == "undecided" else "none"
        reason = str(at.no_jump.item()).replace("a longer hold", "a longer --hold")
        return direction, word, "", "", reason
    error = 0.5 * abs(float(at.jump_high) - float(at.jump_low))
    shown, decided = f"{float(at.ramp_voltage):.4f}", str(at.decided.item())
    return direction, f"{voltage:.5f} +- {error:.5f}", f"{voltage / volts:.5f}", shown, decided


class Couple(OfMotor, Only, OfSchedule, OfController, Stepped, Held, Command, OfBoth):
    """The weak drive: structure and motor coupled, the voltage up and down (Figure 2)."""

    calls, takes = "couple", "tolerance"
    branches: bool = option(
        "compute the branches of stationary motions too, and draw them under the ramps"
    )
    ssp: Path | None = option("write the coupled system for other tools instead")
    ssp_version: Literal["1.0", "2.0"] = option("of SSP", "1.0")
    examples = f"""
  {{program}} couple                               quick: bonded, delaminated, up and down
  {{program}} couple --drive beam                  a delaminated beam on a small motor
  {{program}} couple --drive motor.toml            a motor, box and structure of your own
  {{program}} couple --eta0 1.4:1.62 --rate 1e-5   a slower ramp over less
  {{program}} couple --drive beam --voltage 5.6:7.2 --volt-rate 0.01
  {{program}} couple --drive beam --voltage 6.5 --duration 10 --speed-control 110
  {{program}} couple --increment 0.005             in steps of the voltage, each with time to settle
  {{program}} couple --course voltage.csv          any course of the voltage
  {{program}} couple --ssp weak_drive.ssp          the coupled system as a package for other tools
{ETA0}
A ramp shows its jumps late: voltages are those of rate 0, at which the motion is lost.
{RESUME}"""

    def __call__(self) -> None:
        import orchestrate

        from ..fmu import finder
        from ..running.options import RunOptions
        from ..running.runner import answer_all
        from ..running.store import load

        structure, drive = self.read_structure_and_drive()
        jobs = self.make_jobs(structure, drive)
        if self.ssp:
            print(self.write_package(self.ssp, drive, jobs[-1]))
            return
        files = [Files.from_options(self, job.name) for job in jobs]
        running, branches = self.running(), None
        answer_all(jobs, self.output, RunOptions.from_keywords(running), finder(running))
        states = self.structures_by_name(structure)
        results = {state: load(one.result) for state, one in zip(states, files, strict=True)}
        asked, shown = self.display(results)
        if self.branches:
            digits = digest(structure.as_delaminated().parameters(), drive.parameters())
            store = self.output / f"branches_{'_'.join(self.source_names())}_{digits}.nc"
            running = self.running(store)
            branches = orchestrate.drive_branch(structure, drive, **running)
            branches = with_units(branches, self.drive_units())
            print(*drive_branch_lines(branches), sep="\n")
        print(*couple_lines(shown, drive.volts(structure)), sep="\n")
        for one, data in zip(files, asked.values(), strict=True):
            one.write(data)
        picture = self.common_files(jobs[0].name.rpartition("_")[0], files)
        title = self.picture_title(shown, format_title(shown, jobs[0].control))
        picture.write_pictures(
            partial(draw_couple, title, shown, structure, drive, jobs[0], branches)
        )
        if any(data.jumps.notnull().any() for data in results.values()):
            draw = partial(orchestrate.plot, *shown.values(), part="jumps", title=title)
            picture.write_pictures(draw, "jumps")

    def make_jobs(self, structure: Structure, drive: Drive) -> list[CoupleJob]:
        """Return the jobs for the runs asked for, a ``CoupleJob`` per structure, bonded first."""
        from ..weak_drive.couple import couple_job, scheme_from_arguments

        control = self.make_controller(structure, drive)
        schedule = self.make_schedule(structure, drive, control)
        step, hold = times_in_seconds(self, structure, "step", "hold").values()
        tolerance = self.keywords()["tolerance"]
        scheme = scheme_from_arguments(structure, step, tolerance, control is not None)
        base_name = self.drive_result_name(structure, drive, (schedule, scheme, control, hold))
        return [
            replace(
                couple_job(chosen, drive, schedule, scheme, control=control, hold=hold),
                name=f"{base_name}_{state}",
            )
            for state, chosen in self.structures_by_name(structure).items()
        ]

    def write_package(self, path: Path, drive: Drive, job: CoupleJob) -> Path:
        """Write the coupled system as an SSP file with its FMUs; return its path."""
        from ..fmu import find
        from ..weak_drive.ssp import write_ssp

        own = user_fmus(self.fmu)
        fmus = [find(name, "fmi2", self.build_folder, own.get(name)).path for name in job.models]
        voltage, speed = job.schedule.voltage(0.0), job.speed_start
        start: Any = {"voltage": voltage, "speed_start": speed}
        return write_ssp(path, job.structure, drive, **start, fmus=fmus, version=self.ssp_version)


UNDECIDED, NEITHER = "undecided", "settled at the resonance"
REASONS = {
    UNDECIDED: "undecided: the speed had not settled; give a longer --time",
    NEITHER: "neither passed nor captured: the speed settles at the resonance",
}


def threshold_cells(data: xr.Dataset) -> dict[str, str]:
    """Return the cells of one threshold: voltage, counts of starts, speeds, passage time."""
    passes = int((data.passes.values > 0).sum())
    open_ones = int(data.decision.isin(list(REASONS)).sum())
    low, high = float(data.border_low), float(data.border_high)
    border = "none"
    if math.isfinite(float(data.border)):
        narrow = high - low <= float(data.border.attrs["tolerance"])
        error = f"{0.5 * (high - low):.1g}"
        border = f"{float(data.border):.5f} +- {error}" if narrow else f"{low:.5f} to {high:.5f}"
    speeds = (
        "" if math.isnan(float(data[name])) else text_of(data, data[name], "rad/s", ".4g")
        for name in ("speed_low", "speed_high")
    )
    titles = ("passes from V", "pass", "captured", "undecided", "speed below", "beyond")
    counts = (str(passes), str(data.decision.size - passes - open_ones), str(open_ones))
    return dict(zip(titles, (border, *counts, *speeds), strict=True))


class Capture(OfMotor, Only, OfRamp, Over, Stepped, OfController, Driven, OfBoth):
    """Voltages switched on from rest: which pass the resonance, which are captured."""

    calls = "capture"
    examples = f"""
  {{program}} capture                                       quick, bonded and delaminated
  {{program}} capture --drive beam --voltage 6.1:6.9
  {{program}} capture --over rotor_inertia --values 600:1600:200
  {{program}} capture --drive beam --set armature_resistance=120 --voltage 7:10 --speed-gradient
{ETA0}
The motor is switched on at once and followed until its speed has settled.
{RESUME}"""

    def ask(self) -> tuple[Structure, Drive, Question]:
        structure, drive = self.read_structure_and_drive()
        values = self.read_over()
        if self.eta0 or self.voltage:
            ends = self.parse_ramp_ends(structure, drive)
        else:
            down, up = self.averaged_jump_voltages(structure, drive)
            ends = down, 1.06 * up
        question = self.keywords()
        question |= {"voltage": ends, "over": self.over, "values": values and values[0]}
        question["control"] = self.make_controller(structure, drive)
        return structure, drive, question | times_in_seconds(self, structure, "step")

    def words(self, _: Runs, question: Question) -> str:
        control = question["control"]
        switched = f"controlled by {type(control).__name__}" if control else "switched on from rest"
        return "{}, {:.4g} V to {:.4g} V".format(switched, *question["voltage"])

    def summary(self, results: Runs) -> Iterator[str]:
        rows: list[dict[str, str]] = []
        notes: list[str] = []
        for state, data in results.items():
            (over,) = {str(dim) for dim in data.passes.dims} - {"voltage"} or {""}
            for part in (
                [data.sel({over: value}) for value in data[over].values] if over else [data]
            ):
                where = {over: f"{float(part[over]):g}"} if over else {}
                rows.append({"structure": state, **where, **threshold_cells(part)})
                for decision, reason in REASONS.items():
                    tried = part.voltage.values[part.decision.values == decision]
                    if tried.size:
                        notes.append(f"{state}, {', '.join(f'{v:.5g}' for v in tried)} V {reason}")
                if float(part.above_fold):
                    fold = f"{float(part.fold):.5f} V"
                    notes.append(
                        f"warning: {state}, above the fold at {fold}, beyond which the averaged "
                        "theory has no motion below the resonance"
                    )
        yield from table({title: [row[title] for row in rows] for title in rows[0]}, len(rows))
        yield from notes


def first_stored_interval(data: xr.Dataset) -> xr.Dataset:
    """Return the samples of the first jump where a run is stored around several."""
    import numpy as np

    gaps = np.diff(data.time.values)
    breaks = np.flatnonzero(gaps > 1.5 * np.median(gaps))
    return data.isel(time=slice(0, int(breaks[0]) + 1)) if breaks.size else data


class Passage(OfMotor, Only, OfSchedule, OfController, Stepped, Held, Driven, OfBoth):
    """A run through the resonance at full resolution: speed, motion, power, waterfall."""

    calls, takes = "passage", "around"
    revolutions: int = option("revolutions of each spectrum of the waterfall", 8)
    mass: Literal[1, 2] = option("whose acceleration the spectra are of", 1)
    examples = f"""
  {{program}} passage --eta0 1.4:1.65 --one-way               quick through its resonance
  {{program}} passage --drive rig --one-way --around 3
  {{program}} passage --drive beam --voltage 6.5 --duration 10 --speed-control 110
{ETA0}
{RESUME}"""

    def ask(self) -> tuple[Structure, Drive, Question]:
        from ..weak_drive.schedule import Constant

        structure, drive = self.read_structure_and_drive()
        if self.revolutions < 1:
            raise InputError(f"--revolutions {self.revolutions}: expected a whole number >= 1")
        control = self.make_controller(structure, drive)
        schedule = self.make_schedule(structure, drive, control)
        around = self.around
        if around is None and not isinstance(schedule, Constant):
            around = 300.0 / structure.omega
        times = times_in_seconds(self, structure, "step", "hold")
        return (
            structure,
            drive,
            {"voltage": schedule, "around": around, "control": control, **times},
        )

    def words(self, results: Runs, question: Question) -> str:
        shown = {state: first_stored_interval(data) for state, data in results.items()}
        return format_title(shown, question["control"])

    def draw(self, results: Runs, title: str) -> Any:
        from .. import waterfall
        from ..show.passage import draw

        spectra = {"revolutions": self.revolutions, "mass": self.mass}
        shown = {state: first_stored_interval(data) for state, data in results.items()}
        falls = {state: waterfall(data, **spectra) for state, data in shown.items()}
        return draw(shown, falls, title)

    def summary(self, results: Runs) -> Iterator[str]:
        from ..show.passage import format_jumps

        for state, data in results.items():
            count, first, last = data.sizes["time"], float(data.time[0]), float(data.time[-1])
            samples = f"{count} samples, {first:.4g} s to {last:.4g} s ({data.attrs['kept']})"
            moved = text_of(data, abs(data.x1).max(), "m", ".4g")
            speed = text_of(data, abs(data.speed).max(), "rad/s", ".4g")
            fastest = f"largest |x1| {moved}, speed up to {speed}"
            yield f"{state}: {format_jumps(data)}; {samples}; {fastest}"


class JumpVoltages(OfMotor, OfRamp, Over, Stepped, Driven, Stored, OfBoth):
    """Voltages at which the speed jumps, at rate 0 and on ramps of several rates."""

    calls, takes = "jump_voltages", ""
    rate: str = option(
        "change of eta0 in a time 1/omega, a list", "1e-4,5e-5,2.5e-5", value="A,B,..."
    )
    settle: float = option("time at the first voltage, in 1/omega", 300.0)
    one_way: bool = option("do not come back: jumps up only")
    examples = f"""
  {{program}} jump-voltages                                 quick, up and down
  {{program}} jump-voltages --rate 1e-4,3e-5,1e-5 --one-way
  {{program}} jump-voltages --over clearance --values 0,1e-5,3e-5 --drive beam --one-way
  {{program}} jump-voltages --drive beam --eta0 1.33:1.57 --rate 4e-5,2e-5,1e-5 --one-way
{ETA0}
{RESUME}"""

    def ask(self) -> tuple[Structure, Drive, Question]:
        structure, drive = self.read_structure_and_drive()
        unit = drive.volts(structure) * structure.omega
        question: Question = {
            "voltage": self.parse_ramp_ends(structure, drive),
            "rates": [rate * unit for rate in parse_rates("--rate", self.rate)],
            "back": not self.one_way,
        }
        if (values := self.read_over()) is not None:
            question |= {"over": self.over, "values": values[0]}
        return structure, drive, question | times_in_seconds(self, structure, "settle", "step")

    def words(self, _: Runs, question: Question) -> str:
        ends = "{:.4g} V to {:.4g} V".format(*question["voltage"])
        rates = dict.fromkeys(f"{end(question['rates']):.2g} V/s" for end in (min, max))
        return f"{ends}, {' to '.join(rates)}, and at rate 0"

    def summary(self, results: Runs) -> Iterator[str]:
        (data,) = results.values()
        # a direction in which no ramp went has not been decided
        data = data.sel(
            jump=[jump for jump in data.jump.values if data.decided.sel(jump=jump).any()]
        )
        (over,) = {str(dim) for dim in data.jumps.dims} - {"structure", "jump"} or {""}
        rows: Columns = {"jump at rate 0": [str(jump) for jump in data.jump.values]}
        if over:
            count, parts = data.sizes["jump"], data[over].values
            rows = parameter_column(data, over, [v for v in parts for _ in range(count)])
            rows["jump at rate 0"] = [str(jump) for _ in parts for jump in data.jump.values]
            data = data.stack(row=(over, "jump"), create_index=False)
        for name in map(str, data.structure.values):
            at = data.sel(structure=name)
            cells = zip(at.jumps.values, at.standard_error.values, at.decided.values, strict=True)
            rows[f"{name} V"] = [
                f"{value:.5f} +- {error:.5f}"
                if math.isfinite(value)
                else ("undecided" if decided == "undecided" else "none")
                for value, error, decided in cells
            ]
        changes = data.jumps.isel(structure=1) - data.jumps.isel(structure=0)
        rows["change V"] = [
            "" if math.isnan(change) else f"{change:.5f}" for change in changes.values
        ]
        yield from table(rows, len(rows["change V"]))
        if (data.decided == "undecided").any():
            yield "undecided by constant voltages; drive-branch shows which motions are stable"


def unlocated_changes(leg: xr.Dataset, located: Any) -> str:
    """Return the speeds at which a branch's stability changes without a located bifurcation."""
    at = leg.dropna("point", subset=["voltage"])
    stable, speeds = at.stable.values.astype(int), []
    for i in (stable[1:] != stable[:-1]).nonzero()[0]:
        low, high = sorted(at.speed.values[i : i + 2])
        if not ((located > 2.0 * low - high) & (located < 2.0 * high - low)).any():
            speeds.append(text_of(at, low, "rad/s", ".5g"))
    return ", ".join(speeds)


def drive_branch_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield tables of the bifurcations and of the branches."""
    if count := data.sizes["bifurcation"]:
        order = sorted(range(count), key=lambda i: float(data.bifurcation_voltage[i]))
        order.sort(key=lambda i: str(data.bifurcation_structure[i].item()))  # within a structure
        rows = data.isel(bifurcation=order)
        yield from table(columns_of(rows, "structure kind voltage speed", "bifurcation_"), count)
        yield "at which of them a motor that follows its voltage jumps: jump-voltages, or couple"
    else:
        yield "no bifurcations"
    legs = [data.sel(structure=name, leg=leg) for name in data.structure for leg in data.leg]
    legs = [leg for leg in legs if leg.voltage.notnull().any()]
    columns = {
        "branch": [f"{leg.structure.item()}, {leg.leg.item()}" for leg in legs],
        "motions": [str(int(leg.voltage.notnull().sum())) for leg in legs],
        "stable": [str(int(leg.stable.sum())) for leg in legs],
        "ends by": [str(leg.end.item()) for leg in legs],
        "at": [last_motion(leg) for leg in legs],
    }
    unlocated = [unlocated_changes(leg, data.bifurcation_speed.values) for leg in legs]
    if any(unlocated):
        columns["stability changes near, not located (--period)"] = unlocated
    yield from table(columns, len(legs))
    yield from end_lines(columns["ends by"])


def last_motion(leg: xr.Dataset) -> str:
    """Return voltage and speed of a branch's last motion, as a text."""
    last = leg.dropna("point", subset=["voltage"]).isel(point=-1)
    return f"{float(last.voltage):.5f} V, {text_of(last, last.speed, 'rad/s', '.6g')}"


class DriveBranch(OfMotor, Driven, Stored, OfBoth):
    """Stationary motions of structure and motor, stable and unstable, and their bifurcations."""

    calls = "drive_branch"
    examples = """
  {program} drive-branch                              quick, bonded and delaminated
  {program} drive-branch --drive beam --speed 92:110
Branches go round their folds. Repeat the command to resume an interrupted run."""

    def ask(self) -> tuple[Structure, Drive, Question]:
        return *self.read_structure_and_drive(), self.keywords()

    def words(self, results: Runs, _: Question) -> str:
        voltage = results[""].voltage
        return f"stationary motions, {float(voltage.min()):.4g} V to {float(voltage.max()):.4g} V"

    def summary(self, results: Runs) -> Iterator[str]:
        return drive_branch_lines(results[""])
