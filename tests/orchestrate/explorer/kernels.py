"""The oscillator's kernel as a native FMU, driven as :class:`tools.web_instance.WebInstance` is."""

import math

from ...native.slave import Slave


class Native:
    """An instance of the FMI 2.0 binary, whose serialised state has its whole memory."""

    def __init__(self, path, size):
        self.slave, self.size = Slave(path), size

    def bytes(self):
        fmu = self.slave.fmu
        state = fmu.getFMUState()
        found = fmu.serializeFMUState(state)
        fmu.freeFMUState(state)
        return bytes(found)[-8 * self.size - 8 : -8]

    def begin(self, **values):
        fmu = self.slave.fmu
        self.slave.set(**values)
        fmu.setupExperiment(startTime=0.0)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()

    def set(self, **values):
        self.slave.set(**values)

    def step(self, time, target):
        self.slave.fmu.doStep(time, target - time)


def period(frequency):
    """One period of the box, s."""
    return 2.0 * math.pi / frequency
