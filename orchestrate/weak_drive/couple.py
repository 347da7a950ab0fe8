"""Run structure and motor FMUs under a varying voltage and report where the speed jumps.

The steps of a run follow each other. It is cut into chunks; each hands over the states of both FMUs
and of the master, so an interrupted run goes on with the same bits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..access.instance import Instance
from ..access.models import OSCILLATOR, SHAKER
from ..errors import InputError
from ..response.labels import Variable, flags
from ..running.job import Chunk, Inputs, Table
from ..running.options import Running
from ..structures.drive import Drive
from ..structures.structure import Structure
from . import averaged, own_resonance
from .controllers import Controller
from .held import (
    FOLLOWS,
    MEANINGS,
    NOT_ASKED,
    UNDECIDED,
    HeldCourse,
    HeldVoltageTest,
    Verdict,
    with_final_chunk,
)
from .jump_verdicts import (
    averaged_predictions,
    check_against_theory,
    check_further,
    describe_decision,
    explain_no_jump,
)
from .jumps import JUMP, Passing, time_beyond_threshold
from .losses import (
    AT_END,
    MOST,
    SLOTS,
    THROUGH,
    Loss,
    drop_known_losses,
    empty_verdict_rows,
    further_jump_variables,
    gather_losses,
    is_crossed,
    loss_verdicts,
    pick_jump,
    verdicts_from_rows,
    verdicts_to_rows,
)
from .master import Scheme
from .ramp_record import UPWARD, RampRecord
from .revolutions import COLUMNS
from .run import CoupledRun, Run, begin_run
from .schedule import Constant, Ramp, Schedule, check

if TYPE_CHECKING:
    import xarray as xr
    from typing_extensions import Unpack

MAX_STEPS = 1e9  # more is a typing error: it would run for weeks
TOLERANCE = 1e-8  # of the step control: errors of the displacements are about ten times as large
LONGEST, FIXED = 0.4, 0.1  # steps with the control and without, in 1/omega
MIRRORED = {  # where the motor turns backward
    *("jumps", "jump_speed", "jump_speed_before", "jump_speed_after", "jump_rate", "jump_lag"),
    *("averaged_jumps", "held_jumps", "further_jumps", "further_held"),
}
HOLD, HOLD_OF_ROTOR = 4000.0, 200.0  # usual longest hold: in 1/omega, and in the rotor's time 1/b


@dataclass(frozen=True)
class CoupleJob(CoupledRun):
    """Run the coupled FMUs in chunks of steps; test doubtful jumps by holding voltages."""

    chunk_size: ClassVar[int] = 4_000
    sequential: ClassVar[bool] = True
    has_final_chunk: ClassVar[bool] = True
    item: ClassVar[str] = "step"

    def count(self) -> int:
        """Return the number of items: all communication steps and one held-voltage test."""
        return self.steps() + 1

    def items(self, inputs: Inputs) -> Sequence[int]:
        """Return the item indices: all communication steps, then the held-voltage test."""
        return range(self.count())

    def chunks(self) -> list[Chunk]:
        """Split the items into chunks; the held-voltage test is its own last chunk."""
        return with_final_chunk(super().chunks())

    def run_here(self, fmus: Mapping[str, Path]) -> Table:
        """Run all chunks one after the other in this process and join their tables."""
        chunks: list[Table] = []
        for chunk in self.chunks():
            previous = chunks[-1] if chunks else None
            if chunk.start == self.steps():
                previous = concatenate_tables(chunks)
            chunks.append(self.work(fmus, range(chunk.start, chunk.stop), previous))
        return concatenate_tables(chunks)

    def work(self, fmus: Mapping[str, Path], items: Sequence[int], previous: Table | None) -> Table:
        """Compute one chunk of communication steps, or the held-voltage test at the end."""
        return self.work_on(fmus, items, previous, self.chunk_size, lambda run: run.revolve(items))

    def work_on(
        self,
        fmus: Mapping[str, Path],
        items: Sequence[int],
        previous: Table | None,
        every: int,
        revolve: Callable[[Run], Table],
    ) -> Table:
        """Compute one chunk with a given stepping function and return its final state too."""
        if items[0] == self.steps():
            assert previous is not None
            nothing = {name: values[:0] for name, values in previous.items()}
            return {**nothing, **self.run_held_voltage_tests(fmus, previous, every)}
        with begin_run(self, fmus) as run:
            if previous is not None:
                run.set_state(previous)
            return {**revolve(run), **run.get_state(), **empty_verdicts()}

    def progress_note(self, first: int) -> str:
        """Return the progress bar's note for the chunk of the held-voltage test."""
        return "voltages held where a jump is in doubt" if first == self.steps() else ""

    def run_held_voltage_tests(self, fmus: Mapping[str, Path], table: Table, every: int) -> Table:
        """Hold voltages where the ramp's record leaves a jump in doubt; return verdicts."""
        record = RampRecord(self, table)
        doubts = [record.doubtful_passing(up) for up in UPWARD]
        places = [record.find_further_passings(up) for up in UPWARD]
        ends = [record.last_stretch(up, places[i]) for i, up in enumerate(UPWARD)]
        verdicts, further = [Verdict(NOT_ASKED)] * len(doubts), [empty_verdict_rows()] * len(doubts)
        if not any(doubts) and not any(places) and not any(ends):
            return pack_verdicts(verdicts, further)
        structure, drive = self.structure, self.drive
        threshold = own_resonance.dividing_speed(structure, drive)
        resonance = own_resonance.dividing_speeds(structure, drive)
        with Instance(fmus[OSCILLATOR]) as oscillator, Instance(fmus[SHAKER]) as shaker:

            def start_run(schedule: Schedule) -> Run:
                """Reset both FMU instances and start a run with another voltage schedule."""
                for instance in (oscillator, shaker):
                    instance.reset()
                return Run(replace(self, schedule=schedule), oscillator, shaker)

            units = (self.scheme.h, structure.omega, drive.volts(structure))
            test = HeldVoltageTest(start_run, self.schedule, *units, self.hold, sense=record.sense)
            test.add_checkpoints(table, every, self.steps())
            for i, doubt in enumerate(doubts):
                course = HeldCourse(Verdict(NOT_ASKED))
                if doubt is not None:
                    course = test.classify(*doubt, threshold, UPWARD[i], resonance)
                verdicts[i] = course.verdict
                results = self.run_further_tests(test, table, course, places[i], UPWARD[i])
                if stretch := ends[i]:
                    known = [*loss_verdicts(course), *(verdict for _, verdict in results)]
                    losses = test.losses_before_the_end(stretch, UPWARD[i])
                    losses = drop_known_losses(losses, known, drive.volts(structure))
                    results += [(AT_END, verdict) for verdict in losses]
                further[i] = verdicts_to_rows(results)
        return pack_verdicts(verdicts, further)

    def run_further_tests(
        self,
        test: HeldVoltageTest,
        table: Table,
        course: HeldCourse,
        places: Sequence[Passing],
        up: bool,
    ) -> list[tuple[int, Verdict]]:
        """Hold voltages where the record suggests further jumps; return places and verdicts."""
        record = RampRecord(self, table)
        results = [(THROUGH, verdict) for verdict in course.further]
        known, volts = loss_verdicts(course), self.drive.volts(self.structure)
        sign = 1.0 if up else -1.0
        crossed = sorted(known, key=lambda verdict: sign * verdict.low)
        forward = record.forward()
        Omega = np.abs(table["speed"]) / self.structure.omega
        for place, passing in enumerate(places[:MOST]):
            ends = [passing.before, passing.after]
            if passing.look == JUMP and not self.structure.bonded:
                continue
            if is_crossed(crossed, forward["voltage"][ends], sign):
                crossed = crossed[1:]
                results.append((place, Verdict(NOT_ASKED)))  # the course has met what is seen here
                continue
            middle = float(Omega[ends].mean())
            held = test.for_suspected_jumps(record.end_voltage(up)).classify(
                *record.to_steps(record.begin_earlier(passing, up), up), middle, up
            )
            new_verdicts = drop_known_losses(loss_verdicts(held), known, volts)
            known += new_verdicts
            results += [(place, verdict) for verdict in new_verdicts or [Verdict(FOLLOWS)]]
        return results

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Build the dataset of all revolutions, of the jumps and of their verdicts."""
        import xarray as xr

        if not len(table["time"]):
            raise InputError(
                f"the motor completed no revolution in {self.schedule.duration:g} s: "
                "raise the voltage or the duration"
            )
        variables: dict[str, Any] = {
            name: ("revolution", table[name], {"units": unit, "long_name": text})
            for name, (unit, text) in COLUMNS.items()
        }
        eta0 = table["voltage"] / self.drive.volts(self.structure)
        Omega = table["speed"] / self.structure.omega
        count = {"units": "1", "long_name": "revolution of the motor"}
        coordinates = {
            "revolution": ("revolution", np.arange(1, len(eta0) + 1), count),
            "eta0": (
                "revolution",
                eta0,
                {"units": "1", "long_name": "no-load speed over omega, U/(K omega)"},
            ),
            "Omega": ("revolution", Omega, {"units": "1", "long_name": "mean speed over omega"}),
        }
        threshold = own_resonance.dividing_speed(self.structure, self.drive)
        text = "time from which the mean speed stays beyond the resonance; NaN where it does not"
        passed = time_beyond_threshold(table["time"], np.abs(Omega), threshold)
        variables["passage_time"] = ((), passed, {"units": "s", "long_name": text})
        dataset = xr.Dataset(
            {**variables, **self.all_jump_variables(table)}, coordinates, self.attributes(table)
        )
        names = {"long_name": "direction in which the speed jumps"}
        places = {"units": "1", "long_name": "place of a further jump, in the ramp's order"}
        return dataset.assign_coords(
            jump=("jump", ["up", "down"], names),
            order=("order", np.arange(1, SLOTS + 1), places),
        )

    def all_jump_variables(self, table: Table) -> dict[str, Variable]:
        """Build the variables of the jump in each direction, or the reason for none.

        What happens to a motor that turns backward is told in a mirror, and its signs at the end.
        """
        record = RampRecord(self, table)
        table = record.forward()
        held = [Verdict(int(row[0]), *row[1:]) for row in table["verdicts"][-1]]
        theory = averaged_predictions(self.structure, self.drive)
        losses = [self.collect_losses(record, i, held[i]) for i in range(len(UPWARD))]
        jump_and_further = [
            pick_jump(*pair, 1.0 if up else -1.0) for pair, up in zip(losses, UPWARD, strict=True)
        ]
        jumps = [
            first.passing if first and first.is_sure else None for first, _ in jump_and_further
        ]
        final = [
            first.verdict if first else held[i] for i, (first, _) in enumerate(jump_and_further)
        ]
        columns = jump_variables(table, jumps)
        columns |= self.theory_variables(np.array(columns["jumps"][1], dtype=float))
        reasons = []
        for i, (first, _) in enumerate(jump_and_further):
            if first is None:
                reasons.append(record.explain_no_passing(UPWARD[i]))
            elif jumps[i] is None:
                ends = record.explain_short_sweep(UPWARD[i]) if held[i].outcome == UNDECIDED else ""
                said = held[i].mirrored(record.sense)
                reasons.append(ends or explain_no_jump(said, final[i], theory[i], self.hold))
            else:
                reasons.append("")
        decided = [
            describe_decision(first and first.passing, final[i])
            for i, (first, _) in enumerate(jump_and_further)
        ]
        columns["no_jump"] = ("jump", reasons, {"long_name": "why there is no jump"})
        columns["decided"] = ("jump", decided, {"long_name": "how jump or none was told"})
        columns |= further_jump_variables(table, [further for _, further in jump_and_further])
        columns |= held_voltage_variables(final)
        for name in MIRRORED & columns.keys() if record.sense < 0.0 else ():
            dims, values, attributes = columns[name]
            columns[name] = (dims, np.negative(values), attributes)
        return columns

    def collect_losses(
        self, record: RampRecord, i: int, primary: Verdict
    ) -> tuple[Loss | None, list[Loss]]:
        """Collect all losses of stability in a direction; that at the resonance first."""
        if self.control:
            return None, []
        up, volts, table = UPWARD[i], self.drive.volts(self.structure), record.forward()
        further = verdicts_from_rows(table["further_verdicts"][-1, i])
        if self.structure.bonded:
            theory = averaged_predictions(self.structure, self.drive)[i]
            primary = check_against_theory(primary, theory, volts)
            further = [(place, check_further(verdict, theory, volts)) for place, verdict in further]
        rows, places = record.sweep_leg(up)[1], record.find_further_passings(up)
        return gather_losses(table, rows, record.resonance_passing(up), primary, places, further)

    def theory_variables(self, jumps: np.ndarray) -> dict[str, Variable]:
        """Build the variables that compare bonded jumps with the averaged theory."""
        structure, volts = self.structure, self.drive.volts(self.structure)
        text = "how late the jump comes on the ramp, by the averaged theory (bonded only)"
        late = {"units": "V", "long_name": text}
        if not structure.bonded:
            return {"jump_lag": ("jump", [math.nan, math.nan], late)}
        points = averaged.stability_limits(structure, self.drive)
        ends = [volts * point.eta0 if point else math.nan for point in points]
        kinds = [point.kind if point else "" for point in points]
        text = "voltage at which the motion is lost, by the averaged theory"
        return {
            "averaged_jumps": ("jump", ends, {"units": "V", "long_name": text}),
            "averaged_kind": ("jump", kinds, {"long_name": "by what it is lost there"}),
            "jump_lag": ("jump", (jumps - ends).tolist(), late),
        }

    def attributes(self, table: Table) -> dict[str, str | float]:
        """Return the dataset's title and the relative energy errors of the coupling.

        ``missing_over_motor_work`` is the energy defect of the master over the motor's work.
        """
        state = "bonded" if self.structure.bonded else "delaminated"
        motor = float(table["motor"][-1])
        return {
            "title": f"Weak drive, {state} structure: each revolution of the motor",
            "missing_over_motor_work": float(table["missing"][-1]) / motor,
            "defects_over_motor_work": float(table["defect_sizes"][-1]) / motor,
        }


def empty_verdicts() -> Table:
    """Return empty verdict arrays, for chunks that consist of communication steps."""
    return {
        name: values[:0]
        for name, values in pack_verdicts(
            [Verdict(NOT_ASKED)] * len(UPWARD), [empty_verdict_rows()] * len(UPWARD)
        ).items()
    }


def pack_verdicts(verdicts: Sequence[Verdict], further: Sequence[np.ndarray]) -> Table:
    """Pack the verdicts at the resonance and the further ones into arrays to store."""
    return {
        "verdicts": np.array(verdicts, dtype=float)[np.newaxis],
        "further_verdicts": np.array(further)[np.newaxis],
    }


def concatenate_tables(tables: Sequence[Table]) -> Table:
    """Join the tables of successive chunks."""
    return {name: np.concatenate([part[name] for part in tables]) for name in tables[0]}


def held_voltage_variables(verdicts: Sequence[Verdict]) -> dict[str, Variable]:
    """Build the variables of the held-voltage verdicts and of the voltage brackets."""
    codes = [int(verdict.outcome) for verdict in verdicts]
    middles = [0.5 * (verdict.low + verdict.high) for verdict in verdicts]
    errors = [0.5 * abs(verdict.high - verdict.low) for verdict in verdicts]
    text = "voltage at which the motion is lost though it is held; where held voltages decide"
    half = "half the bracket of that voltage, between staying and lost"
    return {
        "held_verdict": flags("jump", codes, "what held voltages say of the motion", MEANINGS),
        "held_jumps": ("jump", middles, {"units": "V", "long_name": text}),
        "held_error": ("jump", errors, {"units": "V", "long_name": half}),
    }


def jump_variables(table: Table, jumps: Sequence[Passing | None]) -> dict[str, Variable]:
    """Build the variables of voltage, time, speed and amplitude at each jump."""

    def interpolated(name: str, row_name: str) -> list[float]:
        """Interpolate one column of the table at each jump; NaN without a jump."""
        values = table[name]
        return [
            math.nan
            if jump is None
            else float(np.interp(getattr(jump, row_name), np.arange(len(values)), values))
            for jump in jumps
        ]

    def rate(jump: Passing | None) -> float:
        """Return the mean rate of the voltage across a jump, V/s."""
        if jump is None:
            return math.nan
        ends = [jump.before, jump.after]
        return float(np.diff(table["voltage"][ends])[0] / np.diff(table["time"][ends])[0])

    wanted = {
        "jumps": ("voltage", "half", "V", "voltage at which the speed jumps"),
        "jump_time": ("time", "half", "s", "time of that voltage"),
        "jump_speed": ("speed", "row", "rad/s", "mean speed of that revolution"),
        "jump_speed_before": ("speed", "before", "rad/s", "mean speed where it leaves its branch"),
        "jump_speed_after": ("speed", "after", "rad/s", "mean speed after the jump"),
        "jump_amplitude_before": ("amplitude", "before", "m", "amplitude before the jump"),
        "jump_amplitude_after": ("amplitude", "after", "m", "amplitude after the jump"),
    }
    columns: dict[str, Variable] = {
        key: ("jump", interpolated(name, row_name), {"units": unit, "long_name": text})
        for key, (name, row_name, unit, text) in wanted.items()
    }
    text = "change of the voltage per time during the jump"
    rates = [rate(jump) for jump in jumps]
    return {**columns, "jump_rate": ("jump", rates, {"units": "V/s", "long_name": text})}


def require_motor(drive: Drive) -> None:
    """Raise an error if the drive has no motor constant."""
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
    """Build the voltage schedule from the arguments of :func:`couple`."""
    if isinstance(voltage, Schedule):
        return voltage
    try:
        ends = [float(value) for value in np.ravel(voltage)]
    except (TypeError, ValueError):
        ends = []
    if len(ends) not in (1, 2):
        raise InputError(f"voltage = {voltage!r}: expected a number or (first, last), in V")
    if (duration is None) == (len(ends) == 1):
        raise InputError(
            f"voltage = {voltage!r} V and duration = {duration} s: expected a number and a "
            "duration, or (first, last) and a rate"
        )
    if duration is not None:
        return Constant(ends[0], float(duration))
    omega, volts = structure.omega, drive.volts(structure)
    rate = 1e-4 * volts * omega if rate is None else rate
    settle = 300.0 / omega if settle is None else settle
    first, last = ends
    low, sense = (
        0.9 * own_resonance.resonances(structure, drive)[0] * volts,
        math.copysign(1.0, last),
    )
    if spin_up is None:  # a run up begins on the branch below the resonance
        spin_up = 600.0 / omega if sense * last > sense * first > low / 0.9 else 0.0
    ramp = Ramp(first, last, float(rate), float(settle), float(increment), bool(back))
    return replace(ramp, spin_up=float(spin_up), low=sense * low) if spin_up else ramp


def scheme_from_arguments(
    structure: Structure,
    step: float | None,
    algorithm: str = "rollback",
    tolerance: float | None = None,
    sampled: bool = False,
) -> Scheme:
    """Choose algorithm, communication step and tolerance from :func:`couple` arguments."""
    omega = structure.omega
    if tolerance is None:
        controlled = step is None and Scheme(algorithm).goes_back
        tolerance = TOLERANCE if controlled else 0.0
    if step is None:
        step = (LONGEST if tolerance and not sampled else FIXED) / omega
    rounding = 1.0 + 1e-12
    if not 1e-4 / rounding <= step * omega <= rounding:
        raise InputError(f"step = {step} s: expected {1e-4 / omega:g} <= step <= {1.0 / omega:g}")
    return Scheme(algorithm, float(step), tolerance=float(tolerance))


def couple_job(
    structure: Structure,
    drive: Drive,
    schedule: Schedule,
    scheme: Scheme,
    speed_start: float | None = None,
    control: Controller | None = None,
    hold: float | None = None,
) -> CoupleJob:
    """Check the arguments of a coupled run and build its job."""
    if control is not None and not isinstance(control, Controller):
        raise InputError(f"control = {control!r}: expected SpeedControl(...), SpeedGradient(...)")
    if speed_start is None:
        at_rest = control is not None
        speed_start = 0.0 if at_rest else schedule.voltage(0.0) / drive.motor_constant
    check("speed_start", speed_start, "rad/s")
    name = "bonded" if structure.bonded else "delaminated"
    start = float(speed_start)
    if hold is None:
        hold = (HOLD + HOLD_OF_ROTOR / drive.b(structure)) / structure.omega
    check("hold", hold, "s", low=0.0, exclusive=True)
    hold = float(hold)
    job = CoupleJob(f"couple_{name}", structure, drive, schedule, scheme, start, hold, control)
    steps = schedule.duration / scheme.h
    if steps <= MAX_STEPS and job.steps() < 1:
        raise InputError(
            f"duration = {schedule.duration:g} s: expected one communication step or more, "
            f"duration >= {scheme.h:g}"
        )
    if not steps <= MAX_STEPS:
        raise InputError(
            f"{steps:.2g} steps of {scheme.h:g} s in {schedule.duration:g} s: "
            f"expected at most {MAX_STEPS:g}"
        )
    return job


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
    step: float | None = None,
    algorithm: str = "rollback",
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
        Longest time for which a voltage is held where the record of a ramp does not tell a jump
        from a steep branch, s; (4000 + 200/b)/omega by default, 1/b being the time in which the
        rotor settles. A direction that is undecided may need more.
    step : float, optional
        Communication step, s. By default its defect controls it, up to 0.4/omega; with a controller
        up to 0.1/omega, with an ``algorithm`` that cannot go back it is that.
    algorithm : str
        Of :data:`orchestrate.weak_drive.master.ALGORITHMS`.
    tolerance : float, optional
        Of the control: halve a step whose defect is a larger part of the work exchanged in it, and
        take longer ones again where they will do. 1e-8 by default, where no ``step`` is given, else
        0: no control.
    **running
        ``jobs``, ``cluster``, ``progress``, ``store`` and so on, see
        :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Dimension ``revolution``: ``time`` (s), ``voltage`` (V), ``speed`` (rad/s), ``amplitude``
        and ``box_amplitude`` (m), ``box_acceleration`` (m/s2), ``impacts``, energies since the
        start (J), and the numbers ``eta0`` = U/(K omega) and ``Omega`` = speed/omega. Dimension
        ``jump``: ``jumps`` (V), ``jump_time`` (s), ``jump_speed`` (rad/s), speed and amplitude
        before and after, ``jump_rate`` (V/s) at the jumps up and down, NaN where there is none,
        and ``no_jump`` says why. ``decided`` says how it was told: by the record of the ramp, or
        by held voltages, or that it is undecided. ``held_verdict`` says what held voltages say, as
        a number with a meaning: 0 not asked, 1 lost, 2 follows, 3 left before, 4 undecided; with
        ``held_jumps`` and ``held_error`` (V), the voltage and half of its bracket. Where the speed
        jumps more than once in a direction, these are about the first sure jump; over ``jump`` and
        ``order`` the others are told, in the ramp's order: ``further_jumps`` (V), ``further_time``
        (s), ``further_held`` and ``further_error`` (V), and ``further_decided``, which is
        "undecided" where there may be one, and empty where there is none. ``further_count`` says
        how many there are. For a bonded structure
        ``averaged_jumps`` (V), ``averaged_kind`` and ``jump_lag`` (V): where the averaged theory
        loses the motion, by a fold or a Neimark-Sacker point. From
        ``passage_time`` (s) on the speed stays beyond the resonance.

    Raises
    ------
    InputError
        Where an argument is not what is expected, or the motor has not turned once.

    Notes
    -----
    A ramp's jump comes late, about as rate^(2/3). What counts as a jump is told in
    :mod:`orchestrate.weak_drive.jumps`. Where the ramp's record does not tell a jump from a steep
    branch, a state of the run is restored and voltages are held: where a motion is lost, two speeds
    last at one voltage, see :mod:`orchestrate.weak_drive.held`. Such a verdict does not depend on
    the rate. Of a bonded structure none is given that the averaged theory contradicts by more than
    its own error: it is undecided then.

    A further jump beside the passing of the resonance is looked for where the held voltages cross
    it, and where the torque that the vibration takes shows it in the record
    (:mod:`orchestrate.weak_drive.further_jumps`); voltages are held there too. It is one where the
    speeds of two motions at one voltage differ by more than 8e-3 omega; one of less than 1.6e-2
    that the record alone suggests is undecided, since fast ramps show none of it. A change of that
    torque by less than 4e-3, as a speed over omega, or by less than eight times its scatter, is
    none.

    Whatever the clearance, a passage of the resonance is one past the speed that divides the
    motions of the bonded structure, by the averaged theory, moved with the resonance where that of
    the delaminated structure lies clearly apart
    (:mod:`orchestrate.weak_drive.own_resonance`). Voltages are held from before both resonances to
    beyond both; where the voltage does not go that far, the direction is undecided. Halves that
    hardly touch swing freely, with further resonances near these.

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
    from ..access.exported import finder
    from ..running.runner import answer

    require_motor(drive)
    if spin_up is None and speed_start is not None:
        spin_up = 0.0
    settings = (duration, rate, settle, increment, back, spin_up)
    schedule = schedule_from_arguments(structure, drive, voltage, *settings)
    scheme = scheme_from_arguments(structure, step, algorithm, tolerance, control is not None)
    job = couple_job(structure, drive, schedule, scheme, speed_start, control, hold)
    return answer(job, running, finder(running))
