"""An FMU instance as the compiled loops call it: addresses of FMI's functions, past Python."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from ctypes import c_char_p, c_int, c_uint, c_void_p
from typing import Any

from ..errors import FmuError
from .instance import Instance, function_addresses

NOT_FINITE = -1  # a status that FMI does not have
PAUSED, BROKEN = 1, 2  # what a loop answers: to be called again, or stopped at an error
FUNCTIONS = {  # by FMI's version, as `Fmi` of the C header has them; "" where there is none
    2: (
        *("Reset", "SetupExperiment", "EnterInitializationMode", "ExitInitializationMode"),
        *("DoStep", "SetReal", "SetInteger", "SetBoolean", "GetReal", "GetInteger", "GetBoolean"),
    ),
    3: (
        *("Reset", "", "EnterInitializationMode", "ExitInitializationMode"),
        *("DoStep", "SetFloat64", "SetInt32", "SetBoolean", "GetFloat64", "GetInt32", "GetBoolean"),
    ),
}
EVENT_FUNCTIONS = ("EnterEventMode", "UpdateDiscreteStates", "EnterStepMode")


class Fmi(ctypes.Structure):
    """C struct of an instance and its functions; ``failed`` is the call that did not answer OK."""

    _fields_ = [
        ("instance", c_void_p),
        ("version", c_int),
        *((name or "setup", c_void_p) for name in (*FUNCTIONS[3], *EVENT_FUNCTIONS)),
        ("failed", c_char_p),
        ("status", c_int),
        ("warned", c_int),
    ]

    @classmethod
    def from_instance(cls, instance: Instance) -> Fmi:
        """Return the struct of an instance; the event functions are for one that has events."""
        version = 3 if instance.is_fmi3 else 2
        names = (*FUNCTIONS[version], *(EVENT_FUNCTIONS if instance.EVENTS else ("",) * 3))
        component, *known = function_addresses(instance, [name for name in names if name])
        addresses = iter(known)
        return cls(component, version, *(next(addresses) if name else None for name in names))

    def error_of_failed_call(self, instance: Instance) -> FmuError:
        return instance.status_error((self.failed or b"").decode(), self.status)


def value_references(instance: Instance, names: Sequence[str]) -> Any:
    return (c_uint * len(names))(*(instance.variable(name).valueReference for name in names))
