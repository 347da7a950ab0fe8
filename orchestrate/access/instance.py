"""A co-simulation instance: set, step, read, save its state."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from ctypes import byref, c_double, c_uint
from os import PathLike
from types import TracebackType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import FmuError, InputError, VibroimpactError
from .description import describe
from .unpacked import unpacked

REAL = ("Real", "Float64")
Reader = tuple[Callable[..., Any], list[Any], NDArray[np.float64]]


class Instance:
    """A co-simulation instance of an FMI 2.0 or 3.0 FMU, as a context manager.

    Parameters
    ----------
    path : path-like
    name : str
        Instance name.

    Attributes
    ----------
    description : Description

    Raises
    ------
    InputError
        Where there is no FMU, or none for this machine.
    StoreError
        Where it cannot be unpacked.

    Notes
    -----
    Every status but OK raises :class:`FmuError` with what the FMU logged, a discarded step too:
    importers' own loops may take that for the end of the simulation.

    Examples
    --------
    >>> from orchestrate.access import OSCILLATOR, Instance, find
    >>> with Instance(find(OSCILLATOR).path) as instance:
    ...     instance.initialize(box_amplitude=1.0, box_frequency=1.2)
    ...     instance.step(0.0, 100.0)
    ...     instance.get("impact_count")
    [22]
    """

    EVENTS: ClassVar[dict[str, bool]] = {}  # how an FMI 3.0 FMU is asked for its events

    def __init__(self, path: str | PathLike[str], name: str = "instance") -> None:
        self.description = describe(path)
        self._messages: list[str] = []
        self._readers: dict[tuple[str, ...], Reader] = {}
        self._open = False
        try:
            identity = {
                "guid": self.description.guid,
                "unzipDirectory": str(unpacked(self.description)),
                "modelIdentifier": self.description.identifier,
                "instanceName": name,
            }
            (self._make3 if self.is_fmi3 else self._make2)(identity)
        except VibroimpactError:
            raise
        except Exception as error:
            reason = f"FMU {path}: cannot be loaded ({error})"
            raise InputError(f"{reason}; expected an FMU with a binary for this machine") from None
        self._open = True

    @property
    def is_fmi3(self) -> bool:
        """Whether it is FMI 3.0, not 2.0."""
        return self.description.fmi_version.startswith("3")

    def _make2(self, identity: dict[str, str]) -> None:
        import fmpy
        from fmpy import fmi2

        self._fmu = fmi2.FMU2Slave(**identity)
        self._callbacks = fmi2.fmi2CallbackFunctions()
        self._callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
        self._callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        self._callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        # messages come as a format with arguments
        fmpy.logging.addLoggerProxy(byref(self._callbacks))
        self.call("instantiate", callbacks=self._callbacks, loggingOn=True)

    def _make3(self, identity: dict[str, str]) -> None:
        from fmpy import fmi3

        self._fmu = fmi3.FMU3Slave(**identity)
        self.call("instantiate", loggingOn=True, logMessage=self._log, **self.EVENTS)

    def __enter__(self) -> Any:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Free the instance; nothing may be asked of it afterwards."""
        if self._open:
            self._open = False
            self._fmu.freeInstance()

    def _log(self, *arguments: Any) -> None:
        """Keep a message; it is the last argument in both FMI versions."""
        self._messages.append(arguments[-1].decode(errors="replace"))

    def failure(self, error: object) -> FmuError:
        """The FMU's messages since they were last cleared; where there are none, ``error``."""
        quoted = r"(?s).*FmuError\(([\"'])(.*)\1\)\s*$"  # how pythonfmu hands an exception on
        texts = [re.sub(quoted, r"\2", message) for message in self._messages]
        return FmuError("; ".join(texts) or str(error))

    def call(self, function: str, *args: Any, **kwargs: Any) -> Any:
        """Call a method of FMPy's FMU, with the FMU's message where it fails."""
        self._messages.clear()
        try:
            return getattr(self._fmu, function)(*args, **kwargs)
        except Exception as error:
            raise self.failure(error) from None

    def variable(self, name: str) -> Any:
        """FMPy's description of a variable."""
        return self.description.variable(name)

    def set(self, **values: float) -> None:
        """Set variables by name."""
        types: dict[str, dict[int, float]] = {}
        for variable, value in zip(map(self.variable, values), values.values(), strict=True):
            types.setdefault(variable.type, {})[variable.valueReference] = value
        for type_name, chosen in types.items():
            self.call(f"set{type_name}", list(chosen), list(chosen.values()))

    def get(self, *names: str) -> list[Any]:
        """Values by name, as a list."""
        return [
            self.call(f"get{variable.type}", [variable.valueReference])[0]
            for variable in map(self.variable, names)
        ]

    def initialize(self, start_time: float = 0.0, **values: float) -> None:
        """Set ``values`` and initialise."""
        self.set(**values)
        if self.is_fmi3:
            self.call("enterInitializationMode", startTime=start_time)
        else:
            self.call("setupExperiment", startTime=start_time)
            self.call("enterInitializationMode")
        self.call("exitInitializationMode")

    def reset(self) -> None:
        """Back to the state after instantiation."""
        self.call("reset")

    def step(self, time: float, target: float) -> None:
        """One communication step from ``time`` to ``target``, s."""
        self.call("doStep", currentCommunicationPoint=time, communicationStepSize=target - time)

    def read(self, *names: str) -> NDArray[np.float64]:
        """Values of Real variables, in one call of the FMU.

        Parameters
        ----------
        *names : str
            The name of a series (``x1_sample``) stands for all its elements: indexed scalars in
            FMI 2.0, one array in FMI 3.0.

        Returns
        -------
        ndarray
            In the order of ``names``, valid until the next call with them.
        """
        if names not in self._readers:
            self._readers[names] = self._reader(names)
        function, arguments, values = self._readers[names]
        self._messages.clear()
        try:
            function(*arguments)
        except Exception as error:
            raise self.failure(error) from None
        return values

    def _reader(self, names: Sequence[str]) -> Reader:
        """FMPy's function, its arguments, and the array it fills."""
        found = [element for name in names for element in self.elements(name)]
        for variable in (variable for variable, _ in found if variable.type not in REAL):
            raise FmuError(f"{variable.name}: is {variable.type}; expected Real variables")
        references = (c_uint * len(found))(*(variable.valueReference for variable, _ in found))
        values = (c_double * sum(length for _, length in found))()
        arguments = [self._fmu.component, references, len(found), values]
        if self.is_fmi3:
            return (
                self._fmu.fmi3GetFloat64,
                [*arguments, len(values)],
                np.ctypeslib.as_array(values),
            )
        return self._fmu.fmi2GetReal, arguments, np.ctypeslib.as_array(values)

    def elements(self, name: str) -> list[tuple[Any, int]]:
        """Variables a name stands for, each with its number of values."""
        variables = self.description.variables
        if f"{name}[1]" not in variables:
            variable = self.variable(name)
            sizes = (int(dimension.start) for dimension in variable.dimensions or ())
            return [(variable, math.prod(sizes))]
        count = sum(other.startswith(f"{name}[") for other in variables)
        return [(variables[f"{name}[{i + 1}]"], 1) for i in range(count)]

    def save_state(self) -> bytes:
        """The whole state, serialised."""
        get, serialize, _, _, free = self.state_calls()
        state = self.call(get)
        try:
            return bytes(self.call(serialize, state))
        finally:
            self.call(free, state)

    def restore_state(self, data: bytes) -> None:
        """Back to a state that :meth:`save_state` gave."""
        _, _, deserialize, put, free = self.state_calls()
        state = self.call(deserialize, data)
        try:
            self.call(put, state)
        finally:
            self.call(free, state)

    def state_calls(self) -> tuple[str, str, str, str, str]:
        """FMPy's names of the state functions."""
        if self.is_fmi3:
            return (
                "getFMUState",
                "serializeFMUState",
                "deserializeFMUState",
                "setFMUState",
                "freeFMUState",
            )
        return (
            "getFMUstate",
            "serializeFMUstate",
            "deSerializeFMUstate",
            "setFMUstate",
            "freeFMUstate",
        )
