"""Run structure and motor FMUs under a varying voltage; report where the speed jumps."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import ClassVar, get_type_hints

import numpy as np

from ..errors import InputError
from ..lazy import Unpack, xr
from ..model.arguments import checked_list, checked_number
from ..model.drive import Drive
from ..model.ranges import checked_flag, checked_range
from ..model.structure import Structure
from ..response.labels import Variable, variable
from ..response.questions import checked_structure
from ..running.job import Fmus, Table, refuse_unsupported_structure
from ..running.options import Running
from . import averaged, own_resonance
from .controllers import Controller
from .growth import growth_rate
from .hysteresis import LOST, UNDECIDED, HysteresisLoop, HysteresisSettings, Jump
from .master import MAX_STEPS, Scheme
from .ramp_record import DONE, RampRecord, ramp_jump_variables, time_stays_above
from .revolutions import COLUMNS
from .run import MotorJob, motor_run_starter
from .schedule import Constant, Ramp, Schedule

DIRECTIONS = ("up", "down")
KINDS = ("bonded", "delaminated")  # of structures that runs compare
VERDICT = np.dtype([("up", bool), ("jump", [*get_type_hints(Jump).items()])])
MIRRORED = {  # where the motor turns backward
    *("jumps", "jump_low", "jump_high", "ramp_voltage", "jump_lag", "averaged_jumps"),
    *("jump_speed", "jump_speed_before", "jump_speed_after", "jump_rate"),
}


@dataclass(frozen=True)
class CoupleJob(MotorJob):
    """Run the coupled FMUs in chunks of steps; then decide about jumps by a hysteresis loop."""

    asked: ClassVar[str] = "couple"
    hysteresis: HysteresisSettings = field(default_factory=HysteresisSettings)

    def run_all_chunks(self, fmus: Fmus) -> Table:
        *chunks, _ = self.chunks()
        tables: list[Table] = []
        for chunk in chunks:
            previous = tables[-1] if tables else None
            tables.append(self.work(fmus, range(chunk.start, chunk.stop), previous))
        table = {name: np.concatenate([part[name] for part in tables]) for name in tables[0]}
        return {**table, **self.compute_from_all_steps(fmus, table)}

    def progress_note(self, first: int) -> str:
        return "voltages held at jumps" if first == self.step_count() else ""

    def compute_from_all_steps(self, fmus: Fmus, table: Table) -> Table:
        if self.control is not None:
            return {"verdicts": np.array([], VERDICT)}
        with motor_run_starter(fmus) as start:
            volts = RampRecord(self, table, True).rotation_sense * self.drive.volts(self.structure)
            loop = HysteresisLoop(
                lambda schedule: start(replace(self, schedule=schedule)),
                self.schedule,
                step=self.scheme.h,
                omega=self.structure.omega,
                volts=volts,
                max_hold=self.hold,
                settings=self.hysteresis,
                growth=growth_rate,
            )
            loop.add_checkpoints(table, self.chunk_size, self.step_count())
            verdicts = [
                (up, tuple(jump))
                for up in (True, False)
                for jump in loop.decide_jumps(RampRecord(self, table, up))
            ]
        return {"verdicts": np.array(verdicts, VERDICT)}

    def jumps_by_direction(self, table: Table) -> list[list[Jump]]:
        """Return the jumps of both directions; the first sure one stands for all."""
        verdicts = table["verdicts"]
        each = (verdicts["jump"][verdicts["up"] == up].tolist() for up in (True, False))
        return [sorted(map(Jump._make, one), key=lambda jump: jump.outcome != LOST) for one in each]

    def dataset(self, table: Table) -> xr.Dataset:
        if not len(table["time"]):
            raise InputError(
                f"the motor completed no revolution in {self.schedule.duration:g} s: "
                "raise the voltage or the duration"
            )
        variables = {n: variable("revolution", table[n], *text) for n, text in COLUMNS.items()}
        eta0 = table["voltage"] / self.drive.volts(self.structure)
        Omega = table["speed"] / self.structure.omega
        texts = {
            "revolution": (np.arange(1, len(eta0) + 1), "1", "revolution of the motor"),
            "eta0": (eta0, "1", "no-load speed over omega, U/(K omega)"),
            "Omega": (Omega, "1", "mean speed over omega"),
        }
        coordinates = {name: variable("revolution", *text) for name, text in texts.items()}
        threshold = own_resonance.dividing_speed(self.structure, self.drive)
        text = "time from which the mean speed stays beyond the resonance; NaN where it does not"
        passed = time_stays_above(table["time"], np.abs(Omega), threshold)
        variables["passage_time"] = variable((), passed, "s", text)
        labels, jump_columns = self.jump_labels_and_variables(table)
        names = {"long_name": "direction in which the speed jumps; further jumps are numbered"}
        coordinates["jump"] = ("jump", np.array(labels), names)
        motor = float(table["motor"][-1])
        attributes = {
            "title": f"Weak drive, {self.structure.kind} structure: each revolution of the motor",
            "missing_over_motor_work": float(table["missing"][-1]) / motor,
            "defects_over_motor_work": float(table["defect_sizes"][-1]) / motor,
        }
        return xr.Dataset({**variables, **jump_columns}, coordinates, attributes)

    def jump_labels_and_variables(self, table: Table) -> tuple[list[str], dict[str, Variable]]:
        records = [RampRecord(self, table, up) for up in (True, False)]
        each = list(zip(DIRECTIONS, self.jumps_by_direction(table), records, strict=True))
        first = [(jumps[0] if jumps else None, record) for _, jumps, record in each]
        further = [(jump, record) for _, jumps, record in each for jump in jumps[1:]]
        numbered = [f"{way} {i + 1}" for way, jumps, _ in each for i in range(1, len(jumps))]
        every, records_of = zip(*first, *further, strict=True)
        shown = [
            record.row_positions_of_jump(*jump[1:]) if jump else [math.nan] * len(DONE)
            for jump, record in zip(every, records_of, strict=True)
        ]
        columns = ramp_jump_variables(records[0].forward_table(), shown)
        volts = self.drive.volts(self.structure)
        lows = np.array([volts * jump.low if jump else math.nan for jump in every])
        highs = np.array([volts * jump.high if jump else math.nan for jump in every])
        lost = [jump is not None and jump.outcome == LOST for jump in every]
        middles = np.where(lost, 0.5 * (lows + highs), math.nan)
        late = columns["ramp_voltage"][1] - middles
        texts = {
            "jumps": (middles, "voltage at which the motion is lost, whatever the ramp's rate"),
            "jump_low": (lows, "last held voltage at which the motion stays"),
            "jump_high": (highs, "first at which it is lost, or may be"),
            "jump_lag": (late, "how late the ramp shows the jump"),
        }
        columns |= {n: variable("jump", values, "V", text) for n, (values, text) in texts.items()}
        columns |= self.theory_variables(len(every))
        for name in MIRRORED & columns.keys() if records[0].rotation_sense < 0.0 else ():
            dims, values, attributes = columns[name]
            columns[name] = (dims, np.negative(values), attributes)
        how = [self.explain_decision(*pair) for pair in zip(every, records_of, strict=True)]
        decided, why = (np.array(parts) for parts in zip(*how, strict=True))
        columns["decided"] = ("jump", decided, {"long_name": "how jump or none was decided"})
        columns["no_jump"] = ("jump", why, {"long_name": "why there is no jump"})
        return [*DIRECTIONS, *numbered], columns

    def explain_decision(self, jump: Jump | None, record: RampRecord) -> tuple[str, str]:
        """Return how a jump or none was decided, and why there is none."""
        if jump is not None and jump.outcome == UNDECIDED:
            volts = record.rotation_sense * self.drive.volts(self.structure)
            low, high = volts * jump.low, volts * jump.high
            return "undecided", (
                f"undecided between {low:.5g} and {high:.5g} V: voltages held for at most "
                f"{self.hold:.4g} s do not tell; a longer hold may"
            )
        if jump is not None:
            return "by held voltages", ""
        if self.control is not None:
            return "", "a controller sets the voltage"
        if not record.rows_by_leg():
            return "", f"the voltage does not {'rise' if record.up else 'fall'}"
        return "by held voltages", "no jump: held voltages lead back to the same speeds"

    def theory_variables(self, count: int) -> dict[str, Variable]:
        """Build the variables of where averaged theory loses the bonded structure's motion."""
        if not self.structure.bonded:
            return {}
        points = averaged.stability_limits(self.structure, self.drive)
        volts = self.drive.volts(self.structure)
        ends = [volts * point.eta0 if point else math.nan for point in points]
        kinds = [point.kind if point else "" for point in points]
        more = count - len(points)
        text = "voltage at which the motion is lost, by the averaged theory"
        return {
            "averaged_jumps": variable("jump", ends + [math.nan] * more, "V", text),
            "averaged_kind": ("jump", kinds + [""] * more, {"long_name": "how it is lost there"}),
        }


