"""Where a dataset comes from, in its attributes: the question, the FMU, the code, the time."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..version import __version__
from .identity import Fmu, Identity
from .job import Job, brief

if TYPE_CHECKING:
    import xarray as xr


def with_provenance(
    dataset: xr.Dataset, job: Job, identity: Identity, fmus: Mapping[str, Fmu], begun: str
) -> xr.Dataset:
    """A result with all attributes it is to have; those it has already stay.

    Parameters
    ----------
    dataset : xarray.Dataset
    job : Job
    identity : dict
    fmus : mapping of str to Fmu
    begun : str
        When the job was begun.
    """
    call = job.call()
    found: dict[str, Any] = {
        **flat(job.parameters()),
        **about_fmus(fmus),
        "Conventions": "CF-1.11",
        "source": f"vibroimpact {__version__}",
        "call": call,
        "history": f"{begun}: {call}",
        "identity": json.dumps(identity, sort_keys=True),
    }
    return dataset.assign_attrs({**found, **dataset.attrs})


def about_fmus(fmus: Mapping[str, Fmu]) -> dict[str, str]:
    """Name, GUID and FMI version of each FMU."""
    found: dict[str, str] = {}
    for model, fmu in fmus.items():
        ending = f"_{model}" if len(fmus) > 1 else ""
        found[f"fmu_model{ending}"] = fmu.name
        found[f"fmu_guid{ending}"] = fmu.guid
        found[f"fmi_version{ending}"] = fmu.fmi_version
    return found


def flat(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters as attributes of a NetCDF file: numbers and texts, without nesting."""
    found: dict[str, Any] = {}
    for name, value in parameters.items():
        if isinstance(value, dict) and "sha256" not in value:
            for inner, part in flat(value).items():
                found[f"{name}_{inner}" if inner in found else inner] = part
        elif isinstance(value, bool):
            found[name] = int(value)
        elif isinstance(value, (int, float, str)):
            found[name] = value
        elif value is not None:
            found[name] = brief(value)
    return found
