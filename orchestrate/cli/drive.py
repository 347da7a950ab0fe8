"""Options and steps of the commands on the weak drive: motor, voltage, controller, files."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from ..constants import TURN
from ..errors import InputError
from ..lazy import xr
from ..units import Units, with_readable_lengths, with_units
from .command import Command, Options, Question, option, option_names
from .grammar import Positive, parse_changes, parse_ends, parse_number_or_ends, parse_rate
from .notes import warn_of_voltage
from .options import print_assumptions
from .output import Files, digest

if TYPE_CHECKING:
    from ..model import Drive, Structure
    from ..weak_drive.controllers import Controller
    from ..weak_drive.schedule import Schedule

    Runs = Mapping[str, xr.Dataset]  # by structure, or by "" if one result is of both

USUAL = {"quick": ("1.2:1.65", 1e-4), "beam": ("1.25:1.6", 5e-6), "rig": ("0.95:1.24", 5e-5)}
USUAL_RATES = ", ".join(f"{rate:g} for {name}" for name, (_, rate) in USUAL.items())
RATE = 1e-4  # of eta0, in a time 1/omega
ETA0 = "eta0 = U/(K omega) is the voltage as no-load speed over omega = sqrt(k1/m1)."
RESUME = "Repeat the command to resume an interrupted run. A finished result is left as it is."
CONTROLS = {  # options of controllers, with their settings
    "speed_control": ("gain", "reset_time", "speed_rise"),
    "speed_gradient": ("filter_time", "low"),
}
DATASHEET = ("rated_voltage", "no_load_rpm", "stall_torque")

# -- options --------------------------------------------------------------------------------------


class Motor(Options):
    """Options of structure, motor and box."""

    heading, rank = "structure, motor and box", 0
    drive: str = option(
        "TOML file with [motor], [box] and [structure], or a set: quick (no real one: jumps come "
        "soon), beam (some kg on a small motor), rig (near the paper's)",
        "quick",
        value="SET|FILE",
    )
    structure: Any = option(
        "file or set with another [structure] than that of --drive", value="SET|FILE"
    )
    set: list[str] = option(
        "a parameter of the structure, or of motor and box in SI; may be repeated",
        (),
        value="NAME=VALUE",
    )


class OfMotor(Motor):
    """The same, with a motor by its datasheet."""

    heading, rank = "a motor by its datasheet", 0
    remark = "in place of motor_constant and armature_resistance: all three"
    rated_voltage: Positive = option("of the motor, V", value="V")
    no_load_rpm: Positive = option("its speed without load", value="RPM")
    stall_torque: Positive = option("its torque at rest, N m", value="N.M")

    def read_structure_and_drive(self) -> tuple[Structure, Drive]:
        """Return structure and drive of the options, with the changes of ``--set`` to either."""
        from ..model import Drive, Structure

        drive = Drive.from_file(self.drive)
        structure = Structure.from_file(self.structure or self.drive)
        if self.drive == "quick" and structure.omega > 10.0:  # that motor turns at 1.5 rad/s
            raise InputError(
                "--drive is missing: the motor of the set quick is far too slow for "
                f"{structure.omega:.4g} rad/s; expected --drive beam, rig, or a file with [motor]"
            )
        changes = parse_changes(self.set)
        drive_names = {field.name for field in fields(Drive)}
        of_drive = {name: float(value) for name, value in changes.items() if name in drive_names}
        of_structure = {name: value for name, value in changes.items() if name not in drive_names}
        of_drive |= self.read_datasheet(of_drive)
        check_masses(self.structure or self.drive, of_structure)
        changed = structure.replace(**of_structure)
        print_assumptions(changed, self.structure or self.drive, of_structure)
        return changed, drive.replace(**of_drive)

    def read_datasheet(self, changes: Mapping[str, float]) -> dict[str, float]:
        """Return motor constant and resistance from the datasheet's options; empty without them."""
        from ..model.drive import torque_line

        given, names = self.given(OfMotor), ("motor_constant", "armature_resistance")
        if not given:
            return {}
        first = f"{option_names(list(given)[:1])} {next(iter(given.values())):g}"
        if missing := [name for name in DATASHEET if name not in given]:
            text = f"{first}: without {option_names(missing[:1])}"
            raise InputError(f"{text}; expected {option_names(DATASHEET)} together")
        if twice := [name for name in names if name in changes]:
            text = (
                f"--set {twice[0]}={changes[twice[0]]:g}: given with {option_names(DATASHEET[:1])}"
            )
            raise InputError(f"{text}; expected one of them")
        voltage, rpm, torque = given.values()
        return dict(zip(names, torque_line(voltage, TURN * rpm / 60.0, torque), strict=True))

    def source_names(self) -> Iterable[str]:
        """Return the names of the drive's file and, if it is another, of the structure's."""
        return dict.fromkeys(Path(p).stem for p in (self.drive, self.structure) if p)

    def drive_units(self) -> Units:
        """Return the display units; rpm by default if the motor's speed is in rpm."""
        in_rpm = self.no_load_rpm is not None
        return self.read_units().with_defaults(Units("rpm" if in_rpm else ""))

    def picture_title(self, results: Runs, words: str) -> str:
        """Return a picture's title: names of the files, what is shown, the structure."""
        from ..show.labels import title_from_attributes

        structure = title_from_attributes(list(results.values())[-1])  # delaminated, if it is there
        return f"{', '.join(self.source_names())}: {words}; {structure}"

    def drive_result_name(self, structure: Structure, drive: Drive, question: Any) -> str:
        """Return a result's file name: command, names of drive and structure, a digest of all."""
        digits = digest(structure.as_delaminated().parameters(), drive.parameters(), question)
        return f"{self.calls}_{'_'.join(self.source_names())}_{digits}"

    def display(self, results: Runs) -> tuple[dict[str, xr.Dataset], dict[str, xr.Dataset]]:
        """Return runs in display units, and with readable lengths for print and picture."""
        units = self.drive_units()
        asked = {state: with_units(data, units) for state, data in results.items()}
        return asked, dict(zip(asked, with_readable_lengths(*asked.values()), strict=True))

    def common_files(self, base: str, files: Iterable[Files]) -> Files:
        """Return the ``Files`` of the picture of both structures, or of the one of ``--only``."""
        only = getattr(self, "only", None)
        name = f"{base}_{only}" if only else base
        return Files.from_options(self, name, fresh=any(one.fresh for one in files))


