"""The slave inside a pythonfmu FMU: FMI 2.0 calls onto a kernel's flat memory.

Standard library only, Python 3.9. pythonfmu 0.7.0 releases the references to class, instance and
log queue whenever an exception leaves a slave, and once more when the instance is freed; a second
call then crashes the process. :meth:`Slave.refuse` therefore takes one more reference to each
before it raises. ``doStep`` never raises: it logs, and returns False. Every other call has no way
but an exception to give the importer a status that is not OK.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import struct
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from .compiled import load_compiled_kernel
from .table import BOOLEAN, INTEGER, REAL, Model, Variable, format_message, hidden_slot_problem

PHASES = INSTANTIATED, INITIALIZING, STEPPING, TERMINATED = 0.0, 1.0, 2.0, 3.0
ERRORS, WARNINGS, ALL = "logStatusError", "logStatusWarning", "logAll"  # of messages
STATE_MAGIC = b"vibroimpact state "
STATE_HEAD, CHECKSUM = 64, 8  # bytes


class FmuError(Exception):
    """A user's mistake or an unfinished step; the message is one line."""


class Callbacks(ctypes.Structure):
    """The importer's ``fmi2CallbackFunctions``."""

    LOG = ctypes.CFUNCTYPE(  # componentEnvironment, instanceName, status, category, message
        None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p
    )
    _fields_ = (
        ("log", LOG),
        ("allocate", ctypes.c_void_p),
        ("free", ctypes.c_void_p),
        ("step_finished", ctypes.c_void_p),
        ("environment", ctypes.c_void_p),
    )


class Text(ctypes.Structure):
    """A ``std::string``: a pointer (libstdc++), or short texts in its place (Microsoft's)."""

    _fields_ = (("words", ctypes.c_uint64 * 2), ("length", ctypes.c_uint64 * 2))

    def read(self) -> bytes:
        if os.name == "nt":
            length, capacity = self.length
            start = self.words[0] if capacity > 15 else ctypes.addressof(self)
        else:
            start, length = self.words
        return ctypes.string_at(start, length)


class Logger(ctypes.Structure):
    """pythonfmu's logger, whose address a slave is given: its fields say who receives a message.

    The C++ object of the library that travels in this very FMU: virtual table, a flag that the
    importer switches logging on with, instance name, the categories it wants (a ``std::vector``:
    begin, end and capacity; empty for all of them), and the importer's functions.
    """

    _fields_ = (
        ("table", ctypes.c_void_p),
        ("on", ctypes.c_bool),
        ("name", Text),
        ("begin", ctypes.c_uint64),
        ("end", ctypes.c_uint64),
        ("capacity", ctypes.c_uint64),
        ("functions", ctypes.POINTER(Callbacks)),
    )

    def categories(self) -> list[str]:
        places = range(self.begin, self.end, ctypes.sizeof(Text))
        return [Text.from_address(place).read().decode() for place in places]

    def send(self, category: str, text: str) -> None:
        functions = self.functions.contents
        message = text.replace("%", "%%").encode()  # it is a printf format
        name, status = self.name.read(), 3  # fmi2Error
        functions.log(functions.environment, name, status, category.encode(), message)


