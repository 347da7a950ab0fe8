"""Options and steps of the commands on the weak drive: motor, voltage, controller."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import orchestrate

from ..constants import TURN
from ..errors import InputError
from ..lazy import xr
from ..model import Drive, Structure
from ..model.drive import motor_constant_and_resistance
from ..units import Units
from . import grammar
from .answer import FunctionCommand, Runs
from .command import Keywords, Options, option, option_names
from .notes import warn_of_unusual_voltage
from .options import Over, print_assumptions

if TYPE_CHECKING:
    from ..weak_drive.controllers import Controller
    from ..weak_drive.schedule import Schedule

USUAL = {"quick": ((1.2, 1.65), 1e-4), "beam": ((1.25, 1.6), 5e-6), "rig": ((0.95, 1.24), 5e-5)}
USUAL_RATES = ", ".join(f"{rate:g} for {name}" for name, (_, rate) in USUAL.items())
RATE = 1e-4  # of eta0, in a time 1/omega
CONTROLS = {  # options of controllers, with their settings
    "speed_control": ("gain", "reset_time", "speed_rise"),
    "speed_gradient": ("filter_time", "low"),
}
POSITIVE: Any = {"read": grammar.parse_positive_number}
DATASHEET = ("rated_voltage", "no_load_rpm", "stall_torque")


class OfMotor(Options):
    """Options of structure, motor and box."""

    heading, rank = "structure, motor and box", 0
    drive: str = option(
        "TOML file with [motor], [box] and [structure], or a set: quick (no real one: jumps come "
        "soon), beam (some kg on a small motor), rig (near the paper's)",
        "quick",
        "SET|FILE",
    )
    structure: Any = option(
        "file or set with another [structure] than that of --drive", value="SET|FILE"
    )
    set: list[str] = option(
        "a parameter of the structure, or of motor and box in SI; may be repeated",
        (),
        "NAME=VALUE",
    )
    rated_voltage: float | None = option(
        "of the motor, V: by its datasheet, all three in place of motor_constant and "
        "armature_resistance",
        value="V",
        **POSITIVE,
    )
    no_load_rpm: float | None = option("its speed without load", value="RPM", **POSITIVE)
    stall_torque: float | None = option("its torque at rest, N m", value="N.M", **POSITIVE)

    def read_structure_and_drive(self) -> tuple[Structure, Drive]:
        drive = Drive.from_file(self.drive)
        source = self.structure or self.drive
        structure = Structure.from_file(source)
        if self.drive == "quick" and structure.omega > 10.0:  # that motor turns at 1.5 rad/s
            raise InputError(
                "--drive is missing: the motor of the set quick is far too slow for "
                f"{structure.omega:.4g} rad/s; expected --drive beam, rig, or a file with [motor]"
            )
        changes, of_drive = grammar.parse_changes(self.set), {field.name for field in fields(Drive)}
        motor = {name: float(changes.pop(name)) for name in list(changes) if name in of_drive}
        motor |= self.motor_from_datasheet(motor)
        named = next((name for name in ("f1", "f2") if name in changes), None)
        unknown = {"m1", "m2"} - changes.keys() - ({"m2"} if "mu" in changes else set())
        if named and unknown and source in ("paper", "quick"):
            text = f"--set {named}={changes[named]:g}: the motor feels the masses, and those of"
            expected = "expected --set m1=KG --set m2=KG too, or a --structure with them"
            raise InputError(f"{text} {source} are no beam's; {expected}")
        changed = structure.replace(**changes)
        print_assumptions(changed, source, changes)
        return changed, drive.replace(**motor)

    def motor_from_datasheet(self, changes: Mapping[str, float]) -> dict[str, float]:
        """Return motor constant and resistance from the datasheet's options; empty without them."""
        given = {name: getattr(self, name) for name in DATASHEET if getattr(self, name) is not None}
        names = "motor_constant", "armature_resistance"
        if not given:
            return {}
        if missing := [name for name in DATASHEET if name not in given]:
            name, value = next(iter(given.items()))
            text = f"{option_names([name])} {value:g}: without {option_names(missing[:1])}"
            raise InputError(f"{text}; expected {option_names(DATASHEET)} together")
        if twice := [name for name in names if name in changes]:
            text = f"--set {twice[0]}={changes[twice[0]]:g}: given with --rated-voltage"
            raise InputError(f"{text}; expected one of them")
        voltage, rpm, torque = given.values()
        values = motor_constant_and_resistance(voltage, TURN * rpm / 60.0, torque)
        return dict(zip(names, values, strict=True))


class Stepped(Options):
    """The option of the communication step."""

    step: float | None = option(
        "communication step, in 1/omega (default: controlled by its defect, at most 0.4; 0.1 where "
        "a controller or a picture takes samples)"
    )


