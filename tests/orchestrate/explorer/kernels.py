"""The oscillator's kernel as a native FMU, driven as :class:`tests.web_instance.WebInstance` is."""

import math

from ...fmu.programs.driver import open_fmu


class Native:
    """An instance of the FMI 2.0 binary, whose serialised state has its whole memory."""

    def __init__(self, path, size):
        self.fmu, self.size = open_fmu(path), size

    def bytes(self):
        return bytes(self.fmu.save()[0])[-8 * self.size - 8 : -8]

    def begin(self, **values):
        self.fmu.start(**values)

    def set(self, **values):
        self.fmu.set(**values)

    def step(self, time, target):
        self.fmu.call("doStep", time, target - time)


def period(frequency):
    """One period of the box, s."""
    return 2.0 * math.pi / frequency
