"""Do impacts as communication points pay? Event mode and early return of the real FMUs, measured.

``python -m tests.orchestrate.weak_drive.impact_points`` prints the table;
``docs/coupling_scheme.md`` has its numbers.
"""

import numpy as np

from orchestrate.access import OSCILLATOR, SHAKER, Instance, find
from orchestrate.access.events import EventInstance
from orchestrate.weak_drive.exchange import Step
from orchestrate.weak_drive.master import ALGORITHMS, Master, Scheme
from orchestrate.weak_drive.polynomials import end_slope, end_value, integrate_work

from .coupled import QUICK, oscillator_start, settled, starts_of, state_of
from .monolithic import Monolith

TIME, GRID = 40.0, 0.1
CASES = {
    "`quick`": (QUICK, 1.5, 1.25),
    "`quick`, d2/m2 = 5 d1/m1": (QUICK.with_structure(D1=0.01, D2=0.05), 1.3, 1.2),
}


class Counting(Master):
    """A master that counts how often both sides do a step."""

    passes = 0

    def _step_both(self, *arguments):
        self.passes += 1
        return super()._step_both(*arguments)


class ImpactPoints(Counting):
    """A master whose steps end at impacts, further than ``least`` intervals from both ends.

    With ``least`` > 1/2 no impact is one: all are passed within steps.
    """

    def __init__(self, *arguments, least):
        super().__init__(*arguments)
        instance = self.oscillator.instance
        instance.call("enterStepMode")
        self.advance, self.handle = instance.stepper(), instance.event_handler()
        self.least, self.length = least * self.scheme.h, self.scheme.h

    def step(self, voltage, h=None):
        """One interval, in steps of any length."""
        h = h or self.scheme.h
        end, tolerance = self.time + h, self.scheme.tolerance
        while end - self.time > 1e-12 * end:
            wanted = min(self.length, end - self.time)
            size, taken = self.one(voltage, wanted, bool(tolerance) and wanted > h / 64.0)
            if not taken:
                self.length = 0.5 * wanted
            elif size < tolerance * self.scheme.easy and wanted == self.length:
                self.length = min(2.0 * wanted, h)
        self.time = end

    def one(self, voltage, h, may_refuse):
        """A step up to an impact: its defect, and its length, 0 where it was refused."""
        if voltage != self.voltage:
            self.voltage = voltage
            self.shaking = self._outputs_with_force(self.motion)
        done, h, event = self.both(h)
        force = self.fit_force(done.motion, h)
        taken = done.shaking.box_force_work - self.shaking.box_force_work
        defect = taken - integrate_work(force, self.shaking.box_velocity, done.acceleration, h)
        size = self._relative_defect(done, taken, defect)
        if may_refuse and size > self.scheme.tolerance:
            self.oscillator.restore()
            self.shaker.restore()
            return size, 0.0
        self.slope = end_slope(force, h)
        self.balance.add(self.motion, done.motion, done.acceleration, defect, h)
        self._accept_step(done, h)
        if event:
            self.handle()
            self._restart_extrapolation()
        return size, h

    def both(self, h):
        """Structure, then shaker, as in the master itself; where the step has ended, and why."""
        self.oscillator.save()
        self.shaker.save()
        passes = ALGORITHMS["rollback" if self.h_before else "iterated"].passes
        acceleration, last = self._extrapolated_acceleration(), None
        for i in range(passes):
            if i:
                self.oscillator.restore()
                self.shaker.restore()
            motion, length, event = self.flight(acceleration, h)
            force = self._force_for_shaker(motion, length)
            self.shaker.put(*force, self.voltage)
            self.shaker.step(self.time, length)
            self.passes += 1
            if i + 1 == passes or (last and self._converged(motion, last)):
                break
            last = motion
            self.shaker.put(motion.box_force, end_slope(force, length), 0.0, 0.0, self.voltage)
            acceleration = self._acceleration_for_structure(self._read_motor(), length)
        return Step(acceleration, motion, self._read_motor()), length, event

    def flight(self, told, h):
        """The structure to an impact that ends the step, past all others."""
        at = impulse = moment = 0.0
        while True:
            f0, f1, f2, f3 = told
            now = (end_value(told, at), end_slope(told, at), f2 + at * f3, f3)
            self.oscillator.put(*now)
            event, last = self.advance(self.time + at, h - at)
            motion, reached = self._read_structure(), last - self.time
            impulse += motion.box_impulse
            moment += motion.box_impulse_moment + at * motion.box_impulse
            inside = event and self.least <= reached <= h - self.least
            if inside or reached >= h * (1.0 - 1e-12):
                whole = motion._replace(box_impulse=impulse, box_impulse_moment=moment)
                if event and not inside:
                    self.handle()
                return whole, reached if inside else h, inside
            at = reached
            self.handle()


def error(master, case, truth, amplitude):
    """Largest error of the displacements at the intervals' ends, over the amplitude."""
    h, rows = master.scheme.h, []
    for _ in range(round(TIME / h)):
        master.step(case[1])
        rows.append(state_of(master))
    every = round(h / GRID)
    return np.abs(np.array(rows) - truth[every::every][: len(rows)])[:, [0, 2]].max() / amplitude


def measured(case, state, kind, scheme, **options):
    """Error and passes of a master."""
    system = case[0]
    truth, _ = Monolith(*system, case[1]).solve(state, np.arange(0.0, TIME + GRID / 2, GRID))
    first = EventInstance if options else Instance
    with first(find(OSCILLATOR).path) as one, Instance(find(SHAKER).path) as other:
        own, others = starts_of(system, state)
        one.initialize(**oscillator_start(system.structure), **own)
        other.initialize(**system.drive.parameters(), **others)
        master = kind(one, other, system.structure, scheme, **options)
        found = error(master, case, truth, np.abs(truth[:, 0]).max())
        master.close()
        return f"{found:.1e} ({master.passes})"


def main():
    """Print the table."""
    schemes = {
        "fixed steps of 0.2": Scheme("rollback", 0.2),
        "`tolerance` 1e-6": Scheme("rollback", 0.4, tolerance=1e-6),
        "`tolerance` 1e-8": Scheme("rollback", 0.4, tolerance=1e-8),
    }
    for name, case in CASES.items():
        state = settled(*case)
        for text, scheme in schemes.items():
            row = [measured(case, state, Counting, scheme)]
            for least in (0.002, 0.05, 1.0):
                row.append(measured(case, state, ImpactPoints, scheme, least=least))
            print(f"| {name}, {text} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