class Only(Options):
    """The option of one structure of both."""

    only: Literal["bonded", "delaminated"] | None = option("one of both (default: both)")

    def structures_by_name(self, structure: Structure) -> dict[str, Structure]:
        """Return the bonded and the delaminated structure, or the one ``--only`` names."""
        both = {"bonded": structure.as_bonded(), "delaminated": structure.as_delaminated()}
        return {self.only: both[self.only]} if self.only else both


class Stepped(Options):
    """The option of the communication step."""

    step: float | None = option(
        "communication step, in 1/omega (default: controlled by its defect, at most 0.4; 0.1 where "
        "a controller or a picture takes samples)"
    )


class Held(Options):
    """The option of held voltages."""

    hold: float | None = option(
        "longest time for which a voltage is held until the speed settles, 0 for none, in 1/omega "
        "(default: 4000 and 200 times the rotor's own)",
        value="TIME",
    )


class OfVoltage(Options):
    """Options of one voltage."""

    heading, rank = "the motor's voltage", 1
    eta0: float | None = option(
        "voltage as no-load speed over omega (default: 1.53 for quick, 1.45 for beam, else between "
        "the jumps of the averaged theory)"
    )
    voltage: float | None = option("the same in V")


class OfRamp(Options):
    """Options of two voltages."""

    heading, rank = "the motor's voltage", 1
    eta0: str | None = option(
        "voltage as no-load speed over omega (default: about the jumps of the averaged theory)",
        value="FIRST:LAST",
    )
    voltage: str | None = option("the same in V", value="FIRST:LAST")

    def parse_voltages(self, structure: Structure, drive: Drive) -> tuple[float, ...]:
        """Return one voltage or a ramp's first and last one, V; by default around the jumps."""
        self.one_of("eta0", "voltage")
        volts = drive.volts(structure)
        for name, unit in (("voltage", 1.0), ("eta0", volts)):
            if text := getattr(self, name):
                given = tuple(unit * one for one in parse_number_or_ends(f"--{name}", text))
                warn_of_voltage(f"--{name} {text}", given, volts)
                return given
        has_own_parameters = self.set or self.structure or self.rated_voltage is not None
        if self.drive in USUAL and not has_own_parameters:
            first, last = parse_ends("--eta0", USUAL[self.drive][0])
            return first * volts, last * volts
        down, up = self.averaged_jump_voltages(structure, drive)
        return 0.88 * down, 1.06 * up

    def parse_ramp_ends(self, structure: Structure, drive: Drive) -> tuple[float, float]:
        """Return the first and the last voltage of a ramp, V; raise if only one is given."""
        voltages = self.parse_voltages(structure, drive)
        if len(voltages) != 2:
            name = "voltage" if self.voltage else "eta0"
            text = getattr(self, name)
            raise InputError(f"--{name} {text}: expected FIRST:LAST, two numbers such as 1.2:1.65")
        return voltages

    def averaged_jump_voltages(self, structure: Structure, drive: Drive) -> tuple[float, float]:
        """Return the averaged theory's jump voltages, down then up, V; raise without jumps."""
        from ..weak_drive import averaged
        from ..weak_drive.couple import require_motor

        require_motor(structure, drive)
        folds = averaged.folds(structure, drive)
        if not folds:
            raise InputError(
                f"--drive {self.drive}: by the averaged theory its speed does not jump; expected "
                "--eta0 or --voltage with it"
            )
        volts = drive.volts(structure)
        return folds[-1].eta0 * volts, folds[0].eta0 * volts


