"""Run the kernel's WebAssembly module under wasmtime, for tests and campaigns."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orchestrate.fmu.webassembly import WebKernel


class WebInstance:
    """An oscillator in the WebAssembly module, with its memory."""

    def __init__(self, kernel: WebKernel) -> None:
        """Instantiate the WebAssembly module and find its memory."""
        import wasmtime

        self.slots, self.store = kernel.slots, wasmtime.Store()
        module = wasmtime.Module(self.store.engine, kernel.module)
        assert not module.imports
        self.exports = wasmtime.Instance(self.store, module, []).exports(self.store)
        self.exports["_initialize"](self.store)
        place = self.exports["malloc"](self.store, 1024)
        assert self.exports["open_fmu"](self.store, place, 0)
        self.address = self.exports["memory_of"](self.store, place)
        self.starts = kernel.starts

    def bytes(self) -> bytes:
        """Return the instance's whole memory as bytes."""
        end = self.address + 8 * self.slots["SIZE"]
        return bytes(self.exports["memory"].read(self.store, self.address, end))

    def memory(self) -> NDArray[np.float64]:
        """Return the instance's memory as numbers, one per slot."""
        return np.frombuffer(self.bytes())

    def set(self, **values: float) -> None:
        """Set slots by name; with a cubic input the shim's flag too."""
        for name, value in values.items():
            place = self.address + 8 * self.slots[name]
            self.exports["memory"].write(self.store, np.float64(value).tobytes(), place)
            if self.slots["CUBIC"] <= self.slots[name] < self.slots["CUBIC_END"]:
                self.set(SET=1.0)

    def begin(self, **values: float) -> None:
        """Reset the instance, set values over the defaults, and initialise it at time 0."""
        size = 8 * self.slots["SIZE"]
        self.exports["memory"].write(self.store, bytes(size), self.address)
        self.set(**{**self.starts, **values})
        assert self.exports["kernel_initialize"](self.store, self.address, 0.0) == 0

    def step(self, time: float, target: float) -> None:
        """Do one communication step from ``time`` to ``target``, s."""
        self.set(STOP=0.0)
        target = max(time + (target - time), self.memory()[self.slots["TIME"]])
        assert self.exports["kernel_advance"](self.store, self.address, target) == 0
