"""Random sets against :class:`.monolithic.Monolith`: trajectories, folds, Neimark-Sacker points."""

import numpy as np

from orchestrate import Drive, Structure
from orchestrate.dynamics.bifurcations import Kind
from orchestrate.fmu import MOTOR_SHAKER, OSCILLATOR, Instance, find
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.couple import scheme_from_arguments
from orchestrate.weak_drive.drive_branch import DriveBranchJob

from .coupled import System, master, rest, state_of
from .monolithic import Monolith

SEED = 13
RANGES = {  # of what a laboratory would build
    **{"m1": (0.5, 5.0), "omega": (20.0, 200.0), "length": (1e-4, 1e-3), "constant": (0.02, 0.2)},
    **{"mu": (0.5, 2.0), "kappa": (1.05, 2.0), "D1": (0.005, 0.02), "D2": (0.005, 0.02)},
    **{"e": (0.3, 0.9), "beta": (0.1, 0.4), "epsilon": (3e-4, 2e-3), "b": (0.02, 0.1)},
    **{"Omega_b": (0.05, 0.3), "D_b": (0.005, 0.05), "lag": (0.0, 1.0)},
}

WIDE = {  # of what users may enter
    **RANGES,
    **{"mu": (0.25, 4.0), "kappa": (0.4, 3.0), "D1": (0.0, 0.2), "D2": (0.0, 0.2)},
    **{"e": (0.05, 0.95), "b": (0.004, 0.1)},
}


def random_sets(count, seed=SEED, ranges=RANGES):
    """Structures with their drives, each number uniform in its range."""
    rng = np.random.default_rng(seed)
    return [made({name: rng.uniform(*ends) for name, ends in ranges.items()}) for _ in range(count)]


def made(v):
    """A structure and its drive by the numbers of ``RANGES``."""
    m1, omega = v["m1"], v["omega"]
    k1, m2 = m1 * omega**2, v["mu"] * m1
    dampers = {"d1": 2.0 * v["D1"] * omega * m1, "d2": 2.0 * v["D2"] * omega * m2}
    structure = Structure(m1=m1, m2=m2, k1=k1, k2=v["kappa"] * k1, e=v["e"], **dampers)
    drive = Drive.nondimensional(
        **{name: v[name] for name in ("beta", "epsilon", "b", "Omega_b", "D_b")},
        structure=structure,
        length=v["length"],
        motor_constant=v["constant"],
    )
    return System(structure, drive).with_lag(v["lag"] / omega)


def below_resonance(system, share=0.985):
    """A speed in rad/s and the voltage that holds it, by the averaged theory."""
    bonded = system.as_bonded()
    Omega = share * averaged.resonance(*bonded)
    volts = system.drive.volts(system.structure)
    return Omega * system.structure.omega, float(averaged.no_load_speed(*bonded, Omega)) * volts


def settled_state(system, voltage, speed, time=300.0):
    """A state after a time in 1/omega, in flight unless bonded, the angle in the first turn."""
    with master(system, scheme_from_arguments(system.structure, None), rest(speed)) as m:
        while m.time * system.structure.omega < time or (
            m.motion.x1 == m.motion.x2 and not system.structure.bonded
        ):
            m.step(voltage)
        state = state_of(m)
    return [*state[:6], state[6] % (2.0 * np.pi), *state[7:]]


# -- trajectories ----------------------------------------------------------------------------------


def trajectory_error(system, time=40.0):
    """Largest error of the displacements over the amplitude, and the impacts on the way."""
    speed, voltage = below_resonance(system)
    state = settled_state(system, voltage, speed)
    scheme = scheme_from_arguments(system.structure, None)
    rows = [state]
    with master(system, scheme, state) as m:
        for _ in range(round(time / system.structure.omega / scheme.h)):
            m.step(voltage)
            rows.append(state_of(m))
    times = scheme.h * np.arange(len(rows))
    truth, impacts = Monolith(*system, voltage).solve(state, times)
    errors = np.abs(np.array(rows) - truth)[:, [0, 2]]
    return errors.max() / np.abs(truth[:, 0]).max(), impacts


# -- bifurcations ----------------------------------------------------------------------------------


