"""A motor with an unbalance on a box on springs: it shakes a structure with limited power."""

from __future__ import annotations

import math
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING

from ..errors import InputError
from .conversions import damping_from_ratio
from .described import Described
from .ranges import DRIVE, RATIO_QUANTITIES, checked_range, construct_or_explain, invert_exactly
from .structure import Structure

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True, kw_only=True)
class Drive(Described):
    """Weak drive of the coupled system: DC motor with an unbalance on a sprung box, in SI.

    Parameters
    ----------
    box_mass : float
        Box with motor and unbalance, M_t, kg.
    box_stiffness, box_damping : float
        Its suspension, k_b in N/m and c_b in N s/m.
    unbalance_mass, unbalance_radius : float
        kg and m; their product is S.
    rotor_inertia : float
        J with the unbalance, kg m^2.
    motor_constant : float
        K: torque over current, and voltage over speed, N m/A.
    armature_resistance, armature_inductance : float
        R_a in Ohm and L in H; with L = 0 the torque follows the static line K (U - K phi')/R_a.

    Raises
    ------
    InputError
        Where a value is no number in its range.

    Examples
    --------
    >>> drive, structure = Drive.from_file("beam"), Structure.from_file("beam")
    >>> drive.volts(structure), round(drive.beta(structure), 4), round(drive.epsilon, 6)
    (4.5, 0.2727, 0.000909)
    """

    quantities = DRIVE
    box_mass: float
    box_stiffness: float
    box_damping: float
    unbalance_mass: float
    unbalance_radius: float
    rotor_inertia: float
    motor_constant: float
    armature_resistance: float
    armature_inductance: float = DRIVE["armature_inductance"].default

    @classmethod
    def nondimensional(
        cls,
        *,
        beta: float,
        epsilon: float,
        b: float,
        Omega_b: float,
        D_b: float,
        structure: Structure,
        length: float = 1.0,
        motor_constant: float = 1.0,
    ) -> Drive:
        """Make a drive from beta, epsilon, b, Omega_b and D_b, in SI by a structure's m1 and omega.

        Parameters
        ----------
        beta : float
            m1/M_t.
        epsilon : float
            S^2/(J M_t), the unbalance's share in the inertia.
        b : float
            K^2/(R_a J omega), slope of the torque line.
        Omega_b, D_b : float
            The box's own frequency sqrt(k_b/M_t)/omega, and its damping ratio c_b/(2 omega M_t).
        structure : Structure
            Gives m1 and omega.
        length, motor_constant : float
            The scale: S/M_t in m, and K in N m/A.

        Examples
        --------
        >>> structure = Structure.nondimensional(D=0.02)
        >>> numbers = dict(beta=0.25, epsilon=0.001, b=0.02, Omega_b=0.1, D_b=0.005)
        >>> drive = Drive.nondimensional(**numbers, structure=structure)
        >>> drive.box_mass, drive.b(structure), drive.Omega_b(structure)
        (4.0, 0.02, 0.1)
        """
        checked = {"beta": beta, "epsilon": epsilon, "b": b, "Omega_b": Omega_b, "D_b": D_b}
        checked = {name: RATIO_QUANTITIES[name].check(value) for name, value in checked.items()}
        length, omega = DRIVE["unbalance_radius"].check(length), structure.omega
        mass = structure.m1 / checked["beta"]
        inertia = length**2 * mass / checked["epsilon"]
        constant = DRIVE["motor_constant"].check(motor_constant)
        return construct_or_explain(
            checked,
            lambda: cls(
                box_mass=mass,
                box_stiffness=suspension_stiffness(checked["Omega_b"], omega, mass),
                box_damping=damping_from_ratio(checked["D_b"], omega, mass),
                unbalance_mass=0.01 * mass,
                unbalance_radius=100.0 * length,
                rotor_inertia=inertia,
                motor_constant=constant,
                armature_resistance=constant**2 / (checked["b"] * inertia * omega),
            ),
        )

    @classmethod
    def from_datasheet(
        cls,
        *,
        rated_voltage: float,
        no_load_speed: float,
        stall_torque: float,
        unbalance_mass: float,
        unbalance_radius: float,
        box_mass: float,
        box_stiffness: float,
        box_damping: float,
        rotor_inertia: float | None = None,
        mechanical_time_constant: float | None = None,
        armature_inductance: float = 0.0,
    ) -> Drive:
        """Make a drive from a motor's datasheet: voltage, no-load speed, stall torque ...

        Parameters
        ----------
        rated_voltage : float
            V.
        no_load_speed : float
            At that voltage, rad/s.
        stall_torque : float
            At that voltage, N m.
        unbalance_mass, unbalance_radius : float
            kg and m.
        box_mass, box_stiffness, box_damping : float
            kg, N/m, N s/m.
        rotor_inertia : float, optional
            Of the rotor without the unbalance, kg m^2; the unbalance is added.
        mechanical_time_constant : float, optional
            Instead of the inertia, s: J_rotor = tau_m K^2/R_a.
        armature_inductance : float
            H.

        Raises
        ------
        InputError

        Notes
        -----
        K = U/omega_0 and R_a = K U/T_stall: friction is not separated, its torque is part of the
        line between both points.

        Examples
        --------
        >>> motor = dict(rated_voltage=12.0, no_load_speed=200.0, stall_torque=0.06)
        >>> rest = dict(unbalance_mass=0.025, unbalance_radius=0.02, box_mass=5.5)
        >>> box = dict(box_stiffness=309.0, box_damping=4.1)
        >>> drive = Drive.from_datasheet(**motor, **rest, **box, rotor_inertia=4e-5)
        >>> drive.motor_constant, drive.armature_resistance, round(drive.rotor_inertia, 9)
        (0.06, 12.0, 5e-05)
        """
        points = rated_voltage, no_load_speed, stall_torque
        constant, resistance = motor_constant_and_resistance(*points)
        if (rotor_inertia is None) == (mechanical_time_constant is None):
            both = f"{rotor_inertia} and mechanical_time_constant = {mechanical_time_constant}"
            raise InputError(f"rotor_inertia = {both}: expected one of them")
        if mechanical_time_constant is not None:
            rotor_inertia = mechanical_time_constant * constant**2 / resistance
        assert rotor_inertia is not None
        return cls(
            box_mass=box_mass,
            box_stiffness=box_stiffness,
            box_damping=box_damping,
            unbalance_mass=unbalance_mass,
            unbalance_radius=unbalance_radius,
            rotor_inertia=rotor_inertia + unbalance_mass * unbalance_radius**2,
            motor_constant=constant,
            armature_resistance=resistance,
            armature_inductance=armature_inductance,
        )

    @classmethod
    def from_file(cls, path: str | PathLike[str], structure: Structure | None = None) -> Drive:
        """Read ``[motor]`` and ``[box]`` of a TOML file or of a set that comes with the package.

        Parameters
        ----------
        path : path-like
        structure : Structure, optional
            What non-dimensional numbers refer to where the file has no ``[structure]``.
        """
        return cls._read(path, structure)

    @property
    def length(self) -> float:
        """Unit of length S/M_t, m."""
        return self.unbalance_mass * self.unbalance_radius / self.box_mass

    @property
    def epsilon(self) -> float:
        """Share of the unbalance in the inertia, S^2/(J M_t)."""
        return self.length**2 * self.box_mass / self.rotor_inertia

    def beta(self, structure: Structure) -> float:
        """Return the mass ratio m1/M_t."""
        return structure.m1 / self.box_mass

    def b(self, structure: Structure) -> float:
        """Return the non-dimensional slope b of the motor's torque line, K^2/(R_a J omega)."""
        slope = self.motor_constant**2 / self.armature_resistance
        return slope / (self.rotor_inertia * structure.omega)

    def Omega_b(self, structure: Structure) -> float:
        """Return the empty box's natural frequency over the structure's omega."""
        omega, mass, stiffness = structure.omega, self.box_mass, self.box_stiffness
        guess = math.sqrt(stiffness / mass) / omega
        return invert_exactly(guess, lambda x: suspension_stiffness(x, omega, mass), stiffness)

    def D_b(self, structure: Structure) -> float:
        """Return the box's damping ratio, c_b/(2 omega M_t)."""
        omega, mass, damping = structure.omega, self.box_mass, self.box_damping
        guess = damping / (2.0 * omega * mass)
        return invert_exactly(guess, lambda ratio: damping_from_ratio(ratio, omega, mass), damping)

    def volts(self, structure: Structure) -> float:
        """Return the unit of voltage, V: the one whose no-load speed is the structure's omega."""
        return self.motor_constant * structure.omega

    def energy(self, structure: Structure) -> float:
        """Return the unit of energy M_t (omega S/M_t)^2, J."""
        return self.box_mass * (structure.omega * self.length) ** 2

    def parameters(self) -> dict[str, float]:
        """Return the drive's SI values by name, as start values of the ``MotorShaker`` FMU."""
        return dict(vars(self))


def motor_constant_and_resistance(
    rated_voltage: float, no_load_speed: float, stall_torque: float
) -> tuple[float, float]:
    """Return motor constant K, N m/A, and resistance R_a, Ohm, from no-load and stall points."""
    names = "rated_voltage", "no_load_speed", "stall_torque"
    for name, value in zip(names, (rated_voltage, no_load_speed, stall_torque), strict=True):
        checked_range(name, value, low=0.0, open_low=True)
    constant = rated_voltage / no_load_speed
    return constant, constant * rated_voltage / stall_torque


def suspension_stiffness(ratio: float, omega: float, mass: float) -> float:
    """Return the stiffness k_b, N/m, of the box's suspension: M_t (Omega_b omega)^2."""
    return mass * (ratio * omega) ** 2


def sense_of_rotation(voltage: np.ndarray) -> float:
    """Return a motor's sense of rotation by its voltages: -1 where it turns backward, else 1."""
    return -1.0 if -voltage.min(initial=0.0) > voltage.max(initial=0.0) else 1.0
