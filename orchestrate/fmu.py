"""The one place that talks to FMPy: describe an FMU, instantiate it, set, step, read, save its state."""

import math
import os
import re
import shutil
import tempfile
from ctypes import byref, c_double, c_uint
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import FmuError, InputError


@dataclass(frozen=True)
class Description:
    """What ``modelDescription.xml`` says of an FMU.

    Attributes
    ----------
    path : Path
    name, guid, fmi_version : str
    variables : dict
        FMPy's ScalarVariable by name.
    needs_tool : bool
        Whether it needs a tool of its own, such as a Python.
    """

    path: Path
    name: str
    guid: str
    fmi_version: str
    variables: dict
    needs_tool: bool = False


def describe(path, model=None):
    """Read an FMU's description.

    Parameters
    ----------
    path : path-like
    model : str, optional
        Model name the FMU must have.

    Returns
    -------
    Description

    Raises
    ------
    InputError
        Where there is no such file, or it is no FMU of that model for co-simulation.
    """
    import fmpy

    path = Path(path)
    if not path.is_file():
        raise InputError(f"FMU {path}: no such file; `python -m orchestrate build` writes it")
    try:
        found = fmpy.read_model_description(str(path))
    except Exception as error:
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise InputError(f"FMU {path}: not readable as an FMU ({reason}); `python -m orchestrate build` writes one") from None
    if found.coSimulation is None or (model and found.modelName != model):
        raise InputError(f"FMU {path}: model {found.modelName}; allowed is {model or 'a model'} for co-simulation")
    variables = {variable.name: variable for variable in found.modelVariables}
    return Description(path, found.modelName, str(found.guid), found.fmiVersion, variables, bool(found.coSimulation.needsExecutionTool))


