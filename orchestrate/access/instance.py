"""A co-simulation instance: set, step, read, save its state."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from ctypes import byref, c_bool, c_double, c_int, c_uint
from os import PathLike
from types import TracebackType
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import FmuError, InputError, VibroimpactError
from .description import describe
from .library import loaded

REAL = ("Real", "Float64")
WHOLE = ("Integer", "Int32")


class Transfer(NamedTuple):
    """One call that sets or reads some variables of a type, with arrays that are made once.

    Attributes
    ----------
    function : str
        Of the FMU.
    arguments : tuple
        After the instance.
    values : ctypes.Array
        Where they travel.
    places : list of int
        Of them among all that are set or read together.
    """

    function: str
    arguments: tuple[Any, ...]
    values: Any
    places: list[int]


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
        self._readers: dict[tuple[str, ...], tuple[Transfer, NDArray[np.float64]]] = {}
        self._transfers: dict[tuple[str, ...], list[Transfer]] = {}
        self._open = False
        try:
            self._fmu = loaded(self.description, name)
            (self._make3 if self.is_fmi3 else self._make2)()
        except VibroimpactError:
            raise
        except Exception as error:
            reason = f"FMU {path}: cannot be loaded ({error})"
            raise InputError(f"{reason}; expected an FMU with a binary for this machine") from None
        self._open = True
        self._step = self._stepper3() if self.is_fmi3 else self._stepper2()

    @property
    def is_fmi3(self) -> bool:
        """Whether it is FMI 3.0, not 2.0."""
        return self.description.is_fmi3

    def _make2(self) -> None:
        import fmpy
        from fmpy import fmi2

        self._callbacks = fmi2.fmi2CallbackFunctions()
        self._callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
        self._callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        self._callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        # messages come as a format with arguments
        fmpy.logging.addLoggerProxy(byref(self._callbacks))
        self.call("instantiate", callbacks=self._callbacks, loggingOn=True)

    def _make3(self) -> None:
        self.call("instantiate", loggingOn=True, logMessage=self._log, **self.EVENTS)

    def _stepper2(self) -> Callable[[float, float], None]:
        """``fmi2DoStep``: time and length of a step."""
        return lambda time, length: self.run("fmi2DoStep", time, length, True)

    def _stepper3(self) -> Callable[[float, float], None]:
        """``fmi3DoStep``."""
        flags, last = [c_bool() for _ in range(3)], c_double()
        answers = [*map(byref, flags), byref(last)]
        return lambda time, length: self.run("fmi3DoStep", time, length, True, *answers)

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
            free = self._fmu.fmi3FreeInstance if self.is_fmi3 else self._fmu.fmi2FreeInstance
            free(self._fmu.component)

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

    def run(self, function: str, *arguments: Any) -> None:
        """Call a function of the binary itself, past FMPy's wrapper, for what is called often."""
        self._messages.clear()
        status = getattr(self._fmu.dll, function)(self._fmu.component, *arguments)
        if status:
            raise self.failure(f"{function} failed with status {status}")

    def variable(self, name: str) -> Any:
        """FMPy's description of a variable."""
        return self.description.variable(name)

    def set(self, **values: float) -> None:
        """Set variables by name."""
        names = ("Set", *values)
        transfers = self._transfers.get(names) or self._grouped(names)
        given = list(values.values())
        for function, arguments, array, places in transfers:
            try:
                array[:] = [given[place] for place in places]
            except TypeError as error:
                raise FmuError(str(error)) from None
            self.run(function, *arguments)

    def get(self, *names: str) -> list[Any]:
        """Values by name, as a list."""
        key = ("Get", *names)
        found: list[Any] = [None] * len(names)
        for function, arguments, array, places in self._transfers.get(key) or self._grouped(key):
            self.run(function, *arguments)
            for place, value in zip(places, array, strict=True):
                found[place] = value
        return found

    def _grouped(self, names: tuple[str, ...]) -> list[Transfer]:
        """Calls that set or read variables, one a type; the first name says which."""
        verb, *others = names
        places: dict[str, list[int]] = {}
        for place, name in enumerate(others):
            places.setdefault(self.variable(name).type, []).append(place)
        found = [
            self._transfer(verb, kind, [(self.variable(others[i]), 1) for i in some], some)
            for kind, some in places.items()
        ]
        self._transfers[names] = found
        return found

    def _transfer(
        self, verb: str, kind: str, variables: Sequence[tuple[Any, int]], places: list[int]
    ) -> Transfer:
        """A call for variables of a type, each with its number of values."""
        if kind not in (*REAL, *WHOLE, "Boolean"):
            raise FmuError(f"{variables[0][0].name}: is {kind}; expected numbers and Booleans")
        flag = c_bool if self.is_fmi3 else c_int
        element: Any = c_double if kind in REAL else c_int if kind in WHOLE else flag
        values = (element * sum(length for _, length in variables))()
        count = len(variables)
        references = (c_uint * count)(*(variable.valueReference for variable, _ in variables))
        sizes = (len(values),) if self.is_fmi3 else ()
        function = f"fmi{3 if self.is_fmi3 else 2}{verb}{kind}"
        return Transfer(function, (references, count, values, *sizes), values, places)

    def initialize(self, start_time: float = 0.0, **values: float) -> None:
        """Set ``values`` and initialise."""
        self.set(**values)
        start = (False, 0.0, start_time, False, 0.0)  # no tolerance, no end
        if self.is_fmi3:
            self.run("fmi3EnterInitializationMode", *start)
            self.run("fmi3ExitInitializationMode")
        else:
            self.run("fmi2SetupExperiment", *start)
            self.run("fmi2EnterInitializationMode")
            self.run("fmi2ExitInitializationMode")

    def reset(self) -> None:
        """Back to the state after instantiation."""
        self.run("fmi3Reset" if self.is_fmi3 else "fmi2Reset")

    def step(self, time: float, target: float) -> None:
        """One communication step from ``time`` to ``target``, s."""
        self._step(time, target - time)

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
        transfer, values = self._reader(names)
        self.run(transfer.function, *transfer.arguments)
        return values

    def size(self, *names: str) -> int:
        """How many values :meth:`read` gives."""
        return len(self._reader(names)[1])

    def _reader(self, names: tuple[str, ...]) -> tuple[Transfer, NDArray[np.float64]]:
        """A call that reads Real variables, and the array it fills."""
        if names not in self._readers:
            found = [element for name in names for element in self.elements(name)]
            for variable in (variable for variable, _ in found if variable.type not in REAL):
                raise FmuError(f"{variable.name}: is {variable.type}; expected Real variables")
            transfer = self._transfer("Get", found[0][0].type, found, [])
            self._readers[names] = transfer, np.ctypeslib.as_array(transfer.values)
        return self._readers[names]

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
