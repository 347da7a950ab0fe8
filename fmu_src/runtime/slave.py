"""The slave inside a pythonfmu FMU: FMI 2.0 calls onto a kernel's flat memory. Standard library
only.

pythonfmu 0.7.0 releases the references to class, instance and log queue whenever an exception
leaves a slave, and once more when the instance is freed; a second call then crashes the process.
:meth:`Slave.refuse` therefore takes one more reference to each before it raises. ``doStep`` never
raises: it logs, and returns False. Every other call has no way but an exception to give the
importer a status that is not OK.
"""

import ctypes
import hashlib
import os
import struct
import sys
from typing import Any

from .compiled import load_compiled
from .table import BOOLEAN, INTEGER, REAL, explain

INSTANTIATED, INITIALIZING, STEPPING, TERMINATED = 0.0, 1.0, 2.0, 3.0
STATE_MAGIC = b"vibroimpact state "
STATE_HEAD, CHECKSUM = 64, 8  # bytes


class FmuError(Exception):
    """A user's mistake or an unfinished step, as one line."""


def keep(thing):
    """Take one more reference to an object that pythonfmu is going to release once too often."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(thing))


class Slave:
    """Mixed into pythonfmu's ``Fmi2Slave``; the subclass sets ``model`` (a :class:`.table.Model`)
    and ``fingerprint`` (str).
    """

    model: Any = None
    fingerprint = ""
    instance_name: str
    log_queue: list
    log: Any

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        size = self.model.memory_size
        # under its content-hashed name; its files lie with this instance, not with the first of the
        # process
        package = __name__.split(".")[0]
        entries = self.model.entries
        kernel = load_compiled(
            os.path.join(kwargs.get("resources") or "", package), package, tuple(entries)
        )
        self._entries = dict(zip(entries, kernel)) if kernel else entries
        self._array = ctypes.c_double * size if kernel else lambda *values: list(values)
        self._memory = self._array(*([0.0] * size))
        for variable in self.model.variables:
            self._memory[variable.slot] = float(variable.start) if not variable.calculated else 0.0
        self._phase = INSTANTIATED
        self._start_time = 0.0
        self._stale = True  # outputs do not belong to the values set yet (initialisation mode)
        self._checked: dict = {REAL: None, INTEGER: None, BOOLEAN: None}

    # -- failing without a crash
    # --------------------------------------------------------------------------------------

    def report(self, text):
        """One line to the error output: importers drop log messages unless asked for, and may take
        a discarded step for success.
        """
        if os.environ.get("VIBROIMPACT_MESSAGES") == "log":  # an importer that reads the log
            return
        try:
            sys.stderr.write(f"{self.model.name} '{self.instance_name}': {text}\n")
            sys.stderr.flush()
        except Exception:  # a host without an error output
            pass

    def refuse(self, text):
        """Give the call an error status, with ``text`` as its message."""
        self.report(text)
        for kept in (type(self), self, self.log_queue):
            keep(kept)
        raise FmuError(text.replace("%", "%%"))  # the text ends up as a printf format

    def complain(self, text):
        """Log an error without raising."""
        from pythonfmu.enums import Fmi2Status

        self.report(text)
        self.log(text.replace("%", "%%"), Fmi2Status.error, "logStatusError")

    # -- life cycle --------------------------------------------------------------------------------
    # -------------------

    def setup_experiment(self, start_time, stop_time=None, tolerance=None):
        """Start time of the experiment."""
        if self._phase != INSTANTIATED:
            self.refuse("fmi2SetupExperiment: allowed is one call before initialisation")
        if start_time - start_time != 0.0:
            self.refuse(f"startTime = {start_time!r} s: allowed is every finite number")
        self._start_time = start_time

    def enter_initialization_mode(self):
        """Begin initialisation."""
        if self._phase != INSTANTIATED:
            self.refuse(
                "fmi2EnterInitializationMode: allowed is one call after instantiation or fmi2Reset"
            )
        self._phase = INITIALIZING

    def exit_initialization_mode(self):
        """Check and take over what was set."""
        if self._phase != INITIALIZING:
            self.refuse("fmi2ExitInitializationMode: allowed is one call in initialisation mode")
        self.start()
        self._phase = STEPPING

    def start(self):
        """Initialise the kernel with the present values."""
        if self._stale:
            self.enter("initialize", self._start_time)

    def enter(self, entry, time):
        """Call the kernel for outputs that belong to the values set."""
        code = self._entries[entry](self._memory, time)
        if code:
            self.refuse(explain(self.model, self._memory, code))
        self._stale = False

    def catch_up(self):
        """Outputs for the values set since they were computed."""
        if self._phase == INITIALIZING:
            self.start()
        elif self._phase == STEPPING and self.model.refresh:
            self.enter("refresh", self._memory[self.model.time_slot])

    def terminate(self):
        """End of the simulation run; values can still be read."""
        self._phase = TERMINATED

    def do_step(self, current_time, step_size):
        """One communication step; False, with a logged message, where it cannot be done: the
        instance stays where it was.
        """
        try:
            problem = self.step_problem(current_time, step_size) or self.step(
                current_time + step_size
            )
        except Exception as error:
            problem = f"doStep failed inside: {error!r}"
        if problem:
            self.complain(problem)
        return not problem

    def step_problem(self, current_time, step_size):
        """Why a step cannot be tried; an empty string where it can."""
        if self._phase != STEPPING:
            return "fmi2DoStep: allowed is after initialisation and before fmi2Terminate"
        if not 0.0 <= step_size < float("inf"):
            return f"communicationStepSize = {step_size!r} s: allowed is every finite number >= 0"
        reached = self._memory[self.model.time_slot]
        if not abs(current_time - reached) <= 1e-9 * (abs(reached) + abs(step_size)):
            return f"currentCommunicationPoint = {current_time!r} s: allowed is {reached!r} s, where the last step ended"
        return ""

    def step(self, time):
        """Advance; on failure the memory is put back and the reason returned."""
        first, count = self.model.written_only
        head, tail = self._memory[:first], self._memory[first + count :]
        code = self._entries["advance"](self._memory, time)
        if not code:
            return ""
        problem = explain(self.model, self._memory, code)
        self._memory[:first] = head
        self._memory[first + count :] = tail
        return problem

    # -- values ------------------------------------------------------------------------------------
    # -------------------

    def find(self, vrs, kind):
        """The variables at value references, all of one type."""
        found = []
        for vr in vrs:
            if not 0 <= vr < len(self.model.variables) or self.model.variables[vr].type != kind:
                self.refuse(
                    f"valueReference = {vr}: allowed are those of the {kind} variables in modelDescription.xml"
                )
            found.append(self.model.variables[vr])
        return found

    def read(self, vrs, kind):
        """Values at value references."""
        if vrs != self._checked[kind]:
            self.find(vrs, kind)
            self._checked[kind] = list(vrs)
        if self._stale:
            self.catch_up()
        return list(map(self._memory.__getitem__, vrs))

    def get_real(self, vrs):
        """Values of Real variables."""
        return self.read(vrs, REAL)

    def get_integer(self, vrs):
        """Values of Integer variables."""
        return [int(value) for value in self.read(vrs, INTEGER)]

    def get_boolean(self, vrs):
        """Values of Boolean variables."""
        return [value != 0.0 for value in self.read(vrs, BOOLEAN)]

    def get_string(self, vrs):
        """There are no String variables."""
        self.find(vrs, "String")
        return []

    def write(self, vrs, values, kind):
        """Set variables, all or none."""
        found = self.find(vrs, kind)
        for variable, value in zip(found, values):
            if variable.calculated:
                self.refuse(
                    f"{variable.name} = {value!r}: an output cannot be set, allowed are parameters and inputs"
                )
            if variable.fixed and self._phase > INITIALIZING:
                self.refuse(
                    f"{variable.name} = {value!r}: a fixed parameter, to be set before the end of initialisation"
                )
            problem = variable.problem(value)
            if problem:
                self.refuse(problem)
        for vr, value in zip(vrs, values):
            self._memory[vr] = float(value)
        self._stale = True

    def set_real(self, vrs, values):
        """Set Real variables."""
        self.write(vrs, values, REAL)

    def set_integer(self, vrs, values):
        """Set Integer variables."""
        self.write(vrs, values, INTEGER)

    def set_boolean(self, vrs, values):
        """Set Boolean variables."""
        self.write(vrs, [1.0 if value else 0.0 for value in values], BOOLEAN)

    def set_string(self, vrs, values):
        """There are no String variables."""
        self.find(vrs, "String")

    # -- state -------------------------------------------------------------------------------------
    # -------------------

    def _get_fmu_state(self):
        return self._sealed(
            struct.pack(
                f"<{3 + len(self._memory)}d",
                self._phase,
                self._start_time,
                self._stale,
                *self._memory,
            )
        )

    def _sealed(self, body):
        """A saved state: what it is of, a checksum, and its numbers."""
        head = (STATE_MAGIC + self.fingerprint.encode()).ljust(STATE_HEAD - CHECKSUM, b"\0")
        return head + hashlib.sha256(head + body).digest()[:CHECKSUM] + body

    def _set_fmu_state(self, state):
        length = STATE_HEAD + 8 * (3 + len(self._memory))
        if (
            not isinstance(state, bytes)
            or len(state) != length
            or state != self._sealed(state[STATE_HEAD:])
        ):
            self.refuse(
                f"FMU state: allowed are states saved by this FMU ({self.model.name}, {self.fingerprint}), and undamaged"
            )
        numbers = struct.unpack(f"<{(length - STATE_HEAD) // 8}d", state[STATE_HEAD:])
        self._phase, self._start_time, self._stale = numbers[0], numbers[1], numbers[2] != 0.0
        self._memory = self._array(*numbers[3:])

    # the bytes are looked at when they are set: an exception here would corrupt the instance
    _fmu_state_to_bytes = _fmu_state_from_bytes = staticmethod(lambda state: state)
