"""FMPy's view of an FMU in this process: variables by name in FMI 2.0 and 3.0, event mode where
asked for.
"""

import ctypes
import tempfile
from contextlib import contextmanager

import fmpy
from fmpy import fmi2, fmi3
from fmpy.fmi1 import FMICallException

STEPS = 100_000  # more than any test takes: one that waits for what never comes has to end
IMPACT = 2000  # value reference of the clock
COMMON = [
    "x1",
    "x2",
    "v1",
    "v2",
    "x_rel",
    "v_rel",
    "xi1",
    "xi2",
    "xi_rel",
    "box_force",
    "box_impulse",
    "box_impulse_moment",
]
COMMON += [
    "contact_force",
    "in_contact",
    "phase",
    "impact_count",
    "impact_time",
    "impact_velocity",
    "impact_energy",
    "x_rel_max",
    "contact_count",
]
# what is not about the last step
STATE = [name for name in COMMON if name not in ("box_impulse", "box_impulse_moment", "x_rel_max")]


class Slave:
    """One instance; ``time`` is the point of time reached, ``messages`` what the FMU logged."""

    def __init__(self, path, event_mode=False, early_return=False):
        description = fmpy.read_model_description(str(path))
        self.third = description.fmiVersion.startswith("3")
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.messages, self.time, self.steps, self.event_mode = [], 0.0, 0, event_mode
        self._folder = tempfile.TemporaryDirectory()
        fmpy.extract(str(path), self._folder.name)
        token = description.guid or description.instantiationToken
        identifier = description.coSimulation.modelIdentifier
        identity = {
            "guid": token,
            "unzipDirectory": self._folder.name,
            "modelIdentifier": identifier,
            "instanceName": "a",
        }
        if self.third:
            self.fmu = fmi3.FMU3Slave(**identity)
            options = {"eventModeUsed": event_mode, "earlyReturnAllowed": early_return}
            self.fmu.instantiate(
                logMessage=lambda _e, _s, _c, text: self.messages.append(text.decode()),
                loggingOn=True,
                **options,
            )
        else:
            self.fmu = fmi2.FMU2Slave(**identity)
            self.callbacks = fmi2.fmi2CallbackFunctions()
            self.callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
                lambda _e, _i, _s, _c, text: self.messages.append(text.decode())
            )
            self.callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
            self.callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
            fmpy.logging.addLoggerProxy(ctypes.byref(self.callbacks))
            self.fmu.instantiate(callbacks=self.callbacks, loggingOn=True)

    def set(self, **values):
        for name, value in values.items():
            variable = self.variables[name]
            getattr(self.fmu, f"set{variable.type}")([variable.valueReference], [value])

    def get(self, *names):
        found = []
        for name in names:
            variable = self.variables[name]
            found.append(getattr(self.fmu, f"get{variable.type}")([variable.valueReference])[0])
        return found

    def one(self, name):
        return self.get(name)[0]

    def series(self, name):
        """All elements of an array, which FMI 2.0 has one by one."""
        if self.third:
            variable = self.variables[name]
            return list(
                self.fmu.getFloat64([variable.valueReference], int(variable.dimensions[0].start))
            )
        return self.get(*[other for other in self.variables if other.startswith(f"{name}[")])

    def start(self, time=0.0, **values):
        """Set and initialise; goes on to step mode."""
        self.set(**values)
        if self.third:
            self.fmu.enterInitializationMode(startTime=time)
        else:
            self.fmu.setupExperiment(startTime=time)
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        if self.event_mode:
            self.fmu.enterStepMode()
        self.time = time
        return self

    def step(self, time):
        """Step towards ``time``; returns whether an event is to be handled and whether the step
        ended early (FMI 3.0).
        """
        self.steps += 1
        assert self.steps < STEPS
        told = self.fmu.doStep(
            currentCommunicationPoint=self.time, communicationStepSize=time - self.time
        )
        if not self.third:
            self.time = time
            return None
        event, end, early, self.time = told
        assert not end
        return event, early

    def clock(self):
        return self.fmu.getClock([IMPACT])[0]

    def update(self):
        """fmi3UpdateDiscreteStates: there is never anything more to do."""
        again, end, nominals, values, defined, _ = self.fmu.updateDiscreteStates()
        assert not (again or end or nominals or values or defined)

    def refused(self, call, *arguments):
        """Call a method of FMPy that has to be refused; returns the FMU's message."""
        self.messages.clear()
        try:
            getattr(self.fmu, call)(*arguments)
        except FMICallException:
            assert len(self.messages) == 1
            return self.messages[0]
        raise AssertionError(f"{call}{arguments} was accepted")

    def free(self):
        self.fmu.freeInstance()
        self._folder.cleanup()


@contextmanager
def slave(path, **options):
    """A :class:`Slave` for a while."""
    made = Slave(path, **options)
    try:
        yield made
    finally:
        made.free()


def harmonic(eta):
    """The paper's drive."""
    return {"box_amplitude": 1.0 / eta**2, "box_frequency": eta}
