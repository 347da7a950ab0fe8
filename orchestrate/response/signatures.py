"""Public functions as questions: a function's signature says what its job's fields are.

Each argument is a field of the frozen dataclass that the job's class becomes, with its type and
default; its type says how it is checked, see :func:`orchestrate.model.arguments.checks_by_field`.
The function's own lines check what depends on several arguments and end in :func:`as_given`, or
return a result. Keywords beyond those named are how to compute: jobs, store.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import wraps
from inspect import Parameter
from typing import Any, NamedTuple, TypeVar, cast

from ..fmu import make_fmu_finder
from ..lazy import xr
from ..running.options import refuse_unknown_keywords
from ..running.runner import compute_dataset
from .questions import Question, checked_structure

Function = TypeVar("Function", bound=Callable[..., Any])


class ChangedFields(NamedTuple):
    """What a public function makes of its arguments before they are its job's fields."""

    label: str  # end of the result's name
    fields: dict[str, Any]


def as_given(label: str = "", /, **changed: Any) -> Any:
    """Answer by the arguments as given, but for those changed; ``label`` ends the result's name."""
    return ChangedFields(label, changed)


def question(kind: type[Question]) -> Callable[[Function], Function]:
    """Decorate a public function: its keywords become fields of ``kind``, a call runs that job."""

    def decorate(function: Function) -> Function:
        signature = inspect.signature(function)
        known = list(signature.parameters)
        make_fields_of_arguments(kind, function.__name__, signature.parameters)

        @wraps(function)
        def ask(*positional: Any, **keywords: Any) -> xr.Dataset:
            if "running" in known:  # else others are taken too
                refuse_unknown_keywords(keywords, known)
            changes = function(*positional, **keywords)
            if not isinstance(changes, ChangedFields):
                return changes
            call = signature.bind(*positional, **keywords)
            call.apply_defaults()
            structure = checked_structure(call.arguments["structure"]).label()
            name = f"{kind.result or kind.asked}_{structure}{changes.label}"
            running = changes.fields.pop("running", call.arguments.get("running", {}))
            names = {field.name for field in fields(kind)}.intersection(call.arguments)
            arguments = {name: call.arguments[name] for name in names}
            job = kind(**{"name": name, **arguments, **changes.fields})
            return compute_dataset(job.answering_job(), running, make_fmu_finder(running))

        return cast(Function, ask)

    return decorate


def make_fields_of_arguments(
    kind: type[Question], function: str, parameters: Mapping[str, Parameter]
) -> None:
    """Make a class a frozen dataclass whose fields are a function's arguments, and its own."""
    annotations = inspect.get_annotations(kind)
    for name, parameter in parameters.items():
        variadic = parameter.kind is Parameter.VAR_KEYWORD
        if variadic or name in kind.replaced or name in annotations or name == "structure":
            continue
        annotations[name] = parameter.annotation
        if parameter.default is not Parameter.empty:
            setattr(kind, name, parameter.default)
    kind.__annotations__, kind.asked = annotations, function
    dataclass(frozen=True, kw_only=True)(kind)