def require_motor(structure: Structure, drive: Drive) -> None:
    refuse_unsupported_structure("a motor", checked_structure(structure))
    if not isinstance(drive, Drive):
        raise InputError(f"drive = {drive!r}: expected a Drive, such as Drive.from_file('quick')")
    if not drive.motor_constant > 0.0:
        raise InputError(f"motor_constant = {drive.motor_constant} N.m/A: expected a number > 0")


def schedule_from_arguments(
    structure: Structure,
    drive: Drive,
    voltage: float | tuple[float, float] | Schedule,
    duration: float | None = None,
    rate: float | None = None,
    settle: float | None = None,
    increment: float = 0.0,
    back: bool = True,
    spin_up: float | None = None,
) -> Schedule:
    require_motor(structure, drive)
    if isinstance(voltage, Schedule):
        return voltage
    ends = checked_list("voltage", voltage)
    if len(ends) > 2:
        raise InputError(f"voltage = {voltage!r}: expected a number or (first, last), in V")
    if (duration is None) == (len(ends) == 1):
        raise InputError(
            f"voltage = {voltage!r} V and duration = {duration} s: expected a number and a "
            "duration, or (first, last) and a rate"
        )
    if duration is not None:
        return Constant(ends[0], checked_number("duration", duration))
    omega, volts = structure.omega, drive.volts(structure)
    rate = 1e-4 * volts * omega if rate is None else checked_number("rate", rate)
    settle = 300.0 / omega if settle is None else checked_number("settle", settle)
    increment = checked_number("increment", increment)
    first, last = ends
    low = 0.9 * own_resonance.lower_and_higher_resonance(structure, drive)[0] * volts
    sense = math.copysign(1.0, last)
    if spin_up is None:  # a run up begins on the branch below the resonance
        spin_up = 600.0 / omega if sense * last > sense * first > low / 0.9 else 0.0
    ramp = Ramp(first, last, rate, settle, increment, checked_flag("back", back))
    spin_up = checked_number("spin_up", spin_up)
    return replace(ramp, spin_up=spin_up, low=sense * low) if spin_up else ramp


