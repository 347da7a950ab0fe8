"""An electrodynamic shaker: a coil on a suspended table, and the amplifier that drives it."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from os import PathLike

from ..constants import TURN
from ..errors import InputError
from .described import Described
from .ranges import DATASHEET, ELECTRODYNAMIC_SHAKER, checked_flag


@dataclass(frozen=True, kw_only=True)
class Shaker(Described):
    """Electrodynamic shaker with its amplifier, in SI: parameters of ``ElectrodynamicShaker``.

    Parameters
    ----------
    table_mass : float
        Table with all that is fixed to it, the structure's box included, kg.
    suspension_stiffness, suspension_damping : float
        Of the table, N/m and N s/m.
    force_factor : float
        Bl: force over current, N/A, and voltage over velocity.
    coil_resistance, coil_inductance : float
        With the amplifier's output resistance, Ohm and H.
    current_control : bool
        Whether the command is a current; else it is a voltage.
    voltage_limit, current_limit : float
        Peak values of the amplifier, V and A; 0: none.
    travel_limit : float
        Distance of the stops from the middle, m; 0: none. A run that reaches them fails.

    Raises
    ------
    InputError
        Where a value is no number in its range.

    Examples
    --------
    >>> shaker = Shaker.from_file("shaker_100N")
    >>> shaker.force_factor * shaker.current_limit, round(shaker.resonance, 1)
    (100.0, 39.0)
    >>> round(shaker.replace(table_mass=0.6).resonance, 1)
    22.5
    """

    quantities = ELECTRODYNAMIC_SHAKER
    table_mass: float
    suspension_stiffness: float
    suspension_damping: float
    force_factor: float
    coil_resistance: float
    coil_inductance: float = ELECTRODYNAMIC_SHAKER["coil_inductance"].default
    current_control: bool = False
    voltage_limit: float = ELECTRODYNAMIC_SHAKER["voltage_limit"].default
    current_limit: float = ELECTRODYNAMIC_SHAKER["current_limit"].default
    travel_limit: float = ELECTRODYNAMIC_SHAKER["travel_limit"].default

    def __post_init__(self) -> None:
        super().__post_init__()
        flag = checked_flag("current_control", self.current_control)
        object.__setattr__(self, "current_control", flag)

    @classmethod
    def from_datasheet(
        cls,
        *,
        rated_force: float,
        moving_mass: float,
        force_factor: float,
        coil_resistance: float,
        suspension_resonance: float,
        amplifier_power: float,
        travel: float = 0.0,
        payload: float = 0.0,
        damping_ratio: float = 0.05,
        coil_inductance: float = 0.0,
        current_control: bool = False,
    ) -> Shaker:
        """Make a shaker from its data sheet: rated force, moving mass, N/A, travel, amplifier ...

        Parameters
        ----------
        rated_force : float
            Peak of a sine, N.
        moving_mass : float
            Of the bare table with its coil, kg.
        force_factor : float
            N/A.
        coil_resistance : float
            Ohm.
        suspension_resonance : float
            Of the bare table on its suspension, Hz.
        amplifier_power : float
            Of a sine, VA: half the product of the peaks of voltage and current.
        travel : float
            Peak to peak, m; 0: no stops.
        payload : float
            What is fixed to the table, the structure's box included, kg.
        damping_ratio : float
            Of the bare table with its coil open; hardly a data sheet has it.
        coil_inductance : float
            H.
        current_control : bool
            Whether the amplifier's input commands its current.

        Raises
        ------
        InputError
            Where a value is out of range, or the amplifier cannot drive the rated force.

        Notes
        -----
        The current limit is F/(Bl), the voltage limit 2 P over it. The suspension's damping is the
        mechanical one: what the coil adds, (Bl)^2/R, is part of the equations.

        Examples
        --------
        >>> sheet = dict(rated_force=100.0, moving_mass=0.2, force_factor=10.0, travel=0.014)
        >>> coil = dict(coil_resistance=2.0, suspension_resonance=39.0, amplifier_power=150.0)
        >>> shaker = Shaker.from_datasheet(**sheet, **coil, payload=0.4)
        >>> shaker.current_limit, shaker.voltage_limit, round(shaker.table_mass, 9)
        (10.0, 30.0, 0.6)
        """
        given = {
            **{"rated_force": rated_force, "moving_mass": moving_mass},
            **{"suspension_resonance": suspension_resonance, "amplifier_power": amplifier_power},
            **{"travel": travel, "payload": payload, "damping_ratio": damping_ratio},
        }
        sheet = {name: DATASHEET[name].check(value) for name, value in given.items()}
        factor = ELECTRODYNAMIC_SHAKER["force_factor"].check(force_factor)
        resistance = ELECTRODYNAMIC_SHAKER["coil_resistance"].check(coil_resistance)
        if factor == 0.0:
            raise InputError("force_factor = 0.0 N/A: expected a force factor > 0")
        current, rate = sheet["rated_force"] / factor, TURN * sheet["suspension_resonance"]
        least = 0.5 * resistance * current**2
        if sheet["amplifier_power"] < least:
            raise InputError(
                f"amplifier_power = {amplifier_power} VA: expected at least {least:.4g} VA, which "
                f"the coil takes for rated_force = {rated_force} N at rest"
            )
        return cls(
            table_mass=sheet["moving_mass"] + sheet["payload"],
            suspension_stiffness=sheet["moving_mass"] * rate**2,
            suspension_damping=2.0 * sheet["damping_ratio"] * sheet["moving_mass"] * rate,
            force_factor=factor,
            coil_resistance=resistance,
            coil_inductance=coil_inductance,
            current_control=current_control,
            voltage_limit=2.0 * sheet["amplifier_power"] / current,
            current_limit=current,
            travel_limit=0.5 * sheet["travel"],
        )

    @classmethod
    def from_file(cls, path: str | PathLike[str]) -> Shaker:
        """Read ``[shaker]`` of a TOML file or of a set that comes with the package.

        Parameters
        ----------
        path : path-like
            Or ``"shaker_10N"``, ``"shaker_100N"``, ``"shaker_1kN"``: typical values of these sizes,
            with a bare table.
        """
        return cls._read(path)

    @property
    def resonance(self) -> float:
        """Natural frequency of the table on its suspension with the coil open, Hz."""
        return math.sqrt(self.suspension_stiffness / self.table_mass) / TURN

    def command_for(self, acceleration: float, frequency: float, load: float = 0.0) -> float:
        """Return the command's amplitude, V or A, for a sine of the table under a rigid load.

        Parameters
        ----------
        acceleration, frequency : float
            Amplitude in m/s2, and Hz.
        load : float
            Mass that moves with the table, kg.
        """
        rate = 1j * TURN * frequency
        mechanical = self.suspension_stiffness + rate * self.suspension_damping
        force = mechanical + rate**2 * (self.table_mass + load)
        command = force / self.force_factor
        if not self.current_control:
            coil = self.coil_resistance + rate * self.coil_inductance
            command = command * coil + rate * self.force_factor
        return abs(command) * acceleration / abs(rate) ** 2

    def parameters(self) -> dict[str, float | bool]:
        """Return the values by name, as start values of the ``ElectrodynamicShaker`` FMU."""
        return dataclasses.asdict(self)
