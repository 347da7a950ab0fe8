"""Random sets against :class:`.monolithic.Monolith`."""

import numpy as np

from orchestrate import Drive, Structure
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
    """The whole state from the unknowns of shooting, over units."""

    def __init__(self, system, turns, angle, length):
        self.system, self.turns, self.angle = system, turns, angle
        bonded, omega = system.structure.bonded, system.structure.omega
        inductive = system.drive.armature_inductance > 0.0
        self.places = [0, 1, *([] if bonded else [2, 3]), 4, 5, 7, *([8] if inductive else [])]
        self.volts = system.drive.volts(system.structure)
        current = self.volts / system.drive.armature_resistance
        self.units = np.array([length, length * omega] * 3 + [1.0, omega, current])

    def full(self, unknowns):
        """The whole state from those that are free."""
        state = np.zeros(9)
        state[self.places] = unknowns[:-1]
        state[6] = self.angle
        if self.system.structure.bonded:
            state[2:4] = state[:2]
        return state


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
