"""Parameter sets of the weak drive: structure, box and motor, in SI units, with their non-dimensional numbers.

Non-dimensional: time 1/omega, length S/M_t, beta = m1/M_t, epsilon = S^2/(J M_t), b = B/(J omega) with the torque line A U - B phi',
A = K/R_a and B = K^2/R_a, eta0 = U/(K omega), the no-load speed: the "voltage". Omega_b^2 = k_b/(M_t omega^2), D_b = c_b/(2 omega M_t).
"""

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Setup:
    """Two masses in a box that a motor shakes.

    Attributes
    ----------
    name : str
    m1, omega : float
        kg, rad/s.
    mu, kappa, D, e, gamma : float
        The structure's numbers, as in a sweep.
    damping_ratio : float
        d2/m2 over d1/m1: where it is not 1, the force on the box jumps at an impact.
    bonded : bool
        The undamaged structure.
    box_mass, Omega_b, D_b : float
        Box: kg, 1, 1.
    unbalance_mass, unbalance_radius, rotor_inertia : float
        kg, m, kg m^2.
    motor_constant, armature_resistance : float
        N m/A, Ohm.
    """

    name: str
    m1: float
    omega: float
    box_mass: float
    unbalance_mass: float
    unbalance_radius: float
    rotor_inertia: float
    motor_constant: float
    armature_resistance: float
    D: float
    mu: float = 1.0
    kappa: float = 1.2
    e: float = 0.7
    gamma: float = 1e-4
    damping_ratio: float = 1.0
    bonded: bool = False
    Omega_b: float = 0.1
    D_b: float = 0.005

    @property
    def length(self):
        """The unit of length S/M_t, m."""
        return self.unbalance_mass * self.unbalance_radius / self.box_mass

    @property
    def beta(self):
        """Mass ratio m1/M_t."""
        return self.m1 / self.box_mass

    @property
    def epsilon(self):
        """The unbalance's share in the inertia, S^2/(J M_t)."""
        return self.length**2 * self.box_mass / self.rotor_inertia

    @property
    def b(self):
        """Slope of the torque line, B/(J omega)."""
        return self.motor_constant**2 / self.armature_resistance / (self.rotor_inertia * self.omega)

    @property
    def volts(self):
        """Voltage at eta0 = 1, V."""
        return self.motor_constant * self.omega

    @property
    def energy(self):
        """The unit of energy M_t (omega S/M_t)^2, J."""
        return self.box_mass * (self.omega * self.length) ** 2

    def oscillator(self):
        """Parameters of ``TwoMassImpactOscillator``; its own harmonic box motion is off."""
        damping, stiffness = 2.0 * self.D * self.omega * self.m1, self.m1 * self.omega**2
        masses = {"m1": self.m1, "m2": self.mu * self.m1, "k1": stiffness, "k2": self.kappa * stiffness}
        losses = {"d1": damping, "d2": self.damping_ratio * self.mu * damping, "e": self.e, "gamma": self.gamma}
        return {**masses, **losses, "bonded": self.bonded, "box_amplitude": 0.0, "box_frequency": 0.0, "x_rel_max_on": False}

    def shaker(self):
        """Parameters of ``MotorShaker``."""
        box = {
            "box_mass": self.box_mass,
            "box_stiffness": self.box_mass * (self.Omega_b * self.omega) ** 2,
            "box_damping": 2.0 * self.D_b * self.omega * self.box_mass,
        }
        own = ("unbalance_mass", "unbalance_radius", "rotor_inertia", "motor_constant", "armature_resistance")
        return {**box, **{name: getattr(self, name) for name in own}, "armature_inductance": 0.0}

    def as_bonded(self):
        """The undamaged structure."""
        return replace(self, bonded=True)


def nondimensional(name, beta, epsilon, b, D, **more):
    """A set with omega = 1 rad/s, M_t = 1 kg, S = 1 kg m and 1 V for eta0 = 1: every SI number is the non-dimensional one."""
    inertia = 1.0 / epsilon
    return Setup(name, beta, 1.0, 1.0, 0.01, 100.0, inertia, 1.0, 1.0 / (b * inertia), D, **more)


QUICK = nondimensional("quick", 3.0 / 11.0, 1.0 / 1100.0, 0.02, 0.02)
BEAM = Setup("beam", 1.5, 75.0, 5.5, 0.025, 0.02, 5e-5, 0.06, 12.0, 0.005)
SETUPS = {setup.name: setup for setup in (QUICK, BEAM)}
TURN = 2.0 * math.pi
