"""Where the motor's work has gone, and what the coupling has lost of it on the way.

The shaker's FMU keeps its own books. What the structure has lost, in dampers and impacts, follows from the work that the box's acceleration
did on it, as it was told it, less the energy it has stored: the momentum P of the masses is known at both ends of a step with its rate and
mean, so the integral of P times acceleration is.

The defect of a step is the difference between the work that one side gives and the other takes. A small defect is necessary, not
sufficient: two sides may agree on a wrong motion.
"""

from .exchange import E_DAMPER, E_MOTOR, E_STORED, IMPACT_ENERGY, V1, V2, X1, X2, R, V
from .polynomials import product, quartic


class Ledger:
    """Accounts of a run.

    Parameters
    ----------
    setup : Setup
    x, s : list of float
        Outputs of oscillator and shaker at the start.

    Attributes
    ----------
    lost : float
        Energy lost in the structure, J.
    defect, largest : float
        Sum of the steps' defects, and of their sizes, J.
    """

    def __init__(self, setup, x, s):
        structure = setup.oscillator()
        self._numbers = [structure[name] for name in ("m1", "m2", "k1", "k2")]
        self.lost = self.defect = self.sizes = 0.0
        self.start = self._entries(x, s)

    def relative_energy(self, x):
        """Energy of the structure, seen from the box."""
        m1, m2, k1, k2 = self._numbers
        return 0.5 * (m1 * x[V1] * x[V1] + m2 * x[V2] * x[V2] + k1 * x[X1] * x[X1] + k2 * x[X2] * x[X2])

    def energy(self, x, velocity):
        """Energy of the structure, the box moving with ``velocity``."""
        m1, m2, _, _ = self._numbers
        return self.relative_energy(x) + velocity * (m1 * x[V1] + m2 * x[V2] + 0.5 * (m1 + m2) * velocity)

    def add(self, x, x_new, acceleration, defect, h):
        """Enter a step: the oscillator's outputs before and after it, what it was told, and the step's defect."""
        m1, m2, _, _ = self._numbers
        mass = m1 + m2
        a0, a1, a2, a3 = acceleration
        a_end = a0 + h * (a1 + 0.5 * h * (a2 + h * a3 / 3.0))
        ends = (m1 * x[V1] + m2 * x[V2], m1 * x_new[V1] + m2 * x_new[V2])
        slopes = (-h * (x[R] + mass * a0), -h * (x_new[R] + mass * a_end))
        mean = (m1 * (x_new[X1] - x[X1]) + m2 * (x_new[X2] - x[X2])) / h
        momentum = quartic(ends, slopes, mean)
        told = h * product(momentum, (a0, a1 * h, a2 * h * h / 2.0, a3 * h * h * h / 6.0))
        self.lost += self.relative_energy(x) - self.relative_energy(x_new) - told
        self.defect += defect
        self.sizes += abs(defect)

    def _entries(self, x, s):
        """Accounts at a communication point, since the instances' start."""
        return {
            "motor": s[E_MOTOR],
            "box_damper": s[E_DAMPER],
            "impacts": x[IMPACT_ENERGY],
            "stored": s[E_STORED] + self.energy(x, s[V]),
            "dampers": self.lost - x[IMPACT_ENERGY],
        }

    def memory(self):
        """The accounts, as a list of floats."""
        return [self.lost, self.defect, self.sizes, *self.start.values()]

    def remember(self, numbers):
        """The inverse of :meth:`memory`."""
        self.lost, self.defect, self.sizes = numbers[:3]
        self.start = dict(zip(self.start, numbers[3:], strict=True))

    def entries(self, x, s):
        """Accounts since the ledger was opened, J; ``missing`` is what does not add up, ``defect`` the part of the exchange in it."""
        found = {name: value - self.start[name] for name, value in self._entries(x, s).items()}
        missing = found["motor"] - sum(value for name, value in found.items() if name != "motor")
        return {**found, "missing": missing, "defect": self.defect, "defect_sizes": self.sizes}