class OfSchedule(OfRamp):
    """Options of a voltage over time."""

    heading, rank = "voltage over time: a ramp, steps, one value, or a file", 1
    duration: float | None = option("time of a single voltage in place of FIRST:LAST, in s")
    course: Path | None = option(
        "CSV file with time in s and voltage in V, a row each: straight lines between, instead"
    )
    rate: str | None = option(
        f"change of eta0 in a time 1/omega (default: {USUAL_RATES}, else {RATE:g})", value="RATE"
    )
    volt_rate: str | None = option("the same in V/s", value="RATE")
    increment: float = option(
        "change eta0 in steps of this height, at the same mean rate (default: a ramp)", 0.0
    )
    settle: float = option("time at the first voltage, in 1/omega", 300.0)
    one_way: bool = option("do not come back")

    def ramp_rate(self, structure: Structure, drive: Drive) -> float:
        """Return a ramp's rate, V/s, from ``--rate`` or ``--volt-rate``."""
        self.one_of("rate", "volt_rate")
        if self.volt_rate is not None:
            return parse_rate("--volt-rate", self.volt_rate)
        unit = drive.volts(structure) * structure.omega
        if self.rate is None:
            return unit * USUAL.get(self.drive, ("", RATE))[1]
        return unit * parse_rate("--rate", self.rate)

    def make_schedule(
        self, structure: Structure, drive: Drive, control: Controller | None
    ) -> Schedule:
        """Return the voltage over time (a ``Schedule``) that the options describe."""
        from ..weak_drive.couple import schedule_from_arguments
        from ..weak_drive.schedule import Course

        rate, omega = self.ramp_rate(structure, drive), structure.omega
        if self.course:
            for name in ("eta0", "voltage", "duration"):
                self.one_of("course", name)
            return Course.from_csv(self.course)
        ends = self.parse_voltages(structure, drive)
        if len(ends) == 1:
            if self.duration is None:
                raise InputError(f"one voltage, {ends[0]:g} V: expected --duration with it, in s")
            return schedule_from_arguments(structure, drive, ends[0], duration=self.duration)
        if self.duration is not None:
            raise InputError("--duration: expected one voltage with it, not FIRST:LAST")
        return schedule_from_arguments(
            structure,
            drive,
            (ends[0], ends[1]),
            rate=rate,
            settle=self.settle / omega,
            increment=self.increment * drive.volts(structure),
            back=not self.one_way,
            spin_up=0.0 if control else None,
        )


