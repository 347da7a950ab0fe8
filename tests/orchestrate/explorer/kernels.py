"""The oscillator's kernel twice, driven alike: WebAssembly under wasmtime, and the native FMU."""

import math

import numpy as np

from ...native.slave import Slave


class Web:
    """An instance in the WebAssembly module."""

    def __init__(self, kernel):
        import wasmtime

        self.slots, self.store = kernel.slots, wasmtime.Store()
        module = wasmtime.Module(self.store.engine, kernel.module)
        assert not module.imports
        self.exports = wasmtime.Instance(self.store, module, []).exports(self.store)
        base = self.exports["__heap_base"].value(self.store)
        self.address = -(-base // 16) * 16
        memory = self.exports["memory"]
        missing = self.address + 8 * self.slots["SIZE"] - memory.data_len(self.store)
        if missing > 0:
            memory.grow(self.store, -(-missing // 65536))
        self.starts = kernel.starts

    def bytes(self):
        end = self.address + 8 * self.slots["SIZE"]
        return bytes(self.exports["memory"].read(self.store, self.address, end))

    def memory(self):
        return np.frombuffer(self.bytes())

    def set(self, **values):
        for name, value in values.items():
            place = self.address + 8 * self.slots[name]
            self.exports["memory"].write(self.store, np.float64(value).tobytes(), place)
            if self.slots["CUBIC"] <= self.slots[name] < self.slots["CUBIC_END"]:
                self.set(SET=1.0)

    def begin(self, **values):
        size = 8 * self.slots["SIZE"]
        self.exports["memory"].write(self.store, bytes(size), self.address)
        self.set(**{**self.starts, **values})
        assert self.exports["kernel_initialize"](self.store, self.address, 0.0) == 0

    def step(self, time, target):
        self.set(STOP=0.0)
        target = max(time + (target - time), self.memory()[self.slots["TIME"]])
        assert self.exports["kernel_advance"](self.store, self.address, target) == 0


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
