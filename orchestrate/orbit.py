"""From a sweep's journal to a labelled dataset."""

import numpy as np
import xarray

from .sweep import Response


def dataset(plan, rows, fmu):
    """The sweep as a self-describing dataset.

    Parameters
    ----------
    plan : Plan
    rows : ndarray
        The journal's rows.
    fmu : Description

    Returns
    -------
    xarray.Dataset
        Dimensions eta and sample.
    """
    responses = [Response.from_row(row) for row in rows]
    return xarray.Dataset(variables(responses), coordinates(plan), attributes(plan, fmu))


def variables(responses):
    """What was computed at each eta."""

    def along_eta(name, dtype, long_name):
        return ("eta", np.array([getattr(r, name) for r in responses], dtype=dtype), {"units": "1", "long_name": long_name})

    def table(dimension, rows, long_name):
        return (("eta", dimension), np.array(rows), {"units": "1", "long_name": long_name})

    return {
        "xi_rel": table("sample", [r.xi_rel for r in responses], "stroboscopic samples of the gap xi_2 - xi_1 at phase 0"),
        "xi_rel_max": along_eta("xi_rel_max", float, "largest gap over the sampled periods, between samples too"),
        "impacts_per_period": along_eta("impacts_per_period", float, "impacts per excitation period, mean over the samples"),
        "permanent_contact": along_eta("permanent_contact", "i1", "1 where permanent contact occurs in the sampled periods"),
        "multiplicity": along_eta("multiplicity", "i4", "least n such that the state repeats after n periods within the tolerance; 0: none"),
        "end_state": table("coordinate", [r.end for r in responses], "state at the last sample: the next eta starts from it"),
    }


def coordinates(plan):
    """Frequencies, periods and names."""
    etas = np.array(plan.etas)
    numbers = np.arange(plan.transient + 1, plan.transient + plan.samples + 1)
    return {
        "eta": ("eta", etas, {"units": "1", "long_name": "frequency ratio Omega/omega"}),
        "sample": ("sample", numbers, {"units": "1", "long_name": "excitation period n"}),
        "coordinate": ("coordinate", np.array(["xi_1", "xi_2", "xi_1'", "xi_2'"])),
        "period": ("eta", 2.0 * np.pi / etas, {"units": "1", "long_name": "excitation period T = 2 pi/eta (22)"}),
    }


def attributes(plan, fmu):
    """Every parameter, and the FMU that computed it."""
    case = plan.case
    return {
        "title": f"Frequency sweep of the two-mass impact oscillator, e = {case.e:g}, D = {case.D:g}",
        **{name: getattr(case, name) for name in ("e", "D", "mu", "kappa", "gamma")},
        "transient_periods": plan.transient,
        "multiplicity_tolerance": plan.tolerance,
        "fmu_model": fmu.name,
        "fmu_guid": fmu.guid,
        "fmi_version": fmu.fmi_version,
    }
