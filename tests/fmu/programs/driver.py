"""FMUs as importers meet them: FMI calls by name, and a status that is not OK as an exception.

For tests in their own process, and as the module ``driver`` for programs in a fresh one.
"""

import atexit
import ctypes
import functools
import itertools
import os
import sys
import tempfile
from pathlib import Path

import fmpy
from fmpy import fmi2, fmi3
from fmpy.fmi1 import FMICallException
from fmpy.logging import addLoggerProxy

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
STEPS = 100_000  # more than any test takes: one that waits for what never comes has to end
IMPACT = 2000  # value reference of the clock
OF_A_STEP = ("box_impulse", "box_impulse_moment", "x_rel_max", "evaluations")
STATE = (
    *("x1", "x2", "v1", "v2", "x_rel", "v_rel", "xi1", "xi2", "xi_rel", "box_force"),
    *("contact_force", "in_contact", "phase", "impact_count", "impact_time", "impact_velocity"),
    *("impact_energy", "contact_count", "sticking_energy"),
)
COMMON = (*STATE, *OF_A_STEP[:3])
messages = []  # of the call under way
idle = {}  # FMPy's objects without an instance, by FMU: to make one it looks at every function


class Refused(Exception):
    """A call whose status was not OK: function, status, and what the FMU logged."""

    def __init__(self, function, status):
        self.function, self.status, self.messages = function, status, list(messages)
        super().__init__(f"{function}: {status}: {self.messages}")


def hear(*given):
    messages.append(given[-1].decode())


LOGGER = fmi2.fmi2CallbackLoggerTYPE(hear)  # FMPy's proxy calls the last one that it was given


def allocation():
    return (
        fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc),
        fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free),
    )


def callbacks():
    """FMI 2.0's, with a logger that fills a printf format in, as importers written in C do."""
    made = fmi2.fmi2CallbackFunctions()
    made.logger, made.allocateMemory, made.freeMemory = LOGGER, *allocation()
    addLoggerProxy(ctypes.byref(made))
    return made


class Fmu2:
    """One FMI 2.0 co-simulation instance; ``time`` is the communication point reached."""

    make = fmi2.FMU2Slave
    third = False
    home = None  # where FMUs are extracted to
    alive = []

    def __init__(self, path, name="instance", logging=True, **options):
        found = describe(path)
        self.variables = {v.name: v for v in found.modelVariables}
        scalars = [v for v in found.modelVariables if v.type != "Clock" and not v.dimensions]
        self.output_names = [v.name for v in scalars if v.causality == "output"]
        self.others = idle.setdefault(str(path), [])
        self.fmu = (
            self.others.pop()
            if self.others
            else self.make(
                guid=found.guid,
                unzipDirectory=extracted(path),
                modelIdentifier=found.coSimulation.modelIdentifier,
                instanceName=name,
            )
        )
        self.fmu.instanceName = name
        self.event_mode = options.get("event_mode", False)
        self.instantiate(logging, **options)
        self.alive.append(self)
        self.time, self.steps = 0.0, 0

    def instantiate(self, logging):
        self.callbacks = callbacks()
        self.fmu.instantiate(callbacks=self.callbacks, loggingOn=logging)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.free()

    def call(self, function, *arguments, **keywords):
        messages.clear()
        try:
            return getattr(self.fmu, function)(*arguments, **keywords)
        except FMICallException as failure:
            raise Refused(function, failure.status) from None

    def refused(self, function, *arguments, **keywords):
        """The one message of a call that has to be refused."""
        try:
            self.call(function, *arguments, **keywords)
        except Refused as refused:
            (message,) = refused.messages
            return message
        raise AssertionError(f"{function}{arguments} was accepted")

    def reference(self, name):
        return self.variables[name].valueReference

    def set(self, **values):
        for name, value in values.items():
            variable = self.variables[name]
            self.call("set" + variable.type, [variable.valueReference], [value])
        return self

    def get(self, *names):
        """Values; of variables of one type that follow one another by one call."""
        found, variables = [], [self.variables[name] for name in names]
        for kind, group in itertools.groupby(variables, lambda variable: variable.type):
            found += self.call("get" + kind, [variable.valueReference for variable in group])
        return found

    def one(self, name):
        return self.get(name)[0]

    def series(self, name):
        """All elements of an array, which FMI 2.0 has one by one."""
        return self.get(*[other for other in self.variables if other.startswith(f"{name}[")])

    def outputs(self, names=None):
        names = self.output_names if names is None else names
        return dict(zip(names, self.get(*names), strict=True))

    def motion(self):
        """All outputs that are not about the last step."""
        return self.outputs([name for name in self.output_names if name not in OF_A_STEP])

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
        if self.event_mode:
            self.call("enterStepMode")
        return self

    def reset(self):
        self.call("reset")
        self.steps = 0
        return self

    def step(self, target):
        self.call("doStep", self.time, target - self.time)
        self.time = target
        return self

    def at(self, *times):
        for time in times:
            self.step(time)
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
            self.fmu.freeFMUState(state)
        self.time = time
        return self

    def free(self):
        if self in self.alive:
            self.alive.remove(self)
            getattr(self.fmu, f"fmi{3 if self.third else 2}FreeInstance")(self.fmu.component)
            self.others.append(self.fmu)


