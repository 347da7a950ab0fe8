"""One FMU instance as a co-simulation master has it, and what its answers to steps mean.

A step's answer:

- OK: the run continues; after a warning, too, whose message :attr:`Instance.warnings` keeps.
- The FMU ends the simulation (FMI 3.0: ``terminateSimulation``; 2.0: a discarded step, of which
  ``fmi2Terminated`` is true), and logs no error: no step follows; the last one counts if it reached
  its end.
- A discarded step, an early return, which is never allowed here, an error: ``FmuError``, with what
  the FMU logged, or how far the step came.
"""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import Structure, byref, c_bool, c_double, c_void_p
from typing import Any

from ..errors import FmuError
from .fmi import value_references
from .instance import DISCARD, ERROR, Instance


class SimulationEnded(FmuError):
    """Raised if an FMU ends the simulation before the end of a step."""


ANSWERS = ("event", "terminate", "early")


class StepAnswer(Structure):
    """What an FMU answered to its last step, by FMI 3.0's names; the C source has the same."""

    _fields_ = (
        *((name, c_double) for name in ("time", "h", "last")),
        *((name, c_bool) for name in ANSWERS),
    )

    time: float
    h: float
    last: float
    terminate: bool
    early: bool


class Channel:
    """Set and get of an FMU instance's Real variables, with fixed lists of names."""

    def __init__(self, instance: Instance, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self.instance, self.inputs, self.outputs = instance, inputs, outputs
        self.answer = StepAnswer()
        self.ended = ""  # at what time, and why, the FMU ended the simulation
        self.kept = c_void_p()  # handle of the state that compiled code keeps

    def input_and_output_references(self) -> tuple[Any, Any]:
        """Return the value references of the inputs, and of the outputs, as C arrays."""
        inputs, outputs = self.inputs, self.outputs
        return value_references(self.instance, inputs), value_references(self.instance, outputs)

    def clear_messages(self) -> None:
        """Clear the FMU's log messages before a new call, so that an error shows only its own."""
        self.instance._messages.clear()

    def set_inputs(self, *values: float) -> None:
        """Set the FMU's inputs in the order of the constructor; fewer values: the first ones."""
        self.instance.set(**dict(zip(self.inputs[: len(values)], values, strict=True)))

    def get_outputs(self) -> list[float]:
        """Return the FMU's outputs in the order of the constructor; raise unless all are finite."""
        return self.instance.get(*self.outputs)

    def check_step(self, status: int, whole: bool) -> None:
        """Raise unless a step went well by this module's rule; note in ``ended`` if it is the last.

        ``whole`` says whether the step reached its end, :attr:`answer` what the FMU answered.
        """
        answer, name = self.answer, self.instance.description.name
        texts = [self.instance.logged_messages()]
        if answer.terminate and self.instance.logged_messages(ERROR):
            raise self.instance.error_from_log("")  # pythonfmu's answer to an exception
        if answer.terminate:
            texts = [f"the FMU {name} ended the simulation at t = {answer.last:.6g} s", *texts]
            self.ended = ": ".join(filter(None, texts))
        if status == DISCARD or (answer.early and not whole):
            span = f"its step from t = {answer.time:.6g} s to {answer.time + answer.h:.6g} s"
            done = f" (it came to {answer.last:.6g} s)" if answer.last > answer.time else ""
            early = f"returned early from {span}{done}, which was not allowed"
            why = f"discarded {span}{done}" if status == DISCARD else early
            unsaid = "it logged no cause; try a shorter step, and the limits of its inputs"
            cause = texts[-1] or (unsaid if status == DISCARD else "expected its end")
            raise FmuError(f"the FMU {name} {why}: {cause}")
        if self.ended and not whole:
            raise SimulationEnded(self.ended)
        self.instance.check_status("the step", status)

    def close(self) -> None:
        """Free the kept state; an FMU without states is not asked to."""
        if self.kept:
            free = "fmi3FreeFMUState" if self.instance.is_fmi3 else "fmi2FreeFMUstate"
            self.instance.prepare_call(free, byref(self.kept))()
            self.kept = c_void_p()
