"""Basin entropy and uncertainty exponent: how unpredictable is the attractor of a start."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..lazy import xr
from ..model.arguments import checked_integer
from ..response.labels import column_variables, make_dataset, variable

LEAST_BOXES = 4  # along each side of the plane
TEXTS = {
    "basin_entropy": "mean entropy of boxes of starts",
    "boundary_basin_entropy": "mean entropy of boxes with more than one attractor",
    "uncertainty_exponent": "exponent of the uncertain fraction over the box size",
    "uncertainty_exponent_error": "standard error of the exponent by the fit",
    "boundary_dimension": "box-counting dimension of the boundaries",
}
Labels = NDArray[np.int64]
Floats = NDArray[np.float64]


def box_entropies(labels: Labels, size: int) -> Floats:
    """Return ``-sum p ln p`` over the attractors' shares p, of each box of ``size`` x ``size``.

    Boxes with a start of overlapping masses (label -1) are left out.
    """
    rows, columns = (side // size for side in labels.shape)
    boxes = labels[: rows * size, : columns * size]
    boxes = boxes.reshape(rows, size, columns, size).swapaxes(1, 2).reshape(rows * columns, -1)
    boxes = boxes[(boxes >= 0).all(axis=1)]
    shares = np.stack([(boxes == label).mean(axis=1) for label in range(max(1, labels.max() + 1))])
    terms = np.where(shares > 0.0, -shares * np.log(np.where(shares > 0.0, shares, 1.0)), 0.0)
    return np.asarray(terms.sum(axis=0))


def basin_entropy(basins: xr.Dataset, *, box: int = 5) -> xr.Dataset:
    """Compute basin entropy, boundary basin entropy, and the uncertainty exponent of basins.

    Parameters
    ----------
    basins : xarray.Dataset
        What :func:`orchestrate.basin` has answered: a plane of starts.
    box : int
        Starts along each side of a box whose entropy is computed.

    Returns
    -------
    xarray.Dataset
        ``basin_entropy`` and ``boundary_basin_entropy`` (natural logarithms, so that above
        ln 2 = 0.693 boundaries are fractal; below that nothing is said); over ``box_size`` the
        ``uncertain_fraction`` of boxes with more than one attractor; ``uncertainty_exponent``
        alpha, by which that fraction shrinks with the size of the boxes, its standard error of
        the fit, and the ``boundary_dimension`` 2 - alpha: 1 for smooth boundaries.

    Raises
    ------
    InputError
        Where there are no basins, or fewer than four boxes along a side.

    Notes
    -----
    Basin entropy: Daza, Wagemakers, Georgeot, Guery-Odelin and Sanjuan, Scientific Reports 6, 31416
    (2016). Uncertainty exponent: Grebogi, McDonald, Ott and Yorke, Physics Letters A 99, 415
    (1983); here the fraction is that of boxes of starts. Boxes in which the masses would overlap
    at a start are left out.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from orchestrate.dynamics.basin_entropy import basin_entropy
    >>> halves = np.tile(np.arange(64) >= 30, (64, 1)).astype(int)
    >>> found = basin_entropy(xr.Dataset({"attractor_of": (("v_rel", "x_rel"), halves)}), box=4)
    >>> float(found.boundary_basin_entropy.round(4)), float(found.uncertain_fraction[0])
    (0.6931, 0.0)
    """
    size = checked_integer("box", box, 2)
    plane = getattr(basins, "attractor_of", None)
    if plane is None or len(plane.dims) != 2:
        raise InputError(f"basins: {type(basins).__name__} is no answer of basin; expected one")
    labels = np.asarray(plane.values, dtype=np.int64)
    max_size = min(labels.shape) // LEAST_BOXES
    if size > max_size:
        starts = f"{labels.shape[1]} x {labels.shape[0]} starts"
        raise InputError(f"box = {size}: of a plane of {starts}; expected at most {max_size}")
    entropies = box_entropies(labels, size)
    if not entropies.size:
        raise InputError(f"box = {size}: the masses overlap in each box; expected a smaller one")
    sizes = 2 ** np.arange(1, max_size.bit_length())
    uncertain = [box_entropies(labels, each) > 0.0 for each in sizes]
    fractions = np.array([boxes.mean() if boxes.size else math.nan for boxes in uncertain])
    exponent = error = math.nan
    known = fractions > 0.0  # not NaN, where the masses overlap in each box of a size
    if np.count_nonzero(known) >= 3:  # of boxes, through which a line is fitted in logs
        from scipy.stats import linregress

        sides = sizes[known] - 1.0  # from start to start
        line = linregress(np.log(sides), np.log(fractions[known]))
        exponent, error = float(line.slope), float(line.stderr)
    inside = entropies[entropies > 0.0]
    boundary = float(inside.mean()) if inside.size else math.nan
    numbers = float(entropies.mean()), boundary, exponent, error, 2.0 - exponent
    fraction = variable("box_size", fractions, "1", "share of boxes with more than one attractor")
    variables = {**column_variables((), TEXTS, numbers), "uncertain_fraction": fraction}
    coordinates = {"box_size": variable("box_size", sizes, "1", "starts along each side of a box")}
    return make_dataset(variables, coordinates, "Basin entropy", box=size)
