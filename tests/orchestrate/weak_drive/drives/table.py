"""An electrodynamic shaker as somebody else would write it, exact for inputs that are held."""

import numpy as np
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from scipy.linalg import expm

NUMBERS = {"mass": 5.5, "stiffness": 400.0, "damping": 6.0, "bl": 12.0, "r": 3.0, "l": 0.05}


class Table(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        for name, value in NUMBERS.items():
            setattr(self, name, value)
            self.register_variable(
                Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable)
            )
        self.volts = self.specimen_force = 0.0
        for name in ("volts", "specimen_force"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        self.state = np.zeros(3)  # position, velocity, current
        outputs = {
            "table_acc": lambda: self.acceleration(),
            "table_vel": lambda: float(self.state[1]),
            "table_pos": lambda: float(self.state[0]),
            "amperes": lambda: float(self.state[2]),
            "reaction": lambda: -self.specimen_force,
        }
        for name, getter in outputs.items():
            self.register_variable(Real(name, causality=Fmi2Causality.output, getter=getter))

    def acceleration(self):
        x, v, i = self.state.tolist()
        force = self.bl * i - self.stiffness * x - self.damping * v + self.specimen_force
        return force / self.mass

    def do_step(self, current_time, step_size):
        matrix = np.zeros((4, 4))
        matrix[0, 1] = 1.0
        matrix[1, :3] = -self.stiffness, -self.damping, self.bl
        matrix[1, 3] = self.specimen_force
        matrix[1] /= self.mass
        matrix[2, 1:] = -self.bl / self.l, -self.r / self.l, self.volts / self.l
        self.state = (expm(matrix * step_size) @ [*self.state, 1.0])[:3]
        return True
