"""Mass, frequency and damping of each half from knocks on it: the guess of a diagnosis."""

from __future__ import annotations

import os
import re
from operator import itemgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...constants import TURN
from ...errors import InputError
from ...lazy import xr
from ...model import Structure
from ...model.arguments import checked_word
from ...model.toml_files import write
from ...response.labels import variable
from ..pieces import Floats
from ..record import FORCES
from .frf import ESTIMATORS, frf

BAND = (0.2, 5.0)  # of the resonance: lines that are fitted
Complexes = NDArray[np.complex128]
MISFIT = 0.2  # of the response: one oscillator does not describe it
FITTED = {  # units, long names
    "mass": ("kg", "modal mass"),
    "frequency": ("Hz", "undamped natural frequency"),
    "damping": ("1", "damping ratio"),
}


def halves(
    record: xr.Dataset,
    other: xr.Dataset | None = None,
    *,
    thicknesses: tuple[float, float] | None = None,
    resolution: float | None = None,
    estimator: str = "H1",
    output: str | os.PathLike[str] | None = None,
) -> xr.Dataset:
    """Fit a structure to knocks of a hammer: the guess that a diagnosis needs.

    One oscillator is fitted to the response of the half that is struck, over the force. Two
    records of a delaminated structure, with knocks on either half so soft that the halves do not
    strike each other, make both halves. One of a sound beam, with the thicknesses of its layers,
    makes the halves that it would have (:meth:`orchestrate.Structure.from_bonded`).

    Parameters
    ----------
    record, other : xarray.Dataset
        As for :func:`orchestrate.frf`: with ``force1`` and ``acceleration1``, or ``force2`` and
        ``acceleration2``.
    thicknesses : tuple of float, optional
        Of layers 1 and 2, in place of ``other``.
    resolution : float, optional
        As in :func:`orchestrate.frf`.
    estimator : str
        ``"H1"``, ``"H2"`` or ``"Hv"``.
    output : path-like, optional
        TOML file with the structure, to complete by hand.

    Returns
    -------
    xarray.Dataset
        Over ``knocked`` (half 1, half 2): ``mass`` in kg, ``frequency`` in Hz and ``damping``
        (ratio), each with its standard error as ``mass_error``, ...; ``misfit``, what the
        oscillator leaves of the response, and ``averages``. The attributes are the structure's:
        ``Structure.from_attributes(result.attrs)``.

    Raises
    ------
    InputError
        Also where one oscillator leaves a fifth of the response: halves that touch, or strike each
        other, are not described by it.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam").replace(clearance=0.001)
    >>> knocks = [orchestrate.Hammer(peak=5.0, width=0.01, half=n, duration=8.0) for n in (1, 2)]
    >>> records = [orchestrate.shake(beam, one, sample_rate=500.0) for one in knocks]
    >>> orchestrate.halves(*records).frequency.values.round(2).tolist()
    [11.94, 13.08]
    """
    if (other is None) == (thicknesses is None):
        given = "neither" if other is None else "both"
        raise InputError(f"{given} of a second record and thicknesses= given; expected one of them")
    checked_word("estimator", estimator, ESTIMATORS)
    fits = []
    for name, one in (("record", record), ("other", other)):
        try:
            fits += [] if one is None else [fit_half(one, resolution, estimator)]
        except InputError as error:
            raise InputError(re.sub("^record", name, str(error))) from None
    fits.sort(key=itemgetter("knocked"))
    if thicknesses is not None:
        mass, f, zeta = (fits[0][name] for name in FITTED)
        structure = Structure.from_bonded(mass=mass, f=f, zeta=zeta, thicknesses=thicknesses)
    else:
        if (struck := [fit["knocked"] for fit in fits]) != [1, 2]:
            raise InputError(f"other: both knock on half {struck[0]}; expected one on each")
        (m1, f1, zeta1), (m2, f2, zeta2) = ([fit[name] for name in FITTED] for fit in fits)
        numbers: Any = {"m1": m1, "m2": m2, "f1": f1, "f2": f2, "zeta1": zeta1, "zeta2": zeta2}
        structure = Structure.from_halves(**numbers)
    if output is not None:
        write(output, structure=structure)
    texts = {}
    for name, (unit, text) in FITTED.items():
        texts[name] = unit, text
        texts[f"{name}_error"] = unit, f"standard error of the {text}"
    texts["misfit"] = "1", "what the oscillator leaves of the response, relative"
    texts |= {"averages": ("1", "knocks averaged"), "knocked": ("1", "half that is struck")}
    made = {n: variable("knocked", [fit[n] for fit in fits], *texts[n]) for n in texts}
    coordinates = {"knocked": made.pop("knocked")}
    parameters = {name: +value for name, value in structure.parameters().items()}  # no Booleans
    title = f"Halves by knocks: {structure.label()}"
    return xr.Dataset(made, coordinates, {"title": title, **parameters})