def scheme_from_arguments(
    structure: Structure, step: float | None, tolerance: float | None = None, sampled: bool = False
) -> Scheme:
    omega = structure.omega
    if tolerance is None:
        # of the displacements errors are about half as large
        tolerance = 1e-7 if step is None else 0.0
    tolerance = checked_number("tolerance", tolerance)
    if step is None:
        step = (0.4 if tolerance and not sampled else 0.1) / omega
    step, rounding = checked_number("step", step), 1.0 + 1e-12
    if not 1e-4 / rounding <= step * omega <= rounding:
        raise InputError(f"step = {step} s: expected {1e-4 / omega:g} <= step <= {1.0 / omega:g}")
    return Scheme(step, tolerance)


def make_couple_job(
    structure: Structure,
    drive: Drive,
    schedule: Schedule,
    scheme: Scheme,
    speed_start: float | None = None,
    control: Controller | None = None,
    hold: float | None = None,
    hysteresis: HysteresisSettings | None = None,
) -> CoupleJob:
    if control is not None and not isinstance(control, Controller):
        raise InputError(f"control = {control!r}: expected SpeedControl(...), SpeedGradient(...)")
    steps = schedule.duration / scheme.h
    if not steps > 1e-9:
        raise InputError(
            f"duration = {schedule.duration:g} s: expected one communication step or more, "
            f"duration >= {scheme.h:g}"
        )
    if not steps <= MAX_STEPS:
        raise InputError(
            f"{steps:.2g} steps of {scheme.h:g} s in {schedule.duration:g} s: "
            f"expected at most {MAX_STEPS:g}"
        )
    if speed_start is None:
        at_rest = control is not None
        speed_start = 0.0 if at_rest else schedule.voltage(0.0) / drive.motor_constant
    checked_range("speed_start", speed_start, "rad/s")
    hysteresis = HysteresisSettings() if hysteresis is None else hysteresis
    if not isinstance(hysteresis, HysteresisSettings):
        raise InputError(f"hysteresis = {hysteresis!r}: expected HysteresisSettings(...)")
    hold = hysteresis.usual_hold(structure, drive) if hold is None else hold
    checked_range("hold", hold, "s", low=0.0, high=MAX_STEPS * scheme.h)
    run = (structure, drive, schedule, scheme, float(speed_start), float(hold), control)
    return CoupleJob(f"couple_{structure.kind}", *run, hysteresis)


