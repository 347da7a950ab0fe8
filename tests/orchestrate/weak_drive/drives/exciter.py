"""A box that nothing stops, and forces on the halves, all harmonic."""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Exciter(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time = self.pull = 0.0
        self.rate, self.amplitude, self.size1, self.size2 = 9.0, 0.02, 2.0, -1.5
        for name in ("rate", "amplitude", "size1", "size2"):
            kinds = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.tunable}
            self.register_variable(Real(name, **kinds))
        self.register_variable(Real("pull", causality=Fmi2Causality.input))
        outputs = {
            "acc": lambda: -self.amplitude * self.rate**2 * math.sin(self.rate * self.time),
            "vel": lambda: self.amplitude * self.rate * math.cos(self.rate * self.time),
            "push": lambda: self.size1 * math.sin(self.rate * self.time),
            "millinewtons": lambda: 1e3 * self.size2 * math.sin(self.rate * self.time),
        }
        for name, getter in outputs.items():
            self.register_variable(Real(name, causality=Fmi2Causality.output, getter=getter))

    def do_step(self, current_time, step_size):
        self.time = current_time + step_size
        return True