class OfRamp(Options):
    """Options of two voltages."""

    heading, rank = "the motor's voltage", 1
    eta0: str | None = option(
        "voltage as no-load speed over omega (default: from below the resonance to past the jump "
        "up, by the averaged theory)",
        value="FIRST:LAST",
    )
    voltage: str | None = option("the same in V", value="FIRST:LAST")

    def parse_voltages(self, structure: Structure, drive: Drive) -> tuple[float, ...]:
        """Return one voltage or a ramp's first and last one, V; by default around the jumps."""
        from ..weak_drive.couple_all import default_eta0_range

        self.given_option("eta0", "voltage")
        volts = drive.volts(structure)
        for name, unit in (("voltage", 1.0), ("eta0", volts)):
            if text := getattr(self, name):
                given = tuple(unit * one for one in grammar.parse_number_or_ends(f"--{name}", text))
                warn_of_unusual_voltage(f"--{name} {text}", given, volts)
                if abs(given[-1]) < abs(given[0]):
                    print(f"--{name} {text}: the voltage falls first, and rises when it comes back")
                return given
        if self.set or self.structure or self.rated_voltage or self.drive not in USUAL:
            first, last = default_eta0_range(structure.as_bonded(), drive)
        else:
            first, last = USUAL[self.drive][0]
        return first * volts, last * volts


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
    hold: float | None = option(
        "longest time for which a voltage is held until the speed settles, 0 for none, in 1/omega "
        "(default: 4000 and 200 times the rotor's own)",
        value="TIME",
    )

    def make_schedule(self, structure: Structure, drive: Drive, control: Any) -> Schedule:
        from ..weak_drive.couple import schedule_from_arguments
        from ..weak_drive.schedule import Course

        if self.course:
            for name in ("eta0", "voltage", "duration"):
                self.given_option("course", name)
            return Course.from_csv(self.course)
        ends = self.parse_voltages(structure, drive)
        if (len(ends) == 1) != (self.duration is not None):
            given = " to ".join(f"{end:g}" for end in ends)
            expected = "expected --duration, in s, with one voltage and only so"
            raise InputError(f"voltage {given} V: {expected}")
        volts = drive.volts(structure)
        if (chosen := self.given_option("rate", "volt_rate")) is None:
            rate = USUAL[self.drive][1] if self.drive in USUAL else RATE
        else:
            rate = grammar.parse_single_rate(option_names([chosen]), getattr(self, chosen))
        ramp: Any = {
            "rate": rate if chosen == "volt_rate" else volts * structure.omega * rate,
            "settle": self.settle / structure.omega,
            "increment": self.increment * volts,
            "back": not self.one_way,
            "spin_up": 0.0 if control else None,
        }
        voltage = ends if len(ends) == 2 else ends[0]
        return schedule_from_arguments(structure, drive, voltage, self.duration, **ramp)


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
        from ..weak_drive import own_resonance

        chosen = self.given_option(*CONTROLS) or ""
        given = self.given_options(OfController)
        owners = {name: [control] for control, names in CONTROLS.items() for name in names}
        self.refuse_without(owners, [chosen])
        own = {name.removeprefix("speed_"): given[name] for name in given if name not in CONTROLS}
        constant = drive.motor_constant
        if chosen == "speed_control":
            slow = drive.rotor_inertia * drive.armature_resistance / constant**2
            usual = {"gain": 5.0 * constant, "reset_time": slow, "rise": math.inf}
            return orchestrate.SpeedControl(speed=given["speed_control"], **{**usual, **own})
        if chosen == "speed_gradient":
            passed = own_resonance.dividing_speed(structure, drive) * structure.omega
            swing = {"filter_time": 30.0 / structure.omega, "low": 0.6, **own}
            return orchestrate.SpeedGradient(passed=passed, **swing)
        return None


class DriveCommand(OfMotor, FunctionCommand):
    """A command on a structure with its motor, in a picture with a title of its own."""

    def picture_title(self, results: Runs) -> str:
        from ..show.labels import title_from_attributes

        structure = title_from_attributes(list(results.values())[-1])  # delaminated, if it is there
        return f"{', '.join(self.source_file_stems())}: {structure}"

    def draw(self, results: Runs, question: Keywords, *_: xr.Dataset) -> Any:
        if not self.drive:  # spectra without a motor
            return super().draw(results, question)
        return orchestrate.plot(*results.values(), title=self.picture_title(results))

    def display_units(self, question: Keywords) -> Units:
        """Return the display units; rpm by default if the motor's speed is in rpm."""
        if not self.drive:
            return super().display_units(question)
        return self.read_units().with_defaults(Units("rpm" if self.no_load_rpm else ""))

    def read_question(self) -> tuple[Any, ...]:
        from ..weak_drive.couple import require_motor

        structure, drive = self.read_structure_and_drive()
        times = [name for name in ("step", "hold") if name in self.options()]
        question = {**self.function_keywords(), **self.options_in_seconds(structure, *times)}
        if isinstance(self, OfRamp):
            require_motor(structure, drive)
        if isinstance(self, OfController):
            question["control"] = self.make_controller(structure, drive)
        if isinstance(self, OfSchedule):
            question["voltage"] = self.make_schedule(structure, drive, question["control"])
        elif isinstance(self, OfRamp):
            question["voltage"] = ends = self.parse_voltages(structure, drive)
            if len(ends) != 2:
                name = "voltage" if self.voltage else "eta0"
                grammar.parse_ends(f"--{name}", getattr(self, name))
        if isinstance(self, Over):
            question |= self.over_arguments()
        return structure, drive, question

    def options_in_seconds(self, structure: Structure, *names: str) -> Keywords:
        """Return options in 1/omega, such as ``--step``, in s; None where they are not given."""
        times = {name: getattr(self, name) for name in names}
        return {n: None if time is None else time / structure.omega for n, time in times.items()}
