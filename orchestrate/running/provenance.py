"""Provenance of a dataset in its attributes: the question, the FMU, the code, the time."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..lazy import xr
from ..version import __version__
from .identity import Identity
from .job import Job, format_brief

if TYPE_CHECKING:
    from ..fmu.description import Description


def with_provenance(
    dataset: xr.Dataset, job: Job, identity: Identity, fmus: Mapping[str, Description], begun: str
) -> xr.Dataset:
    call = job.format_call()
    of_fmus: dict[str, str] = {}
    for model, fmu in fmus.items():
        ending = f"_{model}" if len(fmus) > 1 else ""
        own = {"fmu_model": fmu.name, "fmu_guid": fmu.guid, "fmi_version": fmu.fmi_version}
        of_fmus |= {f"{name}{ending}": text for name, text in own.items()}
    attributes: dict[str, Any] = {
        **flatten_parameters(job.parameters()),
        **of_fmus,
        "Conventions": "CF-1.11",
        "source": f"vibroimpact {__version__}",
        "question": job.asked,
        "call": call,
        "history": f"{begun}: {call}",
        "identity": json.dumps(identity, sort_keys=True),
    }
    return dataset.assign_attrs({**attributes, **dataset.attrs})


def describe_dataset(data: xr.Dataset) -> str:
    """Return what a dataset holds, for messages: a result of attractors, or a dataset over time."""
    if kind := data.attrs.get("question") or data.attrs.get("analysis"):
        return f"a result of {kind}"
    return f"a dataset over {', '.join(map(str, data.sizes)) or 'nothing'}"


def flatten_parameters(parameters: Mapping[str, Any]) -> dict[str, Any]:
    attributes: dict[str, Any] = {}
    for name, value in parameters.items():
        if isinstance(value, dict) and "sha256" not in value:
            for inner, part in flatten_parameters(value).items():
                attributes[f"{name}_{inner}" if inner in attributes else inner] = part
        elif isinstance(value, bool):
            attributes[name] = int(value)
        elif isinstance(value, (int, float, str)):
            attributes[name] = value
        elif value is not None:
            attributes[name] = format_brief(value)
    return attributes
