"""FMUs in a fresh process: FMI calls by name, and a status that is not OK as an exception."""

import atexit
import ctypes
import os
import sys
import tempfile
from pathlib import Path

import fmpy
from fmpy import fmi2, fmi3
from fmpy.fmi1 import FMICallException
from fmpy.logging import addLoggerProxy

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
messages = []  # of the call under way; the proxy below knows one logger a process
callbacks = fmi2.fmi2CallbackFunctions()
callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
    lambda _e, _i, _s, _c, text: messages.append(text.decode())
)
callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
addLoggerProxy(
    ctypes.byref(callbacks)
)  # expands the message as a printf format, as importers written in C do


class Refused(Exception):
    """A call whose status was not OK: function, status, and what the FMU logged."""

    def __init__(self, function, status):
        self.function, self.status, self.messages = function, status, list(messages)
        super().__init__(f"{function}: {status}: {self.messages}")


class Fmu2:
    """One FMI 2.0 co-simulation instance; ``time`` is the communication point reached."""

    folders = {}  # where an FMU of this process was extracted to,
    descriptions = {}  # and what is known of it
    alive = []

    def __init__(self, path, name="instance", logging=True, folder=None):
        if folder is None:
            if path not in self.folders:
                self.folders[path] = fmpy.extract(path, tempfile.mkdtemp(dir=Path.cwd()))
            folder = self.folders[path]
        found = describe(path)
        self.variables = {v.name: v for v in found.modelVariables}
        scalars = [v for v in found.modelVariables if v.type != "Clock" and not v.dimensions]
        self.output_names = [v.name for v in scalars if v.causality == "output"]
        identifier = found.coSimulation.modelIdentifier
        self.slave = self.make(
            guid=found.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName=name
        )
        self.instantiate(logging)
        self.alive.append(self)
        self.time = 0.0

    make = fmi2.FMU2Slave

    def instantiate(self, logging):
        self.slave.instantiate(callbacks=callbacks, loggingOn=logging)

    def call(self, function, *arguments, **keywords):
        messages.clear()
        try:
            return getattr(self.slave, function)(*arguments, **keywords)
        except FMICallException as failure:
            raise Refused(function, failure.status) from None

    def reference(self, name):
        return self.variables[name].valueReference

    def set(self, **values):
        for name, value in values.items():
            variable = self.variables[name]
            self.call("set" + variable.type, [variable.valueReference], [value])

    def get(self, *names):
        kinds = [(self.variables[name].type, self.variables[name].valueReference) for name in names]
        return [self.call("get" + kind, [reference])[0] for kind, reference in kinds]

    def outputs(self, names=None):
        names = self.output_names if names is None else names
        return dict(zip(names, self.get(*names), strict=True))

    def enter(self, start_time=0.0, **experiment):
        self.time = start_time
        self.call("setupExperiment", startTime=start_time, **experiment)
        self.call("enterInitializationMode")

    def leave(self):
        self.call("exitInitializationMode")

    def start(self, start_time=0.0, **values):
        self.set(**values)
        self.enter(start_time)
        self.leave()
        return self

    def reset(self):
        self.call("reset")
        return self

    def step(self, target):
        self.call("doStep", self.time, target - self.time)
        self.time = target
        return self

    def save(self):
        state = self.call("getFMUState")
        data = self.call("serializeFMUState", state)
        self.call("freeFMUState", state)
        return data, self.time

    def restore(self, data, time):
        state = self.call("deserializeFMUState", data)
        try:
            self.call("setFMUState", state)
        finally:
            self.slave.freeFMUState(state)
        self.time = time
        return self

    def free(self):
        self.alive.remove(self)
        self.slave.freeInstance()


class Fmu3(Fmu2):
    """The same of FMI 3.0."""

    make = fmi3.FMU3Slave

    def instantiate(self, logging):
        self.slave.instantiate(
            loggingOn=logging, logMessage=lambda _e, _s, _c, text: messages.append(text.decode())
        )

    def enter(self, start_time=0.0, **experiment):
        self.time = start_time
        self.call("enterInitializationMode", startTime=start_time, **experiment)


def excepthook(*error):
    failed.append(error)
    sys.__excepthook__(*error)


failed, sys.excepthook = [], excepthook


@atexit.register
def leave():
    for f in list(Fmu2.alive):
        f.free()
    # pythonfmu's library writes into freed memory when a process ends, see test_limits: no test is
    # to fail of that by chance
    if "pythonfmu" in sys.modules and not os.environ.get("TEST_THE_END"):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(1 if failed else 0)


def describe(path):
    if path not in Fmu2.descriptions:
        Fmu2.descriptions[path] = fmpy.read_model_description(path)
    return Fmu2.descriptions[path]


def open_fmu(path, **options):
    """An instance of an FMU, of its own FMI version."""
    return (Fmu3 if describe(path).fmiVersion.startswith("3") else Fmu2)(path, **options)


def outputs(path, end, **values):
    """Outputs at a time of a run with the paper's drive at eta = 1.13, chaotic motion."""
    return open_fmu(path).start(**{**harmonic(1.13), **values}).step(end).outputs()


def compiled():
    """Whether a compiled kernel of the pythonfmu form is mapped into this process."""
    return "/kernel-" in Path("/proc/self/maps").read_text()


def harmonic(eta):
    """Settings with which every number is the paper's non-dimensional one."""
    return {"box_amplitude": 1.0 / eta**2, "box_frequency": eta}