class OfController(Options):
    """Options of a controller of the motor."""

    heading = "controller"
    remark = "starts from rest, takes a part of the voltage at every communication step"
    speed_control: float | None = option("hold a speed in rad/s, by PI", value="SPEED")
    gain: float | None = option("of the PI control, V s/rad (default: 5 K)")
    reset_time: float | None = option("of it, s (default: J R_a/K^2)")
    speed_rise: float | None = option(
        "rate at which the wanted speed rises, rad/s2 (default: at once)"
    )
    speed_gradient: bool = option(
        "swing the rotor across the resonance by the speed-gradient method"
    )
    filter_time: float | None = option("of it, s (default: 30/omega)")
    low: float | None = option("part of the voltage while slower than the mean (default: 0.6)")

    def make_controller(self, structure: Structure, drive: Drive) -> Controller | None:
        """Return the controller that the options describe; None if they ask for none."""
        from ..weak_drive import own_resonance
        from ..weak_drive.controllers import SpeedControl, SpeedGradient
        from ..weak_drive.couple import require_motor

        chosen = self.one_of(*CONTROLS) or ""
        given = self.given(OfController)
        for needed, names in CONTROLS.items():
            for name in names if needed != chosen else ():
                if name in given:
                    expected = f"expected {option_names([needed])} with it"
                    raise InputError(f"{option_names([name])} {given[name]:g}: {expected}")
        own = {name.removeprefix("speed_"): given[name] for name in given if name not in CONTROLS}
        require_motor(structure, drive)
        constant = drive.motor_constant
        if chosen == "speed_control":
            slow = drive.rotor_inertia * drive.armature_resistance / constant**2
            usual = {"gain": 5.0 * constant, "reset_time": slow, "rise": math.inf}
            return SpeedControl(speed=given["speed_control"], **{**usual, **own})
        if chosen == "speed_gradient":
            passed = own_resonance.dividing_speed(structure, drive) * structure.omega
            swing = {"filter_time": 30.0 / structure.omega, "low": 0.6, **own}
            return SpeedGradient(passed=passed, **swing)
        return None


# -- structure and motor --------------------------------------------------------------------------


def check_masses(source: str, changes: Mapping[str, Any]) -> None:
    """Raise if a beam's frequencies are set but its masses are not: the motor feels them."""
    unknown = {"m1", "m2"} - changes.keys() - ({"m2"} if "mu" in changes else set())
    named = next((name for name in ("f1", "f2") if name in changes), None)
    if named and unknown and source in ("paper", "quick"):
        raise InputError(
            f"--set {named}={changes[named]:g}: the motor feels the masses, and those of {source} "
            "are no beam's; expected --set m1=KG --set m2=KG too, or a --structure with them"
        )


# -- voltages and controllers ----------------------------------------------------------------------


def times_in_seconds(arguments: Any, structure: Structure, *names: str) -> dict[str, float | None]:
    """Convert options in 1/omega, such as ``--step``, to s; return a dict, None where not given."""
    values = {name: getattr(arguments, name) for name in names}
    omega = structure.omega
    return {name: None if time is None else time / omega for name, time in values.items()}


# -- answers --------------------------------------------------------------------------------------


class Driven(Command):
    """A command that asks for each structure, or for both at once."""

    @abstractmethod
    def ask(self) -> tuple[Structure, Drive, Question]:
        """Return structure, drive and keywords of the public function."""

    @abstractmethod
    def summary(self, results: Runs) -> Iterable[str]:
        """Return the lines that are printed of the results."""

    @abstractmethod
    def words(self, results: Runs, question: Question) -> str:
        """Return a part of the picture's title."""

    def draw(self, results: Runs, title: str) -> Any:
        import orchestrate

        return orchestrate.plot(*results.values(), title=title)

    def __call__(self) -> None:
        """Ask, print the summary, write results and picture."""
        import orchestrate

        structure, drive, question = self.ask()
        base, results = self.drive_result_name(structure, drive, question), {}
        has_both = hasattr(self, "only")
        states = self.structures_by_name(structure) if has_both else {"": structure}
        names = {state: f"{base}_{state}" if state else base for state in states}
        files = {state: Files.from_options(self, name) for state, name in names.items()}
        function = getattr(orchestrate, self.calls)
        for state, chosen in states.items():
            running = self.running(files[state].result)
            results[state] = function(chosen, drive, **question, **running)
        asked, shown = self.display(results)
        print(*self.summary(shown), sep="\n")
        self.print_units_note(*shown.values())
        for state, data in asked.items():
            files[state].write(data)
        title = self.picture_title(shown, self.words(shown, question))
        picture = self.common_files(base, files.values())
        picture.write_pictures(lambda: self.draw(shown, title))


def format_title(runs: Runs, control: Controller | None = None) -> str:
    """Format a part of a picture's title: the runs' voltages, rate and controller."""
    import numpy as np

    changes = [
        np.abs(np.diff(data.voltage.values) / np.diff(data.time.values)) for data in runs.values()
    ]
    rates, volts = np.concatenate(changes), np.concatenate([data.voltage for data in runs.values()])
    rate = float(np.median(rates[rates > 0.0])) if (rates > 0.0).any() else 0.0
    low, high = float(volts.min()), float(volts.max())
    ends = f"{high:.4g} V" if low == high else f"{low:.4g} V to {high:.4g} V"
    moving = f", {rate:.2g} V/s" if rate and not control else ""
    return f"{ends}{moving}{f', {type(control).__name__}' if control else ''}"
