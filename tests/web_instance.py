"""Run the WebAssembly module under wasmtime, for tests and campaigns."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fmu_src.export.sources import load_model
from fmu_src.runtime.table import BOOLEAN, INTEGER, REAL
from orchestrate.fmu.webassembly import WebKernel

FOLDER = "oscillator"
SETTERS = {REAL: ("Float64", "f8"), INTEGER: ("Int32", "i4"), BOOLEAN: ("Boolean", "u1")}


@functools.cache
def compiled(code: bytes) -> tuple[Any, Any]:
    """Return the engine and the module, which is compiled once for all instances."""
    import wasmtime

    engine = wasmtime.Engine()
    module = wasmtime.Module(engine, code)
    assert not module.imports
    return engine, module


class WebInstance:
    """An oscillator in the WebAssembly module, driven by FMI's functions."""

    def __init__(self, kernel: WebKernel) -> None:
        import wasmtime

        engine, module = compiled(kernel.module)
        self.model, self.variables = load_model(FOLDER), kernel.variables[FOLDER]
        self.types = {variable.name: variable.type for variable in self.model.variables}
        self.store = wasmtime.Store(engine)
        self.exports = wasmtime.Instance(self.store, module, []).exports(self.store)
        self.exports["_initialize"](self.store)
        self.room = self.exports["malloc"](self.store, 1024 + 16 * self.model.memory_size)
        assert self.exports[f"{FOLDER}_open_fmu"](self.store, self.room, 0)
        (self.instance,) = self.read(self.room, "u4", 1)

    def read(self, place: int, kind: str, count: int) -> NDArray[Any]:
        size = count * np.dtype(kind).itemsize
        return np.frombuffer(self.exports["memory"].read(self.store, place, place + size), kind)

    def write(self, place: int, values: ArrayLike, kind: str) -> int:
        """Write numbers at a place of the module's memory; return the place."""
        self.exports["memory"].write(self.store, np.asarray(values, kind).tobytes(), place)
        return place

    def call(self, name: str, *numbers: float) -> bool:
        function = self.exports[f"{FOLDER}_fmi3{name}"]
        return bool(function(self.store, int(self.instance), *numbers) == 0)

    def bytes(self) -> bytes:
        """Return the instance's whole memory as bytes, out of its saved state."""
        state, size = self.write(self.room, 0, "u4"), self.room + 4
        assert self.call("GetFMUState", state)
        handle = int(self.read(state, "u4", 1)[0])
        assert self.call("SerializedFMUStateSize", handle, size)
        count = int(self.read(size, "u4", 1)[0])
        assert self.call("SerializeFMUState", handle, self.room + 8, count)
        saved = self.read(self.room + 8, "u1", count).tobytes()
        assert self.call("FreeFMUState", state)
        return saved[-8 * self.model.memory_size - 8 : -8]

    def memory(self) -> NDArray[np.float64]:
        return np.frombuffer(self.bytes())

    def set(self, **values: float) -> bool:
        """Set variables by name; return whether all may be set so."""
        done = True
        for name, value in values.items():
            setter, kind = SETTERS[self.types[name]]
            reference = self.write(self.room, self.variables[name], "u4")
            place = self.write(self.room + 8, value, kind)
            done = self.call(f"Set{setter}", reference, 1, place, 1) and done
        return done

    def begin(self, start_time: float = 0.0, **values: float) -> bool:
        """Reset the instance, set values over the defaults, and initialise it; whether it did."""
        assert self.call("Reset")
        enter = "EnterInitializationMode", 0, 0.0, start_time, 0, 0.0
        return self.set(**values) and self.call(*enter) and self.call("ExitInitializationMode")

    def step(self, time: float, target: float) -> bool:
        """Do one communication step from ``time`` to ``target``, s; return whether it did."""
        answers = [self.room + place for place in (0, 1, 2, 8)]
        return self.call("DoStep", time, target - time, 0, *answers)