def fit_half(record: xr.Dataset, resolution: float | None, estimator: str) -> dict[str, float]:
    """Fit ``s^2/(m (s^2 + 2 zeta w s + w^2))`` to the acceleration over the force, by SciPy.

    Return the variables of :func:`halves`, with the half as ``knocked``.
    """
    from scipy.optimize import least_squares

    response = frf(record, resolution=resolution)
    driven = response.attrs["excitation"]
    name = driven.replace("force", "acceleration")
    if driven not in FORCES or name not in response.channel.values:
        expected = "expected force1 and acceleration1, or force2 and acceleration2"
        raise InputError(f"record: no force on a half with the half's acceleration; {expected}")
    own = response.sel(estimator=estimator, channel=name)
    f, curve = own.frequency.values, own.magnitude.values * np.exp(1j * own.phase.values)
    used = own.excited.values > 0
    peak = f[used][np.argmax(np.abs(curve[used]))]
    used &= (f >= BAND[0] * peak) & (f <= BAND[1] * peak)
    s = 1j * TURN * f[used] + float(response.get("window_decay", 0.0))
    curve, weight = curve[used], np.sqrt(own.force_psd.values[used])
    weight = weight / np.linalg.norm(weight * curve)
    start = mass_frequency_and_damping(s, curve, weight)

    def weighted_residual(parameters: Floats) -> Floats:
        m, f0, zeta = parameters * start
        w = TURN * f0
        away = weight * (s**2 / (m * (s**2 + 2.0 * zeta * w * s + w * w)) - curve)
        return np.concatenate([away.real, away.imag])

    fit = least_squares(weighted_residual, np.ones(3), method="lm", xtol=1e-12)
    misfit = float(np.sqrt(2.0 * fit.cost))
    if not misfit < MISFIT:
        text = "expected softer knocks, or a wedge: the halves must not touch each other"
        raise InputError(f"record: one oscillator leaves {100 * misfit:.0f} % of {name}; {text}")
    covariance = np.linalg.pinv(fit.jac.T @ fit.jac) * 2.0 * fit.cost / (2.0 * len(s) - 3.0)
    errors = np.sqrt(np.diag(covariance)) * np.abs(start)
    row = {"knocked": int(driven[-1]), "misfit": misfit, "averages": float(response.averages)}
    names = (*FITTED, *(f"{name}_error" for name in FITTED))
    return row | dict(zip(names, [*fit.x * start, *errors], strict=True))


def mass_frequency_and_damping(s: Complexes, curve: Complexes, weight: Floats) -> Floats:
    """Estimate mass, frequency, Hz, and damping ratio by ``1/H = m + d/s + k/s^2``: linear."""
    terms = np.stack([np.ones_like(s), 1.0 / s, 1.0 / s**2], axis=1)
    size = weight * np.abs(curve) ** 2
    rows, right = size[:, None] * terms, size / curve
    rows, right = np.vstack([rows.real, rows.imag]), np.concatenate([right.real, right.imag])
    scale = np.linalg.norm(rows, axis=0)
    m, d, k = np.linalg.lstsq(rows / scale, right, None)[0] / scale
    if not (m > 0.0 and k > 0.0):
        raise InputError("record: no resonance in the response to the knock; expected one")
    critical = 2.0 * np.sqrt(k * m)
    return np.array([m, np.sqrt(k / m) / TURN, max(d / critical, 1e-6)])
