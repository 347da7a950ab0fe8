"""Structures with their drives, and co-simulations of both FMUs from given states."""

import contextlib
from typing import NamedTuple

import numpy as np

from orchestrate import Drive, Structure
from orchestrate.fmu import MOTOR_SHAKER, OSCILLATOR, Instance, find_or_export
from orchestrate.weak_drive.energy_balance import Energies, EnergyBalance
from orchestrate.weak_drive.master import Master, Scheme
from orchestrate.weak_drive.run import oscillator_start_values

GRID = 0.2  # of the comparisons
ORDER = ("x1", "v1", "x2", "v2", "box_position", "box_velocity", "angle", "speed")
STARTS = ("x1_start", "v1_start", "x2_start", "v2_start")
SHAKER_STARTS = ("position_start", "velocity_start", "angle_start", "speed_start", "current_start")


class System(NamedTuple):
    structure: Structure
    drive: Drive

    def as_bonded(self):
        return self._replace(structure=self.structure.as_bonded())

    def with_structure(self, **changes):
        return self._replace(structure=self.structure.replace(**changes))

    def with_lag(self, tau):
        """The inductance whose electric time constant L/R_a is ``tau``."""
        inductance = tau * self.drive.armature_resistance
        return self._replace(drive=self.drive.replace(armature_inductance=inductance))


QUICK, BEAM = (System(Structure.from_file(n), Drive.from_file(n)) for n in ("quick", "beam"))


def system_of(mu, kappa, D1, D2, e, clearance=0.0, **drive):
    """A system by its non-dimensional numbers; of the drive beta, epsilon, b, Omega_b and D_b."""
    numbers = {"mu": mu, "kappa": kappa, "D1": D1, "D2": D2, "e": e, "clearance": clearance}
    structure = Structure.nondimensional(**numbers)
    return System(structure, Drive.nondimensional(**drive, structure=structure))


def rest(speed=0.0, structure=None):
    """Everything at rest but the rotor; with a preload the structure's springs are loaded."""
    x1, x2 = structure.at_rest if structure else (0.0, 0.0)
    return [x1, 0.0, x2, 0.0, 0.0, 0.0, 0.0, speed, 0.0]


def starts_of(system, state):
    """Start values of the structure and of the shaker for a state; the masses' from rest, as the
    FMU counts them.
    """
    x1, v1, x2, v2 = state[:4]
    (rest_1, rest_2), offset = system.structure.at_rest, system.structure.gap_offset
    touching = abs(x2 - x1 + offset) <= 4e-16 * (abs(x1) + abs(offset))
    x1, x2 = x1 - rest_1, x2 - rest_2
    return (
        dict(zip(STARTS, (x1, v1, x1 if touching and offset <= 0.0 else x2, v2), strict=True)),
        dict(zip(SHAKER_STARTS, state[4:], strict=True)),
    )


@contextlib.contextmanager
def instances(form="fmi3"):
    """An instance of the oscillator and one of the motor."""
    oscillator, shaker = (find_or_export(model, form).path for model in (OSCILLATOR, MOTOR_SHAKER))
    with Instance(oscillator) as one, Instance(shaker) as other:
        yield one, other


@contextlib.contextmanager
def master(system, scheme, state, form="fmi3"):
    """A master from a state as :mod:`.monolithic` has it."""
    starts, shaker_starts = starts_of(system, state)
    with instances(form) as (one, other):
        one.initialize(**oscillator_start_values(system.structure), **starts)
        other.initialize(**system.drive.parameters(), **shaker_starts)
        with contextlib.closing(Master(one, other, scheme)) as made:
            yield made


def state_of(m):
    return [*(m[name] for name in ORDER), *m.drive.instance.get("motor_current")]


def settled(system, voltage, speed, time=600.0):
    """A state of the settled motion, in flight unless bonded, with the angle in the first turn."""
    with master(system, Scheme(0.2), rest(speed, system.structure)) as m:
        while m.time < time or (m.motion.x_rel == 0.0 and not system.structure.bonded):
            m.step(voltage)
        state = state_of(m)
    return [*state[:6], state[6] % (2.0 * np.pi), *state[7:]]


def history(system, scheme, voltage, state, time, form="fmi3"):
    """States on the grid, shape (points, 9), and the energies at the end."""
    every = max(1, round(GRID / scheme.h))
    balance = EnergyBalance(system.structure)
    with master(system, scheme, state, form) as m:
        rows = [state]
        for k in range(round(time / scheme.h)):
            energies = balance.add_record(m.step(voltage))
            if (k + 1) % every == 0:
                rows.append(state_of(m))
        return np.array(rows), Energies(*(float(one[-1]) for one in energies))
