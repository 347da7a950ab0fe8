"""The one place that talks to FMPy: describe an FMU, instantiate it, set, step, read, save its state."""

import re
import shutil
import tempfile
from ctypes import c_double, c_uint
from dataclasses import dataclass
from pathlib import Path

from .errors import UserError


class FmuError(RuntimeError):
    """An FMU refused a call; the text is the FMU's own message."""


@dataclass(frozen=True)
class Description:
    """What ``modelDescription.xml`` says of an FMU.

    Attributes
    ----------
    path : Path
    name, guid, fmi_version : str
    variables : dict
        FMPy's ScalarVariable by name.
    """

    path: Path
    name: str
    guid: str
    fmi_version: str
    variables: dict


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
    UserError
        Where there is no such file, or it is no FMU of that model for co-simulation.
    """
    import fmpy

    path = Path(path)
    if not path.is_file():
        raise UserError(f"FMU {path}: no such file; `python -m orchestrate build` writes it")
    try:
        found = fmpy.read_model_description(str(path))
    except Exception as error:
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise UserError(f"FMU {path}: not readable as an FMU ({reason}); `python -m orchestrate build` writes one") from None
    if found.coSimulation is None or (model and found.modelName != model):
        raise UserError(f"FMU {path}: model {found.modelName}; allowed is {model or 'a model'} for co-simulation")
    variables = {variable.name: variable for variable in found.modelVariables}
    return Description(path, found.modelName, str(found.guid), found.fmiVersion, variables)


class Instance:
    """A co-simulation instance of an FMI 2.0 FMU, as a context manager.

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

    def __init__(self, path, name="instance"):
        import fmpy
        from fmpy import fmi2

        self.description = describe(path)
        self._messages = []
        self._folder = tempfile.mkdtemp(prefix="vibroimpact-")
        fmpy.extract(str(path), self._folder)
        found = fmpy.read_model_description(self._folder)
        self._fmu = fmi2.FMU2Slave(
            guid=found.guid, unzipDirectory=self._folder, modelIdentifier=found.coSimulation.modelIdentifier, instanceName=name
        )
        self._callbacks = fmi2.fmi2CallbackFunctions()
        self._callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
        self._callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        self._callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        self.call("instantiate", callbacks=self._callbacks, loggingOn=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _log(self, _environment, _instance, _status, _category, message):
        self._messages.append(message.decode(errors="replace").replace("%%", "%"))

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
            raise UserError(f"variable {name}: the FMU {self.description.name} has none of that name") from None

    def set(self, **values):
        """Set variables by name."""
        for name, value in values.items():
            variable = self.variable(name)
            self.call(f"set{variable.type}", [variable.valueReference], [value])

    def get(self, *names):
        """Values by name, as a list."""
        return [self.call(f"get{variable.type}", [variable.valueReference])[0] for variable in map(self.variable, names)]

    def initialize(self, start_time=0.0, **values):
        """Set ``values`` and initialise."""
        self.call("setupExperiment", startTime=start_time)
        self.set(**values)
        self.call("enterInitializationMode")
        self.call("exitInitializationMode")

    def reset(self):
        """Back to the state after instantiation."""
        self.call("reset")

    def step(self, time, target):
        """One communication step from ``time`` to ``target``, s."""
        self.call("doStep", currentCommunicationPoint=time, communicationStepSize=target - time)

    def reader(self, *names):
        """A fast reader of Real variables: a function that fills and returns one array of c_double, in the order of ``names``."""
        references = (c_uint * len(names))(*[self.variable(name).valueReference for name in names])
        values = (c_double * len(names))()
        get, component, count = self._fmu.fmi2GetReal, self._fmu.component, len(names)

        def read():
            get(component, references, count, values)
            return values

        return read

    def save_state(self):
        """The whole state, serialised."""
        state = self.call("getFMUstate")
        try:
            return self.call("serializeFMUstate", state)
        finally:
            self.call("freeFMUstate", state)

    def restore_state(self, data):
        """Back to a state that :meth:`save_state` gave."""
        state = self.call("deSerializeFMUstate", data)
        try:
            self.call("setFMUstate", state)
        finally:
            self.call("freeFMUstate", state)