class Instance:
    """A co-simulation instance of an FMI 2.0 or 3.0 FMU, as a context manager.

    Parameters
    ----------
    path : path-like
    name : str
        Instance name.

    Notes
    -----
    Every status but OK raises :class:`FmuError` with what the FMU logged, a discarded step too: importers' own loops may take that for
    the end of the simulation.
    """

    EVENTS: dict = {}  # how an FMI 3.0 FMU is asked for its events

    def __init__(self, path, name="instance"):
        import fmpy

        os.environ["VIBROIMPACT_MESSAGES"] = "log"  # the pythonfmu form need not repeat on the error output what is read from its log
        self.description = describe(path)
        self._messages = []
        self._readers = {}
        self._folder = tempfile.mkdtemp(prefix="vibroimpact-")
        try:
            fmpy.extract(str(path), self._folder)
            found = fmpy.read_model_description(self._folder)
            identity = {"unzipDirectory": self._folder, "modelIdentifier": found.coSimulation.modelIdentifier, "instanceName": name}
            make = self._make3 if self.description.fmi_version.startswith("3") else self._make2
            make({"guid": found.guid, **identity})
        except BaseException as error:
            shutil.rmtree(self._folder, ignore_errors=True)
            if isinstance(error, FmuError) or not isinstance(error, Exception):
                raise
            raise InputError(f"FMU {path}: cannot be loaded ({error}); allowed is an FMU with a binary for this machine") from None

    def _make2(self, identity):
        import fmpy
        from fmpy import fmi2

        self._fmu = fmi2.FMU2Slave(**identity)
        self._callbacks = fmi2.fmi2CallbackFunctions()
        self._callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
        self._callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        self._callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        fmpy.logging.addLoggerProxy(byref(self._callbacks))  # messages come as a format with arguments
        self.call("instantiate", callbacks=self._callbacks, loggingOn=True)

    def _make3(self, identity):
        from fmpy import fmi3

        self._fmu = fmi3.FMU3Slave(**identity)
        self.call("instantiate", loggingOn=True, logMessage=self._log, **self.EVENTS)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _log(self, *arguments):
        """Keep a message; it is the last argument in both FMI versions."""
        self._messages.append(arguments[-1].decode(errors="replace"))

    def call(self, function, *args, **kwargs):
        """Call a method of FMPy's FMU, with the FMU's message where it fails."""
        self._messages.clear()
        try:
            return getattr(self._fmu, function)(*args, **kwargs)
        except Exception as error:
            texts = [re.sub(r"(?s).*FmuError\(([\"'])(.*)\1\)\s*$", r"\2", message) for message in self._messages]
            raise FmuError("; ".join(texts) or str(error)) from None

    def variable(self, name):
        """FMPy's description of a variable."""
        try:
            return self.description.variables[name]
        except KeyError:
            raise InputError(f"variable {name}: the FMU {self.description.name} has none of that name") from None

    def set(self, **values):
        """Set variables by name."""
        types: dict = {}
        for variable, value in zip(map(self.variable, values), values.values(), strict=True):
            types.setdefault(variable.type, {})[variable.valueReference] = value
        for type_name, chosen in types.items():
            self.call(f"set{type_name}", list(chosen), list(chosen.values()))

    def get(self, *names):
        """Values by name, as a list."""
        return [self.call(f"get{variable.type}", [variable.valueReference])[0] for variable in map(self.variable, names)]

    def initialize(self, start_time=0.0, **values):
        """Set ``values`` and initialise."""
        self.set(**values)
        if self.description.fmi_version.startswith("3"):
            self.call("enterInitializationMode", startTime=start_time)
        else:
            self.call("setupExperiment", startTime=start_time)
            self.call("enterInitializationMode")
        self.call("exitInitializationMode")

    def reset(self):
        """Back to the state after instantiation."""
        self.call("reset")

    def step(self, time, target):
        """One communication step from ``time`` to ``target``, s."""
        self.call("doStep", currentCommunicationPoint=time, communicationStepSize=target - time)

    def read(self, *names):
        """Values of Real variables, in one call of the FMU.

        Parameters
        ----------
        *names : str
            The name of a series (``x1_sample``) stands for all its elements: indexed scalars in FMI 2.0, one array in FMI 3.0.

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
            raise FmuError("; ".join(self._messages) or str(error)) from None
        return values

    def _reader(self, names):
        """FMPy's function, its arguments, and the array it fills."""
        found = [element for name in names for element in self.elements(name)]
        for variable in (variable for variable, _ in found if variable.type not in ("Real", "Float64")):
            raise FmuError(f"{variable.name}: is {variable.type}; allowed are Real variables")
        references = (c_uint * len(found))(*(variable.valueReference for variable, _ in found))
        values = (c_double * sum(length for _, length in found))()
        arguments = [self._fmu.component, references, len(found), values]
        if self.description.fmi_version.startswith("3"):
            return self._fmu.fmi3GetFloat64, [*arguments, len(values)], np.frombuffer(values)
        return self._fmu.fmi2GetReal, arguments, np.frombuffer(values)

    def elements(self, name):
        """Variables a name stands for, each with its number of values."""
        variables = self.description.variables
        if f"{name}[1]" not in variables:
            variable = self.variable(name)
            return [(variable, math.prod(int(dimension.start) for dimension in variable.dimensions or ()))]
        return [(variables[f"{name}[{i + 1}]"], 1) for i in range(sum(other.startswith(f"{name}[") for other in variables))]

    def save_state(self):
        """The whole state, serialised."""
        get, serialize, _, _, free = self.state_calls()
        state = self.call(get)
        try:
            return self.call(serialize, state)
        finally:
            self.call(free, state)

    def restore_state(self, data):
        """Back to a state that :meth:`save_state` gave."""
        _, _, deserialize, put, free = self.state_calls()
        state = self.call(deserialize, data)
        try:
            self.call(put, state)
        finally:
            self.call(free, state)

    def state_calls(self):
        """FMPy's names of the state functions."""
        if self.description.fmi_version.startswith("3"):
            return "getFMUState", "serializeFMUState", "deserializeFMUState", "setFMUState", "freeFMUState"
        return "getFMUstate", "serializeFMUstate", "deSerializeFMUstate", "setFMUstate", "freeFMUstate"