class Fmu3(Fmu2):
    """The same of FMI 3.0, with event mode where it is asked for."""

    make = fmi3.FMU3Slave
    third = True

    def instantiate(self, logging, event_mode=False, early_return=False):
        options = {"eventModeUsed": event_mode, "earlyReturnAllowed": early_return}
        self.fmu.instantiate(loggingOn=logging, logMessage=hear, **options)

    def series(self, name):
        variable = self.variables[name]
        size = int(variable.dimensions[0].start)
        return list(self.fmu.getFloat64([variable.valueReference], size))

    def enter(self, start_time=0.0, **experiment):
        self.time = start_time
        self.call("enterInitializationMode", startTime=start_time, **experiment)

    def go(self, target):
        """Step towards a point of time; whether there is an event, and whether it ended early."""
        self.steps += 1
        assert self.steps < STEPS
        event, end, early, self.time = self.call("doStep", self.time, target - self.time)
        assert not end
        return event, early

    def clock(self):
        return self.fmu.getClock([IMPACT])[0]

    def update(self):
        """fmi3UpdateDiscreteStates: there is never anything more to do."""
        again, end, nominals, values, defined, _ = self.fmu.updateDiscreteStates()
        assert not (again or end or nominals or values or defined)

    def handle(self):
        self.fmu.enterEventMode()
        self.update()
        self.fmu.enterStepMode()


@functools.cache
def describe(path):
    return fmpy.read_model_description(str(path))


@functools.cache
def extracted(path):
    """The folder that an FMU is extracted to."""
    return fmpy.extract(str(path), tempfile.mkdtemp(dir=Fmu2.home))


def open_fmu(path, **options):
    return (Fmu3 if describe(path).fmiVersion.startswith("3") else Fmu2)(path, **options)


def free_all():
    for f in list(Fmu2.alive):
        f.free()


def harmonic(eta):
    """Settings with which every number is the paper's non-dimensional one."""
    return {"box_amplitude": 1.0 / eta**2, "box_frequency": eta}


if __name__ == "driver":  # a fresh process
    failed, Fmu2.home = [], Path.cwd()

    def excepthook(*error):
        failed.append(error)
        sys.__excepthook__(*error)

    sys.excepthook = excepthook

    @atexit.register
    def leave():
        free_all()
        # pythonfmu's library destroys an object twice when a process ends, which now and then
        # aborts it: no test is to fail of that by chance
        if "pythonfmu" in sys.modules:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(1 if failed else 0)
