"""A figure's data as a job: one item a panel, computed by the figure's own module."""

from dataclasses import dataclass
from importlib import import_module
from typing import ClassVar

import numpy as np
import xarray

from ..curves import KINDS
from ..jobs import Job

NUMBERS = (5, 7, 8, 9, 12)  # figures that are curves; 6, 10 and 11 are the sweeps themselves


def module(number):
    """The module of a figure."""
    return import_module(f"orchestrate.figures.figure{number}")


@dataclass(frozen=True)
class FigureJob(Job):
    """Curves of one figure.

    Attributes
    ----------
    number : int
    skip, keep : int
        Periods dropped and kept, where the paper names them.
    sweeps : tuple of str
        Names of the upward sweeps whose responses it starts from.
    """

    number: int = 5
    skip: int = 2000
    keep: int = 500
    sweeps: tuple = ()
    CHUNK: ClassVar[int] = 1

    def needs(self):
        """The sweeps."""
        return self.sweeps

    def count(self):
        """Number of panels."""
        return module(self.number).PANELS

    def items(self, inputs):
        """The panels with their numbers."""
        return list(enumerate(module(self.number).panels([inputs[name] for name in self.sweeps])))

    def work(self, fmu, items, carry):
        """One panel."""
        ((index, panel),) = items
        points, panel = module(self.number).compute(fmu, panel, self.skip, self.keep)
        about = [panel.case.e, panel.case.D, panel.eta, panel.multiplicity]
        return {**points, "panel": np.full(len(points["tau"]), index, dtype=np.int16), "about": np.array([about])}

    def dataset(self, table, inputs):
        """Points one after the other, with their panels."""
        units = {"units": "1"}
        variables = {
            "tau": ("point", table["tau"], {**units, "long_name": "non-dimensional time from the first period shown"}),
            "state": (("point", "coordinate"), table["state"], {**units, "long_name": "non-dimensional state"}),
            "kind": ("point", table["kind"], {"long_name": ", ".join(f"{i}: {kind}" for i, kind in enumerate(KINDS))}),
            "panel_of": ("point", table["panel"], {"long_name": "panel of the point"}),
            **{name: ("panel", table["about"][:, i], units) for i, name in enumerate(("e", "D", "eta"))},
            "multiplicity": ("panel", table["about"][:, 3].astype("i4"), {**units, "long_name": "of the sweep's response; 0: irregular"}),
        }
        coordinates = {"coordinate": ("coordinate", np.array(["xi_1", "xi_2", "xi_1'", "xi_2'"]))}
        return xarray.Dataset(variables, coordinates, {"title": f"Figure {self.number}"})


def figure_job(number, resolution, sweeps, guid):
    """The job of a figure.

    Parameters
    ----------
    number : int
        Of ``NUMBERS``.
    resolution : Resolution
    sweeps : list of SweepJob
        Upward sweeps of the three cases.
    guid : str
    """
    cases = sweeps if number == 12 else sweeps[:1]
    skip, keep = (resolution.skip, resolution.keep) if number in (8, 9) else (resolution.skip, 20 if number == 7 else 1)
    return FigureJob(f"figure{number}", guid, number, skip, keep, tuple(job.name for job in cases))