def add_reference(thing: Any) -> None:
    """Take one more reference to an object that pythonfmu is going to release once too often."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(thing))


def state_problem(variable: Variable, value: float) -> str:
    """Say why a variable cannot have a value in a saved state; return an empty string if it can."""
    problem = variable.problem(value)
    if problem or variable.type == REAL:
        return problem
    if variable.type == BOOLEAN:
        fits = value in (0.0, 1.0)
    else:  # FMI's integers have 32 bits
        fits = abs(value) < 2.0**31 and value == int(value)
    if fits:
        return ""
    return f"{variable.name} = {variable.format_value(value)}: expected {variable.range_text()}"


class Slave:
    """FMI 2.0 calls by pythonfmu's names, mixed into its ``Fmi2Slave``."""

    model: Model
    fingerprint = ""
    instance_name: str
    log_queue: list[Any]
    log: Any

    def __init__(self, **given: Any) -> None:
        super().__init__(**given)
        self._logger = int(given.get("logger") or 0)
        self._entries: dict[str, Any] = {**self.model.entry_points}
        self._array: Any = lambda *values: list(values)
        self._choose_kernel(given.get("resources") or "")
        self._memory = self._array(*([0.0] * self.model.memory_size))
        for variable in self.model.variables:
            self._memory[variable.slot] = 0.0 if variable.calculated else float(variable.start)
        self._phase = INSTANTIATED
        self._start_time = 0.0
        self._stop_time = float("inf")  # of the experiment, not of the state
        self._warned = False  # of a step too short to advance the time
        self._stale = True  # outputs do not belong to the values set yet (initialisation mode)
        self._set_flags = self.model.set_flag_by_slot
        self._checked: dict[str, Any] = {REAL: None, INTEGER: None, BOOLEAN: None}

    def _choose_kernel(self, resources: str) -> None:
        """Use the compiled kernel where it is there: it lies with this instance's package."""
        package = __name__.split(".")[0]  # under its content-hashed name
        names = tuple(self._entries)
        kernel = load_compiled_kernel(os.path.join(resources, package), package, names)
        if kernel:
            self._entries = dict(zip(names, kernel))
            self._array = ctypes.c_double * self.model.memory_size

    # -- failing without a crash -------------------------------------------------------------------

    def logger(self) -> Logger | None:
        return Logger.from_address(self._logger) if self._logger else None

    def write_to_stderr(self, text: str) -> None:
        """Write one line to the error output, where the importer may not hear what is logged.

        It may take a discarded step for success.
        """
        logger = self.logger()
        if logger and logger.on and logger.begin == logger.end:
            return
        try:
            sys.stderr.write(f"{self.model.name} '{self.instance_name}': {text}\n")
            sys.stderr.flush()
        except Exception:  # a host without an error output
            pass

    def refuse(self, text: str) -> NoReturn:
        self.write_to_stderr(text)
        self.send_error_to_importer(text)
        for kept in (type(self), self, self.log_queue):
            add_reference(kept)
        raise FmuError(text.replace("%", "%%"))  # the text ends up as a printf format

    def send_error_to_importer(self, text: str) -> None:
        """Log an error for an importer that asked for the category of errors, which an exception
        does not reach.

        pythonfmu logs an exception without a category. It would empty its own queue of messages
        while the exception is set, and from Python 3.13 on an importer's callback written in
        Python fails then.
        """
        logger = self.logger()
        if logger and logger.on:
            category = self.error_category()
            if category in logger.categories():
                logger.send(category, text)

    def error_category(self) -> str:
        logger = self.logger()
        wanted = logger.categories() if logger else []
        return ALL if ALL in wanted and ERRORS not in wanted else ERRORS

    def report_error(self, text: str) -> None:
        from pythonfmu.enums import Fmi2Status

        self.write_to_stderr(text)
        self.log(text.replace("%", "%%"), Fmi2Status.error, self.error_category())

    # -- life cycle --------------------------------------------------------------------------------

    def setup_experiment(self, start_time: float, stop_time: float | None = None, *_: Any) -> None:
        if self._phase != INSTANTIATED:
            self.refuse("fmi2SetupExperiment: expected one call before initialisation")
        if start_time - start_time != 0.0:
            self.refuse(f"startTime = {start_time!r} s: expected every finite number")
        stop = float("inf") if stop_time is None else stop_time
        if not stop >= start_time:
            text = f"startTime = {start_time!r} s with stopTime = {stop!r} s"
            self.refuse(f"{text}: expected stopTime >= startTime")
        self._start_time, self._stop_time = start_time, stop

    def enter_initialization_mode(self) -> None:
        if self._phase != INSTANTIATED:
            self.refuse("fmi2EnterInitializationMode: expected one call on a new or reset instance")
        self._phase = INITIALIZING

    def exit_initialization_mode(self) -> None:
        if self._phase != INITIALIZING:
            self.refuse("fmi2ExitInitializationMode: expected one call in initialisation mode")
        self.initialize_if_stale()
        self._phase = STEPPING

    def initialize_if_stale(self) -> None:
        if self._stale:
            self.run_entry_point("initialize", self._start_time)

    def run_entry_point(self, entry: str, time: float) -> None:
        code = self._entries[entry](self._memory, time)
        if code:
            self.refuse(format_message(self.model, self._memory, code))
        self._stale = False

    def bring_up_to_date(self) -> None:
        if self._phase == INITIALIZING:
            self.initialize_if_stale()
        elif self._phase == STEPPING and self.model.refresh:
            self.run_entry_point("refresh", self._memory[self.model.time_slot])

    def terminate(self) -> None:
        self._phase = TERMINATED

    def do_step(self, current_time: float, step_size: float) -> bool:
        try:
            problem = self.step_problem(current_time, step_size)
            problem = problem or self.advance_to(current_time + step_size)
        except Exception as error:
            problem = f"doStep failed inside: {error!r}"
        if problem:
            self.report_error(problem)
        elif step_size > 0.0 and current_time + step_size == current_time:
            self.warn_short_step(current_time, step_size)
        return not problem

    def warn_short_step(self, time: float, step_size: float) -> None:
        from pythonfmu.enums import Fmi2Status

        if not self._warned:
            self._warned = True
            text = f"communicationStepSize = {step_size!r} s: too short to change the time, "
            text += f"{time!r} s, expected a longer one; reported once"
            self.log(text, Fmi2Status.warning, WARNINGS)

    def step_problem(self, current_time: float, step_size: float) -> str:
        if self._phase != STEPPING:
            return "fmi2DoStep: expected after initialisation and before fmi2Terminate"
        if not 0.0 <= step_size < float("inf"):
            return f"communicationStepSize = {step_size!r} s: expected every finite number >= 0"
        reached = self._memory[self.model.time_slot]
        rounding = 1e-9 * (abs(reached) + step_size)  # of the importer's own sum of steps
        if not abs(current_time - reached) <= rounding:
            text = f"currentCommunicationPoint = {current_time!r} s: expected {reached!r} s"
            return f"{text}, where the last step ended"
        target = current_time + step_size
        if target == float("inf"):
            text = f"communicationStepSize = {step_size!r} s: expected a step that ends"
            return f"{text} at a finite time"
        if target - self._stop_time > rounding:
            text = f"the step to time = {target!r} s: expected none past stopTime"
            return f"{text} = {self._stop_time!r} s"
        return ""

    def advance_to(self, time: float) -> str:
        """Step to a time; return why not, with the memory as before, or an empty string."""
        coast = self._entries.get("coast")
        if coast and not coast(self._memory, time):
            return ""
        first, count = self.model.written_only
        head, tail = self._memory[:first], self._memory[first + count :]
        code = self._entries["advance"](self._memory, time)
        if not code:
            return ""
        problem = format_message(self.model, self._memory, code)
        self._memory[:first] = head
        self._memory[first + count :] = tail
        return problem

    # -- values ------------------------------------------------------------------------------------

    def variables_of_type(self, references: Sequence[int], kind: str) -> list[Variable]:
        found = []
        for reference in references:
            known = 0 <= reference < len(self.model.variables)
            variable = self.model.variables[reference] if known else None
            if variable is None or variable.type != kind:
                text = f"valueReference = {reference}: "
                if variable:
                    text += f"{variable.name} is one of the {variable.type} variables, "
                text += f"expected one of the {kind} variables in modelDescription.xml"
                self.refuse(text)
            found.append(variable)
        return found

    def read_values(self, references: Sequence[int], kind: str) -> list[float]:
        if references != self._checked[kind]:
            self.variables_of_type(references, kind)
            self._checked[kind] = list(references)
        if self._stale:
            self.bring_up_to_date()
        return list(map(self._memory.__getitem__, references))

    def get_real(self, references: Sequence[int]) -> list[float]:
        return self.read_values(references, REAL)

    def get_integer(self, references: Sequence[int]) -> list[int]:
        return [int(value) for value in self.read_values(references, INTEGER)]

    def get_boolean(self, references: Sequence[int]) -> list[bool]:
        return [value != 0.0 for value in self.read_values(references, BOOLEAN)]

    def get_string(self, references: Sequence[int]) -> list[str]:
        """Refuse any reference: there are no String variables."""
        self.variables_of_type(references, "String")
        return []

    def write_values(self, references: Sequence[int], values: Sequence[float], kind: str) -> None:
        found = self.variables_of_type(references, kind)
        for variable, value in zip(found, values):
            problem = self.write_problem(variable, value)
            if problem:
                self.refuse(problem)
        for reference, value in zip(references, values):
            self._memory[reference] = float(value)
            if reference in self._set_flags:
                self._memory[self._set_flags[reference]] = 1.0
        self._stale = True

    def write_problem(self, variable: Variable, value: float) -> str:
        given = f"{variable.name} = {variable.format_value(value)}"
        if variable.calculated:
            return f"{given}: an output cannot be set, expected a parameter or an input"
        if variable.fixed and self._phase > INITIALIZING:
            return f"{given}: a fixed parameter, to be set before the end of initialisation"
        return variable.problem(value)

    def set_real(self, references: Sequence[int], values: Sequence[float]) -> None:
        self.write_values(references, values, REAL)

    def set_integer(self, references: Sequence[int], values: Sequence[int]) -> None:
        self.write_values(references, values, INTEGER)

    def set_boolean(self, references: Sequence[int], values: Sequence[bool]) -> None:
        self.write_values(references, [1.0 if value else 0.0 for value in values], BOOLEAN)

    def set_string(self, references: Sequence[int], values: Sequence[str]) -> None:
        """Refuse any reference: there are no String variables."""
        self.variables_of_type(references, "String")

    # -- state -------------------------------------------------------------------------------------

    def _get_fmu_state(self) -> bytes:
        numbers = (self._phase, self._start_time, self._stale, *self._memory)
        return self._with_checksum(struct.pack(f"<{len(numbers)}d", *numbers))

    def _with_checksum(self, body: bytes) -> bytes:
        """Return a saved state: which model it is of, a checksum, and its numbers."""
        head = (STATE_MAGIC + self.fingerprint.encode()).ljust(STATE_HEAD - CHECKSUM, b"\0")
        return head + hashlib.sha256(head + body).digest()[:CHECKSUM] + body

    def _is_own_undamaged_state(self, state: Any) -> bool:
        """Return whether this FMU saved the state, and it is undamaged."""
        length = STATE_HEAD + 8 * (3 + len(self._memory))
        right = isinstance(state, bytes) and len(state) == length
        return right and state == self._with_checksum(state[STATE_HEAD:])

    def _set_fmu_state(self, state: Any) -> None:
        if not self._is_own_undamaged_state(state):
            text = f"FMU state: expected a state saved by this FMU ({self.model.name}, "
            self.refuse(f"{text}{self.fingerprint}), and undamaged")
        numbers = struct.unpack(f"<{3 + len(self._memory)}d", state[STATE_HEAD:])
        memory = self._array(*numbers[3:])
        problem = self._saved_state_problem(numbers[:3], memory)
        if problem:
            self.refuse(f"FMU state: {problem}")
        self._phase, self._start_time = numbers[:2]
        self._stale = numbers[2] != 0.0 or self._phase < STEPPING  # or calculated once more
        self._memory = memory

    def _saved_state_problem(self, head: Sequence[float], memory: Any) -> str:
        """Say why a saved state is none that this FMU had; empty if it is no danger."""
        phase, start_time, stale = head
        if phase not in PHASES or stale not in (0.0, 1.0) or start_time - start_time != 0.0:
            return f"phase {phase!r}, start time {start_time!r} s: expected a saved state's"
        problems = (state_problem(known, memory[known.slot]) for known in self.model.variables)
        problem = next(filter(None, problems), "")
        if phase >= STEPPING and not problem:
            problem = hidden_slot_problem(self.model, memory)
            code = 0 if problem else self._entries["restore"](memory, start_time)
            problem = format_message(self.model, memory, code) if code else problem
        return problem and f"a saved state that this FMU never had: {problem}"

    # the bytes are looked at when they are set: an exception here would corrupt the instance
    _fmu_state_to_bytes = _fmu_state_from_bytes = staticmethod(lambda state: state)