def couple(
    structure: Structure,
    drive: Drive,
    *,
    voltage: float | tuple[float, float] | Schedule,
    duration: float | None = None,
    rate: float | None = None,
    back: bool = True,
    increment: float = 0.0,
    settle: float | None = None,
    spin_up: float | None = None,
    speed_start: float | None = None,
    control: Controller | None = None,
    hold: float | None = None,
    hysteresis: HysteresisSettings | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Couple a structure with a motor of limited power, and take the voltage up and down.

    Two FMUs exchange box acceleration and force, see ``docs/coupling.md``; each revolution of the
    motor is one row of the result. Where the motor passes the resonance its speed jumps (Sommerfeld
    effect).

    Parameters
    ----------
    structure : Structure
    drive : Drive
    voltage : float, (float, float) or Schedule
        V. A number is held for ``duration``; two are the ends of a ramp.
    duration : float, optional
        Of a constant voltage, s.
    rate : float, optional
        Of the ramp, V/s; on average where it goes in steps. By default the no-load speed changes by
        1e-4 omega in a time 1/omega, which is 1e-4 K omega^2.
    back : bool
        Whether the ramp comes back to the first voltage.
    increment : float
        Height of steps instead of a ramp, V; 0 for a ramp.
    settle : float, optional
        Time at the first voltage before the ramp, s; 300/omega by default.
    spin_up : float, optional
        Time before that in which the voltage rises from below the resonance to the first one, s;
        by default 600/omega where a run up would begin beyond the resonance otherwise and no
        ``speed_start`` is given, else 0.
    speed_start : float, optional
        Speed of the motor at the start, rad/s; by default its no-load speed at the first voltage,
        with a controller 0.
    control : Controller, optional
        :class:`orchestrate.SpeedControl` or :class:`orchestrate.SpeedGradient`: takes a part of
        ``voltage``, once a communication step, by the speed. There are no jumps to be found then;
        ``passage_time`` says whether the motor has passed the resonance.
    hold : float, optional
        Longest time for which a voltage is held until the speed settles, s; (4000 + 200/b)/omega by
        default, 1/b being the time in which the rotor settles. A jump that is undecided may need
        more. With 0 no voltage is held, and all ramps are undecided.
    hysteresis : HysteresisSettings, optional
        Steps and thresholds of the rule that decides about jumps, of
        :mod:`orchestrate.weak_drive.hysteresis`.
    step : float, optional
        Communication step, s. By default its defect controls it, up to 0.4/omega; with a controller
        up to 0.1/omega.
    tolerance : float, optional
        Of the control: a step is halved when its energy defect exceeds this fraction of the work
        exchanged in it, and lengthened again when the defect falls well below. By default 1e-7, or
        0 (no control) if ``step`` is given.
    **running
        ``jobs``, ``cluster``, ``progress``, ``store`` and so on, see
        :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Dimension ``revolution``: ``time`` (s), ``voltage`` (V), ``speed`` (rad/s), ``amplitude``
        and ``box_amplitude`` (m), ``box_acceleration`` (m/s2), ``impacts``, energies since the
        start (J), and the numbers ``eta0`` = U/(K omega) and ``Omega`` = speed/omega. From
        ``passage_time`` (s) on the speed stays beyond the resonance.

        Dimension ``jump``: "up" and "down", the first sure jump in each direction, then further
        ones as "up 2". ``jumps`` (V): the voltage at which the motion is lost, whatever the rate;
        NaN where there is no jump or it is undecided. ``jump_low`` and ``jump_high`` (V): its
        bracket, or that in which it is undecided. ``decided`` says how: "by held voltages", or
        "undecided"; ``no_jump`` says why there is no jump.
        ``ramp_voltage`` (V), ``jump_time`` (s), ``jump_speed`` (rad/s), speed and amplitude before
        and after, and ``jump_rate`` (V/s) are what the ramp shows, ``jump_lag`` (V) by how much
        later; NaN where it ends before. For a bonded structure ``averaged_jumps`` (V) and
        ``averaged_kind``: where the averaged theory loses the motion, by a fold or a Neimark-Sacker
        point.

    Raises
    ------
    InputError
        Where an argument is not what is expected, or the motor has not turned once.

    Notes
    -----
    A ramp's jump comes late, about as rate^(2/3). The rule that decides about jumps is that of
    :mod:`orchestrate.weak_drive.hysteresis`: the state at the beginning of each ramp is restored,
    and voltages are held over all of it.

    Examples
    --------
    >>> from orchestrate import Drive, Structure, couple
    >>> structure = Structure.from_file("quick")
    >>> drive = Drive.from_file("quick")
    >>> run = couple(structure, drive, voltage=1.5, duration=150.0, progress=False)
    >>> run.sizes["revolution"] > 25, float(run.impacts[-1]) >= 1.0
    (True, True)
    >>> bool(abs(run.missing[-1]) < 1e-6 * run.motor[-1])
    True
    """
    from ..fmu.exported import make_fmu_finder
    from ..running.runner import compute_dataset

    if spin_up is None and speed_start is not None:
        spin_up = 0.0
    settings = (duration, rate, settle, increment, back, spin_up)
    schedule = schedule_from_arguments(structure, drive, voltage, *settings)
    scheme = scheme_from_arguments(structure, step, tolerance, control is not None)
    more = (speed_start, control, hold, hysteresis)
    job = make_couple_job(structure, drive, schedule, scheme, *more)
    return compute_dataset(job, running, make_fmu_finder(running))