class Whole:
    """Shooting on the monolithic solution, at a given length of the period."""

    def __init__(self, system, turns, angle, length):
        self.system, self.turns, self.angle = system, turns, angle
        bonded, omega = system.structure.bonded, system.structure.omega
        inductive = system.drive.armature_inductance > 0.0
        self.places = [0, 1, *([] if bonded else [2, 3]), 4, 5, 7, *([8] if inductive else [])]
        self.volts = system.drive.volts(system.structure)
        current = self.volts / system.drive.armature_resistance
        self.units = np.array([length, length * omega] * 3 + [1.0, omega, current])

    def after(self, state, voltage, period):
        """The whole state over its units a period later."""
        whole = Monolith(*self.system, voltage * self.volts)
        return whole.solve(state * self.units, np.array([0.0, period]))[0][-1] / self.units

    def full(self, unknowns):
        """The whole state from those that are free."""
        state = np.zeros(9)
        state[self.places] = unknowns[:-1]
        state[6] = self.angle
        if self.system.structure.bonded:
            state[2:4] = state[:2]
        return state

    def residual(self, unknowns, period):
        """What a period changes."""
        state = self.full(unknowns)
        change = self.after(state, unknowns[-1], period) - state
        change[6] -= 2.0 * np.pi * self.turns
        return change[[*self.places, 6]]

    def jacobian(self, unknowns, period, change=1e-6):
        """By the unknowns, and by the period's relative length."""
        columns = []
        for i in range(len(unknowns)):
            moved = np.eye(len(unknowns))[i] * change
            ends = [self.residual(unknowns + sign * moved, period) for sign in (1.0, -1.0)]
            columns.append((ends[0] - ends[1]) / (2.0 * change))
        ends = [self.residual(unknowns, period * (1.0 + sign * change)) for sign in (1.0, -1.0)]
        return np.stack([*columns, (ends[0] - ends[1]) / (2.0 * change)], axis=1)

    def orbit(self, unknowns, period):
        """Unknowns of the motion with this period, and the Jacobian there."""
        matrix = self.jacobian(unknowns, period)
        for _ in range(20):
            left = self.residual(unknowns, period)
            if np.abs(left).max() < 1e-9:
                return unknowns, self.jacobian(unknowns, period)
            unknowns = unknowns - np.linalg.solve(matrix[:, :-1], left)
        raise ArithmeticError(f"no orbit: {np.abs(left).max()}")

    def multipliers(self, matrix):
        """Of the map from the angle to itself."""
        count = len(self.places)
        flow = matrix[:, :count] + np.eye(count + 1, count)
        section = flow[:count] - np.outer(matrix[:count, -1], flow[count]) / matrix[count, -1]
        return np.linalg.eigvals(section)

    def test(self, kind, unknowns, period):
        """What is 0 at a bifurcation, and the motion there."""
        found, matrix = self.orbit(unknowns, period)
        if kind == Kind.FOLD:
            slope = np.linalg.solve(matrix[:, :-1], -matrix[:, -1])
            return float(slope[-1]), found
        values = self.multipliers(matrix)
        if kind == Kind.FLIP:
            return float(values.real.min() + 1.0), found
        pairs = np.abs(values[np.abs(values.imag) > 1e-6])
        return float(pairs[np.argmin(np.abs(pairs - 1.0))] - 1.0), found

    def locate(self, kind, unknowns, period):
        """The voltage over K omega at a bifurcation near a motion, by secants."""
        places, values = [period, period * (1.0 + 1e-5)], []
        for place in places:
            value, unknowns = self.test(kind, unknowns, place)
            values.append(value)
        for _ in range(6):
            slope = (values[-1] - values[-2]) / (places[-1] - places[-2])
            places.append(places[-1] - values[-1] / slope)
            value, unknowns = self.test(kind, unknowns, places[-1])
            values.append(value)
            if abs(places[-1] - places[-2]) < 1e-7 * period:
                break
        return float(unknowns[-1])


def branch_of(system, most=120, range_=(0.95, 1.15)):
    """Legs of a branch, and the unit of length."""
    omega = system.structure.omega
    resonance = averaged.resonance(*system.as_bonded())
    speeds = tuple(share * resonance * omega for share in range_)
    asked = {"longest": 0.1, "most": most, "period": 2, "steps": 48, "settle": 600.0 / omega}
    job = DriveBranchJob("branch", *system, speeds, **asked)
    with Instance(find(OSCILLATOR).path) as one, Instance(find(MOTOR_SHAKER).path) as other:
        shooter = job.make_shooter((one, other), system.structure)
        return job.trace_legs(shooter), shooter.length


def bifurcations(system, range_=(0.95, 1.15)):
    """Kind, speed over omega, voltage over K omega by the branch and by the whole system."""
    legs, length = branch_of(system, range_=range_)
    found = []
    for leg in legs:
        for event in leg.bifurcations:
            unknowns, turns = event.point.root.unknowns, event.point.period.revolutions
            whole = Whole(system, turns, event.point.angle, length)
            period = turns * 2.0 * np.pi / (unknowns[-1] * system.structure.omega)
            try:
                truth = whole.locate(event.kind, unknowns[:-1], period)
            except (ArithmeticError, np.linalg.LinAlgError):
                truth = np.nan
            found.append((event.kind, float(unknowns[-1]), float(unknowns[-2]), truth))
    return found


# -- jumps -----------------------------------------------------------------------------------------
