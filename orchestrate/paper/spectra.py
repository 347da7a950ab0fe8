"""Amplitude spectra of the absolute acceleration, bonded against delaminated (the paper's Figure 3), the impacts' impulses included.

An impulse is no part of sampled accelerations, whatever the rate. It is in the displacement, which is continuous and has a kink there: the
spectrum of the acceleration as a distribution is omega^2 times that of the absolute displacement.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import xarray

from ..fmu import Instance
from ..jobs import Job
from ..trace import REST, begin, period, sampled
from .resolution import ELASTIC

PERIODS, POINTS, HIGHEST = 64, 1024, 40  # periods, states a period, highest multiple of eta shown
SETTLE = 2000
KINDS = ("bonded", "delaminated", "sampled")


def amplitudes(signal):
    """Amplitude spectrum by a Hann window: a sine of amplitude A in a whole number of periods shows as A."""
    window = np.hanning(len(signal) + 1)[:-1]
    return np.abs(np.fft.rfft(signal * window)) * 2.0 / window.sum()


def absolute(states, tau, eta):
    """Absolute displacement of mass 1 over a eta^2: relative to the box, plus the box's ``sin(eta tau)/eta^2``."""
    return states[:, 0] + np.sin(eta * tau) / eta**2


def spectrum(states, eta, case):
    """Orders, amplitudes with impulses, and amplitudes of the sampled acceleration ``-2 D xi_1' - xi_1`` (6).

    Parameters
    ----------
    states : ndarray, shape (PERIODS * POINTS, 4)
        From phase 0 on.
    eta : float
    case : Case
    """
    tau = np.arange(1, len(states) + 1) * period(eta) / POINTS
    orders = np.arange(len(states) // 2 + 1) / PERIODS
    shown = orders <= HIGHEST
    whole = (orders * eta) ** 2 * amplitudes(absolute(states, tau, eta))
    return orders[shown], whole[shown], amplitudes(-2.0 * case.D * states[:, 2] - states[:, 0])[shown]


@dataclass(frozen=True)
class SpectrumJob(Job):
    """Spectra at the delaminated structure's peak, and at 0.4 and 1.13 for comparison.

    Attributes
    ----------
    sweep : str
    """

    sweep: str = ""
    NEEDS: ClassVar[tuple] = ("sweep",)
    CHUNK: ClassVar[int] = 1

    def count(self):
        """Number of frequencies."""
        return 3

    def items(self, inputs):
        """The frequencies, the peak's found."""
        return [float(inputs[self.sweep].xi_rel_max.idxmax()), 0.4, 1.13]

    def work(self, fmu, items, carry):
        """One frequency: bonded, delaminated, and delaminated without its impulses."""
        (eta,) = items
        span, found = period(eta), []
        with Instance(fmu) as instance:
            for bonded in (True, False):
                begin(instance, ELASTIC, eta, REST, bonded=bonded)
                instance.step(0.0, SETTLE * span)
                found.append(spectrum(sampled(instance, SETTLE * span, (SETTLE + PERIODS) * span, PERIODS * POINTS), eta, ELASTIC))
        return {"amplitude": np.array([[found[0][1], found[1][1], found[1][2]]]), "order": found[0][0][None], "eta": np.array([eta])}

    def dataset(self, table, inputs):
        """Amplitudes over orders of eta."""
        text = "amplitude of the absolute acceleration of mass 1 over a eta^2 omega^2"
        variables = {"amplitude": (("eta", "kind", "order"), table["amplitude"], {"units": "1", "long_name": text})}
        coordinates = {"eta": table["eta"], "kind": list(KINDS), "order": table["order"][0]}
        return xarray.Dataset(variables, coordinates, {"title": "Spectra, bonded and delaminated"})
