"""FMU instance for co-simulation: set, get, step, save and restore its state (FMI 2.0 and 3.0)."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from ctypes import byref, c_bool, c_double, c_int, c_size_t, c_uint, c_void_p, cast
from functools import partial
from os import PathLike
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import FmuError, InputError, VibroimpactError
from .description import describe
from .unpacked import new_fmu_object

REAL_TYPES = ("Real", "Float64")
INTEGER_TYPES = ("Integer", "Int32")
STATUSES = ("OK", "warning", "discard", "error", "fatal", "pending")  # of FMI, by number
WARNING, DISCARD, ERROR = (STATUSES.index(word) for word in ("warning", "discard", "error"))
Prepared = Callable[[], None]


def function_addresses(instance: Instance, names: Sequence[str]) -> tuple[int, ...]:
    """Return the addresses of an instance and of functions of FMI, for compiled code."""
    dll, known = instance._fmu.dll, instance._addresses
    prefix = "fmi3" if instance.is_fmi3 else "fmi2"
    for name in names:
        if name not in known:  # looking one up takes longer than a step
            known[name] = cast(dll[f"{prefix}{name}"], c_void_p).value or 0
    return (instance._fmu.component, *(known[name] for name in names))


class Transfer(NamedTuple):
    """A prepared FMI set or get call for several variables of one type, with its value buffer."""

    call: Prepared
    values: Any  # where they travel
    positions: list[int]  # of them among all that are set or read together


class Instance:
    """Co-simulation instance of an FMI 2.0 or 3.0 FMU, as a context manager.

    Notes
    -----
    Every status but OK and a warning raises :class:`FmuError` with what the FMU logged, a discarded
    step too: importers' own loops may take that for the end of the simulation.

    Examples
    --------
    >>> from orchestrate.fmu import OSCILLATOR, Instance, find_or_export
    >>> with Instance(find_or_export(OSCILLATOR).path) as instance:
    ...     instance.initialize(box_amplitude=1.0, box_frequency=1.2)
    ...     instance.step(0.0, 100.0)
    ...     instance.get("impact_count")
    [22]
    """

    EVENTS: ClassVar[dict[str, bool]] = {}  # arguments that make an FMI 3.0 FMU report events

    def __init__(self, path: str | PathLike[str], name: str = "instance") -> None:
        self.description = describe(path)
        self._messages: list[tuple[int, str]] = []  # of the last call: status and text
        self.warnings: dict[str, None] = {}  # texts of all calls that answered a warning, in order
        self._transfers: dict[tuple[str, ...], list[Transfer]] = {}
        self._addresses: dict[str, int] = {}  # of FMI's functions, as far as they are known
        self.cache: dict[object, Any] = {}  # what callers prepare once for this instance
        self._open = False
        try:
            self._fmu = new_fmu_object(self.description, name)
            self._instantiate()
        except VibroimpactError:
            raise
        except Exception as error:
            reason = f"FMU {path}: cannot be loaded ({error})"
            raise InputError(f"{reason}; expected an FMU with a binary for this machine") from None
        self._open = True
        self._start, self._time, self._length = c_double(), c_double(), c_double()
        self._prepare_run()

    @property
    def is_fmi3(self) -> bool:
        return self.description.is_fmi3

    def _instantiate(self) -> None:
        if self.is_fmi3:
            self.call("instantiate", loggingOn=True, logMessage=self._log, **self.EVENTS)
            return
        import fmpy
        from fmpy import fmi2

        self._callbacks = fmi2.fmi2CallbackFunctions()
        self._callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
        self._callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        self._callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        # messages come as a format with arguments
        fmpy.logging.addLoggerProxy(byref(self._callbacks))
        self.call("instantiate", callbacks=self._callbacks, loggingOn=True)

    def _prepare_run(self) -> None:
        """Prepare the calls that initialise, step and reset; FMI 3.0 needs no setup before."""
        prefix, flag = ("fmi3", c_bool) if self.is_fmi3 else ("fmi2", c_int)
        none = flag(False), c_double()  # no tolerance; no end
        names = ["EnterInitializationMode", "ExitInitializationMode"]
        results: list[Any] = []
        if self.is_fmi3:
            names += ["EnterStepMode"] if self.EVENTS else []
            results = [*(byref(c_bool()) for _ in range(3)), byref(c_double())]
        else:
            names = ["SetupExperiment", *names]
        first, *rest = (f"{prefix}{name}" for name in names)
        self._initialize = [self.prepare_call(first, *none, self._start, *none)]
        self._initialize += [self.prepare_call(name) for name in rest]
        self._reset = self.prepare_call(f"{prefix}Reset")
        step = self._time, self._length, flag(True), *results
        self._step = self.prepare_call(f"{prefix}DoStep", *step)

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        if self._open:
            self._open = False
            free = self._fmu.fmi3FreeInstance if self.is_fmi3 else self._fmu.fmi2FreeInstance
            free(self._fmu.component)

    def _log(self, *arguments: Any) -> None:
        status, _, message = arguments[-3:]
        self._messages.append((int(status), message.decode(errors="replace")))

    def logged_messages(self, min_status: int = 0) -> str:
        """Return what the FMU logged in the last call with at least this status, each text once."""
        quoted = r"(?s).*FmuError\(([\"'])(.*)\1\)\s*$"  # how pythonfmu hands an exception on
        messages = (text for status, text in self._messages if status >= min_status)
        texts = (re.sub(quoted, r"\2", text) for text in messages)
        return "; ".join(dict.fromkeys(texts))

    def error_from_log(self, otherwise: object) -> FmuError:
        """Return the error with what the FMU logged in the last call, or else with this text."""
        return FmuError(self.logged_messages() or str(otherwise))

    def status_error(self, function: str, status: int) -> FmuError:
        """Return the ``FmuError`` for a status that ends a run: what was logged, or the status."""
        in_words = STATUSES[status] if 0 <= status < len(STATUSES) else f"status {status}"
        call = f"{function} of the FMU {self.description.name}"
        return self.error_from_log(f"{call} failed ({in_words}) without a message")

    def check_status(self, function: str, status: int) -> None:
        """Raise ``FmuError`` unless a call of the FMU answered OK, or a warning, which is kept."""
        if status == WARNING:
            logged = self.logged_messages(WARNING) or self.logged_messages()
            text = logged or f"{function}, without a message"
            self.warnings[" ".join(f"the FMU {self.description.name} warns: {text}".split())] = None
        elif status:
            raise self.status_error(function, status)

    def call(self, function: str, *args: Any, **kwargs: Any) -> Any:
        """Call a method of FMPy's FMU object; what it raises becomes an ``FmuError``."""
        self._messages.clear()
        try:
            return getattr(self._fmu, function)(*args, **kwargs)
        except Exception as error:
            raise self.error_from_log(error) from None

    def prepare_call(self, function: str, *arguments: Any) -> Prepared:
        """Return a fast callable of an FMI C function with fixed arguments; it raises on failure.

        FMPy and ctypes take longer to convert arguments than the FMU to answer. Here they are made
        once: C numbers, whose values may change from call to call, and arrays.
        """
        call = partial(self._fmu.dll[function], c_void_p(self._fmu.component), *arguments)
        messages = self._messages

        def run() -> None:
            messages.clear()
            if status := call():
                self.check_status(function, status)

        return run

    def variable(self, name: str) -> Any:
        return self.description.variable(name)

    def set(self, /, **values: float) -> None:
        names = ("Set", *values)
        new_values = list(values.values())
        for call, array, positions in self._transfers.get(names) or self._prepare_transfers(names):
            everything = len(positions) == len(new_values)
            selected = new_values if everything else [new_values[i] for i in positions]
            try:
                array[:] = selected
            except TypeError as error:
                raise FmuError(str(error)) from None
            call()

    def get(self, *names: str) -> list[Any]:
        key = ("Get", *names)
        values: list[Any] = [None] * len(names)
        for call, array, positions in self._transfers.get(key) or self._prepare_transfers(key):
            call()
            if len(positions) == len(names):
                return list(array[:])
            for position, value in zip(positions, array, strict=True):
                values[position] = value
        return values

    def _prepare_transfers(self, names: tuple[str, ...]) -> list[Transfer]:
        """Prepare an FMI call per data type for variables; the first name: ``Set``/``Get``."""
        verb, *variables = names
        found = [self.variable(name) for name in variables]
        positions: dict[str, list[int]] = {}
        for position, variable in enumerate(found):
            positions.setdefault(variable.type, []).append(position)
        self._transfers[names] = [
            self._prepare_transfer(verb, kind, [found[i] for i in indices], indices)
            for kind, indices in positions.items()
        ]
        return self._transfers[names]

    def _prepare_transfer(
        self, verb: str, kind: str, variables: Sequence[Any], positions: list[int]
    ) -> Transfer:
        """Prepare one FMI set or get call for variables of one type; return it with its buffer."""
        if kind not in (*REAL_TYPES, *INTEGER_TYPES, "Boolean"):
            raise FmuError(f"{variables[0].name}: is {kind}; expected numbers and Booleans")
        flag = c_bool if self.is_fmi3 else c_int
        element: Any = c_double if kind in REAL_TYPES else c_int if kind in INTEGER_TYPES else flag
        count = len(variables)
        values = (element * count)()
        references = (c_uint * count)(*(variable.valueReference for variable in variables))
        sizes = (c_size_t(count),) if self.is_fmi3 else ()
        function = f"fmi{3 if self.is_fmi3 else 2}{verb}{kind}"
        call = self.prepare_call(function, references, c_size_t(count), values, *sizes)
        if verb == "Set" or kind not in REAL_TYPES:
            return Transfer(call, values, positions)
        numbers = np.ctypeslib.as_array(values)

        def call_and_check() -> None:
            call()
            if not math.isfinite(numbers.sum()) and not np.isfinite(numbers).all():
                raise self.not_finite_error([variable.name for variable in variables], numbers)

        return Transfer(call_and_check, values, positions)

    def not_finite_error(self, names: Sequence[str], values: ArrayLike) -> FmuError:
        index = int(np.flatnonzero(~np.isfinite(values))[0])
        text = f"{names[index]} = {np.ravel(values)[index]}"
        return FmuError(f"the FMU {self.description.name} answers {text}; expected a finite number")

    def initialize(self, start_time: float = 0.0, **values: float) -> None:
        """Set start values and enter the mode of steps."""
        self.set(**values)
        self._start.value = start_time
        for call in self._initialize:
            call()

    def reset(self) -> None:
        self._reset()

    def step(self, time: float, target: float) -> None:
        self._time.value, self._length.value = time, target - time
        self._step()

    def read(self, *names: str) -> NDArray[np.float64]:
        """Return values as :meth:`get` does, as an array."""
        return np.array(self.get(*names), dtype=float)

    def elements(self, name: str) -> list[tuple[Any, int]]:
        """Return the FMI variables behind an (array's) name, each with its number of values."""
        variables = self.description.variables
        if f"{name}[1]" not in variables:
            variable = self.variable(name)
            sizes = (int(dimension.start) for dimension in variable.dimensions or ())
            return [(variable, math.prod(sizes))]
        count = sum(variable_name.startswith(f"{name}[") for variable_name in variables)
        return [(variables[f"{name}[{i + 1}]"], 1) for i in range(count)]

    def save_state(self) -> bytes:
        state = self.call("getFMUState")
        try:
            return bytes(self.call("serializeFMUState", state))
        finally:
            self.call("freeFMUState", state)

    def restore_state(self, data: bytes) -> None:
        state = self.call("deserializeFMUState", data)
        try:
            self.call("setFMUState", state)
        finally:
            self.call("freeFMUState", state)
