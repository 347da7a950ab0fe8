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
    period = 2.0 * np.pi / np.array(plan.etas)

    def along_eta(values, dtype, long_name):
        return ("eta", np.array(values, dtype=dtype), {"units": "1", "long_name": long_name})

    variables = {
        "xi_rel": (
            ("eta", "sample"),
            np.array([r.xi_rel for r in responses]),
            {"units": "1", "long_name": "stroboscopic samples of the gap xi_2 - xi_1 at phase 0"},
        ),
        "xi_rel_max": along_eta([r.xi_rel_max for r in responses], float, "largest gap over the sampled periods, between samples too"),
        "impacts_per_period": along_eta([r.impacts_per_period for r in responses], float, "impacts per excitation period, mean over the samples"),
        "permanent_contact": along_eta([r.permanent_contact for r in responses], "i1", "1 where permanent contact occurs in the sampled periods"),
        "multiplicity": along_eta(
            [r.multiplicity for r in responses],
            "i4",
            "least n such that the state repeats after n periods within the tolerance; 0 where none does",
        ),
        "end_state": (
            ("eta", "coordinate"),
            np.array([r.end for r in responses]),
            {"units": "1", "long_name": "state at the last sample: the next eta starts from it"},
        ),
    }
    coordinates = {
        "eta": ("eta", np.array(plan.etas), {"units": "1", "long_name": "frequency ratio Omega/omega"}),
        "sample": ("sample", np.arange(plan.transient + 1, plan.transient + plan.samples + 1), {"units": "1", "long_name": "excitation period n"}),
        "coordinate": ("coordinate", np.array(["xi_1", "xi_2", "xi_1'", "xi_2'"])),
        "period": ("eta", period, {"units": "1", "long_name": "excitation period T = 2 pi/eta (22)"}),
    }
    case = plan.case
    attributes = {
        "title": f"Frequency sweep of the two-mass impact oscillator, e = {case.e:g}, D = {case.D:g}",
        "e": case.e,
        "D": case.D,
        "mu": case.mu,
        "kappa": case.kappa,
        "gamma": case.gamma,
        "transient_periods": plan.transient,
        "multiplicity_tolerance": plan.tolerance,
        "fmu_model": fmu.name,
        "fmu_guid": fmu.guid,
        "fmi_version": fmu.fmi_version,
    }
    return xarray.Dataset(variables, coordinates, attributes)
